"""Which curve a side of the boundary follows, by where its ends are: a circle, an outline, or none."""

from collections.abc import Sequence

import numpy as np

from fsi.arrays import Array, Indices
from fsi.meshes.geometry.placed import Placed
from fsi.meshes.planar.sizing import Curve

ON_OUTLINE = 1e-9  # of its radius, or of a side: what is nearer stands on an outline
ROUNDING = 1e-15  # of places


def partly_straight(curves: Sequence[Curve]) -> set[int]:
    """The tags of walls that have straight pieces."""
    return {curve.tag for curve in curves if curve.centre is None and curve.body is None}


def within(radius: Array | float, ends: tuple[Array, Array], *, mixed: bool) -> Array:
    """How far off a curve of this radius the ends (n, 2) of sides that follow it may be, (n,).

    mixed: of a wall that has straight pieces too. At the distance d from where these begin they are only
    d^2 / (2 radius) off, so that there sides must end on it up to rounding.
    """
    a, b = ends
    if not mixed:
        return np.broadcast_to(ON_OUTLINE * np.asarray(radius), len(a))
    largest = np.maximum(np.abs(a).max(axis=1), np.abs(b).max(axis=1))
    return np.asarray(np.maximum(ON_OUTLINE * np.hypot(*(b - a).T), ROUNDING * (largest + radius)))


def image_of(images: Sequence[Placed], *ends: Array) -> Indices:
    """On which image of a body sides with these ends (n, 2) are: where a domain is opened it has several."""
    if len(images) == 1:
        return np.zeros(len(ends[0]), dtype=np.int64)
    off = [sum(np.abs(body.signed_distance(x)[0]) for x in ends) for body in images]
    return np.argmin(off, axis=0)


def centres(tags: Indices, ends: tuple[Array, Array], curves: Sequence[Curve]) -> Array:
    """Centres of the circles that sides with these ends (n, 2) on curves of the given tags follow, (n, 2).

    Where a periodic domain is opened, arcs of a body lie around several of its images, and a wall may have
    several arcs: that is meant which both ends are on. NaN for the straight pieces of a wall.
    """
    arcs = [(curve.tag, curve.centre, curve.nodes) for curve in curves if curve.centre is not None]
    of = np.array([tag for tag, _, _ in arcs], dtype=np.int64)
    around = np.array([centre for _, centre, _ in arcs]).reshape(-1, 2)
    # Where the centre alone is known, it is the one of its tag.
    begin = np.array([nodes[0] if len(nodes) else centre for _, centre, nodes in arcs]).reshape(-1, 2)
    circles = np.column_stack([around, np.hypot(*(begin - around).T)])
    images = np.bincount(of, minlength=int(tags.max(initial=0)) + 1)
    # By tag and image, infinitely far where there are fewer.
    order, first = np.argsort(of, kind="stable"), np.cumsum(images) - images
    of_tag = np.tile([np.inf, np.inf, 0.0], (len(images), int(images.max(initial=1)), 1))
    of_tag[of[order], np.arange(len(of)) - first[of[order]]] = circles[order]
    centre: Array = np.where((images > 0)[:, None], of_tag[:, 0, :2], np.nan)[tags]
    mixed = np.isin(tags, [*partly_straight(curves)])
    some = np.flatnonzero((images[tags] > 1) | (mixed & (images[tags] > 0)))
    there, radius = of_tag[tags[some], :, :2], of_tag[tags[some], :, 2]
    away = [np.hypot(*np.moveaxis(x[some, None] - there, -1, 0)) - radius for x in ends]
    off = np.abs(away).max(axis=0)
    rows, nearest = np.arange(len(some)), off.argmin(axis=1)
    centre[some] = there[rows, nearest]
    near = within(radius[rows, nearest], (ends[0][some], ends[1][some]), mixed=True)
    straight = mixed[some] & (off[rows, nearest] > near)
    centre[some[straight]] = np.nan
    return centre
