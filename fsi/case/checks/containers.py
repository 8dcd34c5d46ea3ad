"""What a container in the plane says of itself: its outline, its volume and its distances must agree.

Those of one's own domains may not. Distances that vanish on a wall and grow from there at the rate 1 along
its normal are those to it nearby.
"""

from collections.abc import Iterator

import numpy as np

from fsi.arrays import Array
from fsi.case.case import Case
from fsi.case.section import toml_text
from fsi.errors import InputError
from fsi.meshes.geometry.container import HERE, Container
from fsi.meshes.geometry.curves import WallCurve

_SOUND = tuple(f"fsi.meshes.geometry.{file}" for file in ("box", "round", "shaped"))  # as tests tell
_PLACES = 1025  # of a piece: the area within a half circle of so many sides is 2e-6 too small
_AREA = 1e-4  # of the volume
_ABOVE = 1e-6  # of the size: so high above a wall its distance is compared with that height
_RATE, _UNIT = 1e-2, 1e-3  # a rate of 1 is known to, a unit vector to


def check_container(case: Case) -> None:
    """Raise InputError, which names the shape and what is wrong, where a container contradicts itself."""
    container = case.container()
    if container.dimension == 3 or not container.walls or type(container).__module__ in _SOUND:
        return
    if (fault := next(faults(container), None)) is not None:
        here = f"domain.shape = {toml_text(case.domain.shape)}"
        raise InputError(f"{here}: {fault} (docs/layout.md)")


def faults(container: Container) -> Iterator[str]:
    """What is wrong with a container in the plane, and what to do; nothing if all agrees."""
    pieces, size = container.outline(), container.size()
    at = [curve.at(np.linspace(*curve.interval, _PLACES)) for curve in pieces]
    for curve, x in zip(pieces, at, strict=True):
        if np.abs(x[[0, -1]] - curve.ends).max() > HERE * size:
            yield f"a piece of wall {container.walls[curve.wall]!r} does not run from end to end of `ends`"
    if np.ptp(np.concatenate(at), axis=0).max() > (1.0 + HERE) * size:
        yield f"its size, {size:g}, is less than that of its outline; give a length that no distance exceeds"
    if not len(container.periods):
        yield from _unclosed(container, pieces)
        yield from _areas(container, at)
    for curve, x in zip(pieces, at, strict=True):
        yield from _off(container, curve, x)


def _unclosed(container: Container, pieces: tuple[WallCurve, ...]) -> Iterator[str]:
    """Each piece ends where one other begins, or on the axis."""
    begins, ends = (np.array([curve.ends[k] for curve in pieces]) for k in (0, 1))
    meet = np.linalg.norm(ends[:, None] - begins, axis=2) <= HERE * container.size()
    for one, k in ((ends, 1), (begins, 0)):
        on_axis = container.axisymmetric & (one[:, 0] == 0.0)
        for x in one[(meet.sum(axis=k) != 1) & ~on_axis][:1]:
            yield f"its outline does not close at {x.tolist()}; let each piece begin where one other ends"


def _areas(container: Container, at: list[Array]) -> Iterator[str]:
    area = 0.5 * sum(float(np.sum(x[:-1, 0] * x[1:, 1] - x[:-1, 1] * x[1:, 0])) for x in at)
    if area <= 0.0:
        yield "its outline runs clockwise; let pieces run with the fluid on their left"
    if not abs(area - container.volume) <= _AREA * area:
        yield f"its volume is {container.volume:.6g}, the area in its outline {area:.6g}; correct one of them"


def _off(container: Container, curve: WallCurve, x: Array) -> Iterator[str]:
    """Along a piece, its ends left out, a little within the fluid and a little behind it."""
    along = (x[2:] - x[:-2])[:: _PLACES // 64]
    left = np.column_stack([-along[:, 1], along[:, 0]]) / np.linalg.norm(along, axis=1)[:, None]
    height, k, name = _ABOVE * container.size(), curve.wall, container.walls[curve.wall]
    inside, behind = (x[1 : -1 : _PLACES // 64] + side * height * left for side in (1.0, -1.0))
    away = container.distances(inside)
    if (nearest := np.abs(away[:, k]).max()) > 10.0 * height:
        yield (
            f"its outline has wall {name!r} where its `distances` are up to {nearest:.3g} from it; give "
            "walls the same numbers in both"
        )
    rates = away[:, k] / height
    rate = rates[np.abs(rates - 1.0).argmax()]
    if not abs(rate - 1.0) <= _RATE:
        yield f"its `distances` grow at the rate {rate:.3g} away from wall {name!r}; give lengths, rate 1"
    if np.abs(container.normals(inside)[:, k] - left).max() > _UNIT:
        yield f"its `normals` are not those of wall {name!r}; give unit vectors into the fluid"
    for wall in np.flatnonzero(~(away > -height).all(axis=0))[:1]:
        yield (
            f"its `distances` to wall {container.walls[wall]!r} are negative inside, beside wall {name!r}; "
            "where a wall ends give those to its nearest point"
        )
    if not (container.distances(behind).min(axis=1) < 0.0).all():
        yield (
            f"none of its `distances` is negative behind wall {name!r}, where bodies would be taken for ones "
            "in the fluid; let the least be negative outside"
        )
    sphere, round_ = container.spheres[k], curve.centre is not None
    if (
        sphere is not None
        and np.abs(np.linalg.norm(x - sphere.centre, axis=1) - sphere.radius).max() > height
    ):
        yield f"wall {name!r} is not on its circle of `spheres`; give that which it follows"
    if container.plane[k] and (round_ or curve.solid is not None):
        yield f"wall {name!r} is curved, and `spheres` or `plane` say it is plane; give its circle there"
