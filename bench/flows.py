"""Whether random cases are solved: each of `bench.random_cases` once, without bars.

    python -m bench.flows --kinds "spheres in a box" --kinds "spheres in a cell" --cases 300

A case counts as solved where its mesh is valid and all identities of its flow hold; others are listed with
what is said of them. "finer" are those that the sizes asked for gave no valid mesh, and that took finer ones.
With `--keep FILE` each is written down as soon as it is done, and not solved again. Exit code 1: a case that
is drawn is neither solved nor refused as one that cannot be meshed.
"""

from __future__ import annotations

import json
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.console import Console
from rich.progress import track
from rich.table import Table

from bench.bars import ALL
from bench.random_cases import random_case
from bench.random_walls import KINDS
from fsi.errors import InputError, SolveError
from fsi.meshes.errors import MeshError
from fsi.stokes.model import StokesModel


@dataclass(frozen=True, slots=True)
class Flow:
    """What became of a case.

    Attributes:
        kind, seed: which it is.
        bodies: how many.
        unknowns, iterations: of its system, 0 iterations of direct solvers.
        worst: the largest of what its identities miss.
        finer: which finer sizes its mesh took, if any.
        seconds: CPU time.
        refused: why it was not meshed; failed: why the solve failed.
    """

    kind: str
    seed: int
    bodies: int
    unknowns: int = 0
    iterations: int = 0
    worst: float = 0.0
    finer: str = ""
    seconds: float = 0.0
    refused: str = ""
    failed: str = ""

    @staticmethod
    def of(kind: str, seed: int) -> Flow:
        """Of this case, solved now."""
        start, case = time.process_time(), random_case(kind, seed)
        bodies = len(case.bodies)
        try:
            flow = StokesModel(case)(case.configuration(), 0.0)
        except (InputError, MeshError) as error:
            return Flow(kind, seed, bodies, refused=str(error), seconds=time.process_time() - start)
        except SolveError as error:
            return Flow(kind, seed, bodies, failed=str(error), seconds=time.process_time() - start)
        worst, seconds = max(flow.checks.values()), time.process_time() - start
        return Flow(kind, seed, bodies, flow.dofs, flow.iterations, worst, flow.mesh_instead, seconds)


def flows(kinds: list[str], cases: int, seed: int, keep: Path | None) -> list[Flow]:
    """So many cases in turn of each kind, those that are kept as they are there."""
    lines = keep.read_text().splitlines() if keep is not None and keep.exists() else []
    known = {(one.kind, one.seed): one for one in (Flow(**json.loads(line)) for line in lines)}
    chosen = [(kinds[n % len(kinds)], seed + n // len(kinds)) for n in range(cases)]
    for case in track(chosen, "cases", console=Console(stderr=True)):
        if case not in known:
            known[case] = Flow.of(*case)
            if keep is not None:
                with keep.open("a") as file:
                    file.write(json.dumps(asdict(known[case])) + "\n")
    return [known[case] for case in chosen]


def shown(found: list[Flow], kinds: list[str]) -> Table:
    """A line for each kind."""
    table = Table(title="random cases, each solved once", title_justify="left")
    headings = ("cases", "solved", "refused", "finer", "unknowns to", "iterations to", "identities to", "s")
    table.add_column("kind")
    for heading in headings:
        table.add_column(heading, justify="right")
    for kind in kinds:
        some = [flow for flow in found if flow.kind == kind]
        if some:
            solved = [flow for flow in some if not (flow.refused or flow.failed)]
            table.add_row(
                kind, f"{len(some)}", f"{len(solved)}", f"{sum(bool(flow.refused) for flow in some)}",
                f"{sum(bool(flow.finer) for flow in some)}",
                f"{max((flow.unknowns for flow in solved), default=0)}",
                f"{max((flow.iterations for flow in solved), default=0)}",
                f"{max((flow.worst for flow in solved), default=0.0):.1e}",
                f"{np.median([flow.seconds for flow in some]):.1f}",
            )  # fmt: skip
    return table


def main(
    kinds: Annotated[
        list[str] | None, typer.Option(help=f"One of: {'; '.join(ALL)}.", show_default="all of discs")
    ] = None,
    cases: Annotated[int, typer.Option(help="How many, in turn of each kind.")] = 100,
    seed: Annotated[int, typer.Option(help="The first case of each kind has this seed.")] = 0,
    keep: Annotated[
        Path | None, typer.Option(help="Cases are written here, and not solved again.", show_default="none")
    ] = None,
) -> None:
    """Solve random cases, print a table, and fail where a solve fails."""
    chosen = kinds or list(KINDS)
    for unknown in set(chosen) - set(ALL):
        raise typer.BadParameter(f"{unknown}: not a kind; known: {'; '.join(ALL)}")
    found, console = flows(chosen, cases, seed, keep), Console(width=140)
    console.print(shown(found, chosen))
    for flow in found:
        for what, why in (("refused", flow.refused), ("failed", flow.failed)):
            if why:
                console.print(f"{what}: {flow.kind}, {flow.seed}: {why}")
    if any(flow.failed for flow in found):
        raise typer.Exit(1)


if __name__ == "__main__":
    typer.run(main)
