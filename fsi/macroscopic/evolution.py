"""A macroscopic run: from a case to matter on a line, its steps, its profiles as a table and for ParaView."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.case.case import Case
from fsi.case.checks.macroscopic import line_of, past_walls
from fsi.case.macroscopic import evaluate
from fsi.case.section import toml_text
from fsi.case.series import polynomial
from fsi.errors import InputError, SolveError
from fsi.integration.evolution import CsvTable, Moment
from fsi.integration.state import Schedule, State, StepRecord
from fsi.macroscopic.model import Force, Parcels, blocks
from fsi.parallel import on_root
from fsi.run_folder.paraview import write_polyline
from fsi.run_folder.rows import PROFILE_COLUMNS

_FASTEST = 1e150  # velocities up to this have squares


@dataclass(frozen=True, slots=True)
class Line:
    """Matter on a line.

    Attributes:
        parcels: at time 0.
        force: `(t0, t1) ->` the force per mass f(x, m, t) on parcels that a step from t0 to t1 takes.
        bodies: the rigid bodies that they make up, if the case gives such.
        mass_per_length: of matter at density 1; parcels have the length for their mass, as blocks do.
    """

    parcels: Parcels
    force: Callable[[float, float], Force]
    bodies: BodiesOnLine | None = None
    mass_per_length: float = 1.0


@dataclass(frozen=True, slots=True)
class BodiesOnLine:
    """Bodies as stretches of density 1.

    Attributes:
        q: where they are at time 0.
        axis: along which they stand.
        of_parcel: the body of each parcel, shape (n,).
        load: t -> external loads (N, M).
    """

    q: Configuration
    axis: int
    of_parcel: NDArray[np.intp]
    load: Callable[[float], Array]

    def mean(self, values: Array) -> Array:
        """The mean of the parcels' values over each body, (N,)."""
        mean: Array = np.bincount(self.of_parcel, values) / np.bincount(self.of_parcel)
        return mean

    def at(self, X: Array) -> Configuration:
        """The configuration when parcels are at X."""
        centres = self.q.centres.copy()
        centres[:, self.axis] = self.mean(X)
        return Configuration(centres, self.q.angles, self.q.radii)

    def smallest_gap(self, parcels: Parcels) -> float:
        """Between neighbours; infinite for one body."""
        return smallest_gap(parcels, np.diff(self.of_parcel) != 0)


def smallest_gap(parcels: Parcels, some: NDArray[np.bool_] | None = None) -> float:
    """Between neighbours, or some of these (n - 1,); 0 in contact, infinite without any."""
    gaps = parcels.gaps
    rounding = 8.0 * np.finfo(float).eps * np.abs(parcels.slack).max()
    least = float((gaps if some is None else gaps[some]).min(initial=np.inf))
    return 0.0 if least <= rounding else least


def matter(case: Case) -> Line:
    """The line of a case: its blocks, or its bodies. Raises InputError."""
    return _of_blocks(case) if case.macroscopic.blocks else _of_bodies(case)


def _of_blocks(case: Case) -> Line:
    given = case.macroscopic.blocks
    pieces = [(block.left, block.right, block.density) for block in given]
    parcels, of_parcel = blocks(pieces, case.macroscopic.parcels)
    X, m = parcels.X, parcels.m
    u = np.empty_like(X)
    for i, block in enumerate(given):
        inside = of_parcel == i  # not by X: rounding may put a parcel past the end of its block
        u[inside] = evaluate(block.initial_velocity, X, x=X, m=m)[inside]
        if not (np.abs(u[inside]) <= _FASTEST).all():
            key = f"macroscopic.blocks.{i}.initial_velocity = {toml_text(block.initial_velocity)}"
            raise InputError(
                f"{key}: is not finite, or above {_FASTEST:g}, in the block; give another formula"
            )
    formula = case.macroscopic.force_per_mass

    def force(x: Array, m: Array, t: float) -> Array:
        f = evaluate(formula, x, x=x, m=m, t=t)
        if not np.isfinite(f).all():
            at = f"x = {x[~np.isfinite(f)][0]:.6g}, t = {t:.6g}"
            raise SolveError(
                f"macroscopic.force_per_mass = {toml_text(formula)}: is not finite at {at}; change the "
                "formula"
            )
        return f

    return Line(parcels.moving(u), lambda _t0, _t1: force)


def _of_bodies(case: Case) -> Line:
    """Each body is a stretch of density 1 as long as its diameter, under its own force over its mass.

    A step takes the mean of it, `1/(t1 - t0) int F dt / m`, so that no pulse of a table is lost.
    """
    q, axis, masses = case.configuration(), line_of(case), case.masses()
    assert masses is not None  # checked with the case
    order = np.argsort(q.centres[:, axis])
    centres, radii = q.centres[order, axis], q.radii[order]
    pieces = [(float(x - a), float(x + a), 1.0) for x, a in zip(centres, radii, strict=True)]
    parcels, piece = blocks(pieces, case.macroscopic.parcels)
    of_parcel = order[piece]
    mass = masses[:, axis]

    impulses = [polynomial(body.loads[axis], case.timing.end).antiderivative() for body in case.bodies]

    def per_mass(t0: float, t1: float) -> Force:
        F = np.array([float(impulse(t1) - impulse(t0)) for impulse in impulses]) / (t1 - t0)
        accelerations: Array = (F / mass)[of_parcel]
        return lambda _x, _m, _t: accelerations

    u = case.initial_velocity()[of_parcel, axis]
    bodies = BodiesOnLine(q, axis, of_parcel, lambda t: case.motion(t).F)
    return Line(parcels.moving(u), per_mass, bodies, float(mass[0] / (2.0 * q.radii[0])))


PROFILES = "profiles.csv"
NO_BODIES = Configuration.unturned(np.empty((0, 2)), np.empty(0))


class MacroscopicEvolution:
    """Steps a macroscopic case, as an `fsi.integration.evolution.Evolution`: the parcels are its memory."""

    def __init__(self, case: Case) -> None:
        """A case with [time]. Raises InputError."""
        self.case = case
        self.line = matter(case)
        self.parcels = self.line.parcels
        self.schedule = Schedule(case.timing.end, (), case.output.interval)
        self._step = case.timing.step or case.timing.end

    def start(self) -> Moment:
        """The moment at time 0. Raises SolveError: velocities are too large for numbers."""
        return self._moment(0.0, 0, 0.0)

    def advance(self, state: State) -> Moment:
        """One step. Raises SolveError: a force or what it does is not finite, or a body is past a wall."""
        t_end = self.schedule.landing(state.t, self._step)
        h, force = t_end - state.t, self.line.force(state.t, t_end)
        with np.errstate(over="ignore", invalid="ignore"):  # the moment says what is not finite
            self.parcels = self.parcels.advance(force, state.t, h)
        bodies = self.line.bodies
        if bodies and (past := past_walls(self.case, bodies.at(self.parcels.X), t_end)) is not None:
            raise SolveError(past)
        return self._moment(t_end, state.step + 1, h)

    def memory(self) -> dict[str, NDArray[Any]]:
        """The parcels."""
        return {"slack": self.parcels.slack, "u": self.parcels.u, "w": self.parcels.w}

    def restore(self, memory: Mapping[str, NDArray[Any]]) -> None:
        """Take back what `memory` gave."""
        slack, u, w = memory["slack"], memory["u"], memory["w"]
        self.parcels = replace(self.parcels, slack=slack, u=u, w=w)

    def _moment(self, t: float, step: int, h: float) -> Moment:
        parcels, mass_per_length = self.parcels, self.line.mass_per_length
        columns = totals(parcels, mass_per_length)
        for name, value in columns.items():
            if not np.isfinite(value):
                raise SolveError(
                    f"macroscopic: {name} is not finite at t = {t:.9g}; give smaller forces or velocities"
                )
        bodies = self.line.bodies
        if bodies is None:
            q, U, F = NO_BODIES, np.empty((0, 3)), np.empty((0, 3))
            gap = smallest_gap(parcels)
        else:
            q, gap, F = bodies.at(parcels.X), bodies.smallest_gap(parcels), bodies.load(t)
            U = np.zeros_like(F)
            U[:, bodies.axis] = bodies.mean(parcels.u)
        record = StepRecord(step, t, h, gap, 0, q, U, F, columns)
        state = State(t, step, q, U, self._step)
        write = partial(_write, step, parcels, mass_per_length)
        tables = partial(_tables, step, t, parcels, mass_per_length)
        return Moment(state, record, self.case.names, write, tables)


def totals(parcels: Parcels, mass_per_length: float) -> dict[str, float]:
    """What a step tells of all parcels; not finite where they have run out of numbers."""
    mass = mass_per_length * parcels.dm
    with np.errstate(all="ignore"):
        return {
            "largest_density": float(parcels.density.max()),
            "smallest_gamma": mass_per_length * float(parcels.gamma.min()),
            "momentum": float(parcels.u.sum() * mass),
            "kinetic_energy": 0.5 * float((parcels.u**2).sum() * mass),
        }


def profile(parcels: Parcels, mass_per_length: float) -> dict[str, NDArray[np.float64]]:
    """Density, velocity and gamma at the middles of parcels, shapes (n,).

    rho: dm over half the distance to both neighbours; at free ends to the one there is.
    """
    widths = parcels.dm + parcels.gaps
    room = 0.5 * (np.append(widths[0], widths) + np.append(widths, widths[-1]))
    gamma = 0.5 * (parcels.gamma[1:] + parcels.gamma[:-1])
    return {"rho": parcels.dm / room, "u": parcels.u, "gamma": mass_per_length * gamma}


def _tables(step: int, t: float, parcels: Parcels, mass_per_length: float) -> dict[str, CsvTable]:
    columns = profile(parcels, mass_per_length).values()
    numbers = np.column_stack([mass_per_length * parcels.m, parcels.X, *columns])
    return {PROFILES: (PROFILE_COLUMNS, [[step, t, *row] for row in numbers.tolist()])}


def _write(step: int, parcels: Parcels, mass_per_length: float, folder: Path) -> dict[str, Sequence[str]]:
    name = f"profile_{step:06d}.vtu"
    on_root(lambda: write_polyline(folder / name, parcels.X[:, None], profile(parcels, mass_per_length)))
    return {"profile": [name]}
