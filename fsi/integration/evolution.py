"""What a run needs of anything that moves: moments, from the first to the last.

A model that steps by itself, with a memory of its own (gluey, macroscopic), is an `Evolution`; one that gives
velocities at an instant becomes one by a stepper, in a `SteppedEvolution`.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from numpy.typing import NDArray

from fsi.bodies.configuration import Configuration
from fsi.bodies.gaps import nearest_gaps
from fsi.bodies.order import order_columns
from fsi.integration.state import Advance, Schedule, State, Step, StepRecord
from fsi.integration.strayed import Strayed

type CsvTable = tuple[Sequence[str], Sequence[Sequence[object]]]


@dataclass(frozen=True, slots=True)
class Moment:
    """The end of a step.

    Attributes:
        state: all that the next step depends on, but what the evolution remembers.
        record: the row of steps.csv, and the bodies.
        names: of the bodies that bodies.csv shall have of this moment; empty for none.
        write: writes field files into a folder and names them by series.
        tables: further tables, header and rows, at the times of output.
    """

    state: State
    record: StepRecord
    names: Sequence[str]
    write: Callable[[Path], Mapping[str, Sequence[str]]]
    tables: Callable[[], Mapping[str, CsvTable]] = dict


class Evolution(Protocol):
    """What moves in time, step by step."""

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


@dataclass(frozen=True, slots=True)
class SteppedEvolution:
    """The motion that a stepper gives, with the estimated errors of each instant if they are wanted.

    Attributes:
        stepper: makes the steps, with a model.
        names: of the bodies.
        q: where they begin.
        estimated: true to estimate the discretisation error of each step.
        strayed: how far the bodies are from the exact motion; None where that is not followed.
    """

    stepper: Advance
    names: Sequence[str]
    q: Configuration
    estimated: bool
    strayed: Strayed | None = None

    @property
    def schedule(self) -> Schedule:
        """When it writes and ends."""
        return self.stepper.schedule

    def start(self) -> Moment:
        """The moment at time 0."""
        return self._moment(self.stepper.start(self.q))

    def advance(self, state: State) -> Moment:
        """One accepted step. Raises SolveError."""
        return self._moment(self.stepper.advance(state))

    def memory(self) -> dict[str, NDArray[Any]]:
        """That of the model, and how far the bodies have strayed."""
        return {**self.stepper.model.state(), **(self.strayed.memory() if self.strayed else {})}

    def restore(self, memory: Mapping[str, NDArray[Any]]) -> None:
        """Take back what `memory` gave."""
        self.stepper.model.restore(memory)
        if self.strayed:
            self.strayed.restore(memory)

    def _moment(self, step: Step) -> Moment:
        state, instant = step.state, step.instant
        errors = self.stepper.model.errors(state.q, state.t, instant) if self.estimated else None
        columns = {**instant.record, **(errors.columns if errors else {})}
        columns |= order_columns(state.q, instant.U)
        columns |= {"strain": state.q.strain} if "shear_rate" in columns else {}
        of_bodies = {**instant.body_columns, **(errors.body_columns if errors else {})}
        q, U, F, container = state.q, instant.U, instant.F, self.stepper.container
        if self.strayed and errors:
            self.strayed.follow(step, errors, self.stepper.model, container)
            columns |= self.strayed.columns(state, container)
            columns |= self.strayed.dissipation_column(step, errors.errors)
            of_bodies |= self.strayed.body_columns(q, errors.errors)
        gap = nearest_gaps(q, container.at(state.t, q.strain)).smallest()
        record = StepRecord(state.step, state.t, step.h, gap, step.rejected, q, U, F, columns, of_bodies)
        return Moment(state, record, self.names, lambda folder: instant.write(folder, state.step))
