"""The strain that a suspension has undergone."""

from __future__ import annotations

import numpy as np

from fsi.bodies.configuration import Array
from fsi.case.case import Case
from fsi.case.walls import WallVelocity
from fsi.meshes.geometry.periodic import Cell, Channel


def strain_rate(case: Case, t: float) -> Array | None:
    """E, the symmetric gradient of the mean flow of a channel or a cell at time t, (2, 2); else None."""
    container = case.container()
    if isinstance(container, Cell):
        return _symmetric(container)
    rate = shear_rate(case, t)
    return None if rate is None else 0.5 * rate * np.array([[0.0, 1.0], [1.0, 0.0]])


def shear_rate(case: Case, t: float) -> float | None:
    """The shear rate that the walls of a channel, or the mean flow of a cell, impose at time t.

    Channel: (u_top - u_bottom) / H. Cell: sqrt(2 E:E), E the symmetric gradient; of a shear its rate, of an
    extension twice that. Nothing where there is no such flow.
    """
    container = case.container()
    if isinstance(container, Cell):
        return float(np.sqrt(2.0 * np.sum(_symmetric(container) ** 2)))
    if not isinstance(container, Channel):
        return None
    height = container.upper[1] - container.lower[1]
    ends = [
        (case.domain.walls[name].velocity(t, 2), y)
        for name, y in (("bottom", container.lower[1]), ("top", container.upper[1]))
    ]
    u = [_along(velocity, y) for velocity, y in ends if velocity is not None]
    return (u[1] - u[0]) / height if len(u) == 2 else None


def _symmetric(container: Cell) -> Array:
    gradient = np.array(container.gradient)
    symmetric: Array = 0.5 * (gradient + gradient.T)
    return symmetric


def _along(velocity: WallVelocity, y: float) -> float:
    return float(velocity.velocity[0]) + velocity.shear * y


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
