"""`fsi validate`, from case files to rows in a folder: solves and runs of each case, and their errors."""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

import fsi.parallel as parallel
from fsi.arrays import Array
from fsi.bodies.gaps import nearest_gaps
from fsi.case.case import Case
from fsi.case.quantities import NUMBERS, gap_of
from fsi.case.sections import Expected
from fsi.errors import InputError, SolveError, ValidationError
from fsi.files import require_new
from fsi.integration.state import Results
from fsi.lubrication.exact_results import EXACT
from fsi.models import make_scheme
from fsi.observables.quantities import component, computed, time_at
from fsi.observables.scales import flow_scales
from fsi.observables.truncation import halved
from fsi.run_folder.kept import STEPS
from fsi.runs import run
from fsi.stokes.adapt import solve_with_errors
from fsi.stokes.model import StokesModel
from fsi.validation.rows import Row, chosen_cases, reference, require_sound, swept, write_rows

# Case files, and a folder for the runs of those with [time], to rows as `rows_of` gives them.
type Solve = Callable[[Sequence[Path], Path], Iterator[list[Row]]]


def validate_cases(
    folder: Path,
    names: Sequence[str],
    output: Path,
    show: Callable[[list[Row]], None],
    solve: Solve | None = None,
) -> list[Row]:
    """Validate the named cases of a folder, or all; collective.

    output: a new folder, for validation.json, validation.csv and the runs. show: is told the rows of each
    case, or of each value of its sweep. solve: gives them, in their order; None: this process does. Raises
    InputError: no such case, one that is not sound, or the output folder is not new; nothing is written.
    """
    paths = parallel.on_root(lambda: chosen_cases(folder, names))
    parallel.on_root(lambda: require_sound(paths))
    parallel.on_root(lambda: _make(output))
    rows: list[Row] = []
    for found in (solve or one_by_one)(paths, output / "runs"):
        rows += found
        show(found)
    parallel.on_root(lambda: write_rows(rows, output))
    return rows


def one_by_one(paths: Sequence[Path], runs: Path) -> Iterator[list[Row]]:
    """The rows of case files, case after case, as `rows_of`."""
    for path in paths:
        yield from rows_of(path, runs)


def require_passed(rows: Sequence[Row]) -> None:
    """Raise ValidationError if a value lies outside its tolerance."""
    failed = [row for row in rows if not row.passed]
    if failed:
        row = failed[0]
        wrong = row.failure or f"= {row.value:.9g}, off by {row.true_error:.1e}"
        first = f"first {row.case}: {row.quantity} {wrong}; expected {row.reference:.9g} within {row.rtol:g}"
        raise ValidationError(f"{len(failed)} of {len(rows)} rows fail, {first}")


def _make(output: Path) -> None:
    require_new(output)
    try:
        (output / "runs").mkdir(parents=True)
    except OSError as error:
        raise InputError(f"output = {output}: {error.strerror}; give a folder that can be written") from None


# A second run has steps that many times as long: at order 2 its error is 2.25 times as large, so that what
# both differ by is 1.25 times that of the first, and more at higher order.
STRETCH = 1.5


def rows_of(path: Path, runs: Path) -> Iterator[list[Row]]:
    """The rows of one case file, a list for each value of its sweep; collective.

    runs: where a case with [time] leaves its run folders. Raises InputError: the case is not sound. A solve
    that fails gives rows without value.
    """
    for value, case in swept(path):
        yield rows_at(path.stem, value, case, runs)


def rows_at(name: str, value: float | None, case: Case, runs: Path) -> list[Row]:
    """The rows of a case of that name at one value of its sweep, as `rows_of`; collective."""
    try:
        results = _instant(case) if case.time is None else _history(case, runs / name)
    except SolveError as error:
        parallel.settle(error)
        return failed_rows(name, value, case, str(error))
    return [_row(name, value, case, row, found) for row, found in zip(case.expected, results, strict=True)]


def failed_rows(name: str, value: float | None, case: Case, failure: str) -> list[Row]:
    """The rows of a case that has failed."""
    none = Computed(np.nan, np.nan, np.nan, failure)
    return [_row(name, value, case, row, none) for row in case.expected]


class Computed(NamedTuple):
    """What a solve or a run gives for an expected row.

    Attributes:
        value: the quantity.
        error: of the elements, and of the time steps of a run.
        truncation: what the finite container changes.
        failure: why there is no value, or empty.
        scale: the largest of its kind, as `largest_of_kind`; nan of what is neither a load nor a velocity.
    """

    value: float
    error: float
    truncation: float
    failure: str = ""
    scale: float = np.nan


def _row(name: str, sweep: float | None, case: Case, row: Expected, result: Computed) -> Row:
    expected, digits = reference(case, row)
    size = abs(expected) or result.scale
    q = case.configuration()
    gap = nearest_gaps(q, case.container()).smallest() / float(q.radii.min()) if len(q) else np.inf
    return Row(
        name, sweep, gap, row.quantity, result.value, result.error / size, result.truncation / size, expected,
        digits, row.rtol, row.exact or "", row.source, result.failure, result.scale,
    )  # fmt: skip


def _instant(case: Case) -> list[Computed]:
    solved = solve_with_errors(case)
    solution, errors = solved.solution, solved.errors
    enclosed = any(row.exact and EXACT[row.exact].fitting.enclosed for row in case.expected)
    half = None if enclosed else halved(solved.case)
    smaller = solution if half is None else StokesModel(half)(half.configuration(), 0.0)
    rows = []
    for row in case.expected:
        value, error, other = (computed(case, of, row.quantity) for of in (solution, errors, smaller))
        scale = largest_of_kind(case, solution, row.quantity)
        rows.append(Computed(value, abs(error), abs(other - value), scale=scale))
    return rows


def largest_of_kind(case: Case, results: Results, quantity: str) -> float:
    """The largest velocity or load at time 0, in the unit of a quantity: errors of zeros are over it.

    It is that of all modes of all bodies and of what drives them (`FlowScales`), as in the bars of small
    numbers; torques count over the radius of the body, rotations times it. Infinite where rounding of a
    pressure all around is all that there is. nan of numbers of the flow.
    """
    if quantity in NUMBERS:
        return np.nan
    body, mode = component(case, quantity)
    arms, scales = case.configuration().arms, flow_scales(case, 0.0)
    arm, of_load = float(arms[body, mode]), quantity.split(".")[1] in ("force", "torque")
    largest, rounding = scales.largest(results, arms)[of_load], scales.rounding[of_load]
    if largest <= rounding:
        return np.inf
    return largest * arm if of_load else largest / arm


def _history(case: Case, folder: Path) -> list[Computed]:
    """Times at gaps, from two runs, whose difference is the error of the time steps."""
    assert case.time is not None
    scheme = make_scheme(case)
    assert scheme is not None  # as of all cases that are resolved
    # The error that is held to the tolerance goes with that power of the step.
    tolerance = STRETCH**scheme.error_order * case.time.tolerance
    steps = {"tolerance": tolerance, "gap_loss": STRETCH * case.time.gap_loss}
    coarser, fine = case.time.model_copy(update=steps), _run(case, folder)
    rough = _run(case.model_copy(update={"time": coarser}), folder.with_name(f"{folder.name}-coarser"))
    truncation = 0.0  # change of the velocities at time 0 when the radius of the container is halved
    if (half := halved(case)) is not None:
        U, smaller = (StokesModel(one)(one.configuration(), 0.0).U for one in (case, half))
        truncation = float(np.abs(smaller - U).max() / np.abs(U).max())
    results = []
    for row in case.expected:
        at, late = (time_at(gap_of(row.quantity), *of[:2], case.kinks())[0] for of in (fine, rough))
        elements = float(np.sum(np.where(fine[0] <= at, fine[2], 0.0)))
        results.append(Computed(at, elements + abs(late - at), truncation * at))
    return results


def _run(case: Case, folder: Path) -> tuple[Array, Array, Array]:
    """t, smallest gap, and the delay that the error of the velocity may have caused in each step."""
    output = case.output.model_copy(update={"fields": False, "error_estimates": True})
    case = case.model_copy(update={"output": output})
    run(case, folder)
    table = parallel.on_root(lambda: np.genfromtxt(folder / STEPS, delimiter=",", names=True))
    return table["t"], table["smallest_gap"], table["h"] * table["err_U"]
