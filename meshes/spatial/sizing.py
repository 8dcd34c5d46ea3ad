"""How large the tetrahedra around spheres are: element sizes from the gaps, everywhere in the fluid.

With the distances b_i of a point to the bodies and w_k to the walls,

    h = min over bodies i of (h_body_i + growth b_i),   h_body = 2 pi a / cells_per_circle,

and in gaps so narrow that it matters, min over the pairs of surfaces of h_gap(b_i + b_j), h_gap(b_i + w_k):
on a surface the argument is the distance to the other one. The flow in a narrow gap varies along it over the
lubrication length sqrt(a gap), thus

    h_gap(d) = 0.3 sqrt(a d) / cells_per_gap,   but within [0.3 d, 10 d] / cells_per_gap,

a: the smaller radius. No element is larger than a quarter of a box's diagonal, or 2 pi R / cells_per_circle
in a container of radius R; towards edges where the flow is singular they are smaller (see `grading`). The law
is said in gmsh's own language: a function in Python takes ten times as long.

Around ellipsoids a is the radius 1 / H of the mean curvature, and b the distance to first order: with a point
y before space is stretched by the half axes a_k, k = |y|, and p = k / |y_k / a_k|,

    b = p (k - 1),      H = p^3 (sum a_k^2 - sum (a_k y_k / k)^2) / (2 prod a_k^2).

Their gaps have no layers of prisms, nor have those of spheres to a cylinder, which is not round about the
line of the shortest distance: cells there are at most ELONGATED times as long as the gap is wide.
"""

from dataclasses import dataclass

import numpy as np

from fsi.arrays import Array, Indices
from fsi.meshes.errors import TouchingError
from fsi.meshes.geometry.container import FluidDomain, lengths
from fsi.meshes.geometry.ellipsoid import PlacedEllipsoid
from fsi.meshes.geometry.wall_feet import feet_in_space
from fsi.meshes.resolution import Resolution
from fsi.meshes.spatial.grading import edge_sizes
from fsi.meshes.spatial.sides import Sides

LENGTH, SHORTEST, LONGEST = 0.3, 0.3, 10.0
# Of gaps without prisms: cells' lengths, and the least width over a half axis, which cases are checked for.
# As a gap is a difference, one that was meant to be as wide may be less by rounding.
ELONGATED, NARROWEST = 1.5, 0.02 * (1.0 - 1e-9)


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
        longest: what lengths of cells over the width of the gap do not exceed.
    """

    body: int
    other: int
    smallest: float
    longest: float = LONGEST

    @property
    def layered(self) -> bool:
        """Whether a layer of prisms may fill it."""
        return self.longest == LONGEST


@dataclass(frozen=True, slots=True)
class Spacing:
    """The law of sizes around the bodies of a domain in space; a periodic one has sides and images.

    of: whose images its spheres are, (n,), where it has images. parted: whether each cell becomes eight.
    """

    domain: FluidDomain
    resolution: Resolution
    sides: Sides | None = None
    of: Indices | None = None
    parted: bool = False

    @property
    def largest(self) -> float:
        """What no cell exceeds, nor half of one that is parted."""
        times = 2 if self.parted else 1
        return times * self.domain.container.largest_element(times * self.resolution.cells_per_circle)

    @property
    def bodies(self) -> Indices:
        """Of which body each sphere is an image, (n,)."""
        return np.arange(len(self.domain.radii)) if self.of is None else self.of

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
        if self.domain.ellipsoids:
            return self._close_ellipsoids()
        centres, radii = self.domain.centres, self.domain.radii
        close, size = [], self.resolution.on_body(radii)
        to_walls = self.domain.container.distances(centres) - radii[:, None]
        longest = np.append(np.full(len(radii), LONGEST), self._longest_at_walls())
        for i, (centre, a) in enumerate(zip(centres, radii, strict=True)):
            gaps = np.concatenate([lengths(centres - centre) - radii - a, to_walls[i]])
            gaps[i] = np.inf
            if gaps.min() <= 0.0:
                raise TouchingError("the sphere at {} touches a sphere or wall; move it", centre)
            if gaps[longest == ELONGATED].min(initial=np.inf) < NARROWEST * a:
                what = f"to a cylinder is below {NARROWEST:g} of its radius"
                raise TouchingError(f"the gap of the sphere at {{}} {what}; widen it", centre)
            smallest = np.minimum(a, np.append(radii, np.full(to_walls.shape[1], a)))
            largest = np.maximum(size[i], np.append(size, np.full(to_walls.shape[1], size[i])))
            narrow = np.flatnonzero(self.in_gap(gaps, smallest) < largest)
            close += [ClosePair(i, int(j), float(smallest[j]), float(longest[j])) for j in narrow[narrow > i]]
        return close

    def _longest_at_walls(self) -> list[float]:
        """Of each wall, what `ClosePair.longest` is at it."""
        round_about = [s is None or s.bends_all_ways for s in self.domain.container.spheres]
        return [LONGEST if layered else ELONGATED for layered in round_about]

    def _close_ellipsoids(self) -> list[ClosePair]:
        """The same of ellipsoids; `smallest` is the smallest half axis. Raises MeshError at narrow gaps."""
        every, container, close = self.domain.ellipsoids, self.domain.container, list[ClosePair]()
        for i, body in enumerate(every):
            feet = [body.gap_to(other) for other in every[i + 1 :]] + feet_in_space(body, container)
            for j, foot in enumerate(feet, i + 1):  # from the last body on, walls
                least = min(float(each.form.half_axes.min()) for each in (body, *every[j : j + 1]))
                if foot.gap <= 0.0:
                    raise TouchingError("the ellipsoid at {} touches a body or wall; move it", body.centre)
                if foot.gap < NARROWEST * least:
                    what = f"is below {NARROWEST:g} of its smallest half axis"
                    raise TouchingError(f"a gap of the ellipsoid at {{}} {what}; widen it", body.centre)
                if self.in_gap(foot.gap, least) < self.resolution.on_body(body.form.radius):
                    close.append(ClosePair(i, j, least, ELONGATED))
        return close

    def apply(self) -> None:
        """Make it gmsh's background size."""
        import gmsh  # here, as the estimate of a mesh asks for the law alone

        container, centres, radii = self.domain.container, self.domain.centres, self.domain.radii
        bodies = [
            f"(sqrt((x-({c[0]!r}))^2+(y-({c[1]!r}))^2+(z-({c[2]!r}))^2)-{a!r})"
            for c, a in zip(centres.tolist(), radii.tolist(), strict=True)
        ]
        on_bodies = [repr(h) for h in self.resolution.on_body(radii).tolist()]
        if self.domain.ellipsoids:
            pairs = [_formulas(body) for body in self.domain.ellipsoids]
            bodies = [distance for distance, _ in pairs]
            on_bodies = [f"{self.resolution.on_body(1.0)!r}*{bend}" for _, bend in pairs]
        away = [*bodies, *container.distance_formulas()]
        growth = float(self.resolution.growth)
        sizes = [f"{h}+{growth!r}*{b}" for h, b in zip(on_bodies, bodies, strict=True)]
        for gap in self.close_pairs():
            d, across = f"({away[gap.body]}+{away[gap.other]})", float(self.resolution.cells_per_gap)
            along = f"min({LENGTH!r}*sqrt({gap.smallest!r}*abs({d})),{gap.longest!r}*{d})"
            sizes.append(f"max({along},{SHORTEST!r}*{d})/{across!r}")
        sizes += edge_sizes(self.domain, growth, self.largest)
        sizes.append(repr(self.largest))
        field = gmsh.model.mesh.field
        numbers = []
        for expression in sizes:
            numbers.append(field.add("MathEval"))
            field.setString(numbers[-1], "F", expression)
        smallest = field.add("Min")
        field.setNumbers(smallest, "FieldsList", numbers)
        field.setAsBackgroundMesh(smallest)


def _formulas(body: PlacedEllipsoid) -> tuple[str, str]:
    """The distance to an ellipsoid and 1 / H where it is nearest, in x, y, z."""
    rows, a = body.rotation.T / body.form.half_axes[:, None], body.form.half_axes.tolist()
    from_centre = [f"({s}-({c!r}))" for s, c in zip("xyz", body.centre.tolist(), strict=True)]
    y = ["+".join(f"({w!r})*{r}" for w, r in zip(row, from_centre, strict=True)) for row in rows.tolist()]
    squares = [f"({part})^2" for part in y]
    k = f"sqrt({'+'.join(squares)})"
    p = f"({k}/sqrt({'+'.join(f'{s}/{ak**2!r}' for s, ak in zip(squares, a, strict=True))}))"
    nearest = "+".join(f"{ak**2!r}*{s}" for s, ak in zip(squares, a, strict=True))
    twice, total = 2.0 * float(np.prod(np.square(a))), float(np.sum(np.square(a)))
    bend = f"({twice!r}/({p}^3*({total!r}-({nearest})/{k}^2)))"
    return f"({p}*({k}-1))", f"min({body.form.radius!r},{bend})"
