"""How large the tetrahedra around spheres are: element sizes from the gaps, everywhere in the fluid.

With the distances b_1 <= b_2 of a point to the two nearest bodies and w to the nearest wall, the gap that it
lies in is `b_1 + min(b_2, w)`: on a surface that is the distance to the next one. The size there is

    h = min(h_gap(gap), min over bodies of (h_body + growth b)),   h_body = 2 pi a / cells_per_circle,

where h_gap follows the lubrication length sqrt(a gap), over which the flow in a narrow gap varies,

    h_gap(d) = 0.3 sqrt(a d) / cells_per_gap,   but within [0.3 d, 10 d] / cells_per_gap.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshes.geometry import Array, Container
from meshes.sizing import Resolution

LENGTH, SHORTEST, LONGEST = 0.3, 0.3, 10.0
WITHOUT_BODIES = 0.1  # of the container's size
NARROWEST = 1e-12  # of the container's size: rounding must not give the size 0


@dataclass(frozen=True, slots=True)
class Spacing:
    """The law of sizes around bodies with centres (N, 3) and radii (N,)."""

    container: Container
    centres: Array
    radii: Array
    resolution: Resolution

    def around(self) -> Array:
        """Size of the elements on each body without neighbours, (N,)."""
        size: Array = 2.0 * np.pi * self.radii / self.resolution.cells_per_circle
        return size

    def at(self, x: Array) -> float:
        """Element size at one point (3,)."""
        if len(self.radii) == 0:
            return WITHOUT_BODIES * self.container.size()
        away = np.sqrt(((self.centres - x) ** 2).sum(axis=1)) - self.radii
        far = (self.around() + self.resolution.growth * np.maximum(away, 0.0)).min()
        nearest, *others = np.argsort(away, kind="stable")[:2]
        gap, radius = away[nearest] + self.container.distances(x[None]).min(), self.radii[nearest]
        for other in others:
            if away[nearest] + away[other] < gap:
                gap, radius = away[nearest] + away[other], min(radius, self.radii[other])
        gap = max(gap, NARROWEST * self.container.size())
        return float(min(self.in_gap(gap, radius), far))

    def in_gap(self, gap: Array | float, radius: float) -> Array:
        """h_gap where the gap is `gap` and the smallest radius beside it `radius`."""
        size = np.minimum(LENGTH * np.sqrt(radius * gap), LONGEST * gap)
        law: Array = np.maximum(size, SHORTEST * gap) / self.resolution.cells_per_gap
        return law
