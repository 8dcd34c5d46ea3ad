"""Flows in space on light meshes: two spheres in a box."""

from __future__ import annotations

from typing import Any

from fsi.case.case import Case
from fsi.case.load import parse_case
from fsi.stokes.model import StokesModel
from fsi.stokes.solution import StokesSolution

LIGHT = {"degree": 2, "cells_per_circle": 10, "cells_per_gap": 0.5, "growth": 0.8}
BOX: dict[str, Any] = {
    "name": "two spheres in a box",
    "geometry": "spatial",
    "fluid": {"viscosity": 0.7},
    "domain": {"lower": [-3.0, -3.0, -3.0], "upper": [3.0, 3.0, 4.0], "walls": {"top": [0.4, 0.0, 0.0]}},
    "bodies": [
        {"name": "large", "radius": 1.0, "position": [-0.5, 0.2, -1.5], "force": [0.1, 0.0, -1.0]},
        {
            "name": "small", "radius": 0.6, "position": [0.7, -0.1, 0.2],
            "velocity": [0.3, "free", -0.2], "angular_velocity": ["free", 0.5, 0.0],
            "torque": [0.2, 0.0, 0.0],
        },
    ],
    "discretisation": LIGHT,
}  # fmt: skip


def case(data: dict[str, Any], **discretisation: Any) -> Case:
    return parse_case(data | {"discretisation": data["discretisation"] | discretisation})


def solved(one: Case) -> StokesSolution:
    return StokesModel(one)(one.configuration(), 0.0)
