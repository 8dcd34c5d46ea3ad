"""A run from its case to its folder, and the continuation of a run that was broken off."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from time import process_time

from fsi.bodies.configuration import Configuration
from fsi.bodies.gaps import find_gaps
from fsi.case.case import Case, load_case
from fsi.case.sections import Time
from fsi.errors import InputError
from fsi.integration.fixed_stepper import FixedStepper
from fsi.integration.refining_stepper import Refinable, RefiningStepper
from fsi.integration.schedule import Schedule
from fsi.integration.schemes import AscherRuuthSpiteri, BogackiShampine
from fsi.integration.stepper import Advance, Model, Scheme, State, Step, Stepper
from fsi.meshes.geometry.containers import Container
from fsi.observables.error_estimate import StepErrors
from fsi.reduced.distance_model import DistanceModel
from fsi.run_folder.folder import RunFolder, StepRecord
from fsi.run_folder.provenance import launch

type Progress = Callable[[StepRecord], None]


@dataclass(frozen=True, slots=True)
class Outcome:
    """How a launch ended: the last state, and how many steps it made; 0 if the run was finished before."""

    state: State
    steps: int


def no_progress(record: StepRecord) -> None:
    """Show nothing."""


def run_case(case: Case, folder: Path, model: Model, progress: Progress = no_progress) -> Outcome:
    """Run a case into a new folder. All ranks call it, and `progress` is called on all of them.

    Raises:
        InputError: the case has no [time] or the folder is not new; nothing has been written.
        SolveError: the run cannot go on; the folder keeps the last good state.
    """
    stepper = make_stepper(case, model)
    run = RunFolder.create(folder, case.as_toml(), launch())
    return _drive(case, run, stepper, progress)


def resume_run(
    folder: Path, make_model: Callable[[Case], Model], progress: Progress = no_progress
) -> Outcome:
    """Continue a run after its last committed step; a finished run is left as it is.

    Raises:
        InputError: it is not the folder of a run, or files are missing in it.
        SolveError: as in `run_case`.
    """
    run = RunFolder.reopen(folder)
    case = load_case(run.case)
    if run.checkpoint is not None and run.checkpoint.state.t >= _time(case).end:
        return Outcome(run.checkpoint.state, 0)
    stepper = make_stepper(case, make_model(case))
    run.rewind(launch())
    return _drive(case, run, stepper, progress)


def make_stepper(case: Case, model: Model) -> Advance:
    """The stepper that a case asks for: with inertia if any body has a mass. Raises InputError."""
    given = _time(case)
    schedule = Schedule(given.end, case.knots(), case.output.interval)
    if isinstance(model, DistanceModel):
        return FixedStepper(model, case.container(), schedule, model.step)
    masses = case.masses()
    scheme: Scheme = BogackiShampine() if masses is None else AscherRuuthSpiteri(masses, given.smallest_step)
    stepper = Stepper(
        model=model,
        scheme=scheme,
        container=case.container(),
        names=case.names,
        schedule=schedule,
        tolerance=given.tolerance,
        gap_loss=given.gap_loss,
        smallest_step=given.smallest_step,
    )
    tolerance = case.discretisation.tolerance
    if tolerance is not None and isinstance(model, Refinable):
        return RefiningStepper(stepper, model, tolerance)
    return stepper


def _drive(case: Case, run: RunFolder, stepper: Advance, progress: Progress) -> Outcome:
    """Step from the last commit, or from the start, to the end; keep each step."""
    estimated = case.output.error_estimates or case.discretisation.tolerance is not None

    def kept(advance: Callable[[], Step]) -> State:
        began = process_time()
        step = advance()
        q, t = step.state.q, step.state.t
        errors = stepper.model.errors(q, t, step.instant) if estimated else None
        record = _record(step, errors, stepper.container.at(t), process_time() - began)
        writes = case.output.fields and stepper.schedule.is_output(record.t)
        files = step.instant.write(run.fields, record.step) if writes else {}
        run.keep(record, case.names, files, step.state, stepper.model.state())
        progress(record)
        return step.state

    if run.checkpoint is None:
        state = kept(partial(stepper.start, case.configuration(), _time(case).first_step))
    else:
        stepper.model.restore(run.checkpoint.model)
        state = run.checkpoint.state
    first = state.step
    while state.t < stepper.schedule.end:
        state = kept(partial(stepper.advance, state))
    return Outcome(state, state.step - first)


def _record(step: Step, errors: StepErrors | None, container: Container, cpu: float) -> StepRecord:
    """The step as the tables show it; cpu: CPU seconds of all its solves, rejected ones too."""
    state, instant = step.state, step.instant
    columns = {**instant.record, **(errors.columns if errors else {}), "cpu_step": cpu}
    gap = _smallest_gap(state.q, container)
    known = getattr(instant, "body_columns", {})  # of models that know more of each body
    of_bodies = {**known, **(errors.body_columns if errors else {})}
    return StepRecord(
        state.step, state.t, step.h, gap, step.rejected, state.q, instant.U, instant.F, columns, of_bodies
    )


def _smallest_gap(q: Configuration, container: Container) -> float:
    """The smallest of all gaps, also where no two bodies are near each other."""
    gaps = find_gaps(q, container)
    if len(gaps.pairs) == 0:
        gaps = find_gaps(q, container, reach=gaps.smallest())
    return gaps.smallest()


def _time(case: Case) -> Time:
    if case.time is None:
        raise InputError("time: missing; add a section [time] with its end, or use `fsi solve`")
    return case.time
