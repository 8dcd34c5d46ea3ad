"""Nodes along curves by an element size: where it is sampled, and how they equidistribute `int ds / h`."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array, Indices, parted
from fsi.meshes.errors import MeshError

MOST_HALVINGS = 60
# Calls take longer than the sizes of few places: of few intervals they are found ahead, for some halvings.
FEW, AT_ONCE = 64, 3
SAME_PLACE = 1e-3  # of the distance between places

type Sizes = Callable[[Array, Indices], Array]


def resolve_all(size: Sizes, ends: Array, pieces: int) -> tuple[Array, Array, Indices]:
    """Places s along curves from ends[k, 0] to ends[k, 1], the element sizes there, and the curve k of each.

    Intervals are halved until they are no longer than half the element size at both their ends.
    """
    s = np.linspace(ends[:, 0], ends[:, 1], pieces + 1, axis=1).ravel()
    k = np.repeat(np.arange(len(ends)), pieces + 1)
    found, inside = [(s, size(s, k), k)], np.flatnonzero(k[:-1] == k[1:])
    # Both ends of the intervals that may be too long, the sizes there, (2, n) each, and their curves.
    ends, h = (np.stack([values[inside], values[inside + 1]]) for values in found[0][:2])
    of, halvings = k[inside], 0
    while halvings < MOST_HALVINGS:
        long = np.flatnonzero(_too_long(ends, h))
        if len(long) == 0:
            s, h, k = (np.concatenate(every) for every in zip(*found, strict=True))
            order = np.lexsort((s, k))
            return s[order], h[order], k[order]
        ends, h, of = ends[:, long], h[:, long], of[long]
        at_once = AT_ONCE if len(long) <= FEW else 1
        middle, halvings = _middles(ends, at_once), halvings + at_once
        between = size(middle.ravel(), np.tile(of, len(middle))).reshape(middle.shape)
        ends, h, of = _halved((ends, h, of), (middle, between), found)
    raise MeshError("element sizes down to {} cannot be resolved; is a gap that small meant?", h.min())


def _too_long(ends: Array, h: Array) -> NDArray[np.bool_]:
    """Whether intervals are longer than half the sizes at their ends; both (2, ...)."""
    too_long: NDArray[np.bool_] = ends[1] - ends[0] > 0.5 * h.min(axis=0)
    return too_long


def _middles(ends: Array, levels: int) -> Array:
    """The places that halve intervals, (2, n), so many times, ascending, (2^levels - 1, n)."""
    for _ in range(levels):
        finer = np.empty((2 * len(ends) - 1, ends.shape[1]))
        finer[::2], finer[1::2] = ends, 0.5 * (ends[:-1] + ends[1:])
        ends = finer
    return ends[1:-1]


def _halved(
    intervals: tuple[Array, Array, Indices],
    middles: tuple[Array, Array],
    found: list[tuple[Array, Array, Indices]],
) -> tuple[Array, Array, Indices]:
    """Intervals that are too long, halved while they are and their middles are known; these are found.

    Args:
        intervals: both ends, sizes there, and curves.
        middles: places within them, as `_middles` has them, and the sizes there.
        found: places, sizes and curves; more are appended.

    Returns the last halves.
    """
    (ends, h, of), (middle, between) = intervals, middles
    while True:
        m = len(middle) // 2
        found.append((middle[m], between[m], of))
        ends, h, of = _halves(ends, middle[m]), _halves(h, between[m]), np.tile(of, 2)
        if m == 0:
            return ends, h, of
        middle, between = (np.concatenate([each[:m], each[m + 1 :]], axis=1) for each in (middle, between))
        long = np.flatnonzero(_too_long(ends, h))
        ends, h, of, middle, between = ends[:, long], h[:, long], of[long], middle[:, long], between[:, long]


def _halves(ends: Array, middle: Array) -> Array:
    """What is known at both ends of intervals, (2, n), at those of their halves, (2, 2 n)."""
    return np.stack([np.concatenate([ends[0], middle]), np.concatenate([middle, ends[1]])])


def equidistribute(s: Array, density: Array, least: int) -> Array:
    """Parameters, with both ends of s, that split `int density ds` into equal parts of at most 1."""
    return equidistribute_all(s, density, np.zeros(len(s), dtype=np.int64), np.array([least]))[0]


def equidistribute_all(s: Array, density: Array, k: Indices, least: Indices) -> tuple[Array, Indices]:
    """Those along curves k = 0 ... n - 1, which are split each by itself.

    s: of each curve, ascending, the density there, and their curves, all (m,). least: how many parts, (n,).
    Returns the parameters and their curves.
    """
    first = np.searchsorted(k, np.arange(len(least) + 1))
    column = np.arange(len(k)) - first[k]
    # Each curve is summed by itself: what others have would take digits.
    areas = np.zeros((len(least), int(column.max(initial=0)) + 1))
    areas[k[1:], column[1:]] = np.where(column[1:], 0.5 * (density[1:] + density[:-1]) * np.diff(s), 0.0)
    cumulative = np.cumsum(areas, axis=1)[k, column]
    total = cumulative[first[1:] - 1]
    parts = np.maximum(least, np.ceil(total - 1e-6).astype(np.int64))
    of = np.repeat(np.arange(len(least)), parts + 1)
    end = np.cumsum(parts + 1) - 1
    at = (np.arange(len(of)) - (end - parts)[of]) * (total / parts)[of]
    # NumPy has complex numbers in order of their real parts, then of their imaginary ones.
    i = np.searchsorted(k + 1j * cumulative, of + 1j * at, side="right") - 1
    i = np.minimum(i, first[of + 1] - 2)
    placed: Array = (s[i + 1] - s[i]) / (cumulative[i + 1] - cumulative[i]) * (at - cumulative[i]) + s[i]
    placed[end] = s[first[1:] - 1]
    return placed, of


def spread_all(
    s: Array, h: Array, k: Indices, fixed: Sequence[Sequence[Array]], fewest: Array
) -> list[Array]:
    """Places on each curve as `spread` has them; s of each with h, and the curve of each, all (m,).

    Those of curves without fixed places are found all at once.
    """
    first = np.searchsorted(k, np.arange(len(fixed) + 1))
    placed = [
        spread(s[first[j] : first[j + 1]], h[first[j] : first[j + 1]], stretches, float(fewest[j]))
        for j, stretches in enumerate(fixed)
        if stretches
    ]
    alone = np.array([not stretches for stretches in fixed])
    if not alone.any():
        return placed
    some, number = alone[k], np.cumsum(alone) - 1
    least = np.maximum(1, np.rint(fewest[alone])).astype(np.int64)
    at, of = equidistribute_all(s[some], 1.0 / h[some], number[k[some]], least)
    even, others = iter(parted(at, np.searchsorted(of, np.arange(1, len(least))).tolist())), iter(placed)
    return [next(even if is_alone else others) for is_alone in alone]


def spread(s: Array, h: Array, fixed: Sequence[Array], fewest: float) -> Array:
    """Places between the ends of s that equidistribute `ds / h`, but for stretches of fixed places.

    s: ascending, (n,), h there. fixed: stretches, ascending; what lies beyond the ends of s is left out, and
    so is a stretch that overlaps one before it. fewest: elements in all.
    """
    start, end = float(s[0]), float(s[-1])
    at, slack, placed = start, 0.0, [s[:1]]
    for stretch in sorted(fixed, key=lambda stretch: float(stretch[0])):
        # Of the places themselves: a wall may be 1e10 times as long as they are apart.
        slack = SAME_PLACE * float(np.diff(stretch).min())
        inside = stretch[(stretch > start - slack) & (stretch < end + slack)]
        if len(inside) > 1 and inside[0] > at - slack:
            if inside[0] > at + slack:
                placed.append(_even(s, h, at, float(inside[0]), fewest))
            placed.append(inside[1:])
            at = float(inside[-1])
    if end > at + slack:
        placed.append(_even(s, h, at, end, fewest))
    places = np.concatenate(placed)
    places[-1] = end
    return places


def _even(s: Array, h: Array, low: float, high: float, fewest: float) -> Array:
    """Places after `low` up to `high` that equidistribute `ds / h`."""
    length, between = float(s[-1] - s[0]), (s > low) & (s < high)
    ends = np.interp([low, high], s, h)
    s, h = (np.concatenate([[a], x[between], [b]]) for x, a, b in ((s, low, high), (h, *ends)))
    return equidistribute(s, 1.0 / h, max(1, round(fewest * (high - low) / length)))[1:]
