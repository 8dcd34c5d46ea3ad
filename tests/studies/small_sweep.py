"""A small sweep: over two area fractions, with two seeds."""

from __future__ import annotations

from pathlib import Path

from tests.commands import fsi_command

FRACTION, VISCOSITY = "arrangement.area_fraction", "apparent viscosity"
QUANTITY = ["--quantity", VISCOSITY]


def swept(case: Path, folder: Path, *more: object) -> int:
    given = [f"{FRACTION}=0.2,0.3", "--seeds", 2, *QUANTITY, "--workers", 1, "-o", folder]
    return fsi_command("sweep", case, "--vary", *given, *more)
