"""The surfaces that bound the fluid: discs, fluid discs, plane walls, a round container."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.errors import InputError, SolveError
from fsi.meshes.geometry.container import Container

Bodies = NDArray[np.int64]

DISC, WALL, CONTAINER = 0, 1, 2


class NoPoresError(SolveError):
    """No pores fill the fluid between some surfaces; whoever knows the case says their names."""

    def __init__(self, problem: str, *sides: int) -> None:
        """A problem, with {} in place of its sides, which are as by `BoundingSurfaces.side`."""
        self.problem, self.sides = problem, sides
        super().__init__(self.between([]))

    def between(self, names: Sequence[str]) -> str:
        """The problem, with the names of bodies and then of walls; without these by numbers."""
        known = dict(enumerate(names)) | {-1: "circles of fluid"}
        called = list(dict.fromkeys(known.get(k, f"surface {k}") for k in self.sides))
        return self.problem.format(" and ".join([", ".join(called[:-1]), *called[-1:]][len(called) < 2 :]))


class Shapes(NamedTuple):
    """What compiled loops see of surfaces: always two periods, of which those that are missing are 0.

    The radius of a container is -R, so that |x - centre| = rho + radius holds for the centre x of a circle of
    radius rho that touches a disc from outside or a container from inside.
    """

    kind: NDArray[np.int8]
    centre: Array
    radius: Array
    normal: Array
    periods: Array


@dataclass(frozen=True, slots=True, eq=False)
class BoundingSurfaces:
    """What bounds the fluid, B surfaces: first discs, then fluid discs, then walls or a container.

    Attributes:
        kind: DISC (fluid outside a circle), WALL (straight) or CONTAINER (fluid inside a circle), (B,).
        centre: of the circle; of a wall a point on it, (B, 2).
        radius: of the circle, 0 for walls, (B,).
        normal: of walls, unit, into the fluid; 0 for circles, (B, 2).
        fluid: whether it is a circle of fluid rather than a body, (B,).
        periods: vectors that carry all onto itself, rows, (P, 2), P = 0, 1, 2.
        hollow: whether psi is free on bodies and walls, and bodies have nothing inside (`complement`).
    """

    kind: NDArray[np.int8]
    centre: Array
    radius: Array
    normal: Array
    fluid: NDArray[np.bool_]
    periods: Array
    hollow: bool = False

    def __len__(self) -> int:
        """Number of surfaces B."""
        return len(self.kind)

    @property
    def free(self) -> NDArray[np.bool_]:
        """On which psi is free, (B,)."""
        return ~self.fluid & self.hollow

    @property
    def discs(self) -> int:
        """Number of discs and fluid discs; they come first."""
        return int(np.count_nonzero(self.kind == DISC))

    @property
    def bounds(self) -> int:
        """Number of walls and containers."""
        return len(self) - self.discs

    @property
    def area(self) -> float:
        """Of a cell, or of a channel between its two walls; infinite elsewhere."""
        if len(self.periods) == 2:
            return abs(float(np.linalg.det(self.periods)))
        if len(self.periods) == 0:
            return float("inf")
        low, high = self.centre[-2:]
        return float(np.linalg.norm(self.periods[0])) * abs(float(self.normal[-1] @ (high - low)))

    @property
    def fraction(self) -> float:
        """Of the area of a cell or channel, what bodies have; 1 elsewhere, where it tells nothing."""
        body = (self.kind == DISC) & ~self.fluid
        return float(np.pi * np.sum(self.radius[body] ** 2)) / self.area if len(self.periods) else 1.0

    def side(self, surface: int) -> int:
        """A surface as a position in the bodies followed by walls; -1 of a circle of fluid."""
        bodies = self.discs - int(np.count_nonzero(self.fluid))
        if self.fluid[surface]:
            return -1
        return int(surface) if surface < bodies else int(surface) - self.discs + bodies

    def shapes(self) -> Shapes:
        """What compiled loops see of them."""
        radius = np.where(self.kind == CONTAINER, -self.radius, self.radius)
        periods = np.zeros((2, 2))
        periods[: len(self.periods)] = self.periods
        return Shapes(self.kind, self.centre, radius, self.normal, periods)

    def with_fluid(self, centre: Array, radius: Array) -> BoundingSurfaces:
        """These and more fluid discs, centres (n, 2) and radii (n,), behind those that there are."""
        n, at = len(radius), np.full(len(radius), self.discs)
        return BoundingSurfaces(
            np.insert(self.kind, at, DISC),
            np.insert(self.centre, at, centre, axis=0),
            np.insert(self.radius, at, radius),
            np.insert(self.normal, at, np.zeros((n, 2)), axis=0),
            np.insert(self.fluid, at, values=True),
            self.periods,
        )

    def only(self, some: NDArray[np.bool_]) -> BoundingSurfaces:
        """Some of them, (B,)."""
        parts = (self.kind[some], self.centre[some], self.radius[some], self.normal[some], self.fluid[some])
        return BoundingSurfaces(*parts, self.periods)


def surfaces_of(q: Configuration, container: Container) -> BoundingSurfaces:
    """The discs of a configuration and the walls of its container.

    Raises InputError where pores are not made for such a container.
    """
    _require_pores(q, container)
    middle = np.atleast_2d(container.middle)
    centre, normal, radius, kind = [q.centres], [np.zeros_like(q.centres)], [q.radii], [DISC] * len(q)
    inward = container.normals(middle)[0]
    reach = container.distances(middle)[0]
    for sphere, n, distance in zip(container.spheres, inward, reach, strict=True):
        flat = sphere is None
        kind.append(WALL if flat else CONTAINER)
        centre.append(middle - distance * n if sphere is None else np.atleast_2d(sphere.centre))
        normal.append(n[None] if flat else np.zeros((1, 2)))
        radius.append(np.array([0.0 if sphere is None else sphere.radius]))
    return BoundingSurfaces(
        np.array(kind, np.int8),
        np.concatenate(centre),
        np.concatenate(radius),
        np.concatenate(normal),
        np.zeros(len(kind), bool),
        np.asarray(container.periods, float).reshape(-1, 2),
    )


def _require_pores(q: Configuration, container: Container) -> None:
    """Pores fill what walls or periods close on all sides, in the plane."""
    if q.dimension != 2 or container.dimension != 2 or container.axisymmetric:
        raise InputError('model = "pores": pores are made in the plane; give geometry = "planar"')
    walls, periods = container.spheres, len(container.periods)
    closed = (len(walls), periods) in {(0, 2), (2, 1), (4, 0)} and not any(walls)
    if not closed and not (len(walls) == 1 and all(walls) and periods == 0):
        raise InputError(
            f'model = "pores": no pores are made in a {type(container).__name__}; give a box, a round '
            "container, a channel or a cell"
        )
