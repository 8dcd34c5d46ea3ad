"""What the stress of point forces does in pores: with it stresses in equilibrium have a single-valued phi.

A body on which the fluid exerts -F leaves Airy's function many-valued around it. The stress of a point force
at its centre does as much, and is in equilibrium without the body: what a stress has more than that is of a
single-valued phi (`fsi.pores.complement`). As strain rates of functions, sigma' is

    (2 phi_xy, phi_yy - phi_xx) = (-2 sigma_xy, sigma_xx - sigma_yy).
"""

from __future__ import annotations

import numpy as np

from fsi.arrays import Array
from fsi.pores.assembly import Batch, FluidForms
from fsi.pores.force_series import ForceSeries
from fsi.pores.forms import rates_of_numbers, with_bubbles
from fsi.pores.inner import inner_flow
from fsi.pores.orders import RIGID
from fsi.pores.quadrature import ROOT, Points
from fsi.pores.system import PoreSystem

_DIGITS, _MOST = 18.0, 256  # what points around a fluid disc leave is exp(-18) of all; how many there are


def functions_beside(system: PoreSystem, batch: Batch, numbers: Array, forces: ForceSeries | None) -> Array:
    """Numbers of all functions of pores, (n, total), whose bubbles make least of the stress with them."""
    rates, points = rates_of_numbers(system.shapes.of(batch.pore), batch.rule, batch.orders)
    if forces is None:
        return batch.of_functions(with_bubbles(rates, numbers))
    m = numbers.shape[1]
    of_all = _beside(rates, m, rates_of(forces, batch, points))
    found = with_bubbles(of_all, np.pad(numbers, ((0, 0), (0, 1)), constant_values=1.0))
    return batch.of_functions(np.delete(found, m, axis=1))


def of_pores(system: PoreSystem, batch: Batch, forces: ForceSeries) -> tuple[Array, float]:
    """Products of the numbers of pores with the stress of forces, (n, m), and of that with itself.

    Both less what bubbles take off.
    """
    rates, points = rates_of_numbers(system.shapes.of(batch.pore), batch.rule, batch.orders)
    m = batch.unknown.shape[1]
    of_all, alone = _beside(rates, m, rates_of(forces, batch, points)), np.zeros((len(rates), m + 1))
    alone[:, m] = 1.0
    left = np.einsum("em,emdq->edq", with_bubbles(of_all, alone), of_all)
    return np.einsum("emdq,edq->em", rates[:, :m], left), float(np.sum(left**2))


def of_fluid_discs(system: PoreSystem, forms: FluidForms, forces: ForceSeries) -> tuple[Array, float]:
    """The same of the numbers of fluid discs of one order, (n, m), whose functions are biharmonic."""
    surfaces = system.pores.surfaces
    radius, bodies = surfaces.radius[forms.disc], ~surfaces.fluid & (surfaces.normal == 0.0).all(axis=1)
    order = int(system.assembly.numbering.order[forms.disc[0]])
    nearest = float(surfaces.radius[bodies].min())
    around = order + int(min(_MOST, _DIGITS / np.log1p(nearest / float(radius.max()))))
    t, weight = np.polynomial.legendre.leggauss(order + 4)
    t, weight = 0.5 * (t + 1.0), 0.5 * weight
    angle = 2.0 * np.pi * np.arange(around) / around
    r = np.stack(np.broadcast_arrays(t[:, None] * np.cos(angle), t[:, None] * np.sin(angle)), -1).reshape(
        -1, 2
    )
    weight = np.repeat(2.0 * np.pi / around * weight * t, around)
    jets = [
        inner_flow(r, np.ones(len(r)), np.broadcast_to(one, (len(r), len(one))), order)
        for one in np.eye(forms.unknown.shape[1])[RIGID:]
    ]
    unit = np.array([(2.0 * jet[4], jet[5] - jet[3]) for jet in jets])
    place = len(system.pores) + np.searchsorted(np.flatnonzero(surfaces.fluid), forms.disc)
    _, D = forces.stress(place, surfaces.centre[forms.disc, None] + radius[:, None, None] * r)
    own = np.stack([-2.0 * D.imag, 2.0 * D.real])
    products = np.einsum("fdq,deq,q->ef", unit, own, weight)
    energy = np.einsum("deq,deq,q,e->", own, own, weight, radius**2)
    return np.pad(products, ((0, 0), (RIGID, 0))), float(energy)


def rates_of(forces: ForceSeries, batch: Batch, points: Points) -> Array:
    """As of functions, times roots of weights, (n, 2, Q)."""
    _, D = forces.stress(batch.pore, points.places)
    return np.asarray(points.rows[:, None, ROOT] * np.stack([-2.0 * D.imag, 2.0 * D.real], axis=1))


def _beside(rates: Array, m: int, own: Array) -> Array:
    """Rates of m numbers, of the forces, then of bubbles."""
    return np.concatenate([rates[:, :m], own[:, None], rates[:, m:]], axis=1)
