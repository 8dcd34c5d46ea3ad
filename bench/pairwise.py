"""How far pairwise lubrication is from the resolved flow in sheared suspensions, by area fraction.

The drag of each area fraction is found on one random packing (seed 4), by the mean mobility of its resolved
flow, and used for another one (seed 3). The shipped suspensions, all of area fraction 0.4, have the drag of
the case sheared_pairwise. Errors in per cent, as `fsi compare` has them.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")  # CPU seconds are those of one thread

import argparse
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from fsi.arrangements.arrangement import Wanted
from fsi.arrangements.packing import random_arrangement
from fsi.calibration.drag import calibrated_drag, reduced_model
from fsi.case.case import Case
from fsi.case.load import load_case, parse_case
from fsi.comparison.instants import compare_instants
from fsi.stokes.resistance import resistance_with_error

CASES = Path(__file__).parents[1] / "cases"
FRACTIONS, SHIPPED = (0.2, 0.4, 0.6), ("random", "columns", "oblique_chains", "rows")
GAP, NUMBER, CALIBRATED, COMPARED = 0.02, 30, 4, 3
LAWS = {"law": "exact", "shear_law": "exact", "rotation_law": "exact", "cutoff": 1.0}


def packing(fraction: float, seed: int) -> Case:
    """Discs of radius 1 at random in a channel whose top moves."""
    wanted = Wanted(NUMBER, fraction, GAP, cell="channel", seed=seed)
    found = random_arrangement(np.ones(NUMBER), wanted)
    bodies = [{"name": str(k), "radius": 1.0, "position": x} for k, x in enumerate(found.centres.tolist())]
    domain = {"lower": [0.0, 0.0], "upper": list(found.cell.sides), "periodic": ["x"]}
    domain |= {"walls": {"top": [1.0, 0.0]}}
    data = {"name": f"random, {fraction:g}", "fluid": {"viscosity": 1.0}, "domain": domain, "bodies": bodies}
    return parse_case(data | {"reduced": LAWS})


def drag_of(case: Case) -> float:
    """That of the resolved mean mobility."""
    solved = resistance_with_error(case)
    return calibrated_drag(reduced_model(case), solved.resistance, solved.errors, Path(case.name)).drag


def cases() -> Iterator[tuple[str, Case, float]]:
    """Names, cases, and their drags."""
    for fraction in FRACTIONS:
        yield f"random, {fraction:g}", packing(fraction, COMPARED), drag_of(packing(fraction, CALIBRATED))
    shipped = load_case(CASES / "sheared_pairwise.toml")
    yield "couette_N10.toml, 0.4", shipped, shipped.drag
    for name in SHIPPED:
        yield f"{name}.toml, 0.4", load_case(CASES / "suspensions" / f"{name}.toml"), shipped.drag


def row(name: str, case: Case, drag: float) -> str:
    """One line of the table."""
    data: dict[str, Any] = case.as_data() | {"reduced": LAWS | {"drag": drag}}
    found = compare_instants(
        {model: parse_case(data | {"model": model}) for model in ("resolved", "reduced")}
    )
    ours, mu = found["reduced"], found["resolved"].apparent_viscosity
    errors = (f"{100.0 * (error or 0.0):.0f}" for error in (ours.velocities, ours.spins, ours.gap_rates))
    viscosity = f"{mu:.3f} | {ours.apparent_viscosity:.3f} | {100.0 * (ours.viscosity or 0.0):+.0f}"
    return f"| {name} | {drag:.2f} | {viscosity} | {' | '.join(errors)} |"


def main() -> None:
    """Print the table."""
    argparse.ArgumentParser(description=__doc__).parse_args()
    print("| discs, area fraction | drag | mu_app | pairwise | error | velocities | spins | gap rates |")
    print("|---|---|---|---|---|---|---|---|")
    for name, case, drag in cases():
        print(row(name, case, drag), flush=True)


if __name__ == "__main__":
    main()
