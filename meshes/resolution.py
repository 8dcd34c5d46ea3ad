"""How fine a mesh is: the element sizes on bodies and in gaps.

On a body without neighbours `h_body = 2 pi a / cells_per_circle`. The flow in a narrow gap is a polynomial
across it and varies along it over the lubrication length sqrt(a gap), so that is what a cell must resolve:

    h_gap(d) = 0.11 sqrt(a d) / cells_per_gap,   but within [0.3 d, 4 d] / cells_per_gap,
                                                 and no less than 0.04 sqrt(a d) / cells_per_gap.

With cells_per_gap = 1 that is one cell across a gap of 0.012 a, three across gaps above 0.13 a; in narrower
gaps cells are longer than wide. One cell across leaves an error of the force of order 4 in h / sqrt(a d):
below gaps of 1e-4 a the last bound keeps it at some 1e-6, and the number of cells grows only like log(a/d).
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from fsi.arrays import Array

LENGTH, SHORTEST = 0.11, 0.3
FINEST = 0.04  # element size along the narrowest gaps, over sqrt(a d)
LONGEST = 4.0  # element size over the gap, as gmsh is shown it


@dataclass(frozen=True, slots=True)
class Resolution:
    """How fine a mesh is.

    Attributes:
        cells_per_gap: elements across a gap of 0.012 radii.
        cells_per_circle: elements around an isolated body.
        growth: element size over the distance to the nearest body, far from all bodies; twice that over the
            distance to a singular corner.
        interior: "graded", where sizes in the fluid go over smoothly into those on the boundary, or in the
            plane "sparse", where those hold on the boundary alone. In a suspension of area fraction 0.4
            sparse meshes have a fifth fewer unknowns for an error of 5e-4 of the apparent viscosity.
    """

    cells_per_gap: float = 1.0
    cells_per_circle: int = 48
    growth: float = 0.2
    interior: Literal["graded", "sparse"] = "graded"

    def on_body[T: (float, Array)](self, radius: T) -> T:
        """h_body, the element size on a body without neighbours."""
        return 2.0 * np.pi * radius / self.cells_per_circle

    def across(self, gap: Array | float, radius: Array | float) -> Array:
        """h_gap where the gap is `gap` and the smallest radius beside it `radius`."""
        along = np.sqrt(radius * gap)
        longest = np.maximum(LONGEST * gap, FINEST * along)
        size: Array = np.clip(LENGTH * along, SHORTEST * gap, longest)
        size /= self.cells_per_gap
        return size

    def opened(self, gap: Array, radius: Array | float) -> Array:
        """By how much a gap is opened for gmsh: no cell there is longer than LONGEST times its width."""
        gap = np.minimum(gap, radius)  # without a neighbour it is infinite
        missing: Array = np.maximum(self.across(gap, radius) / LONGEST - gap, 0.0)
        return missing
