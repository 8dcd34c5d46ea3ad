"""One gap between two surfaces: the narrowest of all, or that between two sides; how wide, and where."""

from dataclasses import dataclass

import numpy as np

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.bodies.gaps import feet_on_walls, foot_between, nearest_gaps
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.lattice import Lattice


@dataclass(frozen=True, slots=True)
class SurfaceGap:
    """A gap between a body and what is opposite.

    Attributes:
        width: the distance of the surfaces.
        middle: the point half-way, shape (d,).
        sides: what lies on both sides, numbers of bodies and then of walls.
        normal: the unit vector across it, from the first side to the second, shape (d,).
        away: how far the image of a second body that is meant lies from it, shape (d,); of a wall None.
    """

    width: float
    middle: Array
    sides: tuple[int, int]
    normal: Array
    away: Array | None = None

    @property
    def opposite(self) -> Array:
        """The point of the second side that is nearest to the first, shape (d,)."""
        return np.asarray(self.middle + 0.5 * self.width * self.normal)


def narrowest_gap(q: Configuration, container: Container) -> SurfaceGap | None:
    """The smallest of all gaps between bodies or to a wall; None of a lone body without walls."""
    gaps = nearest_gaps(q, container)
    if not np.isfinite(gaps.smallest()):
        return None
    if gaps.pair_gaps.min(initial=np.inf) == gaps.smallest():
        pair = np.argmin(gaps.pair_gaps)
        i, j = gaps.pairs[pair]
        return gap_between(q, container, (int(i), int(j)), gaps.away[pair])
    i, wall = np.unravel_index(np.argmin(gaps.wall_gaps), gaps.wall_gaps.shape)
    return gap_between(q, container, (int(i), len(q) + int(wall)))


def gap_between(
    q: Configuration, container: Container, sides: tuple[int, int], away: Array | None = None
) -> SurfaceGap:
    """The gap of body `sides[0]` to another body, or to the wall of number `sides[1] - len(q)`.

    away: how far the image of the other body that is meant lies from it; the nearest if not given.
    """
    i, j = sides
    if q.shaped:
        if j >= len(q):
            foot = feet_on_walls(q, i, container)[j - len(q)]
        else:
            images = _images_near(q, container, sides) if away is None else [away]
            feet = ((foot_between(q, i, j, e), e) for e in images)
            foot, away = min(feet, key=lambda found: found[0].gap)
        return SurfaceGap(foot.gap, 0.5 * (foot.x + foot.opposite), sides, 0.0 - foot.normal, away)
    if j < len(q):
        towards, lattice = q.centres[j] - q.centres[i], Lattice(container.periods)
        if away is None:
            away = -lattice.shift(lattice.nearest(towards[None]))[0]
        towards += away
        distance = float(np.linalg.norm(towards))
        width, normal = distance - q.radii[i] - q.radii[j], towards / distance
    else:
        x, wall = q.centres[i : i + 1], j - len(q)
        width, normal = container.distances(x)[0, wall] - q.radii[i], -container.normals(x)[0, wall]
        if not normal.any():  # in the middle of a round wall all around is as near, and the axis is z
            normal = np.eye(q.dimension)[-1 if container.axisymmetric else 0]
    reach = q.radii[i] + 0.5 * width
    return SurfaceGap(float(width), q.centres[i] + reach * normal, sides, normal, away)


def _images_near(q: Configuration, container: Container, sides: tuple[int, int]) -> Array:
    """How far those images of a body lie from it that may be nearest to another one, (n, 2)."""
    lattice, (i, j) = Lattice(container.periods), sides
    m = lattice.nearest((q.centres[i] - q.centres[j])[None])
    return lattice.shift(m + lattice.near(2.0 * float(q.radii.max())))
