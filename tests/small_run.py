"""A small run with everything in it: several outputs, a kink, rejected tries; and what it leaves on disk."""

from __future__ import annotations

import csv
import json
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fsi.case.case import Case
from fsi.case.load import parse_case
from fsi.integration.state import StepRecord
from fsi.runs import MakeEvolution, Outcome, run
from tests.exact_model import DiscsBesidePlane, by

BODIES = [
    {"name": "left", "radius": 1.0, "position": [-3.0, 2.0], "force": [1.0, -20.0]},
    {
        "name": "right",
        "radius": 1.0,
        "position": [3.0, 1.5],
        "velocity": [{"times": [0.0, 0.35, 2.0], "values": [-1.0, 0.0, 1.0]}, 0.0],
        "torque": 1.0,
    },
]
make_model = partial(DiscsBesidePlane, noise=1e-4)
EXACT = by(make_model)


def small_case(**sections: Any) -> Case:
    """Two discs, some twenty steps, fields at a few of them."""
    data = {
        "name": "two discs",
        "fluid": {"viscosity": 1.0},
        "domain": {"shape": "half-plane", "radius": 100.0},
        "bodies": BODIES,
        "time": {"end": 1.0, "tolerance": 1e-6, "first_step": 0.5},
        "output": {"interval": 0.25},
    }
    return parse_case(data | sections)


def start(case: Case, folder: Path) -> Outcome:
    return run(case, folder, make=EXACT)


def contents(folder: Path) -> dict[str, Any]:
    """Every file of a run but its provenance; steps.csv without CPU seconds, nor what counts these."""
    files = {path.relative_to(folder).as_posix(): path for path in folder.rglob("*") if path.is_file()}
    del files["provenance.json"]
    found: dict[str, Any] = {name: path.read_bytes() for name, path in files.items()}
    found["steps.csv"] = [
        {key: value for key, value in row.items() if not key.startswith("cpu_")}
        for row in rows(folder / "steps.csv")
    ]
    with np.load(folder / "state.npz") as state:
        found["state.npz"] = {key: state[key].tobytes() for key in state if not key.endswith("/steps.csv")}
    return found


def rows(table: Path) -> list[dict[str, str]]:
    with table.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def made_older(folder: Path) -> None:
    """Take from a state what older runs did not keep: the strain, checksums, and of which case it is."""
    with np.load(folder / "state.npz") as state:
        arrays = {name: state[name] for name in state.files}
    older = {name: array for name, array in arrays.items() if name not in ("strain", "case")}
    named: dict[str, Any] = {name: array for name, array in older.items() if not name.startswith("sums/")}
    assert len(named) < len(older) < len(arrays) - 1
    np.savez(folder / "state.npz", **named)


def launches(folder: Path) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = json.loads((folder / "provenance.json").read_text())["launches"]
    return found


class KilledError(Exception):
    """Instead of a signal, where the place to break off is a step."""


def break_off(folder: Path, case: Case, step: int, make: MakeEvolution = EXACT) -> None:
    """Begin a run, and end it after that step."""

    def progress(record: StepRecord) -> None:
        if record.step == step:
            raise KilledError

    with pytest.raises(KilledError):
        run(case, folder, progress, make=make)
