"""What one step of a sheared suspension costs, and how accurate it is: `python bench/suspension.py 50 200`.

Discs at area fraction 0.4 between sliding walls, periodic along x: the files
tests/reference/couette_N*.json; one disc in a square cell; and 1000 discs, the 200 of couette_N200 five
times along a cell five times as long. A step is one solve with its mesh, in a process that has done it
before, with a new mesh or the last one moved. The error is that of the apparent viscosity against converged
values: 4e-4, with `--fine` 1e-5. CPU seconds; MB is the peak of the process, some 200 of which are libraries.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

sys.path.insert(0, str(Path(__file__).parents[1]))  # of a checkout that runs bench/suspension.py

import fsi.parallel as parallel
from bench.scaling import JSON_HELP, Scaling
from bench.step import PHASES, forget_peak, peak_memory
from fsi.arrays import Array
from fsi.bodies.configuration import Configuration, Motion
from fsi.meshes.build import FluidMesh, build
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.container import FluidDomain
from fsi.meshes.moving.move import Mover
from fsi.meshes.resolution import Resolution
from fsi.stokes.problem import Boundary, SolverOptions, StokesProblem
from fsi.stokes.solution import StokesSolution
from fsi.stokes.solve import Clock, solve
from fsi.stokes.solvers.workspace import Workspace

REFERENCE = Path(__file__).parents[1] / "tests" / "reference"
# The cheapest that errs by less than 5e-4 at 10, 50 and 200 discs; cases/suspensions/history.toml has it too.
DEGREE, LIGHT = 4, Resolution(cells_per_gap=0.15, cells_per_circle=14, growth=0.7, interior="sparse")
FINE_DEGREE, FINE = 5, Resolution(cells_per_gap=0.2, cells_per_circle=16, growth=0.4, interior="sparse")
# N = 10: the file's own; the others by elements of degree 6 and by pores, as tests/stokes/test_periodic.py
# says. 1000 discs in a channel of five equal periods have the viscosity of one period.
CONVERGED = {10: 8.298079598524666, 50: 6.4329721, 200: 6.2205504, 1000: 6.2205504}
PERIODS = {1: 1, 10: 1, 50: 1, 200: 1, 1000: 5}
MOVE = 2e-4  # of a shear strain, by which bodies and mesh are moved
WARM, REPEATS = 2, 5
# CPU seconds before cells were added up straight into the reduced system, by N and whether the mesh was
# moved; as those of bench/step.py.
START = {(50, False): 0.332, (50, True): 0.145, (200, False): 1.449, (200, True): 0.519}
EXAMPLE = """example:
  OMP_NUM_THREADS=1 python bench/suspension.py 50 200
  OMP_NUM_THREADS=1 python bench/suspension.py 200 1000 --growth 12
  OMP_NUM_THREADS=1 mpiexec -n 2 python bench/suspension.py 200     (of rank 0, which waits with the CPU)

columns: mesh (gmsh, or the move), setup (spaces, constraints), assemble (rigid modes), solve (P^T M P and its
factors), checks (identities, stresses), and their sum; CPU seconds of the cheapest of some warm steps, so
that the other work of the machine counts little, but its clock does. Error: of the apparent viscosity,
relative. MB: the peak of the resident memory. All five sizes take some two minutes and 4 GB.
"""


@dataclass(frozen=True, slots=True)
class Sheared:
    """A suspension of free discs between sliding walls H apart; the rate of shear is 1."""

    channel: Box
    q: Configuration
    H: float
    resolution: Resolution = LIGHT
    degree: int = DEGREE

    def solve(self, fluid: FluidMesh, clock: Clock, workspace: Workspace | None = None) -> StokesSolution:
        """Its flow on that mesh."""
        walls = {
            "bottom": lambda x: np.tile([-0.5 * self.H, 0.0], (len(x), 1)),
            "top": lambda x: np.tile([0.5 * self.H, 0.0], (len(x), 1)),
        }
        nothing = np.zeros((len(self.q.radii), 3))
        free = Motion(nothing.astype(bool), nothing, nothing)
        problem = StokesProblem(fluid, self.channel, self.q, free, Boundary(walls, {}))
        return solve(problem, SolverOptions(self.degree), clock, workspace)

    def mesh(self) -> FluidMesh:
        """A new mesh."""
        return build(FluidDomain(self.channel, self.q.centres, self.q.radii), self.resolution, self.degree)

    def after(self, strain: float, U: Array) -> Sheared:
        """With the bodies a strain later, if they keep their velocities."""
        return replace(self, q=replace(self.q, centres=self.q.centres + strain * U[:, :2]))


def suspension(n: int) -> Sheared:
    """The channel with its n bodies."""
    if n == 1:
        side = float(np.sqrt(np.pi / 0.4))
        centres, L, H = np.array([[0.5 * side, 0.5 * side]]), side, side
    else:
        given = json.loads((REFERENCE / f"couette_N{n // PERIODS[n]}.json").read_text())
        L, H = given["L"], given["H"]
        centres = np.concatenate(
            [np.array(given["centers"]) + np.array([k * L, 0.0]) for k in range(PERIODS[n])]
        )
    return Sheared(
        Box((0.0, 0.0), (PERIODS[n] * L, H), periodic=("x",)), Configuration.unturned(centres, np.ones(n)), H
    )


def new_steps(sheared: Sheared, repeats: int) -> list[StokesSolution]:
    """Solves on meshes of their own."""
    found = []
    for _ in range(repeats):
        clock = Clock()
        fluid = sheared.mesh()
        clock.lap("mesh")
        found.append(sheared.solve(fluid, clock))
    return found


def moved_steps(sheared: Sheared, repeats: int) -> list[StokesSolution]:
    """Solves on a mesh that was made a while before, and moved."""
    U = sheared.solve(sheared.mesh(), Clock()).U
    before = sheared.after(-MOVE, U)
    mover, found = Mover(before.mesh(), before.q.centres), []
    with Workspace() as workspace:
        # The first steps, on the way, make what the others share.
        for way in (*np.linspace(0.0, 1.0, WARM, endpoint=False), *np.ones(repeats)):
            there = before.after(way * MOVE, U)
            clock = Clock()
            quality = mover.move(there.q.centres)
            if quality is None:
                raise SystemExit("the mesh cannot be moved that far: lessen MOVE")
            fluid = mover.fluid.moved(quality, sheared.channel)
            clock.lap("mesh")
            found.append(there.solve(fluid, clock, workspace))
    mover.close()
    return found[WARM:]


def step(n: int, *, moved: bool, fine: bool = False) -> StokesSolution:
    """The cheapest of some steps, two at least: the first waits for its memory, cleared page by page."""
    repeats, sheared = 2 if n == max(PERIODS) else REPEATS, suspension(n)
    if fine:
        sheared = replace(sheared, resolution=FINE, degree=FINE_DEGREE)
    found = (moved_steps if moved else new_steps)(sheared, repeats)
    return min(found, key=lambda solution: sum(solution.seconds.values()))


def asked() -> tuple[list[int], bool, int, Path | None]:
    """Numbers of discs that are asked for, or all, whether finer, turns of growth, the file to write."""
    parser = argparse.ArgumentParser(
        description=(__doc__ or "").split("\n\n")[1],
        epilog=EXAMPLE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    numbers = list(PERIODS)
    parser.add_argument("N", nargs="*", type=int, help=f"numbers of discs: {numbers}; all of them if none")
    parser.add_argument("--fine", action="store_true", help="to 1e-5, by elements of degree 5")
    parser.add_argument("--growth", type=int, default=0, metavar="TURNS", help="how the cost grows, in turns")
    parser.add_argument("--json", type=Path, metavar="FILE", help=JSON_HELP)
    given = parser.parse_args()
    for n in given.N:
        if n not in PERIODS:
            parser.error(f"N = {n}: there is no suspension of that many discs; choose from {numbers}")
    chosen = given.N or numbers
    if given.growth and len({n for n in chosen if n > 1}) < 2:
        parser.error("--growth: give two numbers of discs or more, e.g. 200 1000")
    return chosen, given.fine, given.growth, given.json


def growth(sizes: Sequence[int], turns: int, *, fine: bool) -> Iterator[str]:
    """How steps on new meshes, and these meshes, grow with the number of discs: medians and quartiles."""
    for few, many in pairwise(sorted(sizes)):
        costs = np.array([[cost(n, fine=fine) for n in (few, many)] for _ in range(turns)])
        exponents = np.log(costs[:, 1] / costs[:, 0]) / np.log(many / few)
        least, median, most = np.quantile(exponents, [0.25, 0.5, 0.75], axis=0)
        step, mesh = (f"N^{median[k]:.3f} ({least[k]:.3f} to {most[k]:.3f})" for k in range(2))
        yield f"from {few} to {many} discs a step grows as {step}, its new mesh as {mesh}"


def cost(n: int, *, fine: bool) -> tuple[float, float]:
    """CPU seconds of a step on a new mesh, and of that mesh."""
    seconds = step(n, moved=False, fine=fine).seconds
    return sum(seconds.values()), seconds["mesh"]


def main() -> None:
    """Measure and print."""
    chosen, fine, turns, output = asked()
    scaling = Scaling("a step of a sheared suspension, area fraction 0.4", "discs")
    table = Table(title="one step of a sheared suspension, phi = 0.4, CPU seconds", title_justify="left")
    for heading in ("N", "mesh", "unknowns", "viscosity", "error", *PHASES, "step", "of old", "MB"):
        table.add_column(heading, justify="right", no_wrap=True)
    step(1, moved=False)
    for n in chosen:
        for moved in (False, True):
            forget_peak()
            solution = step(n, moved=moved, fine=fine)
            mu = solution.apparent_viscosity or float("nan")
            error = f"{abs(mu / CONVERGED[n] - 1.0):.1e}" if n in CONVERGED else ""
            seconds = sum(solution.seconds.values())
            of_old = f"{seconds / START[n, moved]:.2f}" if (n, moved) in START and not fine else ""
            phases = [f"{solution.seconds[phase]:.2f}" for phase in PHASES]
            table.add_row(
                f"{n}", "moved" if moved else "new", f"{solution.dofs}", f"{mu:.6f}", error, *phases,
                f"{seconds:.2f}", of_old, f"{peak_memory():.0f}",
            )  # fmt: skip
            scaling.add("mesh moved" if moved else "new mesh", n, seconds)
    if parallel.is_root():
        Console(width=130).print(table)
        scaling.write(output)
    grown = growth([n for n in chosen if n > 1], turns, fine=fine) if turns else ()
    for line in grown:
        if parallel.is_root():
            print(line)


if __name__ == "__main__":
    main()
