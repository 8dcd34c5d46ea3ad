"""What a step between pores costs, by phase: `OMP_NUM_THREADS=1 python bench/pore_speed.py 50 200 1800`.

Discs at area fraction 0.4 between sliding walls, those of tests/reference/couette_N50.json and
couette_N200.json; more are 200 n^2, copies of the latter side by side in n rows. With `--resolved TURNS`
steps are also compared with resolved ones of the same 50 or 200 discs, as `bench/suspension.py` of this
checkout or another one has them, in turns with them.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from contextlib import closing
from pathlib import Path
from time import process_time

import numpy as np
from rich.console import Console
from rich.table import Table

sys.path.insert(0, str(Path(__file__).parents[1]))  # of a checkout that runs bench/pore_speed.py

from bench.against import ROOT, Checkout
from bench.step import forget_peak, peak_memory
from fsi.arrays import Array
from fsi.bodies.configuration import Motion
from fsi.pores.solve import PoreLoading, solve_pores
from fsi.pores.surfaces import DISC, WALL, BoundingSurfaces
from fsi.pores.system import PoreSystem

REFERENCE = ROOT / "tests" / "reference"
PHASES = ("pores", "forms", "solve")
WARM = 3
EXAMPLE = """columns: which step (the first takes machine code from its cache, or makes it), CPU seconds
for the pores (triangulation, fluid discs), for their forms with assembly, for the solve, and their sum;
of warm steps the cheapest of three. MB: the peak of the resident memory. The walls move at a given
speed: errors of the dissipation are those of the apparent viscosity.
"""


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, epilog=EXAMPLE, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("discs", type=int, nargs="+", help="50, or 200 n^2")
    parser.add_argument("--modes", type=int, nargs="+", default=[1, 4], help="of each neck")
    parser.add_argument("--resolved", type=int, default=0, metavar="TURNS", help="compare in so many turns")
    parser.add_argument(
        "--of", type=Path, default=ROOT, metavar="FOLDER", help="whose resolved steps: a checkout"
    )
    wanted = parser.parse_args(arguments)
    resolved = ["of resolved"] if wanted.resolved else []
    table = Table("discs", "modes", "step", "unknowns", *PHASES, "CPU s", "MB", "dissipation", *resolved)
    for discs in wanted.discs:
        for modes in wanted.modes:
            forget_peak()
            first = timed(discs, modes)
            warm = min((timed(discs, modes) for _ in range(WARM)), key=lambda step: sum(step[2:]))
            for step, (unknowns, dissipation, *seconds) in (("first", first), ("warm", warm)):
                times = [f"{value:.3f}" for value in (*seconds, sum(seconds))]
                row = [str(discs), str(modes), step, f"{unknowns:.0f}", *times]
                row += [f"{peak_memory():.0f}", f"{dissipation:.8g}"]
                if resolved and step == "warm":
                    row.append(of_resolved(discs, modes, wanted.resolved, wanted.of.resolve()))
                table.add_row(*row)
    Console(width=130).print(table)


def timed(discs: int, modes: int) -> tuple[float, ...]:
    """Unknowns, the dissipation, and CPU seconds of the phases of one step."""
    surfaces, height = suspension(discs)
    system = PoreSystem.make(surfaces, modes, 1.0)
    nothing = np.zeros((discs, 3))
    walls = np.array([[-0.5 * height, 0.0, 0.0], [0.5 * height, 0.0, 0.0]])
    began = process_time()
    flow = solve_pores(
        system, PoreLoading(Motion(nothing.astype(bool), nothing, nothing), walls, np.zeros((2, 2)))
    )
    seconds = system.seconds["cpu_pores"], system.seconds["cpu_forms"], process_time() - began
    return float(system.unknowns), flow.dissipation, *seconds


def of_resolved(discs: int, modes: int, turns: int, checkout: Path) -> str:
    """CPU seconds of a step over those of a resolved one with its mesh: median of turns and quartiles."""
    if discs not in (50, 200):
        raise SystemExit(f"pore_speed.py: --resolved with {discs} discs: give 50 or 200")
    with closing(Checkout(checkout)) as resolved:
        resolved.seconds(f"{discs} new")  # the first takes what later ones find
        ratios = [sum(timed(discs, modes)[2:]) / resolved.seconds(f"{discs} new") for _ in range(turns)]
    least, median, most = np.quantile(ratios, [0.25, 0.5, 0.75])
    return f"{median:.3f} ({least:.3f} to {most:.3f})"


def suspension(discs: int) -> tuple[BoundingSurfaces, float]:
    """Discs between walls, and their distance."""
    copies = round((discs / 200) ** 0.5) if discs > 200 else 1
    if discs > 200 and discs != 200 * copies**2:
        raise SystemExit(f"pore_speed.py: {discs} discs: give 50, or 200 n^2, e.g. {200 * copies**2}")
    data = json.loads((REFERENCE / f"couette_N{min(discs, 200)}.json").read_text())
    centres, length, height = np.array(data["centers"]), data["L"], data["H"]
    steps = [[i * length, j * height] for i in range(copies) for j in range(copies)]
    return channel(np.concatenate([centres + step for step in steps]), copies * length, copies * height)


def channel(centres: Array, length: float, height: float) -> tuple[BoundingSurfaces, float]:
    """Discs of radius 1 between walls at y = 0 and y = height, which comes with them."""
    N = len(centres)
    surfaces = BoundingSurfaces(
        np.array([DISC] * N + [WALL] * 2, np.int8),
        np.vstack([centres, [[0.0, 0.0], [0.0, height]]]),
        np.append(np.ones(N), [0.0, 0.0]),
        np.vstack([np.zeros((N, 2)), [[0.0, 1.0], [0.0, -1.0]]]),
        np.zeros(N + 2, bool),
        np.array([[length, 0.0]]),
    )
    return surfaces, height


if __name__ == "__main__":
    main()
