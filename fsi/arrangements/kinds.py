"""The kinds of arrangement by name, as `fsi pack` makes them, and the file that it writes."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fsi.arrangements import ordered, sizes
from fsi.arrangements.arrangement import Arrangement, Array
from fsi.arrangements.packing import random_arrangement
from fsi.errors import InputError
from fsi.run_folder.checkpoint import replace

CELLS = {"channel": (True, False), "periodic": (True, True), "box": (False, False)}
SIZES = ("equal", "bidisperse", "lognormal")


@dataclass(frozen=True, slots=True)
class Wanted:
    """What is asked for, with every value filled in; see `fsi pack --help`."""

    number: int
    fraction: float
    radius: float
    gap: float
    cell: str
    aspect: float
    seed: int
    sizes: str
    spread: float
    dimension: int
    rows: int
    length: int
    angle: float

    @property
    def periodic(self) -> tuple[bool, ...]:
        """For each axis whether it is periodic; in space a channel is periodic along x and y."""
        along, across = CELLS[self.cell]
        return (along,) * (self.dimension - 1) + (across,)


def _random(w: Wanted) -> Arrangement:
    return random_arrangement(_radii(w), w.fraction, w.periodic, w.aspect, w.gap, w.seed)


def _radii(w: Wanted) -> Array:
    match w.sizes:
        case "bidisperse":
            return sizes.bidisperse(w.number, w.radius, w.spread)
        case "lognormal":
            # the places come from `seed` itself, so that they do not depend on the radii
            return sizes.lognormal(w.number, w.radius, w.spread, np.random.default_rng((w.seed, 1)))
        case _:
            return sizes.monodisperse(w.number, w.radius)


def _square(w: Wanted) -> Arrangement:
    return ordered.square_array(w.number, w.rows, w.radius, w.fraction, w.gap, w.periodic)


def _hexagonal(w: Wanted) -> Arrangement:
    return ordered.hexagonal_array(w.number, w.rows, w.radius, w.fraction, w.gap, w.periodic)


def _rows(w: Wanted) -> Arrangement:
    return ordered.flow_aligned_rows(w.number, w.rows, w.radius, w.fraction, w.gap, w.periodic)


def _chains(w: Wanted) -> Arrangement:
    return ordered.oblique_chains(
        w.number, w.rows, w.length, w.angle, w.radius, w.fraction, w.gap, w.periodic
    )


def _columns(w: Wanted) -> Arrangement:
    return ordered.wall_to_wall_columns(w.number, w.length, w.angle, w.radius, w.fraction, w.gap, w.periodic)


# The options that a kind takes besides number, area fraction, radius, gap and cell.
OPTIONS: Mapping[str, tuple[str, ...]] = {
    "random": ("aspect", "seed", "sizes", "spread", "dimension"),
    "square": ("rows",),
    "hexagonal": ("rows",),
    "rows": ("rows",),
    "chains": ("rows", "length", "angle"),
    "columns": ("length", "angle"),
}
_MAKERS: Mapping[str, Callable[[Wanted], Arrangement]] = {
    "random": _random,
    "square": _square,
    "hexagonal": _hexagonal,
    "rows": _rows,
    "chains": _chains,
    "columns": _columns,
}


def arrange(kind: str, wanted: Wanted) -> Arrangement:
    """The arrangement of one of the kinds.

    Raises:
        InputError: the bodies do not fit in this way; the largest area fraction that would is named.
    """
    arrangement = _MAKERS[kind](wanted)
    rounding = 1e-9 * wanted.radius
    for what, found in (
        ("gap between bodies", arrangement.smallest_gap()),
        ("gap to a wall", arrangement.smallest_wall_gap()),
    ):
        if found < wanted.gap - rounding:
            raise InputError(
                f"number = {wanted.number}: the smallest {what} would be {found:.4g}, not {wanted.gap:g};"
                " place more bodies side by side, or lower the area fraction or the gap"
            )
    return arrangement


def write_arrangement(arrangement: Arrangement, path: Path, described: Mapping[str, Any]) -> None:
    """Write a file that `bodies_from` reads, with what describes it. Raises InputError."""
    axes = "xyz"[: arrangement.cell.dimension]
    name = {2: "disc", 3: "sphere"}[arrangement.cell.dimension]
    bodies = [
        {"name": f"{name}{number:04d}", "radius": a, **dict(zip(axes, centre, strict=True))}
        for number, (a, centre) in enumerate(
            zip(arrangement.radii.tolist(), arrangement.centres.tolist(), strict=True), 1
        )
    ]
    head = {
        **described,
        "lower": [0.0] * len(axes),
        "upper": list(arrangement.cell.sides),
        "periodic": [axis for axis, is_so in zip(axes, arrangement.cell.periodic, strict=True) if is_so],
    }
    lines = [f" {json.dumps(key)}: {json.dumps(value)}," for key, value in head.items()]
    rows = ",\n".join(f"  {json.dumps(body)}" for body in bodies)
    text = "\n".join(["{", *lines, ' "bodies": [', rows, " ]", "}", ""])
    try:
        replace(path, text.encode())
    except OSError as error:
        raise InputError(f"output = {path}: {error.strerror}; give another path") from None
