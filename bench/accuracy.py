"""Resolved forces and velocities against exact ones, at default settings: `python bench/accuracy.py`.

A disc beside a plane and two equal discs, at five gaps; the exact values are the closed forms of
`fsi.lubrication.exact`. The errors include what the finite container changes.
"""

from __future__ import annotations

from pathlib import Path

from rich.console import Console
from rich.table import Table

from fsi.case.load import load_case
from fsi.lubrication import exact
from fsi.stokes.model import StokesModel
from fsi.stokes.solution import StokesSolution

CASES = Path(__file__).parents[1] / "cases"
GAPS = (1.0, 0.1, 1e-2, 1e-3, 1e-4)
X, Y, ROTATION = range(3)


def solved(name: str, *overrides: str) -> StokesSolution:
    """A case at time 0 with some keys changed."""
    case = load_case(CASES / f"{name}.toml", overrides)
    return StokesModel(case)(case.configuration(), 0.0)


def beside_plane(gap: float, velocity: tuple[float, float], omega: float, mode: int) -> float:
    """Load F of one mode on a disc that moves beside a plane."""
    motion = [f"bodies.0.velocity={list(velocity)}", f"bodies.0.angular_velocity={omega}"]
    return float(solved("disc_beside_plane", f"bodies.0.position=[0.0, {1.0 + gap}]", *motion).F[0, mode])


def pair(gap: float) -> float:
    """Load F_x on the first of two discs that approach each other at relative speed 1."""
    places = (f"bodies.{k}.position=[{side * (1.0 + 0.5 * gap)}, 0.0]" for k, side in enumerate((-1.0, 1.0)))
    return float(solved("two_discs", *places).F[0, X])


def errors(gap: float) -> list[float]:
    """Relative errors of all quantities of the table at one gap."""
    free = solved("free_disc_in_shear", f"bodies.0.position=[0.0, {1.0 + gap}]").U[0]
    velocity, omega = exact.free_in_shear(gap, 1.0, 1.0)
    both = [
        (beside_plane(gap, (0.0, 1.0), 0.0, Y), exact.normal_resistance(gap, 1.0, 1.0)),
        (beside_plane(gap, (1.0, 0.0), 0.0, X), exact.parallel_resistance(gap, 1.0, 1.0)),
        (beside_plane(gap, (0.0, 0.0), 1.0, ROTATION), exact.rotation_resistance(gap, 1.0, 1.0)),
        (free[X], velocity),
        (free[ROTATION], omega),
        (pair(gap), exact.pair_resistance(gap, 1.0, 1.0)),
    ]
    return [abs(float(computed / closed_form) - 1.0) for computed, closed_form in both]


def main() -> None:
    """Compute and print."""
    table = Table(title="relative error at default settings", title_justify="left")
    headings = ("gap/a", "F normal", "F along", "T turning", "V in shear", "omega in shear", "F of a pair")
    for heading in headings:
        table.add_column(heading, justify="right", no_wrap=True)
    for gap in GAPS:
        table.add_row(f"{gap:g}", *(f"{error:.0e}" for error in errors(gap)))
    Console(width=100).print(table)


if __name__ == "__main__":
    main()
