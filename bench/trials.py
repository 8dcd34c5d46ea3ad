"""The trials of the storm: each command of `fsi` with mutated cases, options and run folders."""

from __future__ import annotations

import json
import random
import shutil
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import tomli_w

from bench.mutations import NUMBERS, WORDS, damage, mutated_case, paths

CASES = Path(__file__).parents[1] / "cases"
# Coarse, so that three thousand trials take 20 minutes.
COARSE = {"degree": 2, "cells_per_gap": 0.5, "cells_per_circle": 12, "growth": 0.5}
SHORTER = 0.02  # of the time of a shipped case
SOUND = 0.25  # how often a case has no fault
ANY = ("resolved", "pores", "reduced", "gluey", "macroscopic")
# Levels for which the cases of others serve too.
SERVING = {"reduced": ("resolved",), "pores": ("pores", "resolved")}

type Random = random.Random
type Arguments = list[str]
type Options = dict[str, tuple[object, ...]]
type Trial = Callable[[Random, Place], Arguments]


def shipped(model: str) -> list[Path]:
    """The case files of a model, or of those that serve."""
    files = [path for path in sorted(CASES.rglob("*.toml")) if path.parent.name != "laws"]
    asked = SERVING.get(model, (model,))
    return [path for path in files if tomllib.loads(path.read_text()).get("model", "resolved") in asked]


def coarse(path: Path, model: str) -> dict[str, Any]:
    """A shipped case that takes little time."""
    data = tomllib.loads(path.read_text())
    data["model"] = model
    data["discretisation"] = data.get("discretisation", {}) | COARSE
    if data.get("geometry") == "spatial":
        data["discretisation"]["cells_per_circle"] = 6
    if model == "reduced":
        data["reduced"] = {"drag": 10.0, "cutoff": 1.0} | data.get("reduced", {})
    if model == "pores":
        data["pores"] = {"modes": 0}
    if "time" in data:
        data["time"]["end"] *= SHORTER
    if "calibration" in data:
        data["calibration"] |= {"samples": 6, "held_out": 1}
    return data


@dataclass(frozen=True, slots=True)
class Place:
    """Where a trial happens: its own folder, and the folder of sound runs that it copies; what it did."""

    folder: Path
    runs: Path
    notes: list[str] = field(default_factory=list)

    def case(self, rng: Random, *models: str) -> Path:
        """A mutated case file of one of these models."""
        model = rng.choice(models)
        source = rng.choice(shipped(model))
        self.notes.append(f"{source.relative_to(CASES)} as {model}")
        for other in (*source.parent.glob("*.json"), *(CASES / "laws").glob("*.toml")):
            (self.folder / other.name).write_bytes(other.read_bytes())
        data, path = coarse(source, model), self.folder / "case.toml"
        sound = rng.random() < SOUND
        path.write_bytes(tomli_w.dumps(data).encode() if sound else mutated_case(rng, data))
        return path

    def run(self, rng: Random, *names: str) -> Path:
        """A copy of a run folder, often damaged."""
        name = rng.choice(names or sorted(path.name for path in self.runs.iterdir()))
        copy = self.folder / name
        shutil.copytree(self.runs / name, copy)
        self.notes.append(name)
        for _ in range(rng.choice((0, 1, 1, 2))):
            self.notes.append(damage(rng, copy))
        return copy


def changes(rng: Random, case: Path) -> Arguments:
    """Some --set, of keys that are there or not."""
    try:
        known = [".".join(map(str, path)) for path in paths(tomllib.loads(case.read_text()))]
    except (ValueError, RecursionError):
        known = []
    keys = [*known, "fluid.viscosity", "a.b.c", "bodies.9.radius", "bodies.-1.radius", "", "="]
    wild = (*map(str, NUMBERS), *WORDS, "[", "9" * 5000)
    count = rng.choice((0, 0, 0, 1, 2))
    return [word for _ in range(count) for word in ("--set", f"{rng.choice(keys)}={rng.choice(wild)}")]


def option(rng: Random, name: str, *usual: object) -> Arguments:
    """An option, often left out; its value is mostly a usual one."""
    if rng.random() < 0.75:
        return []
    value = rng.choice(usual) if rng.random() < 0.85 else rng.choice((*NUMBERS, *WORDS))
    return [f"{name}={value}"]


def of_case(command: str, *models: str, out: str | None = None, also: Arguments | None = None) -> Trial:
    """A command on a mutated case; out: the name of what it writes."""

    def trial(rng: Random, place: Place) -> Arguments:
        case = place.case(rng, *models)
        written = [] if out is None else ["--output", str(place.folder / out)]
        return [command, str(case), *written, *(also or []), *changes(rng, case)]

    return trial


def of_run(command: str, *names: str, options: Options | None = None) -> Trial:
    """A command on a damaged run folder with options."""

    def trial(rng: Random, place: Place) -> Arguments:
        run = place.run(rng, *names)
        given = [word for name, usual in (options or {}).items() for word in option(rng, name, *usual)]
        return [*command.split(), str(run), *given]

    return trial


def _keys(rng: Random, _: Place) -> Arguments:
    return ["keys", *rng.choice(([], ["--markdown"], [rng.choice(("gluey", "bodies", *WORDS))]))]


def _pack(rng: Random, place: Place) -> Arguments:
    kind = rng.choice(("random", "random", "square", "hexagonal", "rows", "chains", "columns", "heap"))
    usual: Options = {
        "--number": (1, 5, 20, 40), "--area-fraction": (0.1, 0.4, 0.7, 0.9), "--radius": (1.0, 1e-6, 1e6),
        "--gap": (0.0, 0.02, 3.0), "--cell": ("channel", "periodic", "box"), "--seed": (1, 2),
        "--aspect": (1, 3), "--sizes": ("equal", "bidisperse", "lognormal"), "--spread": (1.4, 0.2),
        "--dimension": (2, 3), "--rows": (1, 2, 5), "--length": (1, 4), "--angle": (0, 45, 90, 135),
    }  # fmt: skip
    chosen = rng.sample(sorted(usual), rng.randrange(4))  # more would hardly ever fit together
    given = [f"{name}={rng.choice((*3 * usual[name], rng.choice(NUMBERS)))}" for name in chosen]
    out = rng.choice((*5 * ("discs.json",), "discs.csv", "nowhere/discs.json", "."))
    return ["pack", kind, "--output", str(place.folder / out), *given]


def _mesh(rng: Random, place: Place) -> Arguments:
    out = str(place.folder / rng.choice(("m.msh", "m.vtu", "m.stl", "nowhere/m.msh")))
    if rng.random() < 0.5:
        return [
            *of_run("mesh", "resolved", "spheres", "reduced")(rng, place),
            "--output",
            out,
            *option(rng, "--step", 1, 2),
        ]
    return [*of_case("mesh", "resolved")(rng, place), "--output", out]


def _probe(rng: Random, place: Place) -> Arguments:
    points = place.folder / "points.csv"
    texts = (b"x,y\n0,3\n1,4\n", b"0;1\n", b"", b"\xff\xfe", b"x,y\n1e400,2\n", b"1,2\n" * 1000)
    points.write_bytes(rng.choice(texts))
    ends = rng.choice(("0,3,3,0.5", "0,0,0,0", "1,2", "nan,0,1,1", "1e300,0,-1e300,1", "0,3,0,4,5,6", "é"))
    where = rng.choice((["--line", ends], ["--plane", ends], ["--points", str(points)], []))
    options: Options = {"--count": (2, 7, 10**9), "--step": (0, 1, 99)}
    return [*of_run("probe", "resolved", "spheres", "reduced", options=options)(rng, place), *where]


def _validate(rng: Random, place: Place) -> Arguments:
    folder = place.folder / "cases"
    folder.mkdir()
    place.case(rng, "resolved", "reduced").rename(folder / "one.toml")
    name = rng.choice(([], ["one"], [rng.choice(WORDS)]))
    return ["validate", "--cases", str(folder), "--output", str(place.folder / "out"), "--", *name]


def _plot_scaling(rng: Random, place: Place) -> Arguments:
    path = place.folder / "bench.json"
    data: dict[str, Any] = {"benchmark": "b", "size": "N", "cpu_seconds": {"one": [[1, 2.0], [10, 30.0]]}}
    if rng.random() < 0.7:
        wrong: tuple[Any, ...] = ([], {}, 1, None, {"one": []}, {"one": [[0, 0]]}, {"one": [["a", 1]]})
        data[rng.choice(list(data))] = rng.choice(wrong)
    path.write_text(json.dumps(data))
    return ["plot", str(path)]


_OF_RENDER: Options = {
    "--size": (200, 300), "--field": ("speed", "pressure", "necks", "t"), "--step": (0, 1),
    "--time": (0.0, 1.0), "--gap": ("0,plane", "0,1"), "--range": ("0,1", "1,0", "0,1e300"),
}  # fmt: skip
_OF_PLOT: Options = {"--gap": ("0,plane", "0,1", "disc,plane"), "--output": ("a.svg", "a.x")}
_OF_REVOLVE: Options = {"--degrees": (90, 360), "--sectors": (3, 8)}
_ALONE, _LEVELS = ["--workers", "1", "--cache", "samples"], ["--levels", "reduced,gluey"]
# Each command: its part of all trials, and one trial.
TRIALS: dict[str, tuple[float, Trial]] = {
    "check": (34.0, of_case("check", *ANY)),
    "keys": (1.0, _keys),
    "mesh": (5.0, _mesh),
    "solve": (5.0, of_case("solve", "resolved", "pores", "pores", "reduced", "reduced", "gluey")),
    "solve --json": (3.0, of_case("solve", "resolved", "pores", "reduced", also=["--json"])),
    "run": (9.0, of_case("run", "reduced", "gluey", "gluey", "macroscopic", "macroscopic", out="run")),
    "run resolved": (1.0, of_case("run", "resolved", out="run")),
    "run pores": (2.0, of_case("run", "pores", out="run")),
    "resume": (9.0, of_run("resume")),
    "resistance": (2.0, of_case("resistance", "resolved", "pores", out="R.json")),
    "calibrate": (1.0, of_case("calibrate", "resolved", out="law", also=_ALONE)),
    "compare": (1.5, of_case("compare", "gluey", "macroscopic", "reduced", out="both", also=_LEVELS)),
    "limit": (4.0, of_case("limit", "gluey", "resolved", out="limit.png")),
    "pack": (6.0, _pack),
    "plot": (5.0, of_run("plot", options=_OF_PLOT)),
    "plot of a bench": (0.5, _plot_scaling),
    "render": (4.0, of_run("render", options=_OF_RENDER)),
    "report": (1.5, of_run("report")),
    "probe": (4.0, _probe),
    "revolve": (2.0, of_run("revolve", "spheres", "spheres", "resolved", options=_OF_REVOLVE)),
    "analyse chains": (1.5, of_run("analyse chains")),
    "analyse memory": (1.5, of_run("analyse memory")),
    "analyse settling": (1.5, of_run("analyse settling")),
    "validate": (1.0, _validate),
}


# Of these, those that need no run folder.
OF_CASES = (
    *("check", "keys", "solve", "solve --json", "run", "run resolved", "run pores"),
    *("resistance", "limit", "pack"),
)


def trial_of(seed: int, place: Place, only: Sequence[str] = ()) -> tuple[str, Arguments]:
    """The command and the arguments of a seed, of some commands only; puts its files into place."""
    rng = random.Random(seed)
    names = only or list(TRIALS)
    name = rng.choices(names, [TRIALS[name][0] for name in names])[0]
    return name, [word.replace("\0", "") for word in TRIALS[name][1](rng, place)]
