"""External forces between bodies, and between bodies and walls, as laws of the gap; and gravity.

    F_i = sum_j f(d_ij) n_ij + sum_walls f(d_iw) n_iw + m_i g

d is the gap, n_ij the unit vector from body j to body i, n_iw the normal of the wall into the fluid, and
f > 0 repels. The forces of a pair are opposite. None makes a torque, as each acts along the line of centres.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.bodies.gaps import Gaps, find_gaps
from fsi.errors import InputError, SolveError
from fsi.meshes.geometry.container import Container


@dataclass(frozen=True, slots=True)
class Bulk:
    """What gravity acts on: the masses of the bodies and their volumes (in the plane areas), shape (N,)."""

    masses: Array
    volumes: Array


class ForceLaw:
    """What acts on bodies besides the fluid; a law says what is different with it."""

    def on_bodies(self, bulk: Bulk, t: float) -> Array | float:  # noqa: ARG002
        """The force on each body by itself at time t, (N, d), or 0."""
        return 0.0

    @property
    def reach(self) -> float:
        """The gap beyond which there is no force between surfaces; 0 of a law that knows none."""
        return 0.0

    def repulsion(self, d: Array) -> Array:
        """f(d), the force that pushes two bodies with the gap d apart, negative for attraction."""
        return np.zeros_like(d)

    def wall_repulsion(self, d: Array) -> Array:
        """The same between bodies and walls."""
        return np.zeros_like(d)


def separations(q: Configuration, gaps: Gaps) -> Array:
    """From body or image j to body i of the close pairs, the vectors that their gaps belong to, (P, d)."""
    return q.centres[gaps.pairs[:, 0]] - q.centres[gaps.pairs[:, 1]] - gaps.away


def external_forces(
    forces: Sequence[ForceLaw], q: Configuration, container: Container, bulk: Bulk, t: float
) -> Array:
    """The sum of all forces on each body at time t, shape (N, d); the gaps of q are positive.

    Raises SolveError: a law gives what is no finite number; InputError: numbers that are not one a body and
    component.
    """
    total = np.zeros_like(q.centres)
    for k, force in enumerate(forces):
        F = on_each_body(force, k, bulk, t, q.dimension)
        if force.reach > 0.0:
            F = F + between_bodies(force, q, container)
        total += finite(F, k, t)
    return total


def on_each_body(force: ForceLaw, k: int, bulk: Bulk, t: float, d: int) -> Array:
    """The force of the law forces.k on each body by itself at time t, (N, d).

    Raises InputError: it gives anything else, but the number 0; numpy would have taken N of N = d bodies for
    d components.
    """
    given, shape = force.on_bodies(bulk, t), (len(bulk.masses), d)
    match given:
        case np.ndarray(shape=found, dtype=numbers) if found == shape and numbers.kind in "fiu":
            return given
        case float() | int() if given == 0.0:
            return np.zeros(shape)
        case np.ndarray(shape=found, dtype=numbers):
            what = f"{numbers} of shape {found}"
        case _:
            what = f"a {type(given).__name__}"
    raise InputError(
        f"forces.{k}: {type(force).__name__}.on_bodies gives {what}; give an array of numbers of shape "
        f"{shape}, a row for each body, or 0"
    )


def finite(F: Array, k: int, t: float) -> Array:
    """What the law forces.k gives at time t. Raises SolveError: it is no finite number."""
    if not np.all(np.isfinite(F)):
        raise SolveError(
            f"forces.{k}: gives a force that is no finite number at t = {t:.9g}; correct this law for the "
            "time and the gaps there"
        )
    return F


def moment_of_forces(forces: Sequence[ForceLaw], q: Configuration, container: Container) -> Array:
    """What forces between bodies, and bodies and walls, carry across a distance: sum of r (x) F, (d, d).

    r is the vector to the body on which F acts, from the centre of the other body or from the wall.
    """
    total = np.zeros((q.dimension, q.dimension))
    for force in forces:
        if force.reach > 0.0:
            gaps = find_gaps(q, container, force.reach)
            total += np.einsum("pi,pj->ij", separations(q, gaps), _on_first(force, q, gaps))
            away = (gaps.wall_gaps + q.radii[:, None])[:, :, None] * container.normals(q.centres)
            total += np.einsum("nwi,nwj->ij", away, _from_walls(force, q, gaps, container))
    return total


def between_bodies(force: ForceLaw, q: Configuration, container: Container) -> Array:
    """Forces of one law on each body, shape (N, d)."""
    gaps = find_gaps(q, container, force.reach)
    with np.errstate(invalid="ignore"):  # infinite forces are for `finite` to refuse
        push, total = _on_first(force, q, gaps), _from_walls(force, q, gaps, container).sum(axis=1)
        np.add.at(total, gaps.pairs[:, 0], push)
        np.add.at(total, gaps.pairs[:, 1], -push)
    return total


def _on_first(force: ForceLaw, q: Configuration, gaps: Gaps) -> Array:
    """Of each pair, the force on the first body, (P, d)."""
    between = separations(q, gaps)
    unit = between / np.linalg.norm(between, axis=1, keepdims=True)
    push: Array = force.repulsion(gaps.pair_gaps)[:, None] * unit
    return push


def _from_walls(force: ForceLaw, q: Configuration, gaps: Gaps, container: Container) -> Array:
    """The force of each wall on each body, (N, walls, d)."""
    push = force.wall_repulsion(gaps.wall_gaps)
    forces: Array = push[:, :, None] * container.normals(q.centres)
    return forces
