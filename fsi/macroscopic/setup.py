"""From a case to matter on a line: the parcels at time 0, the force on them, the bodies that they are."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fsi.bodies.configuration import Array, Configuration
from fsi.case.case import Case
from fsi.case.checks.macroscopic import line_of
from fsi.case.formula import evaluate
from fsi.case.section import toml_text
from fsi.case.series import value_at
from fsi.errors import InputError, SolveError
from fsi.macroscopic.model import Force, Parcels, at_rest_in_memory, blocks


@dataclass(frozen=True, slots=True)
class Line:
    """Matter on a line.

    Attributes:
        parcels: at time 0.
        force: the force per mass f(x, m, t) on parcels.
        bodies: the rigid bodies that they make up, if the case gives such.
    """

    parcels: Parcels
    force: Force
    bodies: BodiesOnLine | None


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
        gaps = np.diff(parcels.X)[np.diff(self.of_parcel) != 0] - parcels.dm
        return float(gaps.min(initial=np.inf))


def matter(case: Case) -> Line:
    """The line of a case: its blocks, or its bodies. Raises InputError."""
    return _of_blocks(case) if case.macroscopic.blocks else _of_bodies(case)


def _of_blocks(case: Case) -> Line:
    given = case.macroscopic.blocks
    pieces = [(block.left, block.right, block.density) for block in given]
    m, dm, X = blocks(pieces, case.macroscopic.parcels)
    u = X.copy()
    for i, block in enumerate(given):
        inside = (block.left <= X) & (block.right >= X)
        u[inside] = evaluate(block.initial_velocity, X, x=X, m=m)[inside]
        if not np.isfinite(u[inside]).all():
            key = f"macroscopic.blocks.{i}.initial_velocity = {toml_text(block.initial_velocity)}"
            raise InputError(f"{key}: is not finite in all of the block; give a formula that is")
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

    return Line(at_rest_in_memory(m, dm, X, u), force, None)


def _of_bodies(case: Case) -> Line:
    """Each body is a stretch of density 1 as long as its diameter, under its own force over its mass."""
    q, axis, masses = case.configuration(), line_of(case), case.masses()
    assert masses is not None  # checked with the case
    order = np.argsort(q.centres[:, axis])
    centres, radii = q.centres[order, axis], q.radii[order]
    pieces = [(float(x - a), float(x + a), 1.0) for x, a in zip(centres, radii, strict=True)]
    m, dm, X = blocks(pieces, case.macroscopic.parcels)
    ends = np.cumsum(2.0 * radii)
    of_parcel = order[np.minimum(np.searchsorted(ends, m), len(radii) - 1)]
    mass = masses[:, axis]

    def per_mass(_x: Array, _m: Array, t: float) -> Array:
        F = np.array([value_at(body.loads[axis], t) for body in case.bodies])
        accelerations: Array = (F / mass)[of_parcel]
        return accelerations

    u = case.initial_velocity()[of_parcel, axis]
    bodies = BodiesOnLine(q, axis, of_parcel, lambda t: case.motion(t).F)
    return Line(at_rest_in_memory(m, dm, X, u), per_mass, bodies)
