"""The strain that a suspension has undergone."""

import numpy as np

from fsi.arrays import Array
from fsi.case.case import Case
from fsi.meshes.geometry.channel import CHANNEL, gradient_between, wall_heights


def strain_rate(case: Case, t: float) -> Array | None:
    """E, the symmetric gradient of the mean flow of a channel or a cell at time t, (d, d); else None."""
    gradient = _mean_gradient(case, t)
    if gradient is None:
        return None
    symmetric: Array = 0.5 * (gradient + gradient.T)
    return symmetric


def shear_rate(case: Case, t: float) -> float | None:
    """The shear rate that the walls of a channel, or the mean flow of a cell, impose at time t.

    It is sqrt(2 E:E), E the symmetric gradient; of a shear its rate, of an extension of the plane twice that.
    Of a channel, |u_top - u_bottom| / H, it has the sign of u_top - u_bottom: walls may go to and fro.
    Nothing where there is no such flow.
    """
    gradient = _mean_gradient(case, t)
    if gradient is None:
        return None
    rate = float(np.sqrt(0.5 * np.sum((gradient + gradient.T) ** 2)))
    return float(np.copysign(rate, gradient.sum())) if case.container().walls else rate


def _mean_gradient(case: Case, t: float) -> Array | None:
    """Rows (dV_i / dx_j) of a cell, or of what both walls of a channel impose, (d, d); else None.

    None too where a stress moves a wall or a cell: the case does not know the rate, steps.csv does, by
    `speed_top` or `shear_rate`.
    """
    container, walls = case.container(), case.wall_velocity(t)
    if not len(container.periods) or case.domain.mean_drive().mean_stress is not None:
        return None
    if not container.walls:
        return container.mean_gradient
    if set(container.walls) != set(CHANNEL) or set(walls) != set(CHANNEL):
        return None
    up, heights = np.eye(container.dimension)[-1], wall_heights(container)
    return gradient_between(container, {name: wall.at(heights[name] * up) for name, wall in walls.items()})


def accumulated_strain(case: Case, t: Array) -> Array | None:
    """The strain from time 0 to times t (n,), the integral of the shear rate; None where there is none."""
    if shear_rate(case, 0.0) is None:
        return None
    kinks = [kink for kink in case.kinks() if kink < t[-1]]
    fine = np.unique(np.concatenate([[0.0], kinks, t]))  # the rate is linear in between
    rate = np.array([shear_rate(case, float(at)) for at in fine])
    strain = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(fine))])
    summed: Array = np.interp(t, fine, strain)
    return summed
