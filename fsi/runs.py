"""A run from its case to its folder, and the continuation of one that was broken off, at all levels."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from time import process_time
from typing import Any

from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.bodies.gaps import nearest_gaps
from fsi.case.case import Case
from fsi.case.checks.work import check_work, require_room
from fsi.case.load import case_data, parse_case
from fsi.case.sections import Time
from fsi.errors import InputError
from fsi.integration.evolution import Evolution, Moment
from fsi.integration.state import State, StepRecord
from fsi.models import make_evolution
from fsi.parallel import on_root
from fsi.run_folder.alone import alone
from fsi.run_folder.folder import Commit, RunFolder
from fsi.run_folder.kept import REMEDY
from fsi.run_folder.one_case import Changes, changes, require_one_case, require_same_keys
from fsi.run_folder.provenance import launch

type Progress = Callable[[StepRecord], None]
type MakeEvolution = Callable[[Case], Evolution]


@dataclass(frozen=True, slots=True)
class Outcome:
    """How a launch ended.

    Attributes:
        state: the last one.
        steps: how many it made; 0 if the run was finished before.
        contact: whether the smallest gap came to `time.contact_gap`.
    """

    state: State
    steps: int
    contact: bool


def no_progress(record: StepRecord) -> None:
    """Show nothing."""


def run(
    case: Case, folder: Path, progress: Progress = no_progress, make: MakeEvolution = make_evolution
) -> Outcome:
    """Run a case into a new folder. All ranks call it, and `progress` is called on all of them.

    Args:
        case: what moves, at any level.
        folder: a new one.
        progress: called with each step that is kept; its arrays are read-only.
        make: what steps the case; the level that it names if not given.

    Raises:
        InputError: the case cannot be run, is more than this machine holds, or the folder is not new;
            nothing stays written.
        SolveError: the run cannot go on; the folder keeps the last good state.
    """
    on_root(lambda: check_work(case))
    on_root(lambda: require_room(case, folder))
    evolution = make(case)
    new = RunFolder.create(folder, case, launch())
    with alone(new.path, refused=folder):
        try:
            return _drive(case, new, evolution, progress)
        except InputError:
            new.discard_if_unused()
            raise


def resume(
    folder: Path,
    progress: Progress = no_progress,
    make: MakeEvolution = make_evolution,
    overrides: Sequence[str] = (),
) -> Outcome:
    """Continue a run after its last committed step; a finished run is left as it is.

    Args:
        folder: of the run.
        progress: as in `run`.
        make: as in `run`.
        overrides: changes of the case, `key=value`; see `one_case` for what may change. It is written into
            the folder, with what it was.

    Raises:
        InputError: it is not the folder of a run, a file in it is not sound, another process runs it, or
            the case is not that of the run any more; nothing in the folder has been changed.
        SolveError: as in `run`.
    """
    with alone(folder, refused=folder):
        return _resume(folder, progress, make, overrides)


def _resume(folder: Path, progress: Progress, make: MakeEvolution, overrides: Sequence[str]) -> Outcome:
    run = RunFolder.reopen(folder)
    case, changed = on_root(lambda: _case_of(run, overrides))
    if run.checkpoint is not None:
        state = _with_shapes(case, run.checkpoint.state)
        contact = _in_contact(case, state)
        if contact or state.t >= case.timing.end:
            return Outcome(state, 0, contact)
    evolution = make(case)
    if run.checkpoint is not None:
        _restore(evolution, run.checkpoint.model, folder)
    run.rewind(case, launch() | ({"changed": changed} if changed else {}))
    return _drive(case, run, evolution, progress)


def _case_of(run: RunFolder, overrides: Sequence[str]) -> tuple[Case, Changes]:
    """The case of a run as it is to go on, and what that changes. Raises InputError."""
    data = case_data(run.case, overrides)
    try:
        case = parse_case(data)
    except InputError:  # whatever else is wrong with a key that may not change: no other value helps
        require_same_keys(run.path, run.kept.provenance, data)
        raise
    changed = changes(run.kept.provenance, case)
    require_one_case(run.path, changed, run.checkpoint.state.t if run.checkpoint else 0.0)
    if "time.end" in changed:
        case = _with_default_step(case, before=changed["time.end"][0])
        changed = changes(run.kept.provenance, case)
    if changed:
        check_work(case)
        require_room(case, run.path)
    return case, changed


def _with_default_step(case: Case, before: object) -> Case:
    """The case with the smallest step of its end, where it has that of the end before, which is stored too.

    before: that end, if the run's record has it. A first step that was given is no shorter, or the case would
    not be sound.
    """
    time = case.timing
    if not isinstance(before, float) or before <= 0.0 or time.smallest_step != Time(end=before).smallest_step:
        return case
    default = Time(end=time.end).smallest_step
    default = default if time.first_step is None else min(default, time.first_step)
    return case.model_copy(update={"time": time.model_copy(update={"smallest_step": default})})


def _restore(evolution: Evolution, memory: Mapping[str, NDArray[Any]], folder: Path) -> None:
    try:
        evolution.restore(memory)
    except (KeyError, ValueError) as error:
        raise InputError(f"output = {folder}: state.npz is damaged ({error}); {REMEDY}") from None


def _drive(case: Case, run: RunFolder, evolution: Evolution, progress: Progress) -> Outcome:
    """Step from the last commit, or from the start, to the end; keep each step."""

    def keep(moment: Moment, began: float) -> State:
        record = moment.record.timed(process_time() - began)
        output = evolution.schedule.is_output(record.t) or _in_contact(case, moment.state)
        with run.writing():
            files = moment.write(run.fields) if output and case.output.fields else {}
        tables = moment.tables() if output else {}
        run.keep(Commit(record, moment.names, files, tables, moment.state, evolution.memory()))
        progress(_read_only(record))
        return moment.state

    began = process_time()
    try:
        if run.checkpoint is None:
            state = keep(evolution.start(), began)
        else:
            state = _with_shapes(case, run.checkpoint.state)
        first = state.step
        while state.t < evolution.schedule.end and not _in_contact(case, state):
            began = process_time()
            state = keep(evolution.advance(state), began)
    except BaseException:
        run.rescue()
        raise
    run.commit()
    return Outcome(state, state.step - first, _in_contact(case, state))


def _read_only(record: StepRecord) -> StepRecord:
    """As callbacks see it: copies, as the next step begins from these arrays, which nobody may write to."""
    q = record.q
    q = replace(q, centres=_view(q.centres), angles=_view(q.angles), radii=_view(q.radii))
    of_bodies = {name: _view(values) for name, values in record.body_columns.items()}
    U, F, columns = _view(record.U), _view(record.F), dict(record.columns)
    return replace(record, q=q, U=U, F=F, columns=columns, body_columns=of_bodies)


def _view(values: Array) -> Array:
    """A copy, read-only for those who do not mean to write."""
    copy = values.copy()
    copy.flags.writeable = False
    return copy


def _with_shapes(case: Case, state: State) -> State:
    """A state that was read, with what the case says of its bodies."""
    return state.of_shapes(case.configuration())


def _in_contact(case: Case, state: State) -> bool:
    """Whether the smallest gap is so small that the run ends."""
    least = case.timing.contact_gap
    if least is None:
        return False
    container = case.container().at(state.t, state.q.strain)
    return nearest_gaps(state.q, container).smallest() <= least
