"""Periodic problems that several tests share."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from fsi.bodies.configuration import Configuration, Motion
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.cell import Cell
from fsi.meshes.resolution import Resolution
from fsi.stokes.problem import Boundary, Formulation
from fsi.stokes.solution import StokesSolution
from tests.flows import at_rest, discs, free, solved

REFERENCE = Path(__file__).parent / "reference"
LIGHT = Resolution(0.3, 16, 1.0)
THREE = discs([(0.4, -1.3), (3.1, 0.2), (1.7, 1.4)], [1.0, 0.8, 0.6])


def reference(name: str) -> Any:
    return json.loads((REFERENCE / f"{name}.json").read_text())


def square(side: float, shear: float = 0.0) -> Cell:
    return Cell(((side, 0.0), (0.0, side)), ((0.0, shear), (0.0, 0.0)))


def force_free(q: Configuration) -> Motion:
    return free(*np.zeros((len(q), 3)))


def couette(name: str, resolution: Resolution, degree: int = 3) -> StokesSolution:
    """The flow of a file: walls that slide with a shear rate of 1 over bodies without force."""
    given = reference(name)
    L, H = given["L"], given["H"]
    q = discs(given["centers"], [given["radius"]] * given["N"])
    walls = {
        "bottom": lambda x: np.tile([-0.5 * H, 0.0], (len(x), 1)),
        "top": lambda x: np.tile([0.5 * H, 0.0], (len(x), 1)),
    }
    channel = Box((0.0, 0.0), (L, H), periodic=("x",))
    return solved(channel, q, force_free(q), Boundary(walls, {}), resolution, degree)


def in_cell(
    cell: Cell, q: Configuration, motion: Motion | None = None, resolution: Resolution | None = None,
    degree: int = 3, formulation: Formulation = "eliminated",
) -> StokesSolution:  # fmt: skip
    """The flow in a cell without walls."""
    return solved(cell, q, motion or force_free(q), Boundary({}, {}), resolution, degree, formulation)


def in_channel(
    channel: Box, q: Configuration, motion: Motion, pressure_gradient: float | None = 0.0,
    net_flux: float | None = None, formulation: Formulation = "eliminated",
) -> StokesSolution:  # fmt: skip
    """The flow between walls at rest."""
    boundary = Boundary(dict.fromkeys(channel.walls, at_rest), {}, None, pressure_gradient, net_flux)
    return solved(channel, q, motion, boundary, formulation=formulation)
