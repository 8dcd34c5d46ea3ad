"""The gaps of bodies with shapes: each place where two surfaces are nearest, of a pair perhaps several."""

from typing import Any

import numpy as np
from rich.console import Console

from fsi.arrays import Array
from fsi.bodies.feet import Feet, find_feet
from fsi.case.case import Case
from fsi.report.console import table

LISTED = 10.0  # of a pair those up to so many times its narrowest


def gaps_json(case: Case) -> list[dict[str, Any]]:
    """Gaps up to the largest radius: what lies on both sides, its width, and a point half-way across it."""
    q, sides = case.configuration(), (*case.names, *case.container().walls)
    reach = float(q.radii.max(initial=0.0))
    found = find_feet(q, case.container(), reach)
    some = np.flatnonzero(found.gaps <= np.minimum(reach, LISTED * _narrowest_of_pairs(found)))
    return [
        {
            "between": [sides[k] for k in found.sides[n].tolist()],
            "gap": found.feet[n].gap,
            "at": (0.5 * (found.feet[n].x + found.feet[n].opposite)).tolist(),
        }
        for n in some.tolist()
    ]


def _narrowest_of_pairs(found: Feet) -> Array:
    """That of the pair to which each belongs, (F,)."""
    return found.gaps[found.narrowest][found.of]


def print_gaps(console: Console, case: Case) -> None:
    """The same for a reader, where there are any."""
    rows = [
        (*row["between"], f"{row['gap']:.6g}", ", ".join(f"{x:.6g}" for x in row["at"]))
        for row in gaps_json(case)
    ]
    if rows:
        console.print(table(("gap between", "and"), ("width", "at"), rows))
