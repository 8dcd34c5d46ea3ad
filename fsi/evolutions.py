"""Cases of the models that step by themselves: which there are, and how they are read, run and resumed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from fsi.case.case import read_toml
from fsi.case.overrides import override
from fsi.case.section import explain, tuples
from fsi.errors import InputError
from fsi.evolution import Evolution, evolve
from fsi.gluey.evolution import GlueyEvolution
from fsi.gluey.limit_study import LimitCase
from fsi.gluey.setup import GlueyCase
from fsi.macroscopic.case import MacroscopicCase
from fsi.macroscopic.evolution import MacroscopicEvolution
from fsi.run import Outcome
from fsi.run_folder.folder import RunFolder, StepRecord
from fsi.run_folder.provenance import launch

type EvolvingCase = GlueyCase | MacroscopicCase

CASES: dict[str, type[GlueyCase | MacroscopicCase | LimitCase]] = {
    "gluey": GlueyCase,
    "macroscopic": MacroscopicCase,
    "limit": LimitCase,
}


def model_of(path: Path) -> str | None:
    """The `model` of a case file if it is one of CASES. Raises InputError if the file cannot be read."""
    model = read_toml(path).get("model")
    return model if isinstance(model, str) and model in CASES else None


def load_evolving(path: Path, overrides: Sequence[str] = ()) -> GlueyCase | MacroscopicCase | LimitCase:
    """Read a case whose model is one of CASES.

    Raises:
        InputError: the file cannot be read or the case is not sound; nothing has been written.
    """
    data: dict[str, Any] = read_toml(path)
    kind = CASES[data["model"]]  # by the file: its keys are those of no other model
    for text in overrides:
        override(data, text)
    try:
        return kind.model_validate(tuples(data))
    except ValidationError as error:
        raise InputError(explain(error, kind)) from None


def run_evolving(case: EvolvingCase, folder: Path, progress: Callable[[StepRecord], None]) -> Outcome:
    """Run a case into a new folder.

    Raises:
        InputError: the folder is not new; nothing has been written.
        SolveError: the run cannot go on; the folder keeps the last good state.
    """
    evolution = _evolution(case)
    run = RunFolder.create(folder, case.as_toml(), launch())
    return Outcome(*evolve(run, evolution, case.output.fields, progress))


def resume_evolving(case: EvolvingCase, folder: Path, progress: Callable[[StepRecord], None]) -> Outcome:
    """Continue a run after its last committed step; a finished one is left as it is. Raises as that."""
    run = RunFolder.reopen(folder)
    if run.checkpoint is not None and run.checkpoint.state.t >= case.time.end:
        return Outcome(run.checkpoint.state, 0)
    run.rewind(launch())
    return Outcome(*evolve(run, _evolution(case), case.output.fields, progress))


def _evolution(case: EvolvingCase) -> Evolution:
    return GlueyEvolution(case) if isinstance(case, GlueyCase) else MacroscopicEvolution(case)
