"""What drives a flow, and how large changes of its results are against the largest of them."""

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.case.case import Case
from fsi.integration.state import Results

# A result that is smaller than this part of what drives the flow may be zero by symmetry.
LEAST = 0.01
# Of the largest result: what the factorisation leaves at gaps of 1e-5 radii, where it is worst.
ROUNDING = 1e-11


@dataclass(frozen=True, slots=True)
class FlowScales:
    """What drives a flow, in the units of a case.

    Attributes:
        velocity: the rate of shear times the largest radius a, or the speed of swimmers, the larger one.
        resistance: force over velocity: mu in the plane, per unit length, and mu a for spheres.
        thrust: the pressure outside open walls times the surface of the largest body, on which it cancels.
    """

    velocity: float
    resistance: float
    thrust: float = 0.0

    def largest(self, results: Results, arm: Array) -> tuple[float, float]:
        """The largest velocity and load, of all modes and what drives them; arm: as for `relative_change`."""
        speed = max(float(np.abs(results.U * arm).max(initial=0.0)), self.velocity)
        return speed, max(float(np.abs(results.F / arm).max(initial=0.0)), self.resistance * speed)

    @property
    def rounding(self) -> tuple[float, float]:
        """The velocity and the load that rounding leaves of a pressure all around a body."""
        load = ROUNDING * self.thrust
        return load / self.resistance if load else 0.0, load


def flow_scales(case: Case, t: float) -> FlowScales:
    """What walls, mean flow and swimmers do at time t.

    A wall shears at its speed over the size of the container.
    """
    radius = max((body.radius for body in case.bodies), default=0.0)
    container = case.container()
    size, walls = container.size(), case.wall_velocity(t).values()
    rates = [
        float(np.linalg.norm(wall.velocity)) / size + float(np.abs(wall.gradient).max()) for wall in walls
    ]
    rates += [abs(stress) / case.fluid.viscosity for stress in case.wall_stress(t).values()]
    rate = max([*rates, float(np.abs(container.mean_gradient).max())])
    swimming = (abs(mode) for body in case.bodies for mode in body.surface_velocity or ())
    surface = 4.0 * pi * radius**2 if case.spheres else 2.0 * pi * radius
    return FlowScales(
        max(rate * radius, max(swimming, default=0.0)),
        case.fluid.viscosity * (radius if case.spheres else 1.0),
        max(map(abs, case.wall_pressure().values()), default=0.0) * surface,
    )


def rounded_dissipation(case: Case, t: float) -> float:
    """What rounding leaves of that of walls which carry the fluid along, and of pressures alike.

    `ROUNDING^2 (mu U^2 + p^2 L^2 / mu)` with the size L of the container, times L in space and with an axis.
    """
    size, mu = case.container().size(), case.fluid.viscosity
    speed = max(
        (float(np.linalg.norm(wall.velocity)) for wall in case.wall_velocity(t).values()), default=0.0
    )
    pressure = max(map(abs, case.wall_pressure().values()), default=0.0)
    power = mu * speed**2 + (pressure * size) ** 2 / mu
    return ROUNDING**2 * power * (size if case.spheres else 1.0)


def relative_change(
    results: Results, change: Results, held: NDArray[np.bool_], arm: Array, scales: FlowScales
) -> dict[str, float]:
    """A change of the results over the largest result: loads on held components, velocities of free ones.

    Gives "force" and "velocity", largest |change| / largest |result|, each only if there is such a result.
    Where symmetry makes all of a kind zero, what is computed is an error itself: a hundredth of what drives
    the flow is the least that a change counts over. Where nothing drives one, a change may be what rounding
    leaves of a pressure; that is none. arm: 1 for translations, the radius for rotations, (N, M).
    """
    F, V, relative = results.F / arm, results.U * arm, {}
    (speed, force), (slow, weak) = scales.largest(results, arm), scales.rounding
    for name, of_kind, values, changed, scale, rounding in (
        ("force", held, F, change.F / arm, force, weak),
        ("velocity", ~held, V, change.U * arm, speed, slow),
    ):
        if np.any(values[of_kind]):
            largest = max(float(np.abs(values[of_kind]).max()), LEAST * scale)
            off = float(np.abs(changed[of_kind]).max())
            relative[name] = off / largest if off > rounding else 0.0
    return relative
