"""Whether error bars hold: random cases of all kinds of walls against much finer solves.

    python -m bench.bars --cases 200 --seed 0

Each case of `bench.random_cases` is solved with its bars, and once more with elements of a higher degree on a
finer mesh, in the plane with cells that halve 20 times towards the corners of the walls, in space with finer
cells beside edges where the flow is singular. A value is inside
where it is no farther from the finer one than its bar. The bench ends with exit code 1 unless 99 % of all
values are inside, 97 % of each kind, and the median ratio of error to bar is at least 0.05, so that bars are
not made to hold by making them long.

Cases are independent: with `--keep FILE` each is written down as soon as it is done, and a later run with the
same file solves the others only, so that many cases can be tried in pieces. `--degree 6` solves all with
elements of that degree, in the plane with gaps that cells of high degree do not resolve by far.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from rich.console import Console
from rich.progress import track
from rich.table import Table

from bench.finer import reference
from bench.random_cases import SHAPED, random_case
from bench.random_walls import KINDS
from fsi.arrays import Array
from fsi.case.case import Case
from fsi.case.sections import HIGHEST_DEGREE
from fsi.errors import InputError, SolveError
from fsi.integration.errors import ErrorEstimate
from fsi.pores.instant import PoreInstant
from fsi.stokes.adapt import solve_with_errors
from fsi.stokes.solution import StokesSolution

type Flow = StokesSolution | PoreInstant

ALL = [*KINDS, *SHAPED]
OF_ALL, OF_EACH, MEDIAN = 0.99, 0.97, 0.05
DEFAULT_DEGREE = 4
GAPS_OF_HIGH_DEGREE = 0.3  # cells across: with more, elements above the default degree err by rounding
# What rounding leaves, of the largest of a case: bars are not asked to be about the error there.
ROUNDING = 1e-9


@dataclass(frozen=True, slots=True)
class Value:
    """A result of a case: its error against the finer solve, and its bar."""

    kind: str
    seed: int
    name: str
    error: float
    bar: float

    @property
    def ratio(self) -> float:
        """Error over bar; inside up to 1."""
        return self.error / self.bar if self.bar > 0.0 else np.inf

    @property
    def inside(self) -> bool:
        """Whether the bar holds."""
        return self.error <= self.bar


def of_degree(case: Case, degree: int) -> Case:
    """The case with elements of another degree, or of the highest there is, on as many cells as suit them."""
    sizes, degree = case.discretisation, min(degree, HIGHEST_DEGREE[case.dimension])
    across = min(sizes.cells_per_gap, GAPS_OF_HIGH_DEGREE if degree > DEFAULT_DEGREE else np.inf)
    changed = sizes.model_copy(update={"degree": degree, "cells_per_gap": across})
    return case.model_copy(update={"discretisation": changed})


def values(kind: str, seed: int, degree: int | None = None) -> list[Value]:
    """All results of a case that have a bar. Raises MeshError, SolveError."""
    case = random_case(kind, seed)
    case = case if degree is None else of_degree(case, degree)
    solved = solve_with_errors(case)
    fine = reference(case, solved.solution.mesh_instead)
    found = results(solved.case, solved.solution, solved.errors, fine)
    return [Value(kind, seed, name, float(error), float(bar)) for name, error, bar in found]


def results(case: Case, coarse: Flow, bars: ErrorEstimate, fine: Flow) -> Iterator[tuple[str, float, float]]:
    """Name, error and bar of each result; those that vanish by symmetry, to rounding, are left out."""
    held, of_bars = case.motion(0.0).held, quantities(bars, bars.stress)
    computed, exact = (quantities(flow, flow.bulk) for flow in (coarse, fine))
    for name in (name for name in of_bars if name in exact):  # walls at rest have no viscosity
        bar = of_bars[name]
        if not np.isfinite(exact[name]).all():  # a dissipation that is infinite, as the program says
            continue
        error = np.abs(computed[name] - exact[name])
        counts = np.isfinite(bar) & (error > ROUNDING * np.abs(exact[name]).max(initial=0.0))
        if name in "UF":
            counts &= case.modes & (held if name == "F" else ~held)
        for place in map(tuple, np.argwhere(counts).tolist()):
            yield f"{name}{list(place) or ''}", error[place], bar[place]


def quantities(of: Any, stress: Any) -> dict[str, Array]:
    """What both a solution with its stress and the bars of both have, by name."""
    found = {name: getattr(of, name) for name in ("U", "F", "dissipation", "apparent_viscosity")}
    if stress is not None:
        found |= {name: getattr(stress, name) for name in ("mean", "stresslets", "normal_stress_difference")}
    return {name: np.array(value, dtype=float) for name, value in found.items() if value is not None}


@dataclass(frozen=True, slots=True)
class Tried:
    """What became of a case: its values, or why it was refused."""

    kind: str
    seed: int
    values: list[Value]
    refused: str | None = None

    @staticmethod
    def of(kind: str, seed: int, degree: int | None = None) -> Tried:
        """Of this case, solved now, with the degree that it has if none is given."""
        try:
            return Tried(kind, seed, values(kind, seed, degree))
        except (InputError, SolveError) as error:
            return Tried(kind, seed, [], str(error))


@dataclass(frozen=True, slots=True)
class Kept:
    """Cases tried before, in a file with one on each line; without a file none."""

    file: Path | None = None

    def read(self) -> dict[tuple[str, int], Tried]:
        """All of them by kind and seed."""
        lines = self.file.read_text().splitlines() if self.file is not None and self.file.exists() else []
        each = (json.loads(line) for line in lines)
        return {
            (one["kind"], one["seed"]): Tried(**one | {"values": [Value(**v) for v in one["values"]]})
            for one in each
        }

    def add(self, tried: Tried) -> None:
        """Write down one more."""
        if self.file is not None:
            with self.file.open("a") as file:
                file.write(json.dumps(asdict(tried)) + "\n")


def measured(kinds: list[str], cases: int, seed: int, kept: Kept, degree: int | None = None) -> list[Tried]:
    """So many cases in turn of each kind, those that are kept as they are there."""
    known, every = kept.read(), list[Tried]()
    chosen = [(kinds[n % len(kinds)], seed + n // len(kinds)) for n in range(cases)]
    for case in track(chosen, "cases", console=Console(stderr=True)):
        if case not in known:
            known[case] = Tried.of(*case, degree)
            kept.add(known[case])
        every.append(known[case])
    return every


def values_of(tried: list[Tried]) -> list[Value]:
    """Those of all these cases."""
    return [value for case in tried for value in case.values]


def shown(found: list[Value], kinds: list[str]) -> Table:
    """A line for each kind, and for all."""
    table = Table(title="values within their bars", title_justify="left")
    for heading in ("kind", "cases", "values", "inside", "share", "worst ratio", "median", "worst is"):
        table.add_column(heading, justify="left" if heading in ("kind", "worst is") else "right")
    for kind in [*kinds, ""]:
        some = [value for value in found if kind in (value.kind, "")]
        if some:
            worst = max(some, key=lambda value: value.ratio)
            inside, cases = sum(value.inside for value in some), len({(v.kind, v.seed) for v in some})
            median = np.median([value.ratio for value in some])
            table.add_row(
                kind or "all", f"{cases}", f"{len(some)}", f"{inside}", f"{inside / len(some):.1%}",
                f"{worst.ratio:.2g}", f"{median:.2g}", f"{worst.name} of seed {worst.seed}",
            )  # fmt: skip
    return table


def holds(found: list[Value], kinds: list[str]) -> bool:
    """Whether enough values are inside, of all and of each kind, and bars are not too long."""
    inside = {kind: [value.inside for value in found if value.kind == kind] for kind in kinds}
    ratios = [value.ratio for value in found]
    return bool(
        np.mean([value.inside for value in found]) >= OF_ALL
        and all(np.mean(of_kind) >= OF_EACH for of_kind in inside.values() if of_kind)
        and np.median(ratios) >= MEDIAN
    )


def main(
    kinds: Annotated[
        list[str] | None,
        typer.Option(help=f"One of: {'; '.join(ALL)}; shapes for all of these.", show_default="all of discs"),
    ] = None,
    cases: Annotated[int, typer.Option(help="How many, in turn of each kind.")] = 200,
    seed: Annotated[int, typer.Option(help="The first case of each kind has this seed.")] = 0,
    degree: Annotated[
        int | None, typer.Option(min=2, max=6, help="Of the elements.", show_default="the case's")
    ] = None,
    outside: Annotated[bool, typer.Option(help="List the values outside their bars.")] = False,
    keep: Annotated[
        Path | None,
        typer.Option(help="Cases tried are written here, and not solved again.", show_default="none"),
    ] = None,
) -> None:
    """Solve random cases with their bars and without, print a table, and fail where bars do not hold."""
    chosen = [name for kind in kinds or KINDS for name in (SHAPED if kind == "shapes" else [kind])]
    for unknown in set(chosen) - set(ALL):
        raise typer.BadParameter(f"{unknown}: not a kind; known: {'; '.join(ALL)}")
    tried = measured(chosen, cases, seed, Kept(keep), degree)
    found = values_of(tried)
    console = Console(width=140)
    console.print(shown(found, chosen))
    console.print(f"{len(tried)} cases, {sum(case.refused is not None for case in tried)} of them refused")
    for case in (case for case in tried if case.refused is not None):
        console.print(f"refused: {case.kind}, {case.seed}: {case.refused}")
    for value in (value for value in found if outside and not value.inside):
        console.print(
            f"{value.kind}, seed {value.seed}: {value.name} errs by {value.error:.2g}, bar {value.bar:.2g}"
        )
    if not holds(found, chosen):
        console.print(
            f"not {OF_ALL:.0%} of all and {OF_EACH:.0%} of each kind inside, or the median below {MEDIAN}"
        )
        raise typer.Exit(1)


if __name__ == "__main__":
    typer.run(main)
