"""What steps are made of: models and their instants, the state between two steps, schemes, steppers.

A `Model` gives the velocities of the bodies at one instant (`fsi.stokes.model` resolves the flow; the reduced
model satisfies the same protocol), a `Scheme` (`fsi.integration.schemes`) makes one step, a stepper chooses
its length, and a `Schedule` the times that steps must land on, met without a sliver of a step.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration, Inertia
from fsi.integration.errors import StepErrors
from fsi.meshes.geometry.container import Container

# A step that ends this close to a stop is stretched to land on it; `gap_limiter.SAFETY` allows for it.
STRETCH = 1.1
# Two times closer than this, relative to the end, are one.
SAME_TIME = 1e-12


@dataclass(frozen=True, slots=True)
class Schedule:
    """Steps land on `kinks` (the kinks of the data), on multiples of `interval` (None: none), on the end."""

    end: float
    kinks: tuple[float, ...] = ()
    interval: float | None = None

    def next_stop(self, t: float) -> float:
        """The first time after t to land on; at most the end."""
        stops = [*self.kinks, *self._outputs_after(t)]
        first = min((s for s in stops if s > t and not self._same(s, t)), default=self.end)
        return self.end if first > self.end or self._same(first, self.end) else first

    def landing(self, t: float, h: float) -> float:
        """Where a step of about h from t ends: never a sliver short of a stop, at most `STRETCH` h long."""
        stop = self.next_stop(t)
        left = stop - t
        if left <= STRETCH * h:
            return stop
        return t + (left / 2.0 if left < 2.0 * h else h)

    def is_output(self, t: float) -> bool:
        """True if fields are written at t: always without an interval, and always at the end."""
        if self.interval is None or t >= self.end:
            return True
        return self._same(t, round(t / self.interval) * self.interval)

    def is_kink(self, t: float) -> bool:
        """True where the data have a kink."""
        return any(self._same(t, kink) for kink in self.kinks)

    def _outputs_after(self, t: float) -> list[float]:
        """The next multiples of the interval, among them the first after t whatever the rounding."""
        if self.interval is None:
            return []
        count = math.floor(t / self.interval)
        return [k * self.interval for k in (count, count + 1, count + 2)]

    def _same(self, t: float, other: float) -> bool:
        return abs(t - other) <= SAME_TIME * self.end


class Results(Protocol):
    """What a model computes."""

    @property
    def U(self) -> Array:
        """Velocities of the bodies, shape (N, M)."""

    @property
    def F(self) -> Array:
        """External loads `int sigma n`, shape (N, M)."""


class Measured(Results, Protocol):
    """The same with the dissipation, and what only some flows have; or the errors of all that."""

    @property
    def dissipation(self) -> float:
        """`2 mu int e:e`."""

    @property
    def apparent_viscosity(self) -> float | None:
        """Over the viscosity of the fluid, of a periodic flow with a mean strain rate."""

    @property
    def wall_speeds(self) -> Mapping[str, float]:
        """Along x, of the walls that a stress moves."""

    @property
    def shear_rate(self) -> float | None:
        """Of a cell that a stress shears, else None."""

    @property
    def dp_dx(self) -> float | None:
        """The mean pressure gradient along a channel whose net flux is given, else None."""

    @property
    def flux(self) -> float | None:
        """The net flux along a channel whose mean pressure gradient is given, else None."""


class Instant(Measured, Protocol):
    """What a model knows at one instant; U, F and `record` are the same on all ranks, to the last bit."""

    @property
    def record(self) -> Mapping[str, float]:
        """The model's columns of steps.csv; `cpu_*` are CPU seconds, the others deterministic."""

    @property
    def body_columns(self) -> Mapping[str, Array]:
        """The model's columns of bodies.csv, (N,) each."""

    def write(self, folder: Path, step: int) -> dict[str, list[str]]:
        """Write VTU files into the folder, all ranks together; unfinished ones have names with a leading dot.

        Returns:
            the names of the files by series ("fluid", "surface"), the same on all ranks.
        """


def velocities(instant: Instant) -> Array:
    """What moves bodies and their images: U (N, M), and where a stress shears a lattice a row more.

    That row begins with the rate.
    """
    if instant.shear_rate is None:
        return instant.U
    of_lattice = np.zeros((1, instant.U.shape[1]))
    of_lattice[0, 0] = instant.shear_rate
    return np.concatenate([instant.U, of_lattice])


class Model(Protocol):
    """Gives the velocities of the bodies; all ranks call it together."""

    def __call__(self, q: Configuration, t: float, inertia: Inertia | None = None) -> Instant:
        """The instant at configuration q and time t, with the load `F - D (U - U0)` if inertia is given."""

    def errors(self, q: Configuration, t: float, instant: Instant) -> StepErrors | None:
        """The estimated errors of an instant that this model gave; None of a model without a mesh."""

    def state(self) -> dict[str, NDArray[Any]]:
        """What must be restored so that a resumed run repeats an unbroken one bit by bit (root's is kept)."""

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Take back what `state` gave."""


@dataclass(frozen=True, slots=True, eq=False)
class Past:
    """What a scheme of several steps keeps of those before.

    Attributes:
        t: their times, the latest first, (K,).
        U: the velocities then, (K, N, M).
        correction: of where the last one ended, (N, M).
    """

    t: Array
    U: Array
    correction: Array

    def forgotten(self) -> Past:
        """Without velocities, after a kink of the data: those before do not foretell what comes."""
        return Past(self.t[:0], self.U[:0], self.correction)


@dataclass(frozen=True, slots=True)
class State:
    """All that the next step depends on.

    Attributes:
        t: time.
        step: its number.
        U: velocities at (q, t), shape (N, M), or with the row of a lattice (see `velocities`).
        h: the next step to try.
        past: None of a scheme of one step, and at the start.
    """

    t: float
    step: int
    q: Configuration
    U: Array
    h: float
    past: Past | None = None

    def of_shapes(self, start: Configuration) -> State:
        """The same with the shapes of the bodies, which no file keeps, from where they started."""
        if not start.shaped:
            return self
        return replace(self, q=replace(self.q, outlines=start.outlines, ellipsoids=start.ellipsoids))


@dataclass(frozen=True, slots=True)
class Trial:
    """One step of a scheme.

    Attributes:
        q: where it ends.
        instant: there.
        error: of its displacement, as estimated, of the shape of velocities.
        past: what the scheme wants to have at the next step.
    """

    q: Configuration
    instant: Instant
    error: Array
    past: Past | None = None


class Scheme(Protocol):
    """A method for a step; error_order: the power of the step with which its estimated error goes to zero."""

    error_order: ClassVar[int]

    def start(self, model: Model, q: Configuration) -> tuple[Instant, Array]:
        """The instant at time 0, and the velocities with which the first step begins."""

    def step(self, model: Model, state: State, t_end: float) -> Trial:
        """One step from `state` to `t_end`; the instant of the trial is that at its end."""


@dataclass(frozen=True, slots=True)
class Step:
    """An accepted step.

    Attributes:
        state: that it ends in.
        instant: there.
        h: its length.
        rejected: how many tries came before.
        error: of its displacement, as estimated, (N, M); None where nothing is known of it.
    """

    state: State
    instant: Instant
    h: float
    rejected: int
    error: Array | None = None


class Advance(Protocol):
    """What a run needs of a stepper: `Stepper` chooses its steps, that of stored gaps takes given ones."""

    @property
    def model(self) -> Model:
        """The model."""

    @property
    def container(self) -> Container:
        """What encloses the fluid."""

    @property
    def schedule(self) -> Schedule:
        """The times to land on."""

    def start(self, q: Configuration) -> Step:
        """The step of length 0 that begins a run."""

    def advance(self, state: State) -> Step:
        """One accepted step. Raises SolveError."""


@dataclass(frozen=True, slots=True)
class StepRecord:
    """One accepted step as the tables show it; step 0, of length 0, is the start. In the units of the case.

    Attributes:
        step, t, h, rejected: its number, its end and length in time, and how many tries came before.
        smallest_gap: at t, of all between bodies and to walls, a length.
        q: where bodies are at t: centres, lengths, and angles, radians.
        U, F: velocities and external loads at t, shape (N, M): of centres, then of turns in radians.
        columns, body_columns: the further ones of steps.csv, and those of bodies.csv, (N,) each.
    """

    step: int
    t: float
    h: float
    smallest_gap: float
    rejected: int
    q: Configuration
    U: Array
    F: Array
    columns: Mapping[str, float]
    body_columns: Mapping[str, Array] = field(default_factory=dict)

    def timed(self, cpu: float) -> StepRecord:
        """With the CPU seconds of the step."""
        return replace(self, columns={**self.columns, "cpu_step": cpu})
