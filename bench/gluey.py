"""CPU seconds of gluey steps of a crowd that is pressed together, by its size: see `--help`.

Discs of radii 0.497 to 0.5 on a triangular lattice beside two walls: "agitated", with random velocities
and gravity, or "squeezed" into the corner so fast that an impulse must travel through all of them.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from statistics import mean
from time import process_time

import numpy as np
from rich.console import Console
from rich.table import Table

sys.path.insert(0, str(Path(__file__).parents[1]))  # of a checkout that runs bench/gluey.py

from bench.scaling import JSON_HELP, Scaling
from fsi.arrays import Array
from fsi.case.gluey import ContactLaw
from fsi.errors import SolveError
from fsi.gluey.contacts import Room
from fsi.gluey.film import DiscFilm
from fsi.gluey.step import advance
from fsi.gluey.system import GlueyState, System
from fsi.meshes.geometry.unbounded import Unbounded

H = 0.01
HEADINGS = ("discs", "step", "contacts", "closed", "iterations", "Newton", "kkt", "overlap", "CPU s")


def crowd(n: int, how: str) -> tuple[System, GlueyState]:
    """About n discs that nearly touch."""
    side = round(np.sqrt(n))
    random = np.random.default_rng(0)
    places = np.stack(np.meshgrid(np.arange(side), np.arange(side), indexing="ij"), -1).reshape(-1, 2)
    shift = np.column_stack([0.5 * (places[:, 1] % 2), np.zeros(len(places))])
    q = (places + shift) * np.array([1.0, np.sqrt(0.75)]) + 0.51
    radii = random.uniform(0.497, 0.5, len(q))
    m = np.pi * radii**2
    mass = np.column_stack([m, m, 0.5 * m * radii**2])
    room = Room(np.zeros((2, 2)), np.eye(2), Unbounded(dimension=2))

    def impulse(t0: float, t1: float) -> Array:
        load: Array = (t1 - t0) * m[:, None] * np.array([-0.5, -1.0, 0.0])
        return load

    U = np.zeros((len(q), 3))
    agitation = random.normal(size=(len(q), 2))
    U[:, :2] = agitation if how == "agitated" else -0.3 * q + 0.1 * agitation
    return System(radii, mass, room, impulse, ContactLaw(), DiscFilm), GlueyState.at(q, U)


def main() -> None:
    """Measure, and print a row for each step."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("how", nargs="?", choices=("agitated", "squeezed"), default="agitated")
    parser.add_argument(
        "counts", nargs="*", type=int, default=[1000, 10_000, 100_000], help="numbers of discs"
    )
    parser.add_argument("--steps", type=int, default=3, help="how many steps of each crowd (3)")
    parser.add_argument("--json", type=Path, metavar="FILE", help=JSON_HELP)
    given = parser.parse_args()
    scaling = Scaling("a gluey step, mean of the measured", "discs")
    table = Table(title=f"{given.how} discs, steps of {H:g}")
    for heading in HEADINGS:
        table.add_column(heading, justify="right")
    try:
        for count in given.counts:
            system, state = crowd(count, given.how)
            spent = []
            for step in range(given.steps):
                began = process_time()
                state, touching, checks = advance(system, state, step * H, H)
                spent.append(process_time() - began)
                table.add_row(
                    f"{len(system.radii)}", f"{step}", f"{len(touching.p)}", f"{(touching.p > 0.0).sum()}",
                    f"{checks.iterations}", f"{checks.newton}", f"{checks.kkt:.1e}", f"{checks.overlap:.1e}",
                    f"{spent[-1]:.2f}",
                )  # fmt: skip
            scaling.add(given.how, len(system.radii), mean(spent))
    except SolveError as error:
        sys.exit(f"error: {error}")
    finally:
        Console(width=110).print(table)
    scaling.write(given.json)


if __name__ == "__main__":
    main()
