"""Element sizes towards corners of the container where the flow is singular, or where a bent wall ends.

Near such a corner the flow varies over the distance r from it, so that cells must be small against r:

    h(r) = max(h_corner, GROWTH growth r),    h_corner = (growth / 2)^DEPTH distance,

where `distance` is that of the corner from what else there is, a body or wall, and `growth` the slope of
sizes away from bodies. Sizes in geometric progression cost few cells: so many for each decade. Where an open
wall meets a solid one the flow is u ~ r^0.59, and what the last cells miss of it changes a force by
h_corner^1.19: of the order growth^7, above the sixth of what cubic elements miss elsewhere. Where velocities
jump that power is 2.74. Below SMALLEST of the container's size gmsh no longer finds its way, as areas of
triangles far from the origin are rounded: of 40 boxes with cells of 1e-9 beside corners it lost a part of 14,
with cells of 1e-8 of none.

Where a wall with a shape ends in a corner, bent around the fluid, its elements may be a thirtieth of those
of the wall that it meets. Of a triangle between the corner and two of them one angle is straight once they
are curved, and it is refused. So sizes along the other wall begin with those of the bent one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fsi.arrays import Array
from fsi.meshes.geometry.container import HERE, FluidDomain
from fsi.meshes.geometry.curves import WallCurve
from fsi.meshes.geometry.placed import Placed
from fsi.meshes.resolution import Resolution

GROWTH = 2.0
DEPTH = 6
SMALLEST = 3e-8
INSIDE = 1e-6  # of the length of a piece: so far from its end it bends as it does there


@dataclass(frozen=True, slots=True)
class Grading:
    """How small elements are near corners.

    Attributes:
        corners: where they are smallest, (n, 2).
        smallest: h_corner at each, (n,).
        slope: of the size away from it.
    """

    corners: Array
    smallest: Array
    slope: float

    @staticmethod
    def of(domain: FluidDomain, growth: float) -> Grading:
        """Towards the corners of a domain, which may lie near bodies, other walls or the axis."""
        container, corners = domain.container, domain.corners
        to_walls, size = container.boundary_distances(corners), container.size()
        to_walls[to_walls < HERE * size] = np.inf  # they meet there
        to_bodies = np.linalg.norm(corners[:, None] - domain.centres, axis=2) - domain.radii
        if domain.placed and len(corners):
            to_bodies = np.column_stack([body.distance_and_bend(corners)[0] for body in domain.placed])
        distances = np.column_stack([to_walls, to_bodies]).min(axis=1, initial=size)
        smallest = np.maximum(distances * (0.5 * growth) ** DEPTH, SMALLEST * size)
        return Grading(corners, smallest, GROWTH * growth)

    @staticmethod
    def beside_bends(curves: Sequence[WallCurve], wall: int, resolution: Resolution) -> Grading:
        """Along a wall: towards ends of it where shaped pieces of others end that bend around the fluid."""
        corners, bends = list[Array](), list[float]()
        ends = [end for curve in curves if curve.wall == wall for end in curve.ends]
        for curve in curves:
            if curve.wall == wall or curve.solid is None:
                continue
            for k, corner in enumerate(curve.ends):
                meets = any(np.array_equal(corner, end) for end in ends)
                if meets and (bend := _bend_around_fluid(curve, curve.solid, k)) < np.inf:
                    corners.append(corner)
                    bends.append(bend)
        smallest = resolution.on_body(np.array(bends))
        return Grading(np.array(corners).reshape(-1, 2), smallest, GROWTH * resolution.growth)

    def sizes(self, x: Array) -> Array:
        """The largest element size at points (n, 2), infinite without corners."""
        away = np.linalg.norm(x[:, None] - self.corners, axis=2)
        sizes: Array = np.maximum(self.smallest, self.slope * away).min(axis=1, initial=np.inf)
        return sizes


def _bend_around_fluid(curve: WallCurve, solid: Placed, end: int) -> float:
    """The radius with which a shaped piece bends around the fluid at its first or last end; else infinite."""
    start, stop = curve.interval if end == 0 else curve.interval[::-1]
    t = solid.nearest(curve.at(np.array([start + INSIDE * (stop - start)])))
    return float(solid.outline.bend(t)[0]) if solid.outline.curvature(t)[0] < 0.0 else np.inf
