"""Two discs in a cell, sheared by pores, and what tests change in it."""

from __future__ import annotations

from typing import Any

from fsi.case.case import Case
from fsi.case.load import parse_case

DATA: dict[str, Any] = {
    "name": "sheared",
    "model": "pores",
    "fluid": {"viscosity": 1.0},
    "domain": {"shape": "cell", "vectors": [[5.0, 0.0], [0.0, 4.0]], "shear": 1.0},
    "bodies": [
        {"name": "one", "radius": 1.0, "position": [1.6, 1.5]},
        {"name": "other", "radius": 0.7, "position": [3.3, 2.2]},
    ],
    "time": {"end": 0.2, "tolerance": 1e-3},
    "output": {"interval": 0.1},
}
BOX = {"lower": [0.0, 0.0], "upper": [5.0, 4.5]}
PULLED = [
    {"name": "one", "radius": 1.0, "position": [1.6, 1.5], "force": [1.0, 0.5]},
    {"name": "other", "radius": 0.7, "position": [3.8, 2.9]},
]


def case_of(**sections: Any) -> Case:
    return parse_case(DATA | sections)
