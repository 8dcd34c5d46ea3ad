"""What a sphere beside a plane costs in space: `python bench/space.py [SETTING ...]`.

The sphere moves along and towards the plane and turns, all at once, the case
cases/validation/sphere_in_space.toml at a gap of GAP radii. Each line is one solve with its mesh, in a
process that has solved a small one before; the error is that of the normal force against Brenner's
series. "s" are seconds on the clock, the others CPU seconds of the first rank; MB is the sum of the
peaks of all ranks, some 200 each of which are libraries, "most" the largest of them. "of old" is what all
CPU seconds are of START.

`mpiexec -n 2 python bench/space.py million` does the same on two ranks; `bench/against.py` takes turns.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import Annotated

import typer
from mpi4py import MPI
from rich.console import Console
from rich.table import Table

sys.path.insert(0, str(Path(__file__).parents[1]))  # of a checkout that runs bench/space.py

from bench.scaling import JSON_HELP, Scaling
from bench.step import PHASES, forget_peak, peak_memory
from fsi.case.case import Case
from fsi.case.load import load_case
from fsi.lubrication.spheres import normal_resistance
from fsi.stokes.model import StokesModel

CASE = Path(__file__).parents[1] / "cases" / "validation" / "sphere_in_space.toml"
GAP = 0.1

# (degree, cells around the sphere, cells across a gap, growth): the default, and meshes that are each about
# four times as large as the one before.
SETTINGS: dict[str, tuple[int, int, float, float]] = {
    "default": (3, 16, 0.75, 0.5),
    "P2": (2, 22, 0.7, 0.45),
    "P2, 4 times": (2, 44, 1.1, 0.28),
    "P2, 16 times": (2, 84, 1.9, 0.17),
    "million": (2, 112, 2.2, 0.133),
}
# CPU seconds of a solve with its mesh when GMRES was preconditioned with the strain rates themselves, on two
# levels, and went to 1e-12; measured in turns with what came after, on a busy 2-core machine.
START = {"default": 9.7, "P2": 1.8, "P2, 4 times": 11.2}
USUAL = [name for name in SETTINGS if name != "million"]
SMALL = (2, 8, 0.5, 1.0)


def sphere_case(setting: tuple[int, int, float, float]) -> Case:
    """The case file at GAP with other sizes."""
    keys = ("degree", "cells_per_circle", "cells_per_gap", "growth")
    own = [f"discretisation.{key}={value}" for key, value in zip(keys, setting, strict=True)]
    return load_case(CASE, [f"bodies.0.position=[0.0, 0.0, {1.0 + GAP}]", *own])


def measured(name: str, scaling: Scaling) -> list[str]:
    """The cells of one line of the table, and one point of the scaling; collective."""
    comm = MPI.COMM_WORLD
    case = sphere_case(SETTINGS[name])
    forget_peak()
    comm.barrier()
    began = time.perf_counter()
    solution = StokesModel(case)(case.configuration(), 0.0)
    comm.barrier()
    seconds = time.perf_counter() - began
    curve = f"P{SETTINGS[name][0]}" if comm.size == 1 else f"P{SETTINGS[name][0]}, first of {comm.size} ranks"
    scaling.add(curve, solution.dofs, sum(solution.seconds.values()))
    peaks = comm.allgather(peak_memory())
    error = abs(-float(solution.F[0, 2] / normal_resistance(GAP, 1.0, 1.0)) - 1.0)
    return [
        name,
        f"{comm.size}",
        f"{solution.dofs}",
        f"{solution.iterations}",
        f"{error:.1e}",
        *(f"{solution.seconds[phase]:.1f}" for phase in PHASES),
        f"{seconds:.1f}",
        f"{sum(solution.seconds.values()) / START[name]:.2f}" if name in START and comm.size == 1 else "",
        f"{sum(peaks):.0f}",
        f"{max(peaks):.0f}",
    ]


def main(
    settings: Annotated[
        list[str] | None,
        typer.Argument(metavar="SETTING...", help=", ".join(SETTINGS), show_default="all but the million"),
    ] = None,
    json: Annotated[Path | None, typer.Option(metavar="FILE", help=JSON_HELP, show_default=False)] = None,
) -> None:
    """Measure one solve of a sphere beside a plane in space at each setting, and print a table."""
    chosen = settings or USUAL
    unknown = [name for name in chosen if name not in SETTINGS]
    if unknown:
        raise typer.BadParameter(f"{unknown[0]}: not a setting; known: {', '.join(SETTINGS)}")
    small = sphere_case(SMALL)
    StokesModel(small)(small.configuration(), 0.0)
    table = Table(title=f"a sphere in space, {GAP:g} radii from a plane", title_justify="left")
    costs = (*PHASES, "s", "of old", "MB", "most")
    for heading in ("setting", "ranks", "unknowns", "iterations", "error", *costs):
        table.add_column(heading, justify="left" if heading == "setting" else "right", no_wrap=True)
    scaling = Scaling(f"a sphere in space, {GAP:g} radii from a plane", "unknowns")
    for name in chosen:
        table.add_row(*measured(name, scaling))
    if MPI.COMM_WORLD.rank == 0:
        Console(width=140).print(table)
        scaling.write(json)


if __name__ == "__main__":
    typer.run(main)
