"""What a run folder has of its run, under which names, read before anything in it is changed.

`sound` reads every file that a run needs to go on; `fsi.run_folder.folder` writes them, provenance.json by
what stands here beside what reads it. What the disk refuses, or has damaged, is said alike by both.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from zlib import crc32

from fsi.case.case import Case
from fsi.errors import FsiError, InputError
from fsi.files import content, json_of, replace
from fsi.run_folder.checkpoint import Checkpoint, read_checkpoint
from fsi.run_folder.one_case import case_record, require_as_written, require_of_one_run
from fsi.run_folder.paraview import Entry, read_collection
from fsi.run_folder.rows import read_rows

CASE, PROVENANCE, STATE, FIELDS = "case.toml", "provenance.json", "state.npz", "fields"
STEPS, BODIES = "steps.csv", "bodies.csv"
REMEDY = "put that right or run the case again"
# Of the folder: what its files mean. Before the number case files had other keys; before 3 nothing told
# whether the case has been changed since.
FORMAT = 3


@dataclass(frozen=True, slots=True)
class Kept:
    """What a folder has of its run.

    Attributes:
        provenance: the content of provenance.json.
        checkpoint: the last commit; None before the first.
        series: the entries of each series that belong to it.
        sums: the CRC-32 of what belongs to it of each table, of older runs too, which keep none.
    """

    provenance: Mapping[str, Any]
    checkpoint: Checkpoint | None = None
    series: Mapping[str, list[Entry]] = field(default_factory=dict)
    sums: Mapping[str, int] = field(default_factory=dict)


def require_run(path: Path) -> None:
    """Raise InputError if a folder is not that of a run."""
    if not (path / CASE).is_file():
        raise InputError(f"run = {path}: not a run folder (it has no {CASE}); give one made by `fsi run`")


def require_as_begun(path: Path) -> None:
    """Raise InputError where someone has changed the case since the run began; older runs cannot tell."""
    if (record := _record(path)) is not None:
        require_as_written(path, record, path / CASE)


def require_commit_of(path: Path, checkpoint: Checkpoint) -> None:
    """Raise InputError where a commit is not that of the run in a folder; older runs cannot tell."""
    if (record := _record(path)) is not None:
        require_of_one_run(path, record, checkpoint.case)


def _record(path: Path) -> dict[str, Any] | None:
    """What provenance.json keeps of the case; None where it keeps nothing.

    Raises InputError: no JSON, or it is lost; before the first commit nothing can be told by it.
    """
    there = (path / PROVENANCE).exists() or (path / STATE).exists()
    kept = json_of(path / PROVENANCE, REMEDY) if there else None
    whole = isinstance(kept, dict) and all(isinstance(kept.get(key), dict) for key in ("case", "files"))
    return kept if whole else None


def sound(path: Path) -> Kept:
    """What is in a folder; every file that a run needs to go on is read, no field files.

    Raises InputError: no run folder, of another version, a file is not sound or of another run, or state.npz
    is lost.
    """
    require_run(path)
    with disk(path, InputError, REMEDY):
        provenance = _provenance(path)
        if not (path / STATE).exists():
            _require_beginning(path)
            return Kept(provenance)
        checkpoint = read_checkpoint(path / STATE)
        require_of_one_run(path, provenance, checkpoint.case)
        sums = {table: _sum_of_rows(path / table, checkpoint) for table in checkpoint.lengths}
        series = {name: _entries(path, name, count) for name, count in checkpoint.entries.items()}
        return Kept(provenance, checkpoint, series, sums)


def _require_beginning(path: Path) -> None:
    """Raise InputError where a run without state.npz has got beyond step 0, with which that file comes."""
    tables = [path / table for table in (STEPS, BODIES) if (path / table).exists()]
    lines = [line for table in tables for line in content(table, REMEDY).splitlines()[1:]]
    steps = [line.partition(b",")[0].decode(errors="replace") for line in lines]
    steps += [file.stem.split("_")[1] for file in (path / FIELDS).glob("[!.]*_*.vtu")]
    if any(step.strip("0") for step in steps):
        raise InputError(
            f"output = {path}: {STATE} is missing, without which no run goes on; put it back, or run the "
            "case again into another folder"
        )


def _sum_of_rows(table: Path, checkpoint: Checkpoint) -> int:
    """The CRC-32 of what is committed of a table. Raises InputError, ValueError: that is not there."""
    length = checkpoint.lengths[table.name]
    text = content(table, REMEDY)[:length] if length else b""
    if len(text) < length:
        raise InputError(f"output = {table.parent}: {table.name} has lost rows; put them back or run again")
    if length:
        try:
            read_rows(table.stem, text, checkpoint.state.t, checkpoint.sums.get(table.name))
        except ValueError as error:
            raise ValueError(f"{table.name}: {error}") from None
    return crc32(text)


def _entries(path: Path, series: str, count: int) -> list[Entry]:
    entries = read_collection(path / f"{series}.pvd")
    if len(entries) < count:
        raise ValueError(f"{series}.pvd: {len(entries)} entries where there were {count}")
    return entries[:count]


def _provenance(path: Path) -> dict[str, Any]:
    """The content of provenance.json. Raises InputError, ValueError: of another version, damaged."""
    data = json_of(path / PROVENANCE, REMEDY)
    if not isinstance(data, dict):
        raise ValueError(f"{PROVENANCE}: is no object")
    written = data.get("format", 1)
    if written != FORMAT:
        raise InputError(
            f"output = {path}: a run of another version of this program (format {written}, this one "
            f"writes {FORMAT}); run the case again, or resume with that version"
        )
    kinds = {"case": dict, "files": dict, "launches": list}
    for key, kind in kinds.items():
        if not isinstance(data.get(key), kind):
            raise ValueError(f"{PROVENANCE}: its {key} is missing")
    return data


def write_provenance(path: Path, case: Case, launches: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Write provenance.json of a case with all its launches; what it has. Raises OSError."""
    data = {"format": FORMAT, "launches": launches, **case_record(case)}
    replace(path / PROVENANCE, (json.dumps(data, indent=2) + "\n").encode())
    return data


@contextmanager
def refused(path: Path, kind: type[FsiError], remedy: str) -> Iterator[None]:
    """Turn what the operating system refuses into an error that names the folder."""
    try:
        yield
    except OSError as error:
        raise kind(f"output = {path}: {error.strerror} ({error.filename or path}); {remedy}") from error


@contextmanager
def disk(path: Path, kind: type[FsiError], remedy: str) -> Iterator[None]:
    """Turn what the operating system refuses, or a damaged file, into an error that names the folder."""
    try:
        with refused(path, kind, remedy):
            yield
    except ValueError as error:
        raise kind(f"output = {path}: a file is damaged ({error}); {remedy}") from error
