"""The run folder: what a run leaves on disk, and how it survives being killed at any moment.

    case.toml         the resolved case, every default filled in
    provenance.json   the case that it is, digests of the files that this names, and one entry for each
                      launch: versions, commit, ranks, command, what it changed of the case
    steps.csv         one row a step; the columns cpu_*, the last ones, are CPU seconds
    bodies.csv        one row for each step (gluey: each output) and body; F and T are external, int sigma n
    contacts.csv, profiles.csv    what the gluey and the macroscopic model add at the times of output
    fields/*.vtu      what the model writes, listed in time by fluid.pvd and surface.pvd
    state.npz         what the next step depends on

Rows are appended and files added first; state.npz, replaced in one go, is the commit: it knows of which case
it is, how long the tables and series were, and checksums of the tables. Resuming reads these, but no field
files, and changes nothing unless all are sound; then it cuts off whatever came after the commit and repeats
those steps. So a run that was killed and resumed ends, in serial, with the same files bit by bit as an
unbroken one, but for provenance.json, the columns cpu_*, and, in state.npz, length and checksum of steps.csv,
which has these. One process runs a folder at a time, see `fsi.run_folder.alone`.

To have all on the disk takes milliseconds, more than many a step. So steps are committed together where they
follow each other so fast, SELDOM times as long after a commit as it took: a kill loses no more than that,
besides the step that is under way.
"""

import csv
import os
import shlex
import shutil
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from fsi.case.case import Case
from fsi.errors import InputError, SolveError
from fsi.files import TEMPORARY, csv_text, replace, require_new
from fsi.integration.state import State, StepRecord
from fsi.parallel import is_root, on_root
from fsi.run_folder.alone import locked
from fsi.run_folder.checkpoint import Checkpoint, write_checkpoint
from fsi.run_folder.kept import (
    BODIES,
    CASE,
    FIELDS,
    REMEDY,
    STATE,
    STEPS,
    Kept,
    disk,
    refused,
    sound,
    write_provenance,
)
from fsi.run_folder.one_case import identity
from fsi.run_folder.paraview import Collection, Entry
from fsi.run_folder.tables import body_table, step_table

SELDOM = 10.0  # so that commits take a tenth of a run at most


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
    """A run folder open for writing, with what it has. All ranks call every method; root alone writes."""

    def __init__(self, path: Path, kept: Kept, *, given: bool = False) -> None:
        self.path = path
        self.kept = kept
        self._given = given  # an empty folder of the user's, which stays
        self.checkpoint = kept.checkpoint
        self._lengths = dict(kept.checkpoint.lengths) if kept.checkpoint else {STEPS: 0, BODIES: 0}
        self._sums = dict(kept.sums)
        self._case = identity(kept.provenance)
        self._rows: dict[str, bytes] = {}  # of each table those that are not on the disk yet
        self._headers: dict[str, list[str]] = {}
        self._series = {series: Collection(entries) for series, entries in kept.series.items()}
        self._grown: set[str] = set()  # the series that have entries that are not on the disk yet
        self._next: tuple[State, Mapping[str, NDArray[Any]]] | None = None  # what is to be committed
        self._due = 0.0  # when

    @classmethod
    def create(cls, path: Path, case: Case, launch: Mapping[str, Any]) -> Self:
        """Make a folder, complete or not at all. Raises InputError: it exists, or cannot be written."""
        path = _resolved(path)
        given = path.is_dir()
        return cls(path, on_root(lambda: _create(path, case, launch)), given=given)

    @classmethod
    def reopen(cls, path: Path) -> Self:
        """Open a folder, changing nothing in it. Raises InputError: no run folder, or a file is not sound."""
        path = _resolved(path)
        return cls(path, on_root(lambda: sound(path)))

    def discard_if_unused(self) -> None:
        """Remove what this rank wrote of a run without a commit; not collective: others may have failed."""
        if is_root() and not (self.path / STATE).exists():
            _discard(self.path, given=self._given)

    @property
    def case(self) -> Path:
        """The resolved case."""
        return self.path / CASE

    @property
    def fields(self) -> Path:
        """Where the model writes its files."""
        return self.path / FIELDS

    def rewind(self, case: Case, launch: Mapping[str, Any]) -> None:
        """Cut off what came after the last commit; add a launch, of the case as it is now.

        Raises InputError: the folder cannot be written.
        """
        on_root(lambda: self._rewind(case, launch))

    def keep(self, commit: Commit) -> None:
        """Add a step, and commit unless that was just done. Raises as `commit`; InputError: other columns."""
        on_root(lambda: self._keep(commit))

    def commit(self) -> None:
        """Have all on the disk that was kept. Raises SolveError: not writable (disk full)."""
        on_root(self._commit)

    def rescue(self) -> None:
        """The same when a run breaks off, as far as it goes; not collective: others may have failed."""
        if is_root():
            with suppress(SolveError):
                self._commit()

    @contextmanager
    def writing(self) -> Iterator[None]:
        """Raise a SolveError where the disk does not take the fields of a step; the last commit stays."""
        without = shlex.join(["fsi", "resume", str(self.path), "--set", "output.fields=false"])
        with refused(self.path, SolveError, f"{self._goes_on}; or `{without}`"):
            yield

    @property
    def _goes_on(self) -> str:
        """What to do about a disk that takes no more."""
        return f"make room, or make it writable, and `{shlex.join(['fsi', 'resume', str(self.path)])}`"

    def _keep(self, commit: Commit) -> None:
        record = commit.record
        tables = {STEPS: step_table(record), BODIES: body_table(record, commit.names), **commit.tables}
        with disk(self.path, InputError, REMEDY):
            rows = {table: self._text(table, *rows) for table, rows in tables.items()}
        self._next = None  # broken off between here and the end, nothing is committed
        for table, text in rows.items():
            self._rows[table] = self._rows.get(table, b"") + text
        for series, added in commit.files.items():
            files = self._series.setdefault(series, Collection())
            files.add(Entry(record.t, part, f"{FIELDS}/{name}") for part, name in enumerate(added))
            self._grown.add(series)
        self._next = commit.state, {key: np.array(value) for key, value in commit.memory.items()}
        if time.perf_counter() >= self._due:
            self._commit()

    def _text(self, table: str, header: Sequence[str], rows: Iterable[Sequence[object]]) -> bytes:
        """Rows of a table, with its header if they are the first. Raises ValueError: it has another one."""
        if self._lengths.get(table, 0) == 0 and table not in self._rows:
            self._headers[table] = list(header)
            rows = [header, *rows]
        elif list(header) != self._header(table):
            raise ValueError(f"the new rows of {table} have other columns than it has")
        return csv_text(rows).encode()

    def _commit(self) -> None:
        """What has been kept since the last time; again from there where the disk took a part of it."""
        if self._next is None:
            return
        began = time.perf_counter()
        with disk(self.path, SolveError, self._goes_on):
            lengths = self._lengths | {table: self._append(table, rows) for table, rows in self._rows.items()}
            for series in self._grown:
                replace(self._collection(series), self._series[series].xml())
            counts = {series: len(files.entries) for series, files in self._series.items()}
            sums = {table: crc32(rows, self._sums.get(table, 0)) for table, rows in self._rows.items()}
            sums = self._sums | sums
            write_checkpoint(self.path / STATE, Checkpoint(*self._next, lengths, counts, sums, self._case))
        self._next = None  # first: broken off after this, nothing is committed twice
        self._lengths, self._sums = lengths, sums
        self._rows, self._grown = {}, set()
        ended = time.perf_counter()
        self._due = ended + SELDOM * (ended - began)

    def _append(self, table: str, rows: bytes) -> int:
        """Write rows behind those that are committed; the length of the table then."""
        length = self._lengths.get(table, 0)
        with (self.path / table).open("r+b" if length else "wb") as file:
            file.seek(length)
            file.write(rows)
            file.truncate()
            file.flush()
            os.fsync(file.fileno())
            return file.tell()

    def _header(self, table: str) -> list[str]:
        """The columns that a table has, also where an earlier launch began it."""
        if table not in self._headers:
            with (self.path / table).open(encoding="utf-8", newline="") as file:
                self._headers[table] = next(csv.reader(file))
        return self._headers[table]

    def _rewind(self, case: Case, launch: Mapping[str, Any]) -> None:
        with disk(self.path, InputError, REMEDY):
            self.fields.mkdir(exist_ok=True)  # or the first step that writes there fails
            # The case first: killed after it, the next launch finds the same changes.
            if "changed" in launch:
                replace(self.case, case.as_toml().encode())
            write_provenance(self.path, case, [*self.kept.provenance["launches"], launch])
            for table, length in self._lengths.items():
                (self.path / table).touch()
                os.truncate(self.path / table, length)
            for series, files in self._series.items():
                replace(self._collection(series), files.xml())
            kept = {self.path / entry.file for files in self._series.values() for entry in files.entries}
            kept |= {self._collection(series) for series in self._series}
            for pattern in ("*.pvd", f"*{TEMPORARY}", f"{FIELDS}/*.vtu", f"{FIELDS}/.*"):
                for file in set(self.path.glob(pattern)) - kept:
                    file.unlink()

    def _collection(self, series: str) -> Path:
        return self.path / f"{series}.pvd"


def _resolved(path: Path) -> Path:
    """The path without links in it. Raises InputError: they lead in a circle."""
    try:
        return path.resolve()
    except (OSError, RuntimeError):  # as Python's version has it
        raise InputError(f"output = {path}: its links lead in a circle; give another folder") from None


def _create(path: Path, case: Case, launch: Mapping[str, Any]) -> Kept:
    with disk(path, InputError, "give a folder that can be written, or make room"):
        _require_new(path)
        if path.is_dir():
            return _fill(path, path, case, launch)
        partial = path.with_name(f".{path.name}{TEMPORARY}")
        partial.mkdir(parents=True, exist_ok=True)  # what was killed left is written over
        return _fill(partial, path, case, launch)


def _fill(partial: Path, path: Path, case: Case, launch: Mapping[str, Any]) -> Kept:
    """Write what a run begins with into a folder, which takes the path then; it may have it already.

    The case comes last, which makes it the folder of a run. A folder that was there stays, with its owner and
    mode: it may be the one that a shell is in.
    """
    with locked(partial, refused=path):
        _require_new(path)  # another process may have made it since
        try:
            (partial / FIELDS).mkdir(exist_ok=True)
            provenance = write_provenance(partial, case, [launch])
            replace(partial / CASE, case.as_toml().encode())
        except BaseException:
            _discard(partial, given=partial == path)
            raise
        if partial != path:
            partial.rename(path)
        return Kept(provenance)


def _discard(folder: Path, *, given: bool) -> None:
    """Remove what is in a folder, and the folder, unless the user has given it."""
    for path in folder.iterdir():
        if path.is_dir():
            shutil.rmtree(path)
        else:
            path.unlink()
    if not given:
        folder.rmdir()


def _require_new(path: Path) -> None:
    resume = f", or `{shlex.join(['fsi', 'resume', str(path)])}` to continue that run"
    require_new(path, "give another folder" + (resume if (path / CASE).is_file() else ""))
