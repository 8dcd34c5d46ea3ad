"""Where the nodes in the narrowest gaps stand: face to face on the two surfaces.

Along a gap `d(xi) = q + kappa xi^2 / 2`, with xi the distance from where it is narrowest and kappa the sum of
the two curvatures, elements of the size `h = FINEST sqrt(a d) / cells_per_gap` are as many as

    n = cells_per_gap / FINEST sqrt(2 / (kappa a)) asinh(xi_n / w),   w = sqrt(2 q / kappa),

and their ends lie at `xi_k = w sinh((k / n) asinh(xi_n / w))`: some hundred, growing only like log(a / q).
There a cell is up to a thousand times as long as wide, and it matters where the nodes of one surface stand
before those of the other: with right-angled cells the force on a disc at a gap of 1e-8 a is right to 4e-7,
with isosceles ones, half a cell off, only to 8e-4. So both surfaces take their nodes from these xi_k.
"""

from dataclasses import dataclass
from math import asinh, ceil, sqrt

import numpy as np

from fsi.arrays import Array
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.curves import WallCurve
from fsi.meshes.resolution import FINEST, LONGEST

SAME_FROM = (FINEST / LONGEST) ** 2  # d / a, above which cells are no longer than LONGEST gaps anyway
NARROW = 0.5 * SAME_FROM  # the smallest gap over a, below which nodes face each other
FARTHEST = 0.3  # xi over a, where both surfaces are nearly parallel for long
_STEPS = 8


@dataclass(frozen=True, slots=True)
class FacedGap:
    """A narrow gap: its width q, the smaller radius a beside it, and the sum of the two curvatures."""

    width: float
    radius: float
    curvature: float

    def places(self, cells_per_gap: float) -> Array:
        """The distances xi_k from the narrowest place, from zero on, (n + 1,)."""
        w = sqrt(2.0 * self.width / self.curvature)
        wide = sqrt(2.0 * (SAME_FROM * self.radius - self.width) / self.curvature)
        turn = asinh(min(wide, FARTHEST * self.radius) / w)
        n = ceil(cells_per_gap / FINEST * sqrt(2.0 / (self.curvature * self.radius)) * turn)
        places: Array = w * np.sinh(np.linspace(0.0, turn, n + 1))
        return places


def on_circle(angle: float, radius: float, xi: Array) -> Array:
    """Where these nodes stand on a circle that has the gap at an angle: lengths along it, ascending."""
    turn = np.arcsin(xi / radius)
    return radius * (angle + np.concatenate([-turn[:0:-1], turn]))


def on_wall(curve: WallCurve, container: Container, foot: float, xi: Array) -> Array:
    """Where they stand on a piece of a wall that has the gap at the length `foot`: lengths, ascending."""
    xi = np.concatenate([-xi[:0:-1], xi])
    along, start = _along(curve, container, foot), curve.at(np.array([foot]))
    s = foot + xi
    for _ in range(_STEPS):
        s = s - ((curve.at(s) - start) @ along - xi)
    return s


def foot_on(curve: WallCurve, container: Container, centre: Array, low: float, high: float) -> float | None:
    """Where between two lengths along a wall it is nearest to a point; None where it is not."""
    import scipy  # late: `fsi check` does without

    def off(s: float) -> float:
        return float((curve.at(np.array([s]))[0] - centre) @ _along(curve, container, s))

    if not off(low) < 0.0 < off(high):
        return None
    return float(scipy.optimize.brentq(off, low, high, xtol=1e-15 * (high - low), rtol=1e-15))


def _along(curve: WallCurve, container: Container, s: float) -> Array:
    """The unit tangent of a wall; the fluid lies on its left."""
    x, y = container.normals(curve.at(np.array([s])))[0, curve.wall]
    return np.array([y, -x])
