"""The kinds of arrangement by name, as `fsi pack` makes them, and the file that it writes."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fsi.arrangements import ordered
from fsi.arrangements.arrangement import Arrangement, Array, Wanted
from fsi.arrangements.packing import random_arrangement
from fsi.errors import InputError
from fsi.files import replace


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
    scaled: Array = w.radius * radii / radii.mean()
    return scaled


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of arrangement.

    Attributes:
        arranged: what makes it.
        options: that it takes besides number, area fraction, radius, gap and cell.
    """

    arranged: Callable[[Wanted], Arrangement]
    options: tuple[str, ...]


KINDS: Mapping[str, Kind] = {
    "random": Kind(
        lambda w: random_arrangement(radii_of(w), w), ("aspect", "seed", "sizes", "spread", "dimension")
    ),
    "square": Kind(ordered.square_array, ("rows",)),
    "hexagonal": Kind(ordered.hexagonal_array, ("rows",)),
    "rows": Kind(ordered.flow_aligned_rows, ("rows",)),
    "chains": Kind(ordered.oblique_chains, ("rows", "length", "angle")),
    "columns": Kind(ordered.wall_to_wall_columns, ("length", "angle")),
}


def arrange(kind: str, wanted: Wanted) -> Arrangement:
    """The arrangement of one of the kinds.

    Raises:
        InputError: the bodies do not fit in this way; the largest area fraction that would is named.
    """
    arrangement = KINDS[kind].arranged(wanted)
    rounding = 1e-9 * wanted.radius
    for what, smallest in (
        ("gap between bodies", arrangement.smallest_gap()),
        ("gap to a wall", arrangement.smallest_wall_gap()),
    ):
        if smallest < wanted.gap - rounding:
            raise InputError(
                f"number = {wanted.number}: the smallest {what} would be {smallest:.4g}, not {wanted.gap:g};"
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
