"""One run of a sweep in its folder: its case and what is wanted of it, then its result."""

import json
import os
import platform
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import fsi.parallel as parallel
from fsi.case.checks.work import check_work
from fsi.case.load import case_text, load_case, named_files
from fsi.errors import InputError, SolveError
from fsi.files import content, json_of, replace
from fsi.run_folder.alone import alone
from fsi.run_folder.kept import CASE
from fsi.run_folder.one_case import digest
from fsi.run_folder.provenance import launch
from fsi.studies.evaluate import Evaluation, FoundValue, at_instant, of_motion

REQUEST, RESULT, LAUNCHES, MOTION = "request.json", "result.json", "launches.txt", "motion"
_REMEDY = "remove its folder, and it is run again"


@dataclass(frozen=True, slots=True)
class Request:
    """A run of a sweep as it is asked for.

    Attributes:
        folder: its own, absolute.
        values: of the keys that vary, with the seed.
        case: the data of its case.
        quantities: what is wanted of it.
        motion: whether the case is run to its end, or solved at time 0.
    """

    folder: Path
    values: Mapping[str, Any]
    case: Mapping[str, Any]
    quantities: tuple[str, ...]
    motion: bool

    def require_same(self) -> None:
        """Raise InputError if the folder holds a run of another case, or one asked for otherwise."""
        if not (self.folder / REQUEST).exists():
            return
        there, wanted = json_of(self.folder / REQUEST, _REMEDY), self._wanted()
        case = content(self.folder / CASE, _REMEDY).decode(errors="replace")
        if case != self._text() or {**there, "quantities": []} != {**wanted, "quantities": []}:
            raise InputError(
                f"{self.folder}: holds a run of another case, of other files, or one with --run where this "
                "is without; give another --output"
            )

    def write(self) -> None:
        """Make the folder, with what is to be done."""
        self.folder.mkdir(parents=True, exist_ok=True)
        replace(self.folder / CASE, self._text().encode())
        replace(self.folder / REQUEST, json.dumps(self._wanted()).encode())

    def result(self) -> Mapping[str, FoundValue]:
        """Values by name: all of a run that is done, none of one that was not begun."""
        return kept_values(self.folder, self.quantities)

    def _text(self) -> str:
        return case_text(self.case, self.folder / CASE)

    def _wanted(self) -> dict[str, Any]:
        files = {key: digest(path) for key, path in named_files(self.case)}
        return {"quantities": list(self.quantities), "motion": self.motion, "files": files}


def compute(folder: Path) -> None:
    """Do the run that is asked for in a folder, unless it is done; collective.

    Whoever else does it is waited for. Raises InputError, SolveError: the run fails, or has no value of some
    quantity; those of the others are kept.
    """
    parallel.on_root((folder / LAUNCHES).touch)
    with alone(folder / LAUNCHES):
        asked = parallel.on_root(lambda: json_of(folder / REQUEST, _REMEDY))
        quantities = tuple(asked["quantities"])
        if len(parallel.on_root(lambda: kept_values(folder, quantities))) == len(quantities):
            return
        parallel.on_root(lambda: _note_launch(folder))
        case = parallel.on_root(lambda: load_case(folder / CASE))
        parallel.on_root(lambda: check_work(case))
        if asked["motion"]:
            found = of_motion(case, folder / MOTION, quantities)
        else:
            found = at_instant(case, quantities)
        parallel.on_root(lambda: _keep(folder, found))
        if found.failures:
            raise SolveError("; ".join(map(str, found.failures.values())))


def kept_values(folder: Path, quantities: tuple[str, ...]) -> Mapping[str, FoundValue]:
    """What a run has found of some quantities. Raises InputError: the file is damaged."""
    if not (folder / RESULT).exists():
        return {}
    try:
        values = json_of(folder / RESULT, _REMEDY)["values"]
        return {name: FoundValue(*values[name]) for name in quantities if name in values}
    except (KeyError, TypeError):
        raise InputError(f"{folder / RESULT}: is damaged, it is no result; {_REMEDY}") from None


def _keep(folder: Path, found: Evaluation) -> None:
    """Write the result, beside what the run has been asked for before."""
    before = json_of(folder / RESULT, _REMEDY)["values"] if (folder / RESULT).exists() else {}
    values = before | {name: [one.value, one.error] for name, one in found.values.items()}
    text = json.dumps({"values": values, "checks": dict(found.checks), "launch": launch()}, indent=1)
    replace(folder / RESULT, (text + "\n").encode())


def _note_launch(folder: Path) -> None:
    """A line for each time that the run begins: one more than it was broken off."""
    with (folder / LAUNCHES).open("a", encoding="utf-8") as file:
        file.write(f"{datetime.now(UTC).isoformat(timespec='seconds')} {platform.node()} {os.getpid()}\n")
