"""How large the tetrahedra around spheres are: element sizes from the gaps, everywhere in the fluid.

With the distances b_i of a point to the bodies and w_k to the walls,

    h = min over bodies i of (h_body_i + growth b_i),   h_body = 2 pi a / cells_per_circle,

and in gaps so narrow that it matters, min over the pairs of surfaces of h_gap(b_i + b_j), h_gap(b_i + w_k):
on a surface the argument is the distance to the other one. The flow in a narrow gap varies along it over the
lubrication length sqrt(a gap), thus

    h_gap(d) = 0.3 sqrt(a d) / cells_per_gap,   but within [0.3 d, 10 d] / cells_per_gap,

a: the smaller radius. No element is larger than a quarter of a box, or than 2 pi R / cells_per_circle in a
container of radius R; towards edges where the flow is singular they are smaller (see `grading`). The law is
said in gmsh's own language: a function in Python takes ten times as long.
"""

from dataclasses import dataclass

import numpy as np

from fsi.meshes.errors import TouchingError
from fsi.meshes.geometry.container import Array, FluidDomain, lengths
from fsi.meshes.planar.sizing import Resolution
from fsi.meshes.spatial.grading import edge_sizes
from fsi.meshes.spatial.sides import Sides

LENGTH, SHORTEST, LONGEST = 0.3, 0.3, 10.0


def in_gap(gap: Array | float, radius: Array | float, resolution: Resolution) -> Array:
    """h_gap where the gap is `gap` and the smallest radius beside it `radius`."""
    size = np.minimum(LENGTH * np.sqrt(radius * gap), LONGEST * gap)
    law: Array = np.maximum(size, SHORTEST * gap) / resolution.cells_per_gap
    return law


@dataclass(frozen=True, slots=True)
class ClosePair:
    """A gap so narrow that it has smaller elements than its bodies elsewhere.

    Attributes:
        body: i.
        other: the other body j, or N + k for wall k.
        smallest: radius of the smaller body.
    """

    body: int
    other: int
    smallest: float


@dataclass(frozen=True, slots=True)
class Spacing:
    """The law of sizes around the bodies of a domain in space; a periodic one has sides and images."""

    domain: FluidDomain
    resolution: Resolution
    sides: Sides | None = None

    def to_sides(self, x: Array) -> Array:
        """Distances of points (n, 3) from periodic sides, (n, 2 k); negative outside."""
        return np.empty((len(x), 0)) if self.sides is None else self.sides.distances(x)

    @property
    def side_tag(self) -> int:
        """Of facets on periodic sides, after those of bodies and walls."""
        return len(self.domain.radii) + len(self.domain.container.walls) + 1

    def in_gap(self, gap: Array | float, radius: float) -> Array:
        """h_gap where the gap is `gap` and the smallest radius beside it `radius`."""
        return in_gap(gap, radius, self.resolution)

    def close_pairs(self) -> list[ClosePair]:
        """All gaps where h_gap is smaller than the size on the larger body. Raises MeshError at contacts."""
        centres, radii = self.domain.centres, self.domain.radii
        close, size = [], self.resolution.on_body(radii)
        to_walls = self.domain.container.distances(centres) - radii[:, None]
        for i, (centre, a) in enumerate(zip(centres, radii, strict=True)):
            gaps = np.concatenate([lengths(centres - centre) - radii - a, to_walls[i]])
            gaps[i] = np.inf
            if gaps.min() <= 0.0:
                raise TouchingError("the sphere at {} touches a sphere or wall; move it", centre)
            smallest = np.minimum(a, np.append(radii, np.full(to_walls.shape[1], a)))
            largest = np.maximum(size[i], np.append(size, np.full(to_walls.shape[1], size[i])))
            narrow = np.flatnonzero(self.in_gap(gaps, smallest) < largest)
            close += [ClosePair(i, int(j), float(smallest[j])) for j in narrow[narrow > i]]
        return close

    def apply(self) -> None:
        """Make it gmsh's background size."""
        import gmsh  # here, as the estimate of a mesh asks for the law alone

        container, centres, radii = self.domain.container, self.domain.centres, self.domain.radii
        bodies = [
            f"(sqrt((x-({c[0]!r}))^2+(y-({c[1]!r}))^2+(z-({c[2]!r}))^2)-{a!r})"
            for c, a in zip(centres.tolist(), radii.tolist(), strict=True)
        ]
        away = [*bodies, *container.distance_formulas()]
        on_bodies = self.resolution.on_body(radii).tolist()
        growth = float(self.resolution.growth)
        sizes = [f"{h!r}+{growth!r}*{b}" for h, b in zip(on_bodies, bodies, strict=True)]
        for gap in self.close_pairs():
            d, across = f"({away[gap.body]}+{away[gap.other]})", float(self.resolution.cells_per_gap)
            along = f"min({LENGTH!r}*sqrt({gap.smallest!r}*abs({d})),{LONGEST!r}*{d})"
            sizes.append(f"max({along},{SHORTEST!r}*{d})/{across!r}")
        sizes += edge_sizes(self.domain, growth)
        sizes.append(repr(container.largest_element(self.resolution.cells_per_circle)))
        field = gmsh.model.mesh.field
        numbers = []
        for expression in sizes:
            numbers.append(field.add("MathEval"))
            field.setString(numbers[-1], "F", expression)
        smallest = field.add("Min")
        field.setNumbers(smallest, "FieldsList", numbers)
        field.setAsBackgroundMesh(smallest)
