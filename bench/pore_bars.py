"""Whether error bars of pores hold: random cases of the plane with few modes against 16.

    python -m bench.pore_bars --cases 24 --seed 0

Cases of `bench.random_cases` whose walls pores can have are solved with one and with four modes, with their
bars. The bench ends with exit code 1 unless 99 % of all values are inside and the median ratio of error to
bar is at least 0.05.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import tomllib
from collections.abc import Iterator
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.progress import track

from bench.bars import Value, holds, results, shown
from bench.random_cases import random_case
from fsi.case.load import parse_case
from fsi.errors import SolveError
from fsi.observables.bars import DrivenBodies
from fsi.pores.accuracy import solve_with_errors
from fsi.pores.fineness import Fineness
from fsi.pores.model import driven
from fsi.pores.resistance import with_modes

KINDS = ["box, walls at rest", "channel, sheared", "channel, driven", "cell", "round container", "suspension"]
MODES, FINEST = (1, 4), 16


def values(kind: str, seed: int) -> Iterator[Value]:
    """All results of a case between pores that have a bar, with each of MODES. Raises SolveError."""
    data: dict[str, Any] = tomllib.loads(random_case(kind, seed).as_toml())
    del data["discretisation"]
    case = parse_case(data | {"model": "pores"})
    q = case.configuration()
    fine = driven(DrivenBodies(case, q, 0.0, case.motion_at(q, 0.0)), Fineness.even(FINEST))
    for modes in MODES:
        solved = solve_with_errors(with_modes(case, modes))
        for name, error, bar in results(case, solved.solution, solved.errors, fine):
            yield Value(kind, seed, f"{name} with {modes}", float(error), float(bar))


def main(
    cases: Annotated[int, typer.Option(min=1, help="how many, of the six kinds in turn")] = 24,
    seed: Annotated[int, typer.Option(min=0, help="of the first of each kind")] = 0,
) -> None:
    """Try the bars of random cases between pores."""
    found, refused = list[Value](), list[str]()
    for n in track(range(cases), "cases", console=Console(stderr=True)):
        kind, number = KINDS[n % len(KINDS)], seed + n // len(KINDS)
        try:
            found += values(kind, number)
        except SolveError as error:
            refused.append(f"{kind}, seed {number}: {error}")
    console = Console(width=130)
    console.print(shown(found, KINDS))
    for line in refused:
        console.print(line, highlight=False)
    if not found or not holds(found, []):  # of all kinds together
        raise SystemExit(1)


if __name__ == "__main__":
    typer.run(main)
