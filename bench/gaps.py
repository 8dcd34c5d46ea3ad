"""Forces in the narrowest gaps against closed forms, at default settings: `python bench/gaps.py`.

A disc beside a plane (along it, towards it, turning), two equal discs and a sphere towards a plane: relative
error, unknowns, CPU seconds of the solve, and these over those at a gap of 1e-3 radii. The exact values are
those of the gap as double precision has it, `(1 + q) - 1`.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

from rich.console import Console
from rich.table import Table

from fsi.case.load import load_case
from fsi.lubrication import exact, spheres
from fsi.stokes.model import StokesModel
from fsi.stokes.solution import StokesSolution

CASES = Path(__file__).parents[1] / "cases"
GAPS = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
REPEATS = 3

type Problem = Callable[[float], tuple[StokesSolution, float, float]]


def solved(name: str, *overrides: str) -> StokesSolution:
    """A case at time 0 with some keys changed."""
    case = load_case(CASES / f"{name}.toml", overrides)
    return StokesModel(case)(case.configuration(), 0.0)


def beside_plane(mode: int) -> Problem:
    """A disc with unit velocity in one mode: the solution, its load and the exact one."""
    exact_law = (exact.parallel_resistance, exact.normal_resistance, exact.rotation_resistance)[mode]
    velocity = [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]][mode]
    moves = (f"bodies.0.velocity={velocity}", f"bodies.0.angular_velocity={float(mode == 2)}")

    def at(gap: float) -> tuple[StokesSolution, float, float]:
        y = 1.0 + gap
        solution = solved("disc_beside_plane", f"bodies.0.position=[0.0, {y!r}]", *moves)
        return solution, float(solution.F[0, mode]), float(exact_law(y - 1.0, 1.0, 1.0))

    return at


def pair(gap: float) -> tuple[StokesSolution, float, float]:
    """Two discs that approach each other at relative speed 1."""
    x = 1.0 + 0.5 * gap
    places = (f"bodies.{k}.position=[{side * x!r}, 0.0]" for k, side in enumerate((-1.0, 1.0)))
    solution = solved("two_discs", *places)
    return solution, float(solution.F[0, 0]), float(exact.pair_resistance(2.0 * (x - 1.0), 1.0, 1.0))


def sphere(gap: float) -> tuple[StokesSolution, float, float]:
    """A sphere that moves towards a plane at speed 1."""
    z = 1.0 + gap
    solution = solved("sphere_towards_plane", f"bodies.0.position=[0.0, {z!r}]")
    return solution, float(solution.F[0, 1]), -float(spheres.normal_resistance(z - 1.0, 1.0, 1.0))


PROBLEMS: dict[str, Problem] = {
    "disc along a plane": beside_plane(0),
    "disc towards a plane": beside_plane(1),
    "disc turning beside it": beside_plane(2),
    "two discs": pair,
    "sphere towards a plane": sphere,
}


def measured(problem: Problem, gap: float) -> tuple[float, int, float]:
    """The relative error, the unknowns and the least CPU seconds of some solves, mesh included."""
    seconds = []
    for _ in range(REPEATS):
        start = time.process_time()
        solution, load, closed_form = problem(gap)
        seconds.append(time.process_time() - start)
    return load / closed_form - 1.0, solution.dofs, min(seconds)


def main() -> None:
    """Compute and print."""
    table = Table(title="narrow gaps at default settings", title_justify="left")
    for heading in ("", "gap/a", "error", "unknowns", "CPU s", "over 1e-3"):
        table.add_column(heading, justify="right" if heading else "left", no_wrap=True)
    for name, problem in PROBLEMS.items():
        rows = [measured(problem, gap) for gap in GAPS]
        for gap, (error, dofs, seconds) in zip(GAPS, rows, strict=True):
            ratio = f"{seconds / rows[0][2]:.2f}"
            table.add_row(name, f"{gap:g}", f"{error:.0e}", str(dofs), f"{seconds:.2f}", ratio)
    Console(width=100).print(table)


if __name__ == "__main__":
    main()
