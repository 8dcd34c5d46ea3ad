"""Quantities of a case by name, at time 0 or of its motion: what `fsi search` and `fsi sweep` look at."""

import csv
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from itertools import islice
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import fsi.parallel as parallel
from fsi.arrays import Array
from fsi.bodies.configuration import LOADS, MODES, PLACES
from fsi.case.case import Case
from fsi.case.checks.expected import check_quantity
from fsi.case.quantities import NUMBERS, gap_of, is_quantity, is_time, names_of_quantities
from fsi.errors import FsiError, InputError, SolveError
from fsi.models import flow_solvers, make_model
from fsi.observables.quantities import component, computed, time_at
from fsi.run_folder.kept import BODIES, CASE, STEPS
from fsi.runs import resume, run
from fsi.studies.means import energy_relaxed, mean_dissipation, mean_over_time, require_enough

_OF_RUN = "take fsi sweep --run"


@dataclass(frozen=True, slots=True)
class FoundValue:
    """The value of a quantity, and its error bar where it has one."""

    value: float
    error: float | None = None


@dataclass(frozen=True, slots=True)
class Evaluation:
    """What there is of some quantities.

    Attributes:
        values: by name.
        failures: why the others have none, by name.
        checks: the identities of the flow that gave them, relative defects.
    """

    values: Mapping[str, FoundValue]
    failures: Mapping[str, FsiError]
    checks: Mapping[str, float] = field(default_factory=dict)

    def __getitem__(self, quantity: str) -> FoundValue:
        """One of them. Raises InputError, SolveError: it has no value."""
        if quantity in self.failures:
            raise self.failures[quantity]
        return self.values[quantity]


def at_instant(case: Case, quantities: Iterable[str]) -> Evaluation:
    """Quantities at time 0, without inertia, the same on all ranks; collective.

    Raises InputError, SolveError: the case cannot be solved.
    """
    if not case.level.flow:
        instant = make_model(case)(case.configuration(), 0.0)
        return _evaluated(quantities, lambda name: FoundValue(computed(case, instant, name)))
    solved = flow_solvers(case).solve(case)

    def value(name: str) -> FoundValue:
        number, error = (computed(case, of, name) for of in (solved.solution, solved.errors))
        return FoundValue(number, abs(error))

    checks = {name: float(defect) for name, defect in solved.solution.checks.items()}
    return replace(_evaluated(quantities, value), checks=checks)


def of_motion(case: Case, folder: Path, quantities: Iterable[str]) -> Evaluation:
    """Quantities of a run to its end: rates averaged over its time, those of a body at the end; collective.

    folder: of the run, which goes on where there is one. Raises InputError, SolveError as `fsi run`.
    """
    if parallel.on_root((folder / CASE).is_file):
        resume(folder)
    else:
        run(case, folder)
    return _evaluated(quantities, lambda name: parallel.on_root(lambda: _moved(case, folder, name)))


def require_quantity(case: Case, quantity: str, *, moving: bool = False) -> None:
    """Raise InputError if a case has no such quantity, at one instant or, moving, of a run."""
    here = f"--quantity {quantity}"
    of_run = ".position." in quantity or is_time(quantity)
    if not is_quantity(quantity):
        raise InputError(f"{here}: no such number; give {names_of_quantities(of_run=moving)}")
    if of_run and not moving:
        raise InputError(f"{here}: is of a run, not of an instant; give a velocity or a force, or {_OF_RUN}")
    check_quantity(case, quantity, here)


def _evaluated(quantities: Iterable[str], value: Callable[[str], FoundValue]) -> Evaluation:
    """Each quantity by itself: one that has no value costs no other; collective."""
    values, failures = dict[str, FoundValue](), dict[str, FsiError]()
    for name in quantities:
        try:
            values[name] = _finite(value(name), name)
        except FsiError as error:
            parallel.settle(error)
            failures[name] = error
    return Evaluation(values, failures)


def _finite(found: FoundValue, quantity: str) -> FoundValue:
    """The same. Raises SolveError: it is no number."""
    if not np.isfinite(found.value):
        here = f"--quantity {quantity}: is {found.value:g} in this case"
        raise SolveError(f"{here}; take another quantity or model")
    return found


def _mean(case: Case, folder: Path, quantity: str) -> FoundValue:
    """Of a number of the flow over the time of a run."""
    number, table = NUMBERS[quantity], np.genfromtxt(folder / STEPS, delimiter=",", names=True)
    column = number.column(case)
    if column not in (table.dtype.names or ()):
        raise InputError(f"--quantity {quantity}: runs of this model have none; take another quantity")
    of_steps = table["t"], table[column], case.kinks()
    if number.square:
        require_enough(table["t"], case.kinks(), quantity)
        return FoundValue(*mean_dissipation(*of_steps, *_relaxed(case, folder)))
    _require_numbers(quantity, table["t"], table[column])
    return FoundValue(*mean_over_time(*of_steps))


def _moved(case: Case, folder: Path, quantity: str) -> FoundValue:
    if quantity in NUMBERS:
        return _mean(case, folder, quantity)
    if is_time(quantity):
        table = np.genfromtxt(folder / STEPS, delimiter=",", names=True)
        at, error = time_at(gap_of(quantity), table["t"], table["smallest_gap"], case.kinks())
        return FoundValue(at, error + _strayed(table, at))
    body, mode = component(case, quantity)
    kind = quantity.split(".")[1]
    names = {"position": PLACES, "force": LOADS, "torque": LOADS}.get(kind, MODES)[case.dimension]
    with (folder / BODIES).open(encoding="utf-8", newline="") as file:
        last = [row for row in csv.DictReader(file) if row["body"] == case.names[body]][-1]
    return FoundValue(float(last[names[mode]]) * (-1.0 if names is LOADS[case.dimension] else 1.0))


def _strayed(steps: NDArray[np.void], t: float) -> float:
    """The largest `err_t` of the step to t, the error of the time at which the run has its gap; 0 without."""
    if "err_t" not in (steps.dtype.names or ()):
        return 0.0
    after = int(np.searchsorted(steps["t"], t))
    return float(steps["err_t"][max(after - 1, 0) : after + 1].max())


def _require_numbers(quantity: str, t: Array, values: Array) -> None:
    """Raise SolveError if some of the values at times t are none, as with walls at rest."""
    lacking = np.isnan(values)
    if lacking.any() and not lacking.all():
        here = f"--quantity {quantity}: is no number at t = {t[lacking][0]:g}, as with walls at rest"
        raise SolveError(f"{here}; give another output.interval or quantity")


def _relaxed(case: Case, folder: Path) -> list[tuple[float, float]]:
    """`energy_relaxed` of the first step of a run; none where no mass moves freely."""
    names, masses = MODES[case.dimension], case.masses()
    free = np.zeros(case.held().shape) if masses is None else np.where(case.held(), 0.0, masses)
    if not free.any():
        return []
    with (folder / BODIES).open(encoding="utf-8", newline="") as file:
        rows = [[float(row[name]) for name in names] for row in islice(csv.DictReader(file), 2 * len(free))]
    return [energy_relaxed(free, np.array(rows[: len(free)]), np.array(rows[len(free) :]))]
