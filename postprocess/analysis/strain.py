"""The strain that a suspension has undergone."""

import numpy as np

from fsi.bodies.configuration import Array
from fsi.case.case import Case


def strain_rate(case: Case, t: float) -> Array | None:
    """E, the symmetric gradient of the mean flow of a channel or a cell at time t, (2, 2); else None."""
    gradient = _mean_gradient(case, t)
    if gradient is None:
        return None
    symmetric: Array = 0.5 * (gradient + gradient.T)
    return symmetric


def shear_rate(case: Case, t: float) -> float | None:
    """The shear rate that the walls of a channel, or the mean flow of a cell, impose at time t.

    Channel: (u_top - u_bottom) / H. Cell: sqrt(2 E:E), E the symmetric gradient; of a shear its rate, of an
    extension twice that. Nothing where there is no such flow.
    """
    gradient = _mean_gradient(case, t)
    if gradient is None or case.container().walls:
        return None if gradient is None else float(gradient[0, 1])
    return float(np.sqrt(0.5 * np.sum((gradient + gradient.T) ** 2)))


def _mean_gradient(case: Case, t: float) -> Array | None:
    """Rows (dV_i / dx_j) of a cell, or of what both walls of a channel impose, (2, 2); else None.

    None too where a stress moves a wall or a cell: the case does not know the rate, steps.csv does, by
    `speed_top` or `shear_rate`.
    """
    container = case.container()
    if not len(container.periods) or case.domain.mean_drive().mean_stress is not None:
        return None
    if not container.walls:
        return container.mean_gradient
    y_bottom, y_top = container.distances(np.zeros((1, 2)))[0] * [-1.0, 1.0]
    ends = [(case.domain.walls[w].velocity_at(t, 2), y) for w, y in (("bottom", y_bottom), ("top", y_top))]
    u = [float(wall.velocity[0]) + wall.shear * y for wall, y in ends if wall is not None]
    return np.array([[0.0, (u[1] - u[0]) / (y_top - y_bottom)], [0.0, 0.0]]) if len(u) == 2 else None


def accumulated_strain(case: Case, t: Array) -> Array | None:
    """The strain from time 0 to times t (n,), the integral of the shear rate; None where there is none."""
    if shear_rate(case, 0.0) is None:
        return None
    kinks = [kink for kink in case.knots() if kink < t[-1]]
    fine = np.unique(np.concatenate([[0.0], kinks, t]))  # the rate is linear in between
    rate = np.array([shear_rate(case, float(at)) for at in fine])
    strain = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(fine))])
    summed: Array = np.interp(t, fine, strain)
    return summed
