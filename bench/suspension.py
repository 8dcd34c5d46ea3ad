"""What one step of a sheared suspension costs, and how accurate it is: `python bench/suspension.py 50 200`.

Discs at area fraction 0.4 between sliding walls, periodic along x: the files
tests/reference/couette_N*.json; one disc in a square cell; and 1000 discs, the 200 of couette_N200 five
times along a cell five times as long. A step is one solve with its mesh, in a process that has done it
before, with a new mesh or the last one moved. The error is that of the apparent viscosity against converged
values. CPU seconds; MB is the peak of the process, some 200 of which are libraries.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from bench.step import PHASES, forget_peak, peak_memory
from fsi.bodies import Configuration, Motion
from fsi.stokes.solution import StokesSolution
from fsi.stokes.solve import Boundary, Clock, solve
from fsi.stokes.workspace import Workspace
from meshes.build import build
from meshes.cell import Channel
from meshes.lattice import Lattice
from meshes.move import Mover
from meshes.sizing import Resolution

REFERENCE = Path(__file__).parents[1] / "tests" / "reference"
# The cheapest that errs by less than 5e-4 at 10, 50 and 200 discs; cases/suspensions/history.toml has it too.
LIGHT = Resolution(cells_per_gap=0.28, cells_per_circle=18, growth=0.25, interior="sparse")
# N = 10: the file's own; the others computed here, by `pytest -m slow tests/stokes/test_periodic.py`. 1000
# discs in a channel of five equal periods have the viscosity of one period.
CONVERGED = {10: 8.298079598524666, 50: 6.432973, 200: 6.220577, 1000: 6.220577}
PERIODS = {1: 1, 10: 1, 50: 1, 200: 1, 1000: 5}
MOVE = 1e-3  # of a shear strain, by which bodies and mesh are moved
REPEATS = 3
EXAMPLE = """example:
  OMP_NUM_THREADS=1 python bench/suspension.py 50 200

columns: mesh (gmsh, or the move), setup (spaces, constraints), assemble (M), solve (P^T M P, MUMPS), checks
(identities, stresses), and their sum; CPU seconds of the cheapest of some steps after a first one, so that
the other work of the machine counts little, but its clock does. Error: of the apparent viscosity, relative.
MB: the peak of the resident memory. All five sizes take some two minutes and 4 GB.
"""


def suspension(n: int) -> tuple[Channel, Configuration, float]:
    """The channel, its n bodies, and the height of the walls."""
    if n == 1:
        side = float(np.sqrt(np.pi / 0.4))
        centres, L, H = np.array([[0.5 * side, 0.5 * side]]), side, side
    else:
        given = json.loads((REFERENCE / f"couette_N{n // PERIODS[n]}.json").read_text())
        L, H = given["L"], given["H"]
        centres = np.concatenate(
            [np.array(given["centers"]) + np.array([k * L, 0.0]) for k in range(PERIODS[n])]
        )
    return Channel((0.0, 0.0), (PERIODS[n] * L, H)), Configuration.unturned(centres, np.ones(n)), H


def step(n: int, *, moved: bool) -> StokesSolution:
    """The cheapest of some steps."""
    channel, q, H = suspension(n)
    walls = {
        "bottom": lambda x: np.tile([-0.5 * H, 0.0], (len(x), 1)),
        "top": lambda x: np.tile([0.5 * H, 0.0], (len(x), 1)),
    }
    nothing = np.zeros((n, 3))
    free, boundary = Motion(nothing.astype(bool), nothing, nothing), Boundary(walls, {})
    before = q.centres - MOVE * np.column_stack([q.centres[:, 1] - 0.5 * H, np.zeros(n)])
    mover = Mover(build(channel, before, q.radii, LIGHT, 3), before) if moved else None
    found, workspace = [], Workspace()
    for k in range(2 if n == max(PERIODS) else REPEATS + 1):
        # The first step, half-way where the mesh is moved, warms up.
        there = q if k > 0 or mover is None else replace(q, centres=0.5 * (before + q.centres))
        clock = Clock()
        if mover is None:
            fluid = build(channel, q.centres, q.radii, LIGHT, 3)
        else:
            quality = mover.move(there.centres)
            fluid = mover.fluid.moved(quality or 0.0, Lattice(channel.periods))
        clock.lap("mesh")
        found.append(
            solve(fluid, channel, there, free, boundary, clock=clock, workspace=workspace if mover else None)
        )
    if mover is not None:
        mover.close()
    workspace.close()
    return min(found[1:], key=lambda solution: sum(solution.seconds.values()))


def sizes() -> list[int]:
    """The numbers of discs that the command line asks for, or all."""
    parser = argparse.ArgumentParser(
        description=(__doc__ or "").split("\n\n")[1],
        epilog=EXAMPLE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    numbers = list(PERIODS)
    parser.add_argument("N", nargs="*", type=int, help=f"numbers of discs: {numbers}; all of them if none")
    asked: list[int] = parser.parse_args().N
    for n in asked:
        if n not in PERIODS:
            parser.error(f"N = {n}: there is no suspension of that many discs; choose from {numbers}")
    return asked or numbers


def main() -> None:
    """Measure and print."""
    asked = sizes()
    table = Table(title="one step of a sheared suspension, phi = 0.4, CPU seconds", title_justify="left")
    for heading in ("N", "mesh", "unknowns", "viscosity", "error", *PHASES, "step", "MB"):
        table.add_column(heading, justify="right", no_wrap=True)
    step(1, moved=False)
    for n in asked:
        for moved in (False, True):
            forget_peak()
            solution = step(n, moved=moved)
            mu = solution.apparent_viscosity or float("nan")
            error = f"{abs(mu / CONVERGED[n] - 1.0):.1e}" if n in CONVERGED else ""
            phases = [f"{solution.seconds[phase]:.2f}" for phase in PHASES]
            table.add_row(
                f"{n}", "moved" if moved else "new", f"{solution.dofs}", f"{mu:.6f}", error, *phases,
                f"{sum(solution.seconds.values()):.2f}", f"{peak_memory():.0f}",
            )  # fmt: skip
    Console(width=130).print(table)


if __name__ == "__main__":
    main()
