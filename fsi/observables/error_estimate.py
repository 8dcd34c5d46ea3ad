"""How accurate U and F of an instant are: bounds of their errors, and the one number that sums them up."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fsi.bodies.configuration import Array
from fsi.integration.step_errors import Results
from fsi.observables.flow_scales import FlowScales

# A result that is smaller than this part of what drives the flow may be zero by symmetry.
LEAST = 0.01


def relative_change(
    results: Results, change: Results, held: NDArray[np.bool_], arm: Array, scales: FlowScales
) -> dict[str, float]:
    """A change of the results over the largest result.

    Results are the loads on held components and the velocities of free ones. Where symmetry makes all of a
    kind zero, what is computed is an error itself: a hundredth of what drives the flow is the least that a
    change counts over.

    Args:
        results: U and F.
        change: their changes or errors, of any sign.
        held: which velocities are prescribed, shape (N, M).
        arm: 1 for translations, the radius for rotations, shape (N, M).
        scales: a velocity and a resistance of the flow.

    Returns:
        "force" and "velocity": largest |change| / largest |result|, each only if there is such a result.
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
