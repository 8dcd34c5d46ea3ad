"""The length of a film: up to which gaps the resistance of two shapes is the series of its nearest points.

Moved along the tangent by x from the nearest points, the film between two shapes that touch is H(x) thick,
first by a power law, c x^b, of smooth shapes x^2/(2 R). What makes the series of the gap d converge no more
is the first of

    H slopes by 1 in its law        2 c x^b there, of smooth shapes R
    H is by half off its law        2 c x^b there, on either side: of a disc 0.9 radii beside a plane, of
                                    the flat side of an ellipse 0.9 of its smaller half axis
    other points are near too       a quarter of their H, as they shut fluid in

as then lubrication ends, what is beyond x = sqrt(2 R d) has another shape, or other points take over.
"""

from typing import NamedTuple

import numpy as np

from fsi.arrays import Array
from fsi.calibration.pair import Pair
from fsi.meshes.geometry.feet import Foot, Opposite
from fsi.meshes.geometry.placed import Placed
from fsi.meshes.geometry.wall_feet import all_wall_feet

_NEAREST, _POINTS = 1e-5, 400  # along the outline, on each side: from here on, in equal ratios, to its half
_THIN = 1e-7  # over the radius: from where the film is so thick to twice there it tells its law
_FLAT = 6.0  # power from which sides are flat: the law of d would have an exponent of 5/2 and more
_SHUT_IN = 0.25  # of H where other points are near: from H on coefficients are a hundred times c_1
_OFF = 0.5  # of the law: where the film has another shape


class _Sides(NamedTuple):
    """A body, what is opposite, and where they are nearest and nearly so."""

    body: Placed
    opposite: Opposite
    foot: Foot
    others: list[Foot]


def film_length(pair: Pair) -> float:
    """The length of the film between two shapes; 0 of flat sides, which have no such law."""
    sides = _sides(pair)
    lengths = [_of_side(sides, sign) for sign in (1.0, -1.0)]
    return min(*lengths, *(_SHUT_IN * (other.gap - sides.foot.gap) for other in sides.others))


def _sides(pair: Pair) -> _Sides:
    case = pair.at(pair.plan.range[0])
    q, container = case.configuration(), case.container()
    body, reach = q.placed[pair.first], pair.reduced_radius
    if pair.second is None:
        wall = container.walls.index(pair.plan.pair[1])
        foot, *others = all_wall_feet(body, container, reach)[wall]
        return _Sides(body, lambda x: container.to_wall(wall, x), foot, others)
    other = q.placed[pair.second]
    foot, *others = body.feet_to(other, reach)
    return _Sides(body, other.signed_distance, foot, others)


def _of_side(sides: _Sides, sign: float) -> float:
    """Of one side of the nearest points."""
    x, H = _film(sides, sign)
    first = int(np.argmax(_THIN * sides.body.outline.radius < H))
    second = int(np.searchsorted(x, 2.0 * x[first]))
    if second == len(x):
        return 0.0
    power = float(np.log(H[second] / H[first]) / np.log(x[second] / x[first]))
    if power >= _FLAT:
        return 0.0
    c = float(H[first] / x[first] ** power)
    law = c * x**power
    off = np.flatnonzero(np.abs(H[second:] / law[second:] - 1.0) > _OFF)
    departs = law[second + off[0]] if len(off) else law[-1]
    steep = c * (power * c) ** (-power / (power - 1.0))  # where c x^power has the slope 1
    return 2.0 * float(min(departs, steep))


def _film(sides: _Sides, sign: float) -> tuple[Array, Array]:
    """x and H along the body's outline, as far as it goes on from the nearest points, (n,) each."""
    foot = sides.foot
    points = sides.body.at(foot.t + sign * np.geomspace(_NEAREST, 0.5, _POINTS)).x
    tangent = np.array([foot.normal[1], -foot.normal[0]])
    x = np.abs((points - foot.x) @ tangent)
    back = np.flatnonzero(np.diff(x) <= 0.0)
    n = int(back[0]) + 1 if len(back) else len(x)
    return x[:n], sides.opposite(points[:n])[0] - foot.gap
