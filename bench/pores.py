"""How far pores are from the resolved flow, by the number of modes a neck.

    python -m bench.pores --cases 60 --seed 0

Each case of `bench.pore_packings` is solved by pores with 1, 2, 4 and 8 modes and by elements of degree 5,
which are known to a few 1e-8 (the second table shows it, and that pores with 16 modes are nearer than the
default elements). A row has the worst case of its area fraction. The third table has arrays, whose drag and
viscosities are taken relative to the literature or to elements.

The bench ends with exit code 1 where one mode misses a bound, where a viscosity does not fall from each
number of modes to the next, where one lies below the resolved one by more than BELOW, or a lower bound above,
where a velocity is off by more than its bar, or where arrays miss theirs.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")  # CPU seconds are those of one thread

import json
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from time import process_time
from typing import Annotated

import numpy as np
import typer
from rich.console import Console
from rich.progress import track
from rich.table import Table

from bench.pore_arrays import FRACTIONS as OF_ARRAYS
from bench.pore_arrays import LATTICES, QUANTITIES, array_values, reference_values
from bench.pore_packings import (
    Deviation,
    Packing,
    SolvedPacking,
    by_elements,
    by_pores,
    deviation,
    least_dissipation,
    over_bars,
    packings,
)
from fsi.files import replace
from fsi.meshes.resolution import Resolution
from fsi.pores.bars import reference_modes

MODES, LEAST = (1, 2, 4, 8), (4, 8)
DEGREE, FINE = 5, Resolution(cells_per_gap=0.5, cells_per_circle=32)
# Up to these area fractions, with one mode: relative errors of viscosity, velocities, rates.
BOUNDS = {0.4: (0.025, 0.05, 0.03), 0.6: (0.015, 0.025, 0.015), 1.0: (0.005, 0.01, 0.01)}
BELOW = 1e-6  # of the viscosity: what the resolved one and the quadrature of pores are known to
COMPARED = 4  # small packings whose finest flows are compared
FINER, SIXTEEN = (6, Resolution(cells_per_gap=0.8, cells_per_circle=44)), 16
TWO, FINEST = (2, 1e-2), (16, 1e-3)  # modes and bound of arrays


@dataclass(frozen=True, slots=True)
class Measured:
    """A packing by pores: against the resolved flow, by the number of modes.

    Attributes:
        packing: which.
        resolved: by elements.
        errors: of each number of modes.
        over_bars: the largest error of a velocity over its bar, of each number of modes.
        least: how far lower bounds are below the resolved viscosity, relative, by the modes of LEAST.
        unknowns: the same, a disc.
        seconds: of the processor, pores and forms and solution.
    """

    packing: Packing
    resolved: SolvedPacking
    errors: dict[int, Deviation]
    over_bars: dict[int, float]
    least: dict[int, float]
    unknowns: dict[int, float]
    seconds: dict[int, float]

    def faults(self) -> Iterator[str]:
        """What it does not keep."""
        name, mu = self.packing.name, {modes: error.viscosity for modes, error in self.errors.items()}
        bounds = next(bound for fraction, bound in BOUNDS.items() if self.packing.fraction <= fraction)
        for what, bound in zip(("viscosity", "velocities", "rates"), bounds, strict=True):
            error = getattr(self.errors[MODES[0]], what)
            if error > bound:
                yield f"{name}: {what} off by {error:.2%} with one mode, bound {bound:.1%}"
        for modes, error in mu.items():
            if error < -BELOW:
                yield f"{name}: viscosity {-error:.1e} below the resolved one with {modes} modes"
        for few, many in pairwise(mu):
            if mu[many] >= mu[few]:
                yield f"{name}: viscosity no lower with {many} modes than with {few}"
        for modes, ratio in self.over_bars.items():
            if ratio > 1.0:
                yield f"{name}: a velocity {ratio:.2f} times its bar off with {modes} modes"
        for modes, below in self.least.items():
            if below < -BELOW:
                yield f"{name}: lower bound {-below:.1e} above the resolved viscosity with {modes} modes"


def measured(packing: Packing) -> Measured:
    """By all numbers of modes."""
    resolved = by_elements(packing, FINE, DEGREE)
    flows, seconds = {}, {}
    for modes in sorted({*MODES, *map(reference_modes, MODES)}):
        began = process_time()
        flows[modes] = by_pores(packing, modes)
        seconds[modes] = process_time() - began
    U = {modes: flow.U for modes, flow in flows.items()}
    errors = {modes: deviation(packing, flows[modes], resolved) for modes in MODES}
    unknowns = {modes: flows[modes].unknowns / len(packing.q) for modes in MODES}
    over = {modes: float(over_bars(packing, modes, U, resolved.U).max()) for modes in MODES}
    least = {modes: 1.0 - least_dissipation(packing, modes) / resolved.dissipation for modes in LEAST}
    return Measured(packing, resolved, errors, over, least, unknowns, seconds)


def by_fraction(found: list[Measured]) -> Table:
    """The worst of each area fraction, and the mean of unknowns and CPU milliseconds a disc."""
    table = Table(
        title="worst errors of packings, per cent, and over bars; means a disc", title_justify="left"
    )
    bounds = ("least viscosity", "lower bound: worst", "median")
    for heading in ("phi", "cases", "modes", *Deviation._fields, "of bars", *bounds, "unknowns", "ms"):
        table.add_column(heading, justify="right")
    for fraction in sorted({case.packing.fraction for case in found}):
        some = [case for case in found if case.packing.fraction == fraction]
        for modes in MODES:
            errors = 100.0 * np.array([case.errors[modes] for case in some])
            unknowns = np.mean([case.unknowns[modes] for case in some])
            ms = np.mean([1e3 * case.seconds[modes] / len(case.packing.q) for case in some])
            of_bars = max(case.over_bars[modes] for case in some)
            cells = [f"{error:.2g}" for error in (*errors.max(axis=0), of_bars, errors[:, 0].min())]
            below = 100.0 * np.array([case.least[modes] for case in some if modes in case.least])
            cells += [f"{below.max():.2g}", f"{np.median(below):.2g}"] if len(below) else ["", ""]
            table.add_row(f"{fraction:g}", f"{len(some)}", f"{modes}", *cells, f"{unknowns:.0f}", f"{ms:.0f}")
    return table


def finest(some: Iterable[Packing]) -> Table:
    """Which of default elements, those of the bench and pores at their finest are nearest to finer ones."""
    table = Table(title="at the finest: viscosity against elements of degree 6", title_justify="left")
    for heading in ("packing", "elements, default", f"degree {DEGREE}", f"{SIXTEEN} modes", "nearer"):
        table.add_column(heading, justify="left" if heading in ("packing", "nearer") else "right")
    for packing in some:
        exact = by_elements(packing, FINER[1], FINER[0])
        usual, fine, pores = (
            deviation(packing, flow, exact).viscosity
            for flow in (
                by_elements(packing, Resolution(), 3),
                by_elements(packing, FINE, DEGREE),
                by_pores(packing, SIXTEEN),
            )
        )
        nearer = "pores" if abs(pores) < abs(usual) else "elements"
        table.add_row(packing.name, f"{usual:.1e}", f"{fine:.1e}", f"{pores:.1e}", nearer)
    return table


def of_arrays() -> tuple[Table, list[str]]:
    """Errors of arrays with two modes and at the finest, and which miss their bounds."""
    table, faults = Table(title="arrays, relative errors", title_justify="left"), []
    for heading in ("array", "c", "modes", *QUANTITIES):
        table.add_column(heading, justify="right")
    for lattice in LATTICES:
        for c in OF_ARRAYS:
            exact = reference_values(lattice, c)
            for modes, bound in (TWO, FINEST):
                error = array_values(lattice, c, modes) / exact - 1.0
                table.add_row(lattice, f"{c:g}", f"{modes}", *(f"{e:.1e}" for e in error))
                if np.abs(error).max() > bound:
                    faults.append(f"{lattice} array, c = {c:g}, {modes} modes: not within {bound:g}")
    return table, faults


def write(path: Path, found: list[Measured]) -> None:
    """All cases with their errors, unknowns a disc and CPU seconds by modes."""
    rows = [
        {
            "packing": case.packing.name,
            "fraction": case.packing.fraction,
            "errors": {modes: error._asdict() for modes, error in case.errors.items()},
            "over_bars": case.over_bars,
            "lower_bounds": case.least,
            "unknowns": case.unknowns,
            "seconds": case.seconds,
        }
        for case in found
    ]
    replace(path, (json.dumps(rows, indent=1) + "\n").encode())


def main(
    cases: Annotated[int, typer.Option(help="How many packings.")] = 60,
    seed: Annotated[int, typer.Option(help="Of the first packing; the next has one more.")] = 0,
    arrays: Annotated[bool, typer.Option(help="Measure square and hexagonal arrays too.")] = True,
    output: Annotated[Path | None, typer.Option("--json", help="Write all cases there.")] = None,
) -> None:
    """Compare pores with elements, print tables, and fail where a bound is missed."""
    all_packings = list(packings(cases, seed))
    found = [measured(packing) for packing in track(all_packings, "packings", console=Console(stderr=True))]
    console = Console(width=150)
    console.print(by_fraction(found))
    console.print(finest(all_packings[:COMPARED]))
    faults = [fault for case in found for fault in case.faults()]
    if arrays:
        table, missed = of_arrays()
        console.print(table)
        faults += missed
    if output is not None:
        write(output, found)
    for fault in faults:
        console.print(fault)
    if faults:
        raise typer.Exit(1)


if __name__ == "__main__":
    typer.run(main)
