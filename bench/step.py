"""What one step of a disc over a plane costs, and how accurate it is: `python bench/step.py`.

A step is one solve with its mesh, in a process that has done it before. The disc approaches the plane of
a half-plane; the error is that of its force against the closed form of Jeffrey and Onishi 1981. With
`--sphere` it is a sphere on an axis, and Brenner's series 1961. P4, without another word, is the default.
Seconds are CPU seconds, of the cheapest of five; MB is the peak of the process, some 200 of which are
libraries.
"""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.table import Table

from fsi.bodies.configuration import Configuration
from fsi.case.case import Case
from fsi.case.load import load_case
from fsi.lubrication import exact, spheres
from fsi.stokes.model import StokesModel
from fsi.stokes.solution import StokesSolution

CASES = Path(__file__).parents[1] / "cases"
DISC, SPHERE = CASES / "disc_beside_plane.toml", CASES / "sphere_towards_plane.toml"
GAPS = (0.1, 1e-2, 1e-3, 1e-4)
PHASES = ("mesh", "setup", "assemble", "solve", "checks")
REPEATS = 5
# A step that closes this fraction of the gap is moved, and back; gmsh is not asked.
MOVE = 0.05

DEFAULT = "P4"
SETTINGS: dict[str, dict[str, object]] = {
    DEFAULT: {},
    "P3": {"degree": 3},
    "P3 light": {"cells_per_circle": 24, "growth": 0.3},
    "P3 fine": {"cells_per_circle": 80, "growth": 0.1, "cells_per_gap": 2.0},
    "P2": {"degree": 2},
    "P4 fine": {"degree": 4},
    "P4 light": {"degree": 4, "cells_per_circle": 24, "growth": 0.5},
    "P4 few": {"degree": 4, "cells_per_circle": 16, "growth": 0.5, "cells_per_gap": 0.4},
    "P5": {"degree": 5, "cells_per_circle": 20, "growth": 0.45, "cells_per_gap": 0.3},
    "P6": {"degree": 6, "cells_per_circle": 16, "growth": 0.6, "cells_per_gap": 0.25},
    "P4 multiplier": {"formulation": '"multiplier"'},
}
MOVED = "P4 mesh moved"

# CPU seconds before cells were added up straight into the reduced system, the least of two runs that took
# turns with the new ones: one core of a 2-core EPYC, November 2026, other work beside; the default was P3.
# Of the sphere those of 85393da, the least of six.
START = {
    (DISC, 0.1, DEFAULT): 0.124, (DISC, 0.1, "P4 light"): 0.159, (DISC, 0.1, MOVED): 0.070,
    (DISC, 1e-2, DEFAULT): 0.134, (DISC, 1e-2, "P4 light"): 0.159, (DISC, 1e-2, MOVED): 0.066,
    (DISC, 1e-3, DEFAULT): 0.137, (DISC, 1e-3, "P4 light"): 0.184, (DISC, 1e-3, MOVED): 0.063,
    (SPHERE, 1e-4, DEFAULT): 0.111, (SPHERE, 1e-4, "P4 few"): 0.111,
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Cost:
    """CPU seconds of a step, by phase and together; relative error of its force; size; peak memory in MB."""

    phases: dict[str, float]
    seconds: float
    error: float
    dofs: int
    memory: float


def case_of(file: Path, gap: float, setting: dict[str, object], remesh: str = "always") -> Case:
    """The case file with another gap and other settings."""
    own = [f"discretisation.{key}={value}" for key, value in setting.items()]
    place = f"bodies.0.position=[0.0, {1.0 + gap}]"
    return load_case(file, [place, "time.end=1.0", f'time.remesh="{remesh}"', *own])


def remeshed(file: Path, gap: float, setting: dict[str, object]) -> Cost:
    """A step with a new mesh."""
    case = case_of(file, gap, setting)
    model, q = StokesModel(case), case.configuration()
    return measured(lambda: model(q, 0.0), load(file, gap))


def load(file: Path, gap: float) -> float:
    """The exact force that pushes at speed 1."""
    q = (1.0 + gap) - 1.0
    return float((exact if file == DISC else spheres).normal_resistance(q, 1.0, 1.0))


def moved(file: Path, gap: float) -> Cost:
    """A step at default settings whose mesh is that of the last one, moved to the body's new place."""
    case = case_of(file, gap * (1.0 + MOVE), {}, "when-needed")
    model, q = StokesModel(case), case.configuration()
    model(q, 0.0)
    nearer = Configuration(q.centres - [[0.0, MOVE * gap]], q.angles, q.radii)
    return measured(lambda: model(nearer, 0.0), load(file, gap))


def measured(step: Callable[[], StokesSolution], load: float) -> Cost:
    """The cheapest of some steps, after one that warms up: other work of the machine counts little then."""
    step()
    forget_peak()
    cheapest = min((step() for _ in range(REPEATS)), key=lambda solution: sum(solution.seconds.values()))
    return Cost(
        cheapest.seconds,
        sum(cheapest.seconds.values()),
        abs(-cheapest.F[0, 1] / load - 1.0),
        cheapest.dofs,
        peak_memory(),
    )


def forget_peak() -> None:
    """Let the peak of this process's memory begin anew (Linux)."""
    Path("/proc/self/clear_refs").write_text("5")


def peak_memory() -> float:
    """Peak of the resident memory in MB since `forget_peak`."""
    found = re.search(r"VmHWM:\s+(\d+) kB", Path("/proc/self/status").read_text())
    return float(found[1]) / 1000.0 if found else float("nan")


def row(file: Path, gap: float, name: str, cost: Cost) -> list[str]:
    """The cells of one line of the table."""
    old = START.get((file, gap, name))
    return [
        f"{gap:g}",
        name,
        f"{cost.dofs}",
        f"{cost.error:.1e}",
        *(f"{cost.phases[phase]:.3f}" for phase in PHASES),
        f"{cost.seconds:.3f}",
        f"{cost.seconds / old:.2f}" if old else "",
        f"{cost.memory:.0f}",
    ]


def asked() -> tuple[Path, list[float], list[str]]:
    """The case, the gaps and settings that the command line asks for, or all."""
    names = [*SETTINGS, MOVED]
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n")[1])
    parser.add_argument("gap", nargs="*", type=float, help="over the radius; 0.1, 0.01, 0.001, 1e-4 if none")
    parser.add_argument("--settings", nargs="+", choices=names, default=names, help="all if not given")
    parser.add_argument("--sphere", action="store_true", help="a sphere on an axis in place of a disc")
    given = parser.parse_args()
    return SPHERE if given.sphere else DISC, given.gap or list(GAPS), given.settings


def main() -> None:
    """Measure and print."""
    file, gaps, settings = asked()
    table = Table(title=f"one warm step of {file.stem}, CPU seconds", title_justify="left")
    for heading in ("gap/a", "setting", "unknowns", "error", *PHASES, "step", "of old", "MB"):
        table.add_column(heading, justify="left" if heading == "setting" else "right", no_wrap=True)
    for gap in gaps:
        for name in settings:
            cost = moved(file, gap) if name == MOVED else remeshed(file, gap, SETTINGS[name])
            table.add_row(*row(file, gap, name, cost), end_section=name == settings[-1])
    Console(width=120).print(table)


if __name__ == "__main__":
    main()
