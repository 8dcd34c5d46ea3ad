"""A run as Python sees it: its case, tables as pandas frames, fields as pyvista grids.

    run = fsi.open_run("runs/settling_discs")
    run.steps, run.bodies                       # the tables; run.table(NAME) for NAME.csv
    for step, t in run.times.items():
        fluid = run.mesh(step)                  # curved cells with velocity, pressure, vorticity, strain_rate

A run that is still going on, or that was killed, can be opened too: it then ends at its last complete step.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from numbers import Real
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyvista as pv

from fsi.arrays import Array
from fsi.bodies.configuration import PLACES, Configuration
from fsi.case.case import Case
from fsi.case.load import load_case
from fsi.errors import InputError
from fsi.files import json_of
from fsi.gluey.system import room
from fsi.meshes.geometry.container import Container
from fsi.postprocess.run.grids import joined, read_grid
from fsi.postprocess.run.tables import read_table, rows_of
from fsi.run_folder.checkpoint import Checkpoint, read_checkpoint
from fsi.run_folder.kept import CASE, PROVENANCE, STATE, require_as_begun, require_commit_of
from fsi.run_folder.paraview import Entry, read_collection

_REMEDY = "give a run folder as `fsi run` has written it, or run the case again"
_POINT_DATA = {"fluid": ("velocity",), "surface": ("traction",)}  # known at nodes, by series


def open_run(path: Path | str) -> Run:
    """Open the folder of a run, without changing anything in it.

    Raises InputError: it is not a run folder.
    """
    path = Path(path)
    if not (path / CASE).is_file():
        raise InputError(f"run = {path}: there is no {CASE}; give the folder that `fsi run` has written")
    return Run(path)


@dataclass(frozen=True)
class Run:
    """An open run folder. What the tables and series held when they were first asked for is kept.

    Attributes:
        path: the folder.
    """

    path: Path

    def __repr__(self) -> str:
        """What it is and how far it has come, in one line; step 0 is its beginning."""
        steps = len(self._steps) - 1
        return f"<Run {self.case.name!r}: {self.case.model}, {steps} steps to t = {self.end:g}>"

    @cached_property
    def case(self) -> Case:
        """The case, with every default filled in. Raises InputError: it is not the one that was run."""
        case = load_case(self.path / CASE)
        require_as_begun(self.path)
        return case

    @property
    def viscous(self) -> bool:
        """Whether it is of a model with a viscous fluid."""
        return self.case.level.viscous

    @property
    def series(self) -> str:
        """What its pictures are made of: "fluid", "bodies" (and their contacts), or "profile"."""
        return self.case.level.series

    @property
    def drawn_by_tables(self) -> bool:
        """Whether it has bodies in a viscous fluid in the plane, which are drawn without any field files."""
        return self.viscous and self.case.geometry == "planar" and bool(self.case.bodies)

    @property
    def steps(self) -> pd.DataFrame:
        """steps.csv, a row for each step; a copy. Raises InputError, as does `bodies`."""
        return self._steps.copy()

    @property
    def bodies(self) -> pd.DataFrame:
        """bodies.csv, a row for each step and body; a copy."""
        return self._bodies.copy()

    def require_tables(self) -> None:
        """Raise InputError where someone has changed the tables; before the first step they may be empty."""
        if self._commit is not None:
            for name in ("steps", "bodies") if self.case.names else ("steps",):
                self.table(name)

    @cached_property
    def _steps(self) -> pd.DataFrame:
        return self.table("steps")

    @cached_property
    def _bodies(self) -> pd.DataFrame:
        return self.table("bodies")

    def table(self, name: str) -> pd.DataFrame:
        """The complete rows of the table `name`.csv. Raises InputError: none, or someone has changed them."""
        path, commit = self.path / f"{name}.csv", self._commit
        if name == "bodies" and not self.case.names:
            raise InputError(f"{self.path}: the run has no bodies, and so no {path.name}")
        there = {each.stem for each in self.path.glob("*.csv")}
        lost = path.name in (*(commit.lengths if commit else ()), "steps.csv", "bodies.csv")
        if there and name not in there and not lost:
            known = sorted(there if self.case.names else there - {"bodies"})
            raise InputError(f"table = {name}: the run has none of it; give {', '.join(known)}")
        if commit is None:
            if not path.exists():
                raise InputError(f"{path}: is not there yet; continue the run with `fsi resume`")
            return read_table(path, None)
        return read_table(path, commit.lengths.get(path.name), commit.state.t, commit.sums.get(path.name))

    def columns(self, name: str) -> dict[str, Array]:
        """The columns of numbers of `name`.csv, each of shape (rows,). Raises InputError."""
        frame = self.table(name).drop(columns="body", errors="ignore")
        return {str(column): frame[column].to_numpy(dtype=float) for column in frame}

    @property
    def times(self) -> pd.Series[float]:
        """Time of each step that has field files, by the number of the step; empty where there are none."""
        return self.times_of("fluid")

    def times_of(self, series: str) -> pd.Series[float]:
        """The same for another series, such as "surface"."""
        times = {entry.step: entry.t for entry in self._entries(series)}
        return pd.Series(times, name="t", dtype=float).rename_axis("step")

    def has(self, series: str) -> bool:
        """Whether it has written any files of that series."""
        return bool(self._entries(series))

    def mesh(self, step: int | None = None, series: str = "fluid") -> pv.UnstructuredGrid:
        """The fields of a step (default: the last that has any), all ranks' parts in one grid.

        The series "fluid" has curved cells whose nodes, and values there, are the finite element's own;
        "surface" has the curved edges of the bodies. A gluey run has the series "bodies" and "contacts", a
        macroscopic one "profile".

        Raises InputError: there are no fields of that step.
        """
        step = self.step(step, series)
        known = _POINT_DATA.get(series, ())
        if series == "fluid" and self.case.level.pressure:
            known = (*known, "pressure")
        return joined([read_grid(file, known) for file in self.files(step, series)])

    def files(self, step: int, series: str = "fluid") -> list[Path]:
        """The field files of a step, one of each rank."""
        return [self.path / entry.file for entry in self._entries(series) if entry.step == step]

    def step(self, step: int | None = None, series: str = "fluid") -> int:
        """That step, or the last one, if it has fields. Raises InputError."""
        written = self.times_of(series).index
        if written.empty:
            if self.series != "fluid" and series in ("fluid", "surface"):
                what = f'model = "{self.case.model}": the run in {self.path} has no flow field'
                raise InputError(f"{what}; use `fsi render`, `fsi plot` or `fsi report`")
            names = sorted(each.stem for each in self.path.glob("*.pvd"))
            if names and series not in ("fluid", "surface"):
                raise InputError(f"series = {series}: the run has none of it; give {', '.join(names)}")
            if self.case.output.fields:
                self.table("steps")  # without a step yet there are no fields either
            what = f"{self.path / series}.pvd: the run has written no fields"
            remedy = "set output.fields = true and run it again"
            if self.drawn_by_tables:
                remedy += ", or see `fsi render --field motion`, which needs none"
            raise InputError(f"{what}; {remedy}")
        if step is None:
            return int(written[-1])
        if step not in written:
            some = written if len(written) < 5 else [written[0], written[1], "...", written[-1]]
            raise InputError(f"step = {step}: has no fields; give one of {', '.join(map(str, some))}")
        return step

    def nearest(self, time: float, series: str = "fluid") -> int:
        """The step with fields nearest to a time. Raises InputError."""
        if not (isinstance(time, Real) and np.isfinite(time)):
            raise InputError(f"time = {time}: give a finite number")
        self.step(None, series)
        return int((self.times_of(series) - time).abs().idxmin())

    def time(self, step: int) -> float:
        """Of a step, with fields or without. Raises InputError, as all that ask for a step: there is none."""
        return float(self.times[step]) if step in self.times.index else self._of_step(step, "t")

    def container(self, step: int) -> Container:
        """What encloses the fluid at a step; the lattice of a sheared cell moves, as its stress drives it."""
        now = self.case.container().at(self.time(step), self.strain(step))
        return now.sheared(self._of_step(step, "shear_rate")) if self._stressed else now

    def strain(self, step: int) -> float:
        """By which a stress has sheared the lattice at a step; zero where none does."""
        return self._of_step(step, "strain") if self._stressed else 0.0

    @property
    def _stressed(self) -> bool:
        """Whether a stress shears a cell."""
        return self.case.domain.mean_drive().mean_stress is not None

    def _of_step(self, step: int, column: str) -> float:
        return float(rows_of(self._steps, step)[column].iloc[0])

    def configuration(self, step: int) -> Configuration:
        """Where the bodies were at a step. Raises InputError: bodies.csv has none of it."""
        start, d = self.case.configuration(), self.case.dimension
        if not len(start):
            return start
        x, angles = np.hsplit(rows_of(self._bodies, step)[list(PLACES[d])].to_numpy(), [d])
        return replace(start, centres=x, angles=angles.reshape(start.angles.shape), strain=self.strain(step))

    def meshed(self, step: int) -> Configuration:
        """Where the fields of a step have the bodies: apart where laws stand for narrow gaps."""
        return self.case.meshed_at(self.configuration(step), self.time(step))

    def wall_distances(self, x: Array) -> Array:
        """Distance of points (n, d) to each wall, (n, walls); in gluey runs not to those far away."""
        if self.viscous:
            return self.case.container().distances(x)
        walls = room(self.case)
        return np.asarray(np.sum((x[:, None] - walls.points) * walls.normals, axis=2))

    @property
    def end(self) -> float:
        """Time of the last complete step. Raises InputError where there is none."""
        return float(self._steps["t"].iloc[-1])

    @property
    def asked(self) -> float | None:
        """The time until which the case asks it to run; None where it has no [time]."""
        return None if self.case.time is None else self.case.time.end

    @property
    def finished(self) -> bool:
        """Whether the run has reached that end."""
        least = None if self.case.time is None else self.case.time.contact_gap
        if least is not None and float(self._steps["smallest_gap"].iloc[-1]) <= least:
            return True  # in contact
        return self.asked is not None and self.end >= self.asked

    @cached_property
    def launches(self) -> list[dict[str, Any]]:
        """What provenance.json says of each launch. Raises InputError."""
        data = json_of(self.path / PROVENANCE, _REMEDY)
        launches = data.get("launches") if isinstance(data, dict) else None
        if not (isinstance(launches, list) and all(isinstance(launch, dict) for launch in launches)):
            raise InputError(f"{self.path / PROVENANCE}: has no list of launches; {_REMEDY}")
        return launches

    @cached_property
    def _commit(self) -> Checkpoint | None:
        """How far the files are complete; None where nothing tells. Raises InputError: of another run."""
        path = self.path / STATE
        if not path.exists():
            return None
        commit = _sound(read_checkpoint, path)
        require_commit_of(self.path, commit)
        return commit

    def _entries(self, series: str) -> list[Entry]:
        path = self.path / f"{series}.pvd"
        count = self._commit.entries.get(series) if self._commit else None
        if path.exists():
            return _sound(read_collection, path)[:count]
        if count:
            raise InputError(f"{path}: is not there, though the run has written it; {_REMEDY}")
        return []


def _sound[T](read: Callable[[Path], T], path: Path) -> T:
    """What a file of the run says. Raises InputError where it is damaged."""
    try:
        return read(path)
    except ValueError as error:
        raise InputError(f"{path}: is damaged ({error}); {_REMEDY}") from None
