"""How accurate U and F of an instant are: bounds of their errors, and the one number that sums them up."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fsi.bodies.configuration import Array
from fsi.case.case import Case
from fsi.integration.step_errors import Results


@dataclass(frozen=True, slots=True)
class FlowScales:
    """Rate of shear times the largest radius; force over velocity, mu in the plane and mu a for spheres."""

    velocity: float
    resistance: float


def flow_scales(case: Case, t: float) -> FlowScales:
    """What walls and mean flow do at time t; a wall shears at its speed over the size of the container."""
    radius = max((body.radius for body in case.bodies), default=0.0)
    container = case.container()
    size, walls = container.size(), case.wall_velocity(t).values()
    rates = [float(np.linalg.norm(wall.velocity)) / size + abs(wall.shear) for wall in walls]
    rate = max([*rates, float(np.abs(container.mean_gradient).max())])
    return FlowScales(rate * radius, case.fluid.viscosity * (radius if case.spheres else 1.0))


# A result that is smaller than this part of what drives the flow may be zero by symmetry.
LEAST = 0.01


def relative_change(
    results: Results, change: Results, held: NDArray[np.bool_], arm: Array, scales: FlowScales
) -> dict[str, float]:
    """A change of the results over the largest result: loads on held components, velocities of free ones.

    Gives "force" and "velocity", largest |change| / largest |result|, each only if there is such a result.
    Where symmetry makes all of a kind zero, what is computed is an error itself: a hundredth of what drives
    the flow is the least that a change counts over. arm: 1 for translations, the radius for rotations, (N,
    M).
    """
    F, V = results.F / arm, results.U * arm
    speed = max(float(np.abs(V).max(initial=0.0)), scales.velocity)
    force = max(float(np.abs(F).max(initial=0.0)), scales.resistance * speed)
    relative = {}
    for name, of_kind, values, changed, scale in (
        ("force", held, F, change.F / arm, force),
        ("velocity", ~held, V, change.U * arm, speed),
    ):
        if np.any(values[of_kind]):
            largest = max(float(np.abs(values[of_kind]).max()), LEAST * scale)
            relative[name] = float(np.abs(changed[of_kind]).max()) / largest
    return relative
