"""The gap between two outlines along their common normal, by Newton's method.

Where x(t) and y(s) are nearest, the tangents are opposite and the way between is normal to them,

    x' (x) y' = 0,    (x - y) . y' = 0,        a (x) b = a_1 b_2 - a_2 b_1

Its matrix has the determinant |x'|^2 |y'|^2 (kappa_1 + kappa_2 + gap kappa_1 kappa_2), whatever small the
gap: it converges in some six steps also where the gap itself is lost beside the size of the bodies. It does
not where both are straight, and may leave for another solution: what is found is checked, and else left to
the signed distance (`placed`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fsi.arrays import Array
from fsi.meshes.geometry.jets import JetOf, cross

STEPS = 12
CONVERGED = 1e-12  # of t, which the last step squares


@dataclass(frozen=True, slots=True, eq=False)
class CommonNormals:
    """Where two outlines have a common normal, n places.

    Attributes:
        t: on the first, (n,).
        s: on the second, (n,).
        gap: the distance there, (n,).
    """

    t: Array
    s: Array
    gap: Array


def common_normals(one: JetOf, other: JetOf, t: Array, s: Array, reach: float) -> CommonNormals | None:
    """The common normals near x(t), y(s), (n,) each, at which the distance is least; None where one is none.

    reach: how far x(t) and y(s) may be moved along their curves, a length.
    """
    start, beginning = one(t).x, other(s).x
    with np.errstate(all="ignore"):  # of what is singular nothing is left below
        for _ in range(STEPS):
            x, dx, ddx = one(t)
            y, dy, ddy = other(s)
            turned, along = cross(dx, dy), ((x - y) * dy).sum(axis=1)
            a, b = cross(ddx, dy), cross(dx, ddy)
            c, d = (dx * dy).sum(axis=1), ((x - y) * ddy).sum(axis=1) - (dy**2).sum(axis=1)
            determinant = a * d - b * c
            step, beside = (d * turned - b * along) / determinant, (a * along - c * turned) / determinant
            t, s = t - step, s - beside
            if not np.all(np.isfinite(step) & np.isfinite(beside)):
                return None
            if np.all((np.abs(step) < CONVERGED) & (np.abs(beside) < CONVERGED)):
                break
        else:
            return None
    x, dx, ddx = one(t)
    y, dy, ddy = other(s)
    way = x - y
    gap = cross(way, dy) / np.hypot(*dy.T)  # along the normal out of the second
    # The matrix of second derivatives of |x - y|^2 / 2 is positive where the distance is least.
    first = (dx**2).sum(axis=1) + (way * ddx).sum(axis=1)
    second = (dy**2).sum(axis=1) - (way * ddy).sum(axis=1)
    least = (first > 0.0) & (first * second > (dx * dy).sum(axis=1) ** 2)
    near = (np.hypot(*(x - start).T) <= reach) & (np.hypot(*(y - beginning).T) <= reach)
    nearer = gap <= np.hypot(*(start - beginning).T) + CONVERGED * reach
    if np.all(least & near & nearer & (gap > 0.0) & ((dx * dy).sum(axis=1) < 0.0)):
        return CommonNormals(t, s, gap)
    return None
