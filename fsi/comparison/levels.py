"""One case at several levels: the case of each, and the runs."""

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from fsi.case.case import MODELS, Case
from fsi.case.load import load_case, parse_case
from fsi.errors import InputError
from fsi.levels import LEVELS
from fsi.parallel import on_root
from fsi.runs import Progress, no_progress, resume, run


def case_at_levels(case: Case, levels: Sequence[str], law: str | None = None) -> dict[str, Case]:
    """The case at each level, with another law of the reduced model if one is given.

    Raises InputError if the case is not one for it.
    """
    if len(levels) < 2 or len(set(levels)) < len(levels) or not set(levels) <= set(MODELS):
        raise InputError(
            f"--levels {','.join(levels)}: give at least two different ones of {', '.join(MODELS)}"
        )
    data = case.as_data()
    if law is not None:
        data["reduced"] = data["reduced"] | {"law": law}
    return {level: parse_case(_at_level(data, level)) for level in levels}


def _at_level(data: dict[str, Any], level: str) -> dict[str, Any]:
    """The case as data at a level; one without a flow writes all its steps, which is little.

    Its steps land on the times of output, and a gluey run has rows of its bodies at those alone: what is
    compared would depend on them. Runs of a flow have rows of all steps, of which fields would be much.
    """
    output = dict(data["output"])
    if not LEVELS[level].flow:
        output.pop("interval", None)
    return data | {"model": level, "output": output}


def require_motion(cases: Mapping[str, Case]) -> None:
    """Raise InputError where a level only steps and the case has no [time]."""
    for case in cases.values():
        if not case.level.viscous:
            _ = case.timing


def run_levels(cases: Mapping[str, Case], folder: Path, progress: Progress = no_progress) -> None:
    """Run all levels, or go on with what is in the folder; collective.

    Raises InputError if the folder holds the run of another case, with nothing written; SolveError if a run
    cannot go on.
    """
    for level, case in cases.items():
        on_root(partial(_require_same, folder / level, case))
    on_root(lambda: folder.mkdir(parents=True, exist_ok=True))
    for level, case in cases.items():
        # Not by each rank: one that looks late would see the folder that root has made since.
        if on_root((folder / level).exists):
            resume(folder / level, progress)
        else:
            run(case, folder / level, progress)


def _require_same(folder: Path, case: Case) -> None:
    """A run that is there already must be one of this case."""
    if folder.exists() and load_case(folder / "case.toml") != case:
        raise InputError(f"output = {folder}: holds the run of another case; give a new folder")
