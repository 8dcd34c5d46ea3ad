"""The kinds of arrangement by name, as `fsi pack` makes them, and the file that it writes.

Those of spheres are random or crystals (see `crystals`). In the plane the ordered ones are arrays,
flow-aligned rows, oblique chains and wall-to-wall columns of equal discs of radius a. Each cell has exactly
the area fraction phi that is asked for. Neighbours in rows, chains and columns have the gap g, and
s = 2 a + g is the distance of their centres. Walls, where the cell has them, are above and below.
"""

import dataclasses
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import pi, prod, radians, sin, sqrt
from pathlib import Path
from typing import Any

import numpy as np

from fsi.arrangements.arrangement import Arrangement, Wanted, too_large
from fsi.arrangements.cell import SimulationCell
from fsi.arrangements.crystals import BODY_CENTRED, CLOSE_PACKED, CUBIC, FACE_CENTRED, crystal
from fsi.arrangements.oriented_packing import oriented_arrangement
from fsi.arrangements.packing import random_arrangement
from fsi.arrays import Array
from fsi.errors import InputError
from fsi.files import replace
from fsi.meshes.geometry.curves import rescaled


def square_array(w: Wanted) -> Arrangement:
    """Discs at the distance b of each other, `b^2 = pi a^2 / phi`, and b/2 off the walls."""
    columns = _columns(w, rows=w.rows)
    least = w.apart if all(w.periodic) else w.apart + w.gap
    _check_fraction(w, w.disc_area / least**2)
    b = w.radius * sqrt(pi / w.fraction)
    k, m = _grid(columns, w.rows)
    return _arranged(w, (columns * b, w.rows * b), b * (k + 0.5), b * (m + 0.5))


def hexagonal_array(w: Wanted) -> Arrangement:
    """Rows along x of discs b apart, `b^2 = 2 pi a^2 / (sqrt3 phi)`, every other row shifted by b/2.

    Rows are `c = (sqrt3/2) b` apart, and c/2 off the walls; across periodic sides their number is even.
    """
    columns = _columns(w, rows=w.rows)
    _need_periodic_x(w, "a hexagonal array")
    if w.periodic[1] and w.rows % 2:
        odd = f"number = {w.number}" if w.number % 2 else f"rows = {w.rows}"
        raise InputError(f"{odd}: odd, so that images of the rows do not fit; give an even number")
    least = w.apart
    if not w.periodic[1]:
        least = max(least, (w.apart + w.gap) * 2.0 / sqrt(3.0))
    _check_fraction(w, 2.0 * w.disc_area / (sqrt(3.0) * least**2))
    b = w.radius * sqrt(2.0 * pi / (sqrt(3.0) * w.fraction))
    c = 0.5 * sqrt(3.0) * b
    k, m = _grid(columns, w.rows)
    return _arranged(w, (columns * b, w.rows * c), b * (k + 0.5 * (m % 2)), c * (m + 0.5))


def flow_aligned_rows(w: Wanted) -> Arrangement:
    """Rows along x of discs s apart, `c = pi a^2 / (phi s)` from row to row, every other one shifted by s/2.

    The outer rows are c/2 off the walls.
    """
    columns, s = _columns(w, rows=w.rows), w.apart
    _need_periodic_x(w, "rows")
    _check_fraction(w, w.disc_area / (s * (s if w.periodic[1] else s + w.gap)))
    c = w.disc_area / (w.fraction * s)
    k, m = _grid(columns, w.rows)
    return _arranged(w, (columns * s, w.rows * c), s * (k + 0.5 * (m % 2)), c * (m + 0.5))


def oblique_chains(w: Wanted) -> Arrangement:
    """Straight chains of `length` discs at `angle` degrees to x, side by side in `rows` layers.

    The free room c between neighbouring chains, across them, is that between layers; it is c/2 to the walls.
    With h the rise of a chain and `X = (2 a + c) / sin(angle)` their distance along x,
    `length pi a^2 = phi X (h + 2 a + c)`.
    """
    _need_periodic_x(w, "chains")
    abreast = _columns(w, rows=w.rows, length=w.length)
    s, slope = w.apart, _slope(w.angle)
    rise = (w.length - 1) * s * slope
    area = w.length * pi * w.radius**2 * slope
    least = w.gap if w.periodic[1] else 2.0 * w.gap
    _check_fraction(w, area / ((2.0 * w.radius + least) * (rise + 2.0 * w.radius + least)))
    width = -0.5 * rise + sqrt(0.25 * rise**2 + area / w.fraction)  # 2 a + c: its product with h + 2 a + c
    k, place = _grid(w.length, abreast * w.rows)
    chain, layer = place % abreast, place // abreast
    x = (chain + 0.5) * width / slope + np.cos(radians(w.angle)) * s * k
    y = layer * (rise + width) + 0.5 * width + s * slope * k
    return _arranged(w, (abreast * width / slope, w.rows * (rise + width)), x, y)


def wall_to_wall_columns(w: Wanted) -> Arrangement:
    """Chains of `length` discs at `angle` degrees to x from wall to wall, with the gap g to the walls too.

    The height is `H = (length - 1) s sin(angle) + 2 a + 2 g`; they are `length pi a^2 / (phi H)` apart in x.
    """
    if w.periodic != (True, False):
        raise InputError(f'cell = "{w.cell}": columns stand between walls; give "channel"')
    abreast = _columns(w, length=w.length)
    s, slope = w.apart, _slope(w.angle)
    height = (w.length - 1) * s * slope + 2.0 * w.radius + 2.0 * w.gap
    _check_fraction(w, w.length * pi * w.radius**2 * slope / (s * height))
    distance = w.length * pi * w.radius**2 / (w.fraction * height)
    k, chain = _grid(w.length, abreast)
    x = (chain + 0.5) * distance + np.cos(radians(w.angle)) * s * k
    return _arranged(w, (abreast * distance, height), x, w.radius + w.gap + s * slope * k)


def _arranged(w: Wanted, sides: tuple[float, float], x: Array, y: Array) -> Arrangement:
    cell = SimulationCell(sides, w.periodic)
    return Arrangement(cell, cell.wrapped(np.column_stack([x, y])), np.full(len(x), w.radius))


def _grid(inner: int, outer: int) -> tuple[Array, Array]:
    """Indices 0..inner-1, repeated for each of 0..outer-1, and those of the outer count."""
    k, m = np.meshgrid(np.arange(inner, dtype=float), np.arange(outer, dtype=float))
    return k.ravel(), m.ravel()


def _columns(w: Wanted, **counts: int) -> int:
    """The number of discs over the product of counts, those side by side, given by their keys."""
    rows = prod(counts.values())
    if rows > w.number:
        key = max(counts, key=lambda key: counts[key])
        raise InputError(f"{key} = {counts[key]}: more discs side by side than number = {w.number}; lower it")
    if w.number % rows:
        here = f"number = {w.number}: no multiple of {rows}, the discs side by side (rows times length)"
        raise InputError(f"{here}; give {rows * round(w.number / rows)}")
    return w.number // rows


def _slope(angle: float) -> float:
    """The sine of an angle between 0 and 180 degrees."""
    if not 1.0 <= angle <= 179.0:
        raise InputError(f"angle = {angle:g}: must be from 1 to 179 degrees to x; for 0 take rows")
    return sin(radians(angle))


def _need_periodic_x(w: Wanted, what: str) -> None:
    if not w.periodic[0]:
        raise InputError(
            f'cell = "{w.cell}": {what} would cross walls at its ends; give one that is periodic along x, '
            '"channel" or "periodic"'
        )


def _check_fraction(w: Wanted, largest: float) -> None:
    if w.fraction > largest * (1.0 + 1e-12):
        raise too_large(w.fraction, f"gaps of {w.gap:g} radii", largest)


def radii_of(w: Wanted) -> Array:
    """Radii of the mean that is asked for, exactly: all equal, of two sizes, or lognormal.

    Of two sizes half of them, rounded down, are `spread` >= 1 times the others. The logarithm of lognormal
    ones is normal; `spread` is the standard deviation over the mean of that distribution, from which they are
    drawn independently.
    """
    if w.sizes == "bidisperse":
        radii = np.where(np.arange(w.number) < w.number // 2, w.spread, 1.0)
    elif w.sizes == "lognormal":
        # The places come from `seed` itself, so that they do not depend on the radii.
        random = np.random.default_rng((w.seed, 1))
        radii = np.exp(np.sqrt(np.log1p(w.spread**2)) * random.standard_normal(w.number))
    else:
        return np.full(w.number, w.radius)
    return np.asarray(w.radius * radii / radii.mean())


def at_random(w: Wanted) -> Arrangement:
    """Discs, spheres, ellipses or rods at random."""
    return (random_arrangement if w.shape == "disc" else oriented_arrangement)(radii_of(w), w)


@dataclass(frozen=True, slots=True)
class Kind:
    """What makes it, its options besides number, area fraction, radius, gap and cell, and its dimension.

    That of random arrangements is an option.
    """

    arranged: Callable[[Wanted], Arrangement]
    options: tuple[str, ...]
    dimension: int = 2


KINDS: Mapping[str, Kind] = {
    "random": Kind(
        at_random,
        ("aspect", "seed", "sizes", "spread", "dimension", "shape", "ratio", "aligned"),
    ),
    "square": Kind(square_array, ("rows",)),
    "hexagonal": Kind(hexagonal_array, ("rows",)),
    "rows": Kind(flow_aligned_rows, ("rows",)),
    "chains": Kind(oblique_chains, ("rows", "length", "angle")),
    "columns": Kind(wall_to_wall_columns, ("length", "angle")),
    "simple-cubic": Kind(crystal(CUBIC), (), 3),
    "body-centred": Kind(crystal(BODY_CENTRED), (), 3),
    "face-centred": Kind(crystal(FACE_CENTRED), (), 3),
    "close-packed": Kind(crystal(CLOSE_PACKED), (), 3),
}


def arrange(kind: str, wanted: Wanted) -> Arrangement:
    """The arrangement. Raises InputError: the bodies do not fit in this way; named is what fraction would."""
    unit = wanted.radius  # so that in all units it is the same arrangement, to the last move
    in_units = dataclasses.replace(wanted, gap=float(rescaled(wanted.gap, 1.0 / unit)), radius=1.0)
    arrangement = KINDS[kind].arranged(in_units).scaled(unit)
    rounding = 1e-9 * wanted.radius
    remedy = "place more bodies side by side, or lower the area fraction or the gap"
    gaps = {"between bodies": arrangement.smallest_gap(), "to a wall": arrangement.smallest_wall_gap()}
    for where, smallest in gaps.items():
        if smallest < wanted.gap - rounding:
            here = f"number = {wanted.number}: the smallest gap {where} would be {smallest:.4g}"
            raise InputError(f"{here}, not {wanted.gap:g}; {remedy}")
    return arrangement


def write_arrangement(arrangement: Arrangement, path: Path, described: Mapping[str, Any]) -> None:
    """Write a file that `bodies_from` reads, with what describes it. Raises InputError."""
    cell = arrangement.cell
    axes = "xyz"[: cell.dimension]
    bodies = [
        {key: value for key, value in body.items() if key != "position"}
        | dict(zip(axes, body["position"], strict=True))
        for body in arrangement.bodies()
    ]
    periodic = [axis for axis, is_so in zip(axes, cell.periodic, strict=True) if is_so]
    head = {**described, "lower": [0.0] * len(axes), "upper": list(cell.sides), "periodic": periodic}
    lines = [f" {json.dumps(key)}: {json.dumps(value)}," for key, value in head.items()]
    rows = ",\n".join(f"  {json.dumps(body)}" for body in bodies)
    text = "\n".join(["{", *lines, ' "bodies": [', rows, " ]", "}", ""])
    try:
        replace(path, text.encode())
    except OSError as error:
        raise InputError(f"output = {path}: {error.strerror}; give another path") from None
