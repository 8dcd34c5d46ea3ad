"""The reduced case of one disc, made in Python."""

from __future__ import annotations

from typing import Any

import fsi

DISC: dict[str, Any] = {"name": "disc", "radius": 1.0, "position": [0.0, 2.0], "force": [0.0, -1.0]}


def reduced(**more: Any) -> fsi.Case:
    """A disc above a plane in the reduced model, built without a file."""
    sections: dict[str, Any] = {
        "name": "disc",
        "model": "reduced",
        "fluid": {"viscosity": 1.0},
        "domain": {"shape": "half-plane", "radius": 100.0},
        "bodies": [DISC],
        "reduced": {"drag": 10.0},
        "time": {"end": 1.0},
    }
    return fsi.make_case(**(sections | more))
