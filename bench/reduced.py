"""What a step of the reduced model costs, by number of discs.

Discs of radius 1 at random, at area fraction 0.55, in a channel whose top moves, are stirred by forces for 20
steps; the numbers are means of the last three. near: discs with a gap below 0.05, as a part of all;
defects: the worst of all identities; to read: CPU seconds to check the case, once.
"""

from __future__ import annotations

import os
import sys

os.environ.setdefault("OMP_NUM_THREADS", "1")  # CPU seconds are those of one thread

import argparse
import resource
from collections.abc import Mapping
from pathlib import Path
from time import process_time

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))  # of a checkout that runs bench/reduced.py

from bench.scaling import JSON_HELP, Scaling
from fsi.arrangements.arrangement import Wanted
from fsi.arrangements.packing import random_arrangement
from fsi.arrays import Array
from fsi.case.case import Case
from fsi.case.load import parse_case
from fsi.models import make_model, make_stepper

AREA_FRACTION, GAP, PERIOD = 0.55, 0.01, 2500
STEPS, MEASURED = 20, 3


def positions(number: int) -> tuple[Array, Array]:
    """Centres (N, 2) and the sides of the channel: periods of a fluid of hard discs, as many as needed."""
    one = min(number, PERIOD)
    part = random_arrangement(np.ones(one), Wanted(one, AREA_FRACTION, GAP, cell="periodic", seed=0))
    columns, rows = (number // one, 1) if number <= 4 * one else (2 * (number // (8 * one)), 4)
    i, j = np.meshgrid(np.arange(columns), np.arange(rows), indexing="ij")
    corners = np.column_stack([i.ravel(), j.ravel()]) * part.cell.sides
    sides = np.array([columns, rows]) * part.cell.sides + [0.0, 2.0 + 2.0 * GAP]
    return (corners[:, None] + part.centres + [0.0, 1.0 + GAP]).reshape(-1, 2), sides


def case(number: int, scheme: str) -> Case:
    """A stirred channel of discs."""
    random = np.random.default_rng(0)
    x, room = positions(number)
    force = 20.0 * random.standard_normal((len(x), 2)) + 30.0 * np.sin(6.0 * np.pi * x[:, ::-1] / room)
    bodies = [
        {"name": str(k), "radius": 1.0, "position": p, "force": f, "mass": 1.0, "moment_of_inertia": 0.5}
        for k, (p, f) in enumerate(zip(x.tolist(), force.tolist(), strict=True))
    ]
    for body in bodies if scheme == "adaptive" else ():
        del body["mass"], body["moment_of_inertia"]
    stepping = {} if scheme == "adaptive" else {"scheme": scheme, "step": 0.02}
    return parse_case(
        {
            "name": "discs",
            "model": "reduced",
            "fluid": {"viscosity": 1.0},
            "domain": {
                "lower": [0.0, 0.0],
                "upper": room.tolist(),
                "periodic": ["x"],
                "walls": {"top": [10.0, 0.0]},
            },
            "bodies": bodies,
            "reduced": {"law": "leading", "drag": 12.0, "cutoff": 0.5},
            "time": {"end": 100.0, "tolerance": 1e-2, "first_step": 0.02} | stepping,
        }
    )


DEFECTS = ("momentum", "angular_momentum", "kernel", "residual", "power", "balance", "invariant", "energy")


def measure(number: int, scheme: str) -> dict[str, float]:
    """One size: the columns of the table, and `step`, the CPU seconds of a step."""
    began = process_time()
    given = case(number, scheme)
    read = process_time() - began
    stepper = make_stepper(given, make_model(given))
    state = stepper.start(given.configuration()).state
    spent = []
    for _ in range(STEPS):
        began = process_time()
        step = stepper.advance(state)
        spent.append(process_time() - began)
        state = step.state
    record, N = step.instant.record, len(given.bodies)
    gaps = step.instant.pairs.gap  # type: ignore[attr-defined]
    return {
        "discs": N,
        "pairs": record["pairs"] / N,
        "near": 2.0 * float(np.sum(gaps < 0.05)) / N,
        "solve": record["cpu_solve"] + record.get("cpu_pairs", 0.0),
        "step": float(np.mean(spent[-MEASURED:])),
        "GB": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6,
        "defect": max(record.get(name, 0.0) for name in DEFECTS),
        "read": read,
    }


def row(scheme: str, found: Mapping[str, float]) -> str:
    """A row of the table."""
    cells = [
        f"{found['discs']}",
        f"{found['pairs']:.2f}",
        f"{found['near']:.2f}",
        f"{found['solve']:.3f}",
        f"{found['step']:.3f}",
        f"{1e6 * found['step'] / found['discs']:.1f}",
        f"{found['GB']:.2f}",
        f"{found['defect']:.0e}",
        f"{found['read']:.1f}",
    ]
    return f"| {' | '.join([scheme, *cells])} |"


def main() -> None:
    """Measure, print, write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument(
        "numbers",
        metavar="N",
        nargs="*",
        type=int,
        default=[1000, 10000, 100000],
        help="numbers of discs, 1000 10000 100000 if not given",
    )
    parser.add_argument(
        "--scheme",
        choices=("distance", "adaptive"),
        help="both if not given; an adaptive step is three solves and the search for gaps that close",
    )
    parser.add_argument("--json", type=Path, metavar="FILE", help=JSON_HELP)
    given = parser.parse_args()
    print(
        "| scheme | discs | pairs/disc | near | CPU s/solve | a step | us a disc | GB | defects | to read |"
    )
    print("|---|---|---|---|---|---|---|---|---|---|")
    scaling = Scaling("a step of the reduced model", "discs")
    for scheme in [given.scheme] if given.scheme else ["distance", "adaptive"]:
        for number in given.numbers:
            found = measure(number, scheme)
            print(row(scheme, found), flush=True)
            scaling.add(scheme, int(found["discs"]), found["step"])
    scaling.write(given.json)


if __name__ == "__main__":
    main()
