"""What a run needs of a model that steps by itself, with a memory of its own, and how it is driven.

Models that give velocities at an instant are stepped by `fsi.integration.stepper`; a model whose step is a
projection with
memory (gluey, macroscopic) is an `Evolution`. Both share the run folder, its tables and its resuming bit by
bit.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import process_time
from typing import Any, Protocol

from numpy.typing import NDArray

from fsi.integration.schedule import Schedule
from fsi.integration.stepper import State
from fsi.run_folder.folder import RunFolder, StepRecord

type Table = tuple[Sequence[str], Sequence[Sequence[object]]]


@dataclass(frozen=True, slots=True)
class Moment:
    """The end of a step: the state, its row of steps.csv, and what is written at the times of output.

    write: writes field files into a folder and names them by series; tables: further tables, header and rows.
    """

    state: State
    record: StepRecord
    write: Callable[[Path], Mapping[str, Sequence[str]]]
    tables: Callable[[], Mapping[str, Table]]


class Evolution(Protocol):
    """A model that steps by itself."""

    @property
    def names(self) -> Sequence[str]:
        """Of the bodies in bodies.csv, which has the times of output."""

    @property
    def schedule(self) -> Schedule:
        """When it writes and ends."""

    def start(self) -> Moment:
        """The moment at time 0."""

    def advance(self, state: State) -> Moment:
        """One step. Raises SolveError."""

    def memory(self) -> dict[str, NDArray[Any]]:
        """What the next step depends on besides the state."""

    def restore(self, memory: Mapping[str, NDArray[Any]]) -> None:
        """Take back what `memory` gave."""


def evolve(
    run: RunFolder, evolution: Evolution, fields: bool, progress: Callable[[StepRecord], None]
) -> tuple[State, int]:
    """Step from the last commit, or from the start, to the end; keep each step.

    Returns:
        the last state and how many steps were made.
    """

    def kept(moment: Moment, began: float) -> State:
        record = moment.record.timed(process_time() - began)
        output = evolution.schedule.is_output(record.t)
        files = moment.write(run.fields) if output and fields else {}
        tables = moment.tables() if output else {}
        names = evolution.names if output else ()
        run.keep(record, names, files, moment.state, evolution.memory(), tables)
        progress(record)
        return moment.state

    began = process_time()
    if run.checkpoint is None:
        state = kept(evolution.start(), began)
    else:
        evolution.restore(run.checkpoint.model)
        state = run.checkpoint.state
    first = state.step
    while state.t < evolution.schedule.end:
        began = process_time()
        state = kept(evolution.advance(state), began)
    return state, state.step - first
