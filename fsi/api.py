"""What a Python user imports: a case, its solution at one instant, its run, a calibration.

    import fsi

    case = fsi.load_case("cases/disc_in_box.toml")
    solution = fsi.solve(case)
    solution["disc"].force                  # that the fluid exerts on the body
    u, p = solution.evaluate([[0.0, 4.0]])  # at points
    run = fsi.run(case, "runs/disc")        # tables (pandas) and fields (pyvista)

Under MPI all ranks call these functions together, with the same case, the same folder, the same points.
"""

import reprlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from numbers import Integral
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike

from fsi.arrays import Array
from fsi.calibration.calibrate import calibrate_case
from fsi.calibration.result import CalibrationResult
from fsi.calibration.sampling import Sampling
from fsi.case.arguments import of_folder, path_of, require_case, require_type, same_folder, told_as
from fsi.case.case import Case
from fsi.case.checks.work import check_work
from fsi.case.load import load_case, make_case
from fsi.errors import FsiError, InputError, SolveError
from fsi.files import require_folder
from fsi.integration.errors import ErrorEstimate
from fsi.integration.evolution import Evolution
from fsi.integration.state import Instant, StepRecord
from fsi.models import FlowInstant, flow_solvers, make_evolution, make_model
from fsi.observables.resistance import Resistance
from fsi.parallel import on_root, require_same, together_in_turn
from fsi.postprocess.run.probe import given_points
from fsi.postprocess.run.run import Run
from fsi.postprocess.run.run import open_run as open_folder
from fsi.report.progress import ProgressBar
from fsi.run_folder.kept import refused
from fsi.runs import MakeEvolution, Progress, no_progress
from fsi.runs import resume as resume_run
from fsi.runs import run as run_case

__all__ = [
    "BodySolution", "CalibrationResult", "Case", "FsiError", "InputError", "Resistance", "Run", "Solution",
    "SolveError", "StepRecord", "calibrate", "load_case", "make_case", "open_run", "resume", "run", "solve",
]  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False)
class BodySolution:
    """One body of a solved instant; in space what turns is a vector of three.

    Attributes:
        name: of the body.
        position: of its centre, shape (d,).
        velocity: of its centre, shape (d,).
        angular_velocity: positive counterclockwise in the plane.
        force: that the FLUID exerts on the body, shape (d,), in the plane per unit length.
        torque: likewise, about the centre.
    """

    name: str
    position: Array
    velocity: Array
    angular_velocity: Array
    force: Array
    torque: Array


@dataclass(frozen=True, eq=False)
class Solution:
    """A case solved at time 0.

    Attributes:
        case: what was solved; with a tolerance the refined one, but of pores, refined one by one, that given.
        instant: velocities U and external loads F, shape (N, M), read-only, and what the model knows besides.
        errors: estimated errors of U and F, of the dissipation, the apparent viscosity, dp_dx and flux; None
            of a model without a flow.
    """

    case: Case
    instant: Instant
    errors: ErrorEstimate | None
    _given: Case  # that `fsi resistance` refines: R needs other sizes than the flow

    def __post_init__(self) -> None:
        """Let nobody write to what the bodies' velocities and forces are made of."""
        self.instant.U.flags.writeable = self.instant.F.flags.writeable = False

    @property
    def bodies(self) -> tuple[BodySolution, ...]:
        """The bodies, in the order of the case."""
        q, d = self.case.configuration(), self.case.dimension
        U, F = self.instant.U.copy(), 0.0 - self.instant.F
        return tuple(
            BodySolution(name, q.centres[i], U[i, :d], U[i, d:].squeeze(), F[i, :d], F[i, d:].squeeze())
            for i, name in enumerate(self.case.names)
        )

    def __getitem__(self, name: str) -> BodySolution:
        """The body of that name. Raises KeyError, with the first names that there are."""
        if name not in self:
            raise KeyError(f"{name!r}: there is no such body among {reprlib.repr(self.case.names)}")
        return self.bodies[self.case.names.index(name)]

    def __contains__(self, name: object) -> bool:
        """Whether there is a body of that name."""
        return name in self.case.names

    def __iter__(self) -> Iterator[BodySolution]:
        """Body by body."""
        return iter(self.bodies)

    @property
    def dissipation(self) -> float:
        """`2 mu int e:e`, infinite where walls' velocities jump; in a reduced model that of gaps and drag.

        Where a reduced model has a bulk stress, that of the fluid and of lone bodies is in it too.
        """
        return float(self.instant.record["dissipation"])

    @property
    def apparent_viscosity(self) -> float | None:
        """Over the viscosity of the fluid; None but for a periodic flow with a mean strain rate."""
        return self.instant.apparent_viscosity

    @property
    def dp_dx(self) -> float | None:
        """The mean pressure gradient along a channel whose net flux is given, else None."""
        return self.instant.dp_dx

    @property
    def flux(self) -> float | None:
        """The net flux along a channel whose mean pressure gradient is given, else None.

        Of fluid and bodies through a section across x; in the plane per unit length.
        """
        return self.instant.flux

    @together_in_turn()
    def evaluate(self, points: ArrayLike) -> tuple[Array, Array]:
        """Velocity (n, d) and pressure (n,) at points (n, d), the same on all ranks.

        NaN outside the fluid. Raises InputError: it has no flow, or no pressure.
        """
        flow, x = self._at(points)
        return flow.evaluate(x) if len(x) else (x, x[:, 0])

    @together_in_turn()
    def velocity(self, points: ArrayLike) -> Array:
        """Velocity (n, d) at points (n, d), as `evaluate`; NaN outside the fluid. Raises InputError."""
        flow, x = self._at(points)
        return flow.velocity(x) if len(x) else x

    @together_in_turn()
    def resistance(self) -> Resistance:
        """R of all bodies, F = R U, and its inverse, with walls at rest; with a tolerance refined to it.

        The same as by `fsi resistance`. Raises InputError; SolveError: the tolerance is not reached.
        """
        if not self.bodies:
            raise InputError("bodies: there are none, and no resistance; give one")
        self._flow("resistance")
        solve = flow_solvers(self._given)
        if self._given.tolerance is None:
            return solve.resistance(self._given)
        return solve.resistance_with_errors(self._given).resistance

    @of_folder()
    def write(self, folder: Path | str) -> dict[str, list[str]]:
        """Write the fields as VTU files into a folder; gives their names by series. Raises InputError."""
        folder = same_folder(folder)
        on_root(lambda: require_folder(folder))
        with refused(folder, InputError, "make room, or give another folder"):
            on_root(lambda: folder.mkdir(parents=True, exist_ok=True))
            return self.instant.write(folder, 0)

    def _at(self, points: ArrayLike) -> tuple[FlowInstant, Array]:
        flow, x = self._flow("flow to evaluate"), given_points(points, self.case.dimension)
        require_same("points", x.tobytes)
        return flow, x

    def _flow(self, what: str) -> FlowInstant:
        if not self.case.level.flow:
            raise InputError(f'model = "{self.case.model}": has no {what}; take "resolved" or "pores"')
        return cast(FlowInstant, self.instant)

    def __repr__(self) -> str:
        """What it is, in one line, and a line for each of the first bodies."""
        what = f"{self.case.model}, {len(self.bodies)} bodies in {self.case.dimension} dimensions"
        lines = [f"<Solution of {self.case.name!r}: {what}, dissipation {self.dissipation:.8g}>"]
        shown = "  {0.name}: V = {0.velocity}, force of the fluid = {0.force}"
        with np.printoptions(precision=6, suppress=False):
            return "\n".join([*lines, *map(shown.format, self.bodies[:5])])


@told_as("path")
def open_run(path: Path | str) -> Run:
    """Open the folder of a run, without changing anything in it. Raises InputError: it is no run folder."""
    return open_folder(path_of("path", path))


@together_in_turn()
def solve(case: Case) -> Solution:
    """The velocities of all bodies and the forces of the fluid on them at time 0, without inertia.

    A case of a level with a flow has error bars, and is refined to its tolerance if it has one.

    Raises:
        InputError: it is no case, its level steps by itself and has no instant, or it is more than this
            machine holds.
        SolveError: the solve fails, or a check of it.
    """
    require_case(case)
    on_root(lambda: check_work(case))
    if not case.level.flow:
        return Solution(case, make_model(case)(case.configuration(), 0.0), None, case)
    solved = flow_solvers(case).solve(case)
    return Solution(solved.case, solved.solution, solved.errors, case)


@of_folder()
def run(case: Case, folder: Path | str, callback: Progress = no_progress) -> Run:
    """Move the bodies of a case in time, at its level, into a new run folder.

    Args:
        case: with a section [time].
        folder: a new one.
        callback: called with each step that is kept, whose arrays are read-only, on all ranks; an exception
            in it ends the run, which `resume` continues.

    Raises:
        InputError: the case has no [time], or the folder is not new.
        SolveError: the run cannot go on; the folder keeps the last good state.
    """
    require_case(case)
    _follow(callback, partial(run_case, case, same_folder(folder)))
    return open_run(folder)


@of_folder()
def resume(folder: Path | str, callback: Progress = no_progress, overrides: Sequence[str] = ()) -> Run:
    """Continue a run after its last complete step; a finished one is left as it is.

    Args:
        folder: of the run.
        callback: as in `run`.
        overrides: changes of the case, `["time.end=20"]`; only time.end, output.interval and output.fields
            may change. They are written into the folder.

    Raises:
        InputError: it is no run folder, a file in it is damaged, or its case has been changed since.
        SolveError: as in `run`.
    """
    _follow(callback, partial(resume_run, same_folder(folder), overrides=overrides))
    return open_run(folder)


@of_folder()
def calibrate(case: Case, folder: Path | str, processes: int = 1) -> CalibrationResult:
    """Sample a resistance as [calibration] says, fit a law, write both into a folder.

    Args:
        case: with a section [calibration].
        folder: for the law; samples that are there are not computed again, unless code has changed.
        processes: how many of this machine work on different samples.

    Raises:
        InputError: the case cannot be calibrated, the folder not be written, or there is no process.
        SolveError: a sample failed.
    """
    require_type("processes", processes, "give a whole number", right=isinstance(processes, Integral))
    if processes < 1:
        raise InputError(f"processes = {processes}: give at least 1")
    require_case(case)
    folder = same_folder(folder)
    return calibrate_case(case, case.name, folder, Sampling(folder / "samples", processes))


def _follow(callback: Progress, launch: Callable[[Progress, MakeEvolution], Any]) -> None:
    """Launch a run with a progress bar, on terminals and in notebooks."""

    def show(record: StepRecord) -> None:
        bar.show(record)
        callback(record)

    def make(case: Case) -> Evolution:
        bar.begin(case.timing.end)
        return make_evolution(case)

    require_type("callback", callback, "give a function that takes a StepRecord", right=callable(callback))
    with ProgressBar() as bar:
        launch(show, make)
