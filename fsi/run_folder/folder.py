"""The run folder: what a run leaves on disk, and how it survives being killed at any moment.

    case.toml         the resolved case, every default filled in
    provenance.json   one entry for each launch: versions, commit, ranks, command
    steps.csv         one row a step; the columns cpu_*, the last ones, are CPU seconds
    bodies.csv        one row for each step and body; F and T are external loads (int sigma n)
    contacts.csv, profiles.csv    what the gluey and the macroscopic model add at the times of output
    fields/*.vtu      what the model writes, listed in time by fluid.pvd and surface.pvd
    state.npz         what the next step depends on

Rows are appended and files added first; state.npz, replaced in one go, is the commit: it knows how
long the tables and series were. Resuming cuts off whatever came after it and repeats that step. So
a run that was killed and resumed ends, in serial, with the same files bit by bit as an unbroken one,
but for the columns cpu_* and provenance.json.
"""

import csv
import io
import json
import os
import shutil
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self
from xml.etree.ElementTree import ParseError
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from fsi.bodies.configuration import LOADS, MODES, PLACES
from fsi.errors import FsiError, InputError, SolveError
from fsi.files import TEMPORARY, json_of, replace
from fsi.integration.state import State, StepRecord
from fsi.parallel import is_root, on_root
from fsi.run_folder.checkpoint import Checkpoint, read_checkpoint, write_checkpoint
from fsi.run_folder.paraview import Entry, collection, read_collection

CASE, PROVENANCE, STATE, FIELDS = "case.toml", "provenance.json", "state.npz", "fields"
STEPS, BODIES = "steps.csv", "bodies.csv"
STEP_COLUMNS = ("step", "t", "h", "smallest_gap", "rejected")
# Of the folder: what its files mean. Those of before the number have case files with other keys.
FORMAT = 2


@dataclass(frozen=True, slots=True)
class Commit:
    """A step as the folder keeps it.

    Attributes:
        record: its row of steps.csv, and the bodies.
        names: of the bodies that bodies.csv shall have of this step; empty for none.
        files: the field files that it has written, by series.
        tables: further tables, header and rows.
        state, memory: all that the next step depends on.
    """

    record: StepRecord
    names: Sequence[str]
    files: Mapping[str, Sequence[str]]
    tables: Mapping[str, tuple[Sequence[str], Iterable[Sequence[object]]]]
    state: State
    memory: Mapping[str, NDArray[Any]]


class RunFolder:
    """A run folder open for writing, with its last commit. All ranks call every method; root alone writes."""

    def __init__(self, path: Path, checkpoint: Checkpoint | None = None) -> None:
        self.path = path
        self.checkpoint = checkpoint
        self._lengths = dict(checkpoint.lengths) if checkpoint else {STEPS: 0, BODIES: 0}
        self._headers: dict[str, list[str]] = {}
        self._series: dict[str, list[Entry]] = {}

    @classmethod
    def create(cls, path: Path, case_toml: str, launch: Mapping[str, Any]) -> Self:
        """Make a folder, complete or not at all. Raises InputError: it exists, or cannot be written."""
        path = path.resolve()
        on_root(lambda: _create(path, case_toml, launch))
        return cls(path)

    @classmethod
    def reopen(cls, path: Path) -> Self:
        """Open a folder, changing nothing in it. Raises InputError: no run folder, or not readable."""
        path = path.resolve()
        return cls(path, on_root(lambda: _last_commit(path)))

    def discard_if_unused(self) -> None:
        """Remove a folder without a commit, if this rank wrote it; not collective: others may have failed."""
        if is_root() and not (self.path / STATE).exists():
            shutil.rmtree(self.path)

    @property
    def case(self) -> Path:
        """The resolved case."""
        return self.path / CASE

    @property
    def fields(self) -> Path:
        """Where the model writes its files."""
        return self.path / FIELDS

    def rewind(self, launch: Mapping[str, Any]) -> None:
        """Cut off what came after the last commit, and add a launch. Raises InputError: parts are missing."""
        on_root(lambda: self._rewind(launch))

    def keep(self, commit: Commit) -> None:
        """Append a step to tables and series; then commit. Raises SolveError: not writable (disk full)."""
        on_root(lambda: self._keep(commit))

    def _keep(self, commit: Commit) -> None:
        record = commit.record
        with _disk(self.path, SolveError, f"make it writable and `fsi resume {self.path}`"):
            self._append(STEPS, *_step_table(record))
            self._append(BODIES, *_body_table(record, commit.names))
            for table, (header, rows) in commit.tables.items():
                self._append(table, header, rows)
            for series, added in commit.files.items():
                entries = self._series.setdefault(series, [])
                entries += [Entry(record.t, part, f"{FIELDS}/{name}") for part, name in enumerate(added)]
                replace(self._collection(series), collection(entries))
            counts = {series: len(entries) for series, entries in self._series.items()}
            checkpoint = Checkpoint(commit.state, commit.memory, self._lengths, counts)
            write_checkpoint(self.path / STATE, checkpoint)

    def _append(self, table: str, header: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")  # gives floats all their digits
        begins = self._lengths.get(table, 0) == 0
        if begins:
            self._headers[table] = list(header)
            writer.writerow(header)
        elif list(header) != self._header(table):
            raise ValueError(f"the new rows of {table} have other columns than it has")
        writer.writerows(rows)
        with (self.path / table).open("wb" if begins else "ab") as file:
            file.write(text.getvalue().encode())
            file.flush()
            os.fsync(file.fileno())
            self._lengths[table] = file.tell()

    def _header(self, table: str) -> list[str]:
        """The columns that a table has, also where an earlier launch began it."""
        if table not in self._headers:
            with (self.path / table).open(encoding="utf-8", newline="") as file:
                self._headers[table] = next(csv.reader(file))
        return self._headers[table]

    def _rewind(self, launch: Mapping[str, Any]) -> None:
        counts = self.checkpoint.entries if self.checkpoint else {}
        with _disk(self.path, InputError, "put that right or run the case again"):
            for table, length in self._lengths.items():
                _cut(self.path / table, length)
            for series, count in counts.items():
                self._series[series] = read_collection(self._collection(series))[:count]
                replace(self._collection(series), collection(self._series[series]))
            kept = {self.path / entry.file for entries in self._series.values() for entry in entries}
            kept |= {self._collection(series) for series in counts}
            for pattern in ("*.pvd", f"*{TEMPORARY}", f"{FIELDS}/*.vtu", f"{FIELDS}/.*"):
                for file in set(self.path.glob(pattern)) - kept:
                    file.unlink()
            _write_launches(self.path, [*_provenance(self.path)["launches"], launch])

    def _collection(self, series: str) -> Path:
        return self.path / f"{series}.pvd"


def _create(path: Path, case_toml: str, launch: Mapping[str, Any]) -> None:
    with _disk(path, InputError, "give a folder that can be written"):
        if path.exists() and not (path.is_dir() and not any(path.iterdir())):
            resume = f", or `fsi resume {path}` to continue that run" if (path / CASE).is_file() else ""
            raise InputError(f"output = {path}: exists and is not empty; give another folder{resume}")
        partial = path.with_name(f".{path.name}{TEMPORARY}")
        if partial.exists():
            shutil.rmtree(partial)
        (partial / FIELDS).mkdir(parents=True)
        replace(partial / CASE, case_toml.encode())
        _write_launches(partial, [launch])
        partial.rename(path)


def _last_commit(path: Path) -> Checkpoint | None:
    if not (path / CASE).is_file():
        raise InputError(f"output = {path}: not a run folder (it has no {CASE}); give one made by `fsi run`")
    with _disk(path, InputError, "put that right or run the case again"):
        written = _provenance(path).get("format", 1)
        if written != FORMAT:
            raise InputError(
                f"output = {path}: a run of another version of this program (format {written}, this one "
                f"writes {FORMAT}); run the case again, or resume with that version"
            )
        return read_checkpoint(path / STATE) if (path / STATE).exists() else None


def _cut(table: Path, length: int) -> None:
    table.touch()
    if table.stat().st_size < length:
        raise InputError(f"output = {table.parent}: {table.name} has lost rows; put them back or run again")
    os.truncate(table, length)


def _provenance(path: Path) -> dict[str, Any]:
    data = json_of(path / PROVENANCE, "put it back or run the case again")
    launches = data.get("launches") if isinstance(data, dict) else None
    if not (isinstance(launches, list) and all(isinstance(launch, dict) for launch in launches)):
        raise ValueError(f"{PROVENANCE} has no list of launches")
    return dict(data)


def _write_launches(path: Path, launches: Sequence[Mapping[str, Any]]) -> None:
    data = {"format": FORMAT, "launches": launches}
    replace(path / PROVENANCE, (json.dumps(data, indent=2) + "\n").encode())


def _step_table(record: StepRecord) -> tuple[list[str], list[list[object]]]:
    """Header and the row of steps.csv, CPU seconds last."""
    columns = dict(sorted(record.columns.items(), key=lambda column: column[0].startswith("cpu_")))
    own: list[object] = [record.step, record.t, record.h, record.smallest_gap, record.rejected]
    return [*STEP_COLUMNS, *columns], [own + [_plain(value) for value in columns.values()]]


def _body_table(record: StepRecord, names: Sequence[str]) -> tuple[list[str], list[list[object]]]:
    """Header and rows of bodies.csv."""
    d = record.q.dimension
    more = record.body_columns
    numbers = np.column_stack([record.q.centres, record.q.angles, record.U, record.F, *more.values()])
    listed = numbers.tolist() if names else []  # without names the bodies of this step are not wanted
    rows = [[record.step, record.t, name, *row] for name, row in zip(names, listed, strict=True)]
    return ["step", "t", "body", *PLACES[d], *MODES[d], *LOADS[d], *more], rows


def _plain(value: float) -> float:
    """A NumPy scalar as Python's int or float."""
    return value.item() if isinstance(value, np.generic) else value


@contextmanager
def _disk(path: Path, kind: type[FsiError], remedy: str) -> Iterator[None]:
    """Turn what the operating system refuses, or a damaged file, into an error that names the folder."""
    try:
        yield
    except OSError as error:
        raise kind(f"output = {path}: {error.strerror} ({error.filename or path}); {remedy}") from error
    except (ValueError, KeyError, BadZipFile, ParseError) as error:
        raise kind(f"output = {path}: a file is damaged ({error}); {remedy}") from error
