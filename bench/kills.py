"""kill -9 at random moments: `python bench/kills.py`, 100 of them.

A command is killed with all its processes at a random moment, one to three times, and then repeated until it
is done: `fsi resume` where there is a run folder. What it leaves must be, byte for byte, what an undisturbed
one leaves. Compared are all files of the folder (tables, series, fields, state, case, law, samples) but
provenance.json, pictures, and the columns and keys of CPU seconds and dates. On two ranks MUMPS is not
repeatable bit by bit: there the numbers of tables are compared, to 1e-9.
"""

from __future__ import annotations

import csv
import json
import os
import random
import re
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from rich.console import Console
from rich.table import Table

from bench.small_cases import CALIBRATED, FALLING_BALL, FALLING_DISC, TWO_REDUCED

ROOT = Path(__file__).parents[1]
GLUEY = "cases/gluey/two_discs.toml --set output.interval=0.25 --set time.step=0.05"
MACROSCOPIC = "cases/macroscopic/bulk.toml --set output.interval=0.25 --set time.step=0.02"
RANKS = "planar run on two ranks"


@dataclass(frozen=True, slots=True)
class Scenario:
    """What is killed: a command of fsi that leaves `out`, its case, and on how many ranks."""

    command: str
    case: str = ""
    ranks: int = 1


SCENARIOS = {
    "planar run": Scenario("run case.toml", FALLING_DISC),
    "spatial run": Scenario("run case.toml", FALLING_BALL),
    "reduced run": Scenario("run case.toml", TWO_REDUCED),
    "gluey run": Scenario(f"run {ROOT / GLUEY}"),
    "macroscopic run": Scenario(f"run {ROOT / MACROSCOPIC}"),
    "calibration": Scenario("calibrate case.toml --workers 1", CALIBRATED),
    "calibration by two processes": Scenario("calibrate case.toml --workers 2", CALIBRATED),
    RANKS: Scenario("run case.toml", FALLING_DISC, 2),
}


def start(scenario: Scenario, folder: Path) -> subprocess.Popen[bytes]:
    """Begin, or go on, in a session of its own."""
    going_on = scenario.command.startswith("run") and (folder / "out").exists()
    command = "resume out" if going_on else f"{scenario.command} -o out"
    ranks = [str(Path(sys.executable).with_name("mpiexec")), "-n", str(scenario.ranks)]
    program = [sys.executable, "-m", "fsi", *command.split()]
    with (folder / "said").open("ab") as said:
        return subprocess.Popen(
            ranks + program if scenario.ranks > 1 else program,
            cwd=folder,
            stdout=said,
            stderr=said,
            start_new_session=True,
            env=os.environ | {"PYTHONPATH": str(ROOT)},
        )


def finish(scenario: Scenario, folder: Path) -> float:
    """Go on to the end; seconds that it took. Raises RuntimeError: it fails."""
    began = time.monotonic()
    if start(scenario, folder).wait(timeout=1200) != 0:
        raise RuntimeError((folder / "said").read_text()[-1000:])
    return time.monotonic() - began


def kill(scenario: Scenario, folder: Path, after: float) -> bool:
    """Start, and kill everything after so many seconds; whether it still ran."""
    running = start(scenario, folder)
    try:
        running.wait(timeout=after)
    except subprocess.TimeoutExpired:
        os.killpg(running.pid, signal.SIGKILL)
        running.wait()
        _await_ranks(running.pid)
        return True
    return False


def _await_ranks(session: int) -> None:
    """Until the ranks are gone: launchers give them groups of their own, and they end with the launcher."""
    deadline = time.monotonic() + 20.0
    while time.monotonic() < deadline:
        pids = [int(path.name) for path in Path("/proc").iterdir() if path.name.isdigit()]
        mine = [pid for pid in pids if _session(pid) == session]
        if not mine:
            return
        for pid in mine:
            os.kill(pid, signal.SIGKILL)
        time.sleep(0.05)


def _session(pid: int) -> int | None:
    try:
        return os.getsid(pid)
    except OSError:
        return None


def left(folder: Path) -> dict[str, Any]:
    """What a command has left, without dates and CPU seconds."""
    files = {path.relative_to(folder).as_posix(): path for path in folder.rglob("*") if path.is_file()}
    return {
        name: _without_times(path)
        for name, path in files.items()
        if path.name != "provenance.json" and path.suffix != ".png"
    }


def _without_times(path: Path) -> Any:
    match path.suffix:
        case ".csv":
            with path.open(newline="") as file:
                table = list(csv.DictReader(file))
            return [
                {k: v for k, v in row.items() if not k.startswith("cpu_") and k != "seconds"} for row in table
            ]
        case ".json":
            return _plain(json.loads(path.read_text()))
        case ".npz":
            with np.load(path) as state:  # the length of steps.csv has those of its CPU seconds
                return {key: state[key].tobytes() for key in state if not key.endswith("/steps.csv")}
        case ".toml":
            return re.sub(r"(?m)^fitted = .*$", "", path.read_text())
        case _:
            return path.read_bytes()


def _plain(data: Any) -> Any:
    """Without the keys of times, at any depth."""
    match data:
        case dict():
            return {k: _plain(v) for k, v in data.items() if k not in ("seconds", "fitted")}
        case list():
            return [_plain(item) for item in data]
        case _:
            return data


def differences(one: Path, other: Path, scenario: Scenario) -> list[str]:
    """Names of the files that differ."""
    a, b = left(one), left(other)
    if scenario.ranks > 1:
        tables = ("steps.csv", "bodies.csv")
        return [name for name in tables if not _close(a[name], b[name])] + sorted(set(a) ^ set(b))
    return sorted(name for name in {**a, **b} if a.get(name) != b.get(name))


# What measures rounding is not repeatable on two ranks.
ROUNDING = {"power", "momentum", "angular_momentum", "balance", "net_flux", "residual", "F_x", "F_y", "T"}


def _close(one: list[dict[str, str]], other: list[dict[str, str]]) -> bool:
    if len(one) != len(other):
        return False
    pairs = [(a[k], b[k]) for a, b in zip(one, other, strict=True) for k in a if k not in {*ROUNDING, "body"}]
    x, y = np.array(pairs, dtype=float).T
    return bool(np.allclose(x, y, rtol=1e-9, atol=1e-9))


def main(
    count: Annotated[int, typer.Option(help="How many moments.")] = 100,
    seed: Annotated[int, typer.Option(help="Of the moments.")] = 0,
    only: Annotated[list[str] | None, typer.Option(help="Scenarios; all in turn if not given.")] = None,
) -> None:
    """Kill, go on, compare."""
    names, draw = only or [*SCENARIOS], random.Random(seed)
    kills, running, trials = (dict.fromkeys(names, 0) for _ in range(3))
    bad: list[str] = []
    with tempfile.TemporaryDirectory() as place:
        base, seconds = Path(place), {}
        for name in names:
            seconds[name] = finish(SCENARIOS[name], _new(base / name / "whole", SCENARIOS[name]))
        number = 0
        while sum(kills.values()) < count:
            name = names[number % len(names)]
            scenario, number = SCENARIOS[name], number + 1
            folder = _new(base / name / str(number), scenario)
            for _ in range(min(draw.randint(1, 3), count - sum(kills.values()))):
                kills[name] += 1
                running[name] += kill(scenario, folder, draw.uniform(0.2, 1.0) * seconds[name])
            trials[name] += 1
            try:
                finish(scenario, folder)
                differ = differences(base / name / "whole" / "out", folder / "out", scenario)
            except (RuntimeError, subprocess.TimeoutExpired) as error:
                differ = [str(error)]
            print(f"{name}, {number}, killed {kills[name]} times so far: {differ or 'equal'}", flush=True)
            if differ:
                bad.append(name)
    table = Table("what", "moments", "still running", "ends", "unequal")
    for name in names:
        table.add_row(name, *map(str, (kills[name], running[name], trials[name], bad.count(name))))
    Console().print(table)
    raise SystemExit(bool(bad))


def _new(folder: Path, scenario: Scenario) -> Path:
    folder.mkdir(parents=True)
    (folder / "case.toml").write_text(scenario.case)
    return folder


if __name__ == "__main__":
    typer.run(main)
