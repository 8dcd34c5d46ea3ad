"""The necks between bodies, and bodies and walls: what is dissipated in them, what flows through them.

The fluid of a neck is the two strips along it, on both sides of the shortest segment between two surfaces,
out to the inscribed circles of its pores (`fsi.pores.quadrature`). Necks to fluid discs are left out: these
are no bodies.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.pores.assembly import Batch
from fsi.pores.carrier import stream
from fsi.pores.fields import stream_function
from fsi.pores.forms import rates_of_numbers, with_bubbles
from fsi.pores.pore_data import Complex, pore_data
from fsi.pores.quadrature import Points, pore_points, uniform
from fsi.pores.regions import NEXT, OTHER
from fsi.pores.solve import PoreFlow

# Hardly off the feet of a neck.
_FEET = np.array([[1e-9, 1.0 - 1e-9], [1.0, 1.0]])
_MIDDLE = np.array([[1e-9], [1.0]])


@dataclass(frozen=True, slots=True)
class Necks:
    """K necks.

    Attributes:
        sides: positions in the bodies followed by the walls, (K, 2); the first is a body.
        image: of the second side, in periods, seen from the first, (K, 2).
        gap: their lengths, (K,).
        dissipation: of the fluid in them, (K,).
        flux: psi on the second side less psi on the first, what flows to the right of the way from the first
            to the second, (K,).
    """

    sides: NDArray[np.int64]
    image: NDArray[np.int64]
    gap: Array
    dissipation: Array
    flux: Array


def necks_of(flow: PoreFlow) -> Necks:
    """The necks of a flow between bodies, and bodies and walls."""
    system = flow.system
    pores, surfaces = system.pores, system.pores.surfaces
    dissipation, flux = np.zeros(len(pores.necks)), np.zeros(len(pores.necks))
    for batch in system.assembly.batches:
        shapes = system.shapes.of(batch.pore)
        rates, points = rates_of_numbers(shapes, batch.rule, batch.orders)
        numbers = with_bubbles(rates, flow.numbers(batch))
        lost = system.viscosity * _in_strips(rates, points, numbers)
        through = _fluxes(flow, batch, pore_data(shapes), batch.of_functions(numbers))
        neck = pores.sides[batch.pore]
        there = neck >= 0
        np.add.at(dissipation, neck[there], lost[there])
        flux[neck[there]] = through[there]
    kept = ~surfaces.fluid[pores.necks].any(axis=1)
    sides = np.where(pores.necks < system.bodies, pores.necks, pores.necks - surfaces.discs + system.bodies)
    return Necks(sides[kept], pores.neck_image[kept], pores.neck_gap[kept], dissipation[kept], flux[kept])


def _in_strips(rates: Array, points: Points, numbers: Array) -> Array:
    """What is dissipated in the strips along the sides of pores, of fluid of viscosity 1, (n, 3)."""
    total = np.einsum("em,emkq->ekq", numbers, rates)
    lost = np.cumsum(np.sum(total**2, axis=1), axis=1)
    at_ends = np.take_along_axis(lost, points.ends[:, :3] - 1, axis=1)
    return np.diff(at_ends, axis=1, prepend=0.0)


def _fluxes(flow: PoreFlow, batch: Batch, data: Complex, numbers: Array) -> Array:
    """psi at the second foot of the neck on each side of pores less psi at the first, (n, 3).

    As the neck is seen from its first surface in its base place: images move with the mean flow.
    """
    system, G = flow.system, flow.loading.gradient
    shapes = system.shapes.of(batch.pore)
    psi = stream_function(data, pore_points(data, uniform(_MIDDLE, _FEET, _MIDDLE)), batch, numbers)[0]
    rise = np.diff(psi[:, :6].reshape(-1, 3, 2))[..., 0]
    periods = np.zeros((2, 2))
    periods[: len(system.pores.surfaces.periods)] = system.pores.surfaces.periods
    first = np.where(shapes.turn > 0.0, NEXT, OTHER)
    image = np.take_along_axis(system.pores.image[batch.pore], first[..., None], axis=1)
    e = (image @ periods)[:, :, None]
    carried = np.diff(stream(G, shapes.foot) - stream(G, shapes.foot - e))[..., 0]
    return np.asarray(0.0 + shapes.turn * (rise - carried))  # 0.0: no -0
