"""Arrays, flow-aligned rows, oblique chains and wall-to-wall columns of equal discs of radius a in the plane.

Each cell has exactly the area fraction phi that is asked for. Neighbours in rows, chains and columns have the
gap g, and s = 2 a + g is the distance of their centres. Walls, where the cell has them, are above and below.
"""

from __future__ import annotations

from math import pi, radians, sin, sqrt

import numpy as np

from fsi.arrangements.arrangement import Arrangement, Array, Cell
from fsi.errors import InputError

CHANNEL, DOUBLY_PERIODIC, BOX = (True, False), (True, True), (False, False)


def square_array(
    number: int, rows: int, radius: float, fraction: float, gap: float, periodic: tuple[bool, ...]
) -> Arrangement:
    """Discs at the distance b of each other, `b^2 = pi a^2 / phi`, and b/2 off the walls."""
    columns = _columns(number, rows)
    least = 2.0 * radius + (gap if all(periodic) else 2.0 * gap)
    _check_fraction(fraction, pi * radius**2 / least**2)
    b = radius * sqrt(pi / fraction)
    k, m = _grid(columns, rows)
    return _arranged((columns * b, rows * b), periodic, b * (k + 0.5), b * (m + 0.5), radius)


def hexagonal_array(
    number: int, rows: int, radius: float, fraction: float, gap: float, periodic: tuple[bool, ...]
) -> Arrangement:
    """Rows along x of discs b apart, `b^2 = 2 pi a^2 / (sqrt3 phi)`, every other row shifted by b/2.

    Rows are `c = (sqrt3/2) b` apart, and c/2 off the walls; across periodic sides their number is even.
    """
    columns = _columns(number, rows)
    _need_periodic_x(periodic, "a hexagonal array")
    if periodic[1] and rows % 2:
        raise InputError(f"rows = {rows}: odd, so that images of the rows do not fit; give an even number")
    least = 2.0 * radius + gap
    if not periodic[1]:
        least = max(least, (2.0 * radius + 2.0 * gap) * 2.0 / sqrt(3.0))
    _check_fraction(fraction, 2.0 * pi * radius**2 / (sqrt(3.0) * least**2))
    b = radius * sqrt(2.0 * pi / (sqrt(3.0) * fraction))
    c = 0.5 * sqrt(3.0) * b
    k, m = _grid(columns, rows)
    return _arranged((columns * b, rows * c), periodic, b * (k + 0.5 * (m % 2)), c * (m + 0.5), radius)


def flow_aligned_rows(
    number: int, rows: int, radius: float, fraction: float, gap: float, periodic: tuple[bool, ...]
) -> Arrangement:
    """Rows along x of discs s apart, `c = pi a^2 / (phi s)` from row to row, every other one shifted by s/2.

    The outer rows are c/2 off the walls.
    """
    columns = _columns(number, rows)
    _need_periodic_x(periodic, "rows")
    s = 2.0 * radius + gap
    _check_fraction(fraction, pi * radius**2 / (s * (s if periodic[1] else s + gap)))
    c = pi * radius**2 / (fraction * s)
    k, m = _grid(columns, rows)
    return _arranged((columns * s, rows * c), periodic, s * (k + 0.5 * (m % 2)), c * (m + 0.5), radius)


def oblique_chains(
    number: int, rows: int, length: int, angle: float, radius: float, fraction: float, gap: float,
    periodic: tuple[bool, ...],
) -> Arrangement:  # fmt: skip
    """Straight chains of `length` discs at `angle` degrees to x, side by side in `rows` layers.

    The free room c between neighbouring chains, across them, is that between layers; it is c/2 to the walls.
    With h the rise of a chain and `X = (2 a + c) / sin(angle)` their distance along x,
    `length pi a^2 = phi X (h + 2 a + c)`.
    """
    _need_periodic_x(periodic, "chains")
    abreast = _columns(number, rows * length)
    s, slope = 2.0 * radius + gap, _slope(angle)
    rise = (length - 1) * s * slope
    area = length * pi * radius**2 * slope
    least = gap if periodic[1] else 2.0 * gap
    _check_fraction(fraction, area / ((2.0 * radius + least) * (rise + 2.0 * radius + least)))
    w = -0.5 * rise + sqrt(0.25 * rise**2 + area / fraction)  # 2 a + c: the root of w (w + h) = area / phi
    k, place = _grid(length, abreast * rows)
    chain, layer = place % abreast, place // abreast
    run = np.cos(radians(angle)) * s
    x = (chain + 0.5) * w / slope + run * k
    y = layer * (rise + w) + 0.5 * w + s * slope * k
    return _arranged((abreast * w / slope, rows * (rise + w)), periodic, x, y, radius)


def wall_to_wall_columns(
    number: int, length: int, angle: float, radius: float, fraction: float, gap: float,
    periodic: tuple[bool, ...],
) -> Arrangement:  # fmt: skip
    """Chains of `length` discs at `angle` degrees to x from wall to wall, with the gap g to the walls too.

    The height is `H = (length - 1) s sin(angle) + 2 a + 2 g`; they are `length pi a^2 / (phi H)` apart in x.
    """
    if periodic != CHANNEL:
        raise InputError("columns stand between walls: give a channel, periodic along x only")
    abreast = _columns(number, length)
    s, slope = 2.0 * radius + gap, _slope(angle)
    height = (length - 1) * s * slope + 2.0 * radius + 2.0 * gap
    _check_fraction(fraction, length * pi * radius**2 * slope / (s * height))
    apart = length * pi * radius**2 / (fraction * height)
    k, chain = _grid(length, abreast)
    x = (chain + 0.5) * apart + np.cos(radians(angle)) * s * k
    return _arranged((abreast * apart, height), periodic, x, radius + gap + s * slope * k, radius)


def _arranged(
    sides: tuple[float, float], periodic: tuple[bool, ...], x: Array, y: Array, radius: float
) -> Arrangement:
    cell = Cell(sides, periodic)
    return Arrangement(cell, cell.wrapped(np.column_stack([x, y])), np.full(len(x), radius))


def _grid(inner: int, outer: int) -> tuple[Array, Array]:
    """Indices 0..inner-1, repeated for each of 0..outer-1, and those of the outer count."""
    k, m = np.meshgrid(np.arange(inner, dtype=float), np.arange(outer, dtype=float))
    return k.ravel(), m.ravel()


def _columns(number: int, rows: int) -> int:
    if number % rows:
        raise InputError(
            f"number = {number}: no multiple of {rows}, the discs side by side (rows times length); "
            f"give {rows * max(round(number / rows), 1)}"
        )
    return number // rows


def _slope(angle: float) -> float:
    """The sine of an angle between 0 and 180 degrees."""
    if not 1.0 <= angle <= 179.0:
        raise InputError(f"angle = {angle:g}: must be from 1 to 179 degrees to x; for 0 take rows")
    return sin(radians(angle))


def _need_periodic_x(periodic: tuple[bool, ...], what: str) -> None:
    if not periodic[0]:
        raise InputError(f"{what}: would cross walls at its ends; give a cell that is periodic along x")


def _check_fraction(fraction: float, largest: float) -> None:
    if fraction > largest * (1.0 + 1e-12):
        raise InputError(
            f"area fraction = {fraction:g}: too large for these gaps; the largest possible is "
            f"{np.floor(1e4 * largest) / 1e4:g}"
        )
