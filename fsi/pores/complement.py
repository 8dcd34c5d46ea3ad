"""The stress in equilibrium that dissipates least in pores: a pressure, in cells and channels a lower bound.

In the plane a stress in equilibrium has Airy's function phi, sigma = (phi_yy, -phi_xy; -phi_xy, phi_xx).
Bodies without force and torque leave phi and grad phi single-valued; apart from that phi is free on their
circles. By the complementary principle (the least dissipation W at a mean strain rate E, |Omega| the area)

    W >= 2 |Omega| Sigma : E - 1/mu int over the fluid of (sigma' : sigma') / 2

for all of them, Sigma the mean stress. Of deviators (s, d) = (sigma_xy, (sigma_xx - sigma_yy) / 2)

    1/mu int (sigma' : sigma') / 2 = 1/(4 mu) int 4 phi_xy^2 + (phi_yy - phi_xx)^2,

the form of psi. So the least of it at a mean stress is found by the elements of psi, with functions on bodies
that leave it free there (`free_functions`), and a mean stress (s, d) is a mean gradient, G = s diag(-1, 1) +
d [[0, 1], [1, 0]]. With |Omega| (s, d) M (s, d) / mu this least and e = (E_xy, E_xx), the best stress gives

    (s, d) = 2 mu M^-1 e,   W >= 4 mu |Omega| e M^-1 e,   mu_app / mu >= e M^-1 e / |e|^2.

Walls of a channel that slide have power 2 s E_xy |Omega| in a stress that is free on them too. They bear
opposite forces, and a pressure costs nothing, so that s alone counts: mu_app / mu >= 1 / M_ss.

The lower bound is as exact as the upper one: but for quadrature. And as the two come together, the best
stress tends to that of the flow, with its pressure (`fsi.pores.pressure`).

Bodies with loads leave phi many-valued. The stress of point forces at their centres has all of that, and what
they have more than it is of a single-valued phi as above (`fsi.pores.pushed`). With c the products over
4 |Omega| of the mean stresses with it, (s, d) = M^-1 (2 mu e - c). No bound of the viscosity is made of it.
In a box phi is free in the corners too, and its walls, which rest, are as a container.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array, Indices
from fsi.pores.assembly import Batch
from fsi.pores.carrier import carried, stream
from fsi.pores.definite import Cholesky
from fsi.pores.force_series import ForceSeries
from fsi.pores.orders import KNOTS, RIGID, numbers_of
from fsi.pores.pushed import functions_beside, of_fluid_discs, of_pores
from fsi.pores.regions import NEXT, OTHER
from fsi.pores.surfaces import DISC, WALL
from fsi.pores.system import PoreSystem
from fsi.pores.topology import Pores

# Modes of a neck: with one pressures in narrow necks are off by half of themselves, with 16 rounding tells.
FEWEST, MOST = 2, 12
_STRESSES = (np.diag([-1.0, 1.0]), np.array([[0.0, 1.0], [1.0, 0.0]]))


@dataclass(frozen=True, slots=True, eq=False)
class AiryStress:
    """A stress in equilibrium, by the numbers of its phi: those of psi of a `PoreFlow`, and used like them.

    Attributes:
        system: whose numbers these are; bodies are hollow.
        x: all numbers, what they have more than the mean stress carries along, (n,).
        mean: (phi_y, -phi_x) = mean x of the mean stress, (2, 2).
        forces: whose stress stands beside that of phi, if any.
    """

    system: PoreSystem
    x: Array
    mean: Array
    forces: ForceSeries | None

    @property
    def gradient(self) -> Array:
        """By which (phi_y, -phi_x) differs from image to image, which no stress tells: nothing, (2, 2)."""
        return np.zeros((2, 2))

    def functions(self, batch: Batch) -> Array:
        """Of all functions of the pores of a batch, (n, total), but for a linear function of each pore."""
        numbers = self.x[batch.unknown] + _carried(self.system, batch, self.mean)
        return functions_beside(self.system, batch, numbers, self.forces)


@dataclass(frozen=True, slots=True, eq=False)
class LeastStresses:
    """The stresses of least dissipation at mean stresses, and that of bodies with loads.

    Attributes:
        system: of phi, whose bodies are hollow; of fluid of viscosity 1.
        means: the m mean stresses, of s and, of a cell, of d, as G above; none without periods.
        forces: the loads, if any.
        x: numbers beside each, (n, m), then beside the forces, (n, 1).
        M: their products over 4 |Omega|, as above, (m, m).
        c: those with the forces, (m,); 0 without.
    """

    system: PoreSystem
    means: tuple[Array, ...]
    forces: ForceSeries | None
    x: Array
    M: Array
    c: Array

    @classmethod
    def of(cls, pores: Pores, modes: Indices, forces: ForceSeries | None = None) -> LeastStresses:
        """With these numbers of modes for the necks, (K,). Raises SolveError."""
        surfaces = replace(pores.surfaces, hollow=True)
        system = PoreSystem.of(0, replace(pores, surfaces=surfaces), np.clip(modes, FEWEST, MOST), 1.0)
        means = _STRESSES[: len(surfaces.periods)]
        x, products = _least(system, means, forces)
        M, c = np.split(products[: len(means)] / (4.0 * surfaces.area), [len(means)], axis=1)
        return cls(system, means, forces, x, M, c.sum(axis=1))

    def viscosity(self, E: Array) -> float:
        """Below the apparent viscosity over mu in the mean strain rate E, of a channel that of its walls.

        Of bodies without loads.
        """
        e = self._rates(E)
        return float(e @ np.linalg.solve(self.M, e) / (e @ e))

    def stress(self, E: Array, mu: float) -> AiryStress:
        """The best of them in the mean strain rate E, of fluid of viscosity mu."""
        m = len(self.means)
        means = np.linalg.solve(self.M, 2.0 * mu * self._rates(E) - self.c)
        mean = sum((size * G for size, G in zip(means, self.means, strict=True)), np.zeros((2, 2)))
        x = self.x[:, :m] @ means + self.x[:, m:].sum(axis=1)
        return AiryStress(self.system, x, mean, self.forces)

    def _rates(self, E: Array) -> Array:
        """e, of a channel E_xy alone."""
        return np.array([E[0, 1], E[0, 0]])[: len(self.means)]


def _least(system: PoreSystem, means: Sequence[Array], forces: ForceSeries | None) -> tuple[Array, Array]:
    """The best stresses beside these means, then beside forces: numbers (n, k), and products (k, k)."""
    m, k = len(means), len(means) + (forces is not None)
    loads, alone = np.zeros((system.size, k)), np.zeros((k, k))
    if not k:  # fluid that is enclosed all round, around bodies without loads
        return loads, alone
    for batch in system.assembly.batches:
        q = np.zeros((*batch.unknown.shape, k))
        for g, mean in enumerate(means):
            q[..., g] = _carried(system, batch, mean)
        Kq = np.einsum("eij,ejg->eig", batch.forms.K, q)
        if forces is not None:
            Kq[..., m], energy = of_pores(system, batch, forces)
            alone[m, m] += energy
        np.subtract.at(loads, batch.unknown.ravel(), Kq.reshape(-1, k))
        alone += np.einsum("eig,eih->gh", q, Kq)
    if forces is not None:
        for forms in system.assembly.fluid:
            products, energy = of_fluid_discs(system, forms, forces)
            loads[forms.unknown, m] -= products
            alone[m, m] += energy
        alone[m, :m] = alone[:m, m]
    free = _free(system)
    x = np.zeros_like(loads)
    x[free] = Cholesky(system.assembly.lower, free).solve(loads[free])
    return x, np.asarray(alone - x.T @ loads)


def _free(system: PoreSystem) -> NDArray[np.bool_]:
    """Which numbers are free, (n,), once what costs nothing is held.

    Rigid numbers of bodies: knots do what they do. phi = 1, between walls phi = y, in a container any linear
    function and |x|^2: f, g of a knot on a wall, f, f', g of one and f of another on a container.
    """
    numbering, surfaces = system.assembly.numbering, system.pores.surfaces
    free = np.ones(system.size, bool)
    free[numbering.surface[:-1][surfaces.free, None] + np.arange(RIGID)] = False
    last = numbering.neck[1:] - KNOTS
    if not surfaces.bounds:
        free[last[np.argmax(numbering.knots)]] = False
        return free
    first, *others = last[surfaces.kind[system.pores.necks[:, 1]] != DISC]
    if len(surfaces.periods):
        free[[first, first + 2]] = False
    else:
        free[[first, first + 1, first + 2, others[0]]] = False
    return free


def _carried(system: PoreSystem, batch: Batch, G: Array) -> Array:
    """`carried`, walls not by rigid numbers but at their knots, which strain them, (n, m)."""
    q, orders = carried(system, batch, G), batch.orders
    shapes, k = system.shapes.of(batch.pore), 0
    for v in range(3):
        wall = shapes.kind[:, v] == WALL
        q[wall, k : k + RIGID] = 0.0
        k += numbers_of(orders.fluid[v])
    for v in range(3):
        k += orders.modes[v]
        if orders.knots[v]:
            last = k + orders.knots[v] - KNOTS  # a wall is the second surface of a neck
            for end, vertex in enumerate((NEXT[v], OTHER[v])):
                wall = shapes.kind[:, vertex] == WALL
                x = shapes.foot[wall, v, end] - shapes.centre[wall, 0]
                q[wall, last : last + KNOTS] = _at_knot(x, shapes.normal[wall, vertex], G)
            k += orders.knots[v]
    return q


def _at_knot(x: Array, n: Array, G: Array) -> Array:
    """f, f', g, g' of the flow u = G x on a wall of normals n, (n, KNOTS)."""
    e, u = np.column_stack([n[:, 1], -n[:, 0]]), x @ G.T
    slope = np.column_stack([-u[:, 1], u[:, 0]])
    bend = np.array([[-G[1, 0], G[0, 0]], [G[0, 0], G[0, 1]]])
    along, across = np.sum(e * slope, axis=1), np.sum(n * slope, axis=1)
    return np.column_stack([stream(G, x), along, across, np.sum((e @ bend) * n, axis=1)])
