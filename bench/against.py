"""What a solve costs here and in another checkout, in turns: `python bench/against.py FOLDER`.

    git worktree add /tmp/before COMMIT
    python bench/against.py /tmp/before
    python bench/against.py /tmp/before --bars
    python bench/against.py /tmp/before --discs 200
    python bench/against.py /tmp/before --gap 0.1 --gap 0.001
    python bench/against.py . --ranks 2 --discs 200
    python bench/against.py . --ranks 2 --sphere "P2, 16 times"

Each of the two solves the same case files in a process of its own, warm, mesh included; with `--bars` what
counts is their error bars, which come after the solve, with `--discs` one step of so many sheared discs (see
`bench/suspension.py`), on a new mesh and on a moved one, with `--gap` a disc so many radii beside a plane,
with `--sphere` a setting of `bench/space.py`.
They are asked for one solve each in turn, so that other work on the machine slows down both, and their CPU
seconds are compared: those of the cheapest solve, and the quartiles of the ratio of the two of each turn.
With `--ranks` this checkout solves on several ranks; seconds are those of the first, which does not sleep
while it waits. The bench ends with exit code 1 where a median is above `--most`.
"""

from __future__ import annotations

import os
import subprocess
import sys
from contextlib import closing
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.console import Console
from rich.table import Table

from fsi.workers.launch import mpiexec

ROOT = Path(__file__).parents[1]
CASES = ["disc_beside_plane", "two_discs", "disc_in_box", "couette_N10", "sheared_cell"]
# Read by both: for each line of the input one solve, and its CPU seconds in the output. A line is the path of
# a case file, behind "bars" where these are asked for, and before a gap if it has one of its own; a number of
# discs and "new" or "moved"; or "sphere" and a setting.
SERVE = """
import sys, time, fsi
from pathlib import Path
import fsi.meshes.backend
from mpi4py import MPI
from bench.suspension import moved_steps, new_steps, suspension
from fsi.case.load import load_case
from fsi.stokes.model import StokesModel

assert Path(fsi.__file__).is_relative_to(sys.argv[1]), f"{fsi.__file__} is not of {sys.argv[1]}"
models = {}

def of_discs(n, mesh):
    (solution,) = (moved_steps if mesh == "moved" else new_steps)(suspension(n), 1)
    return sum(solution.seconds.values())

def of_sphere(setting):
    from bench.space import SETTINGS, sphere_case
    if setting not in SETTINGS:
        raise SystemExit(f"{setting}: not a setting; known: {', '.join(SETTINGS)}")
    case = sphere_case(SETTINGS[setting])
    return sum(StokesModel(case)(case.configuration(), 0.0).seconds.values())

def of_case(asked, bars):
    if asked not in models:
        path, *gaps = asked.split(" at ")
        case = load_case(Path(path), [f"bodies.0.position=[0.0, {1.0 + float(gap)}]" for gap in gaps])
        models[asked] = StokesModel(case), case.configuration()
    model, q = models[asked]
    start = time.process_time()
    solution = model(q, 0.0)
    if bars:
        start = time.process_time()
        model.errors(q, 0.0, solution)
    return time.process_time() - start

comm = MPI.COMM_WORLD

def next_asked():
    # While others read, ranks sleep: they would slow down what the other checkout does.
    if comm.rank > 0:
        while not comm.iprobe(source=0):
            time.sleep(5e-4)
        return comm.recv(source=0)
    line = sys.stdin.readline().strip()
    for rank in range(1, comm.size):
        comm.send(line, rank)
    return line

while asked := next_asked():
    comm.barrier()
    kind, _, what = asked.partition(" ")
    if kind == "sphere":
        seconds = of_sphere(what)
    elif kind == "bars":
        seconds = of_case(what, True)
    else:
        seconds = of_discs(int(kind), what) if kind.isdigit() else of_case(asked, False)
    if comm.rank == 0:
        print(seconds, flush=True)
"""


class Checkout:
    """The process of one checkout."""

    def __init__(self, folder: Path, ranks: int = 1) -> None:
        environment = os.environ | {"PYTHONPATH": str(folder), "OMP_NUM_THREADS": "1"}
        started = [mpiexec(), "-n", f"{ranks}"] if ranks > 1 else []
        command = [*started, sys.executable, "-c", SERVE, str(folder)]
        self.process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment, cwd=folder
        )

    def seconds(self, asked_for: str) -> float:
        """CPU seconds of one solve. Raises typer.Exit where its process has ended."""
        asked, answers = self.process.stdin, self.process.stdout
        assert asked is not None
        assert answers is not None
        asked.write(f"{asked_for}\n")
        asked.flush()
        answer = answers.readline()
        if not answer:
            raise typer.Exit(1)
        return float(answer)

    def close(self) -> None:
        """End the process."""
        self.process.communicate()


def main(
    other: Annotated[Path, typer.Argument(help="The other checkout.", exists=True, file_okay=False)],
    turns: Annotated[int, typer.Option(help="Solves of each case by each of them.")] = 20,
    most: Annotated[float, typer.Option(help="How many times as dear a solve may be.")] = 1.03,
    cases: Annotated[list[str] | None, typer.Option(help="Of the folder cases.", show_default="five")] = None,
    bars: Annotated[bool, typer.Option("--bars", help="Of cases the seconds of their error bars.")] = False,
    discs: Annotated[list[int] | None, typer.Option(help="Sheared discs, in place of cases.")] = None,
    gap: Annotated[list[float] | None, typer.Option(help="Of a disc and a plane, in place of cases.")] = None,
    sphere: Annotated[list[str] | None, typer.Option(help="A setting of bench/space.py.")] = None,
    ranks: Annotated[int, typer.Option(help="On which this checkout solves.", min=1)] = 1,
) -> None:
    """Solve cases in turns, print a table, and fail where they have become dearer."""
    table = Table(title="CPU seconds of a warm solve", title_justify="left")
    for heading in ("case", "there", "here", "quartiles of here / there, each turn"):
        table.add_column(heading, justify="left" if heading == "case" else "right")
    medians = []
    what, disc = "bars " if bars else "", ROOT / "cases" / f"{CASES[0]}.toml"
    asked = {f"{what}gap {q:g}": f"{what}{disc} at {q!r}" for q in gap or []}
    asked |= {f"{n} discs, {mesh} mesh": f"{n} {mesh}" for n in discs or [] for mesh in ("new", "moved")}
    asked |= {f"sphere, {setting}": f"sphere {setting}" for setting in sphere or []}
    if cases or not asked:
        asked |= {f"{what}{case}": f"{what}{ROOT / 'cases' / case}.toml" for case in cases or CASES}
    with closing(Checkout(ROOT, ranks)) as here, closing(Checkout(other.resolve())) as there:
        for case, solve in asked.items():
            taken = np.array([(there.seconds(solve), here.seconds(solve)) for _ in range(turns + 1)])[1:]
            quartiles = np.quantile(taken[:, 1] / taken[:, 0], [0.25, 0.5, 0.75])
            medians.append(quartiles[1])
            shown = (f"{ratio:.3f}" for ratio in quartiles)
            table.add_row(case, *(f"{least:.4f}" for least in taken.min(axis=0)), " ".join(shown))
    Console(width=100).print(table)
    if max(medians) > most:
        raise typer.Exit(1)


if __name__ == "__main__":
    typer.run(main)
