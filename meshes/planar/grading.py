"""Element sizes towards corners of the container where the flow is singular.

Near such a corner the flow varies over the distance r from it, so that cells must be small against r:

    h(r) = max(h_corner, GROWTH growth r),    h_corner = (growth / 2)^DEPTH distance,

where `distance` is that of the corner from what else there is, a body or wall, and `growth` the slope of
sizes away from bodies. Sizes in geometric progression cost few cells: so many for each decade. Where an open
wall meets a solid one the flow is u ~ r^0.59, and what the last cells miss of it changes a force by
h_corner^1.19: of the order growth^7, above the sixth of what cubic elements miss elsewhere. Where velocities
jump that power is 2.74. Below SMALLEST of the container's size gmsh no longer finds its way, as areas of
triangles far from the origin are rounded: of 40 boxes with cells of 1e-9 beside corners it lost a part of 14,
with cells of 1e-8 of none.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fsi.arrays import Array
from fsi.meshes.geometry.container import HERE, FluidDomain

GROWTH = 2.0
DEPTH = 6
SMALLEST = 3e-8


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

    def sizes(self, x: Array) -> Array:
        """The largest element size at points (n, 2), infinite without corners."""
        away = np.linalg.norm(x[:, None] - self.corners, axis=2)
        sizes: Array = np.maximum(self.smallest, self.slope * away).min(axis=1, initial=np.inf)
        return sizes
