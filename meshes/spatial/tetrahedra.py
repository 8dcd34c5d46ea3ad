"""Tetrahedra in the fluid around bodies: gmsh fills it but for layers of prisms in narrow gaps of spheres."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import fsi.meshes.backend  # noqa: F401

import gmsh
import numpy as np
import scipy  # its modules load when they are used

from fsi.arrays import Indices
from fsi.meshes.cells.curved import CurvedCells, require_valid
from fsi.meshes.errors import MeshError, TouchingError
from fsi.meshes.geometry.container import FluidDomain, lengths
from fsi.meshes.geometry.curves import Sphere, rescaled
from fsi.meshes.planar.triangulate import REMEDY, StraightCells, gmsh_model, require_boundary
from fsi.meshes.resolution import Resolution
from fsi.meshes.spatial.curved_tetrahedra import RoundSurface, curve_tets
from fsi.meshes.spatial.gap_prisms import (
    CLEARANCE,
    WIDEST,
    GapPrisms,
    NarrowGap,
    choose,
    find_gaps,
    pattern,
    split_prisms,
)
from fsi.meshes.spatial.halved import halved
from fsi.meshes.spatial.local_sizes import LocalSizes
from fsi.meshes.spatial.refined import is_fine, refined, twice, volumes
from fsi.meshes.spatial.sides import choose_sides, images, with_bodies
from fsi.meshes.spatial.sizing import Spacing
from fsi.meshes.spatial.solids import ON_CURVE, add_fluid, structure
from fsi.meshes.spatial.untangle import curved_and_valid

# Elements around a body: what misses more than elements of two degrees tell is made again with smaller ones.
MENDED_FROM = 14
TRIANGLE, TETRAHEDRON = 2, 4  # as gmsh calls them
# Cells. For 250,000 Netgen takes three times as long as all else in gmsh, and a tenth off errors; for fewer
# it takes less time for each.
OPTIMISED = 100_000
# Of the smaller radius: where a gap is narrower, two layers of cells take many times the iterations of one.
NARROW = 0.01
# Of the largest radius: so far sides of a cell move where gmsh fails. It does where one is the plane of the
# seam or of a pole of its spheres, as at places on the grid of those that are tried.
ASIDE = 0.02

# Cells, round surfaces by their tags, and of a periodic domain which bodies images are.
type _Filled = tuple[StraightCells, dict[int, RoundSurface], Indices | None]


@dataclass(frozen=True, slots=True)
class StraightTetrahedra:
    """Cells of the fluid around bodies before they are curved, in units of the largest radius.

    Attributes:
        cells: of a periodic domain their tags are those of images.
        surfaces: round ones, by their tags.
        mended: whether vertices move where curved cells would not be valid.
        unit: of lengths.
        of: which bodies images are, None without periods.
        bodies: N.
    """

    cells: StraightCells
    surfaces: dict[int, RoundSurface]
    mended: bool
    unit: float
    of: Indices | None
    bodies: int

    def curved(self, order: int) -> CurvedCells:
        """Cells of an order, valid or not."""
        cells = (curved_and_valid if self.mended else curve_tets)(self.cells, self.surfaces, order)
        if self.of is not None:
            cells = replace(cells, tags=with_bodies(cells.tags, self.of, self.bodies))
        return replace(cells, nodes=self.unit * cells.nodes)


def fill(domain: FluidDomain, resolution: Resolution) -> StraightTetrahedra:
    """The fluid around bodies; arguments as for `fsi.meshes.build.build`.

    gmsh's kernel has absolute tolerances: it is given lengths in units of the largest radius, or without
    bodies of the container.

    Raises MeshError where spheres touch, or gmsh fails.
    """
    unit = float(domain.radii.max(initial=0.0)) or domain.container.size()
    centres, radii = (rescaled(x, 1.0 / unit) for x in (domain.centres, domain.radii))
    ellipsoids = tuple(body.rescaled(1.0 / unit) for body in domain.ellipsoids)
    in_units = FluidDomain(
        domain.container.scaled(1.0 / unit), centres, radii, edges=domain.edges, ellipsoids=ellipsoids
    )
    try:
        # Sizes towards edges where the flow is singular end at a growth that twice as large ones would pass.
        parted = is_fine(resolution) and not domain.edges
        made = _parted(in_units, resolution) if parted else None
        cells, surfaces, of = made or _filled(Spacing(in_units, resolution))
    except MeshError as error:
        raise error.in_units(unit) from error
    mended = resolution.cells_per_circle >= MENDED_FROM
    return StraightTetrahedra(cells, surfaces, mended, unit, of, len(domain.radii))


def _filled(asked: Spacing) -> _Filled:
    """Cells of these sizes; where gmsh fails between sides of a periodic domain, with these elsewhere."""
    try:
        return _filled_between(*_opened(asked))
    except TouchingError:
        raise
    except MeshError as error:
        if len(asked.domain.container.periods) == 0:
            raise
        spacing, of = _opened(asked, ASIDE)
        try:
            return _filled_between(spacing, of)
        except MeshError:
            raise error from None


def _filled_between(spacing: Spacing, of: Indices | None) -> _Filled:
    """Cells of these sizes, those between surfaces halved."""
    layers = choose(_gaps(spacing), spacing)
    outside = halved(_outside(spacing, layers), spacing.side_tag - 1)
    return *_completed(outside, spacing, layers), of


def _parted(domain: FluidDomain, resolution: Resolution) -> _Filled | None:
    """The cells of twice the sizes, parted; None where gaps are narrow, or these cells are not valid."""
    try:
        spacing, of = _opened(Spacing(domain, twice(resolution), parted=True))
        gaps = _gaps(spacing)
        if any(gap.width(0.0) < NARROW * gap.smallest for gap in gaps):
            return None
        layers = choose(gaps, spacing)
        coarse, surfaces = _completed(_outside(spacing, layers), spacing, layers)
        curved = curved_and_valid(coarse, surfaces, 2)
        require_valid(curved.nodes[curved.cells], 2)
    except TouchingError:
        raise
    except MeshError:
        return None
    cells = refined(curved)
    return (cells, surfaces, of) if volumes(cells.vertices, cells.cells).min() > 0.0 else None


def _opened(spacing: Spacing, aside: float = 0.0) -> tuple[Spacing, Indices | None]:
    """A periodic domain between sides, which have the tag after the last wall's; which bodies images are.

    aside: how far the sides are from where they lie best, each a little farther than the one before.
    """
    domain = spacing.domain
    if len(domain.container.periods) == 0:
        return spacing, None
    reach = 0.5 * float(domain.radii.max(initial=0.0))
    anywhere = choose_sides(domain, np.empty((0, 3)), np.empty(0))
    around = replace(spacing, domain=images(domain, anywhere, reach)[0])
    gaps = [gap for gap in find_gaps(around) if anywhere.distances(gap.middle()[None]).min() >= 0.0]
    middles = np.array([gap.middle() for gap in gaps]).reshape(-1, 3)
    sides = choose_sides(domain, middles, np.array([WIDEST / CLEARANCE * gap.smallest for gap in gaps]))
    sides = sides.moved(aside)
    every, of = images(domain, sides, reach)
    return replace(spacing, domain=every, sides=sides, of=of), of


def _gaps(spacing: Spacing) -> list[NarrowGap]:
    """Those that layers of prisms may fill, of spheres."""
    return [] if spacing.domain.ellipsoids else find_gaps(spacing)


def _completed(
    cells: StraightCells, spacing: Spacing, layers: Sequence[GapPrisms]
) -> tuple[StraightCells, dict[int, RoundSurface]]:
    """The cells with those of the layers, valid or not, and round surfaces by their tags."""
    domain = spacing.domain
    bodies: list[RoundSurface] = list(domain.ellipsoids)
    if not bodies:
        bodies = [Sphere(x, float(a)) for x, a in zip(domain.centres, domain.radii, strict=True)]
    surfaces = enumerate([*bodies, *domain.container.spheres], 1)
    spheres = {tag: sphere for tag, sphere in surfaces if sphere is not None}
    if spacing.sides is not None:
        on_sides = np.unique(cells.facets[cells.tags == spacing.side_tag])
        cells = replace(cells, vertices=spacing.sides.matched(cells.vertices, on_sides))
    for tag, sphere in spheres.items():
        on = np.unique(cells.facets[cells.tags == tag])
        cells.vertices[on] = sphere.project(cells.vertices[on])
    for layer in layers:
        cells = _with_prisms(cells, layer, spacing)
    require_boundary(cells.cells, cells.facets)
    return replace(cells, cells=_upright(cells)), spheres


def _outside(spacing: Spacing, layers: Sequence[GapPrisms]) -> StraightCells:
    """gmsh's cells of the fluid outside the layers of prisms, whose sides have the tag 0."""
    with gmsh_model():
        add_fluid(spacing, layers)
        tied = [] if spacing.sides is None else spacing.sides.tie(gmsh.model)
        sides = [face for layer in layers for face in structure(layer)]
        gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)
        gmsh.option.setNumber("Mesh.MeshSizeFromPoints", 0)
        gmsh.option.setNumber("Mesh.OptimizeThreshold", 0.5)
        _apply(spacing)
        if tied:
            _mesh_surfaces()
        gmsh.model.mesh.generate(3)
        if len(gmsh.model.mesh.getElementsByType(TETRAHEDRON)[0]) <= OPTIMISED:
            gmsh.model.mesh.optimize("Netgen")
        return _read(spacing.domain, sides, tied)


def _mesh_surfaces() -> None:
    """Surfaces alone, up to the first error: edges of a side split, but not of its image, crash gmsh.

    In space it goes on after errors: it asks for sizes within bodies too, and has its own there.
    """
    gmsh.option.setNumber("General.AbortOnError", 2)
    gmsh.model.mesh.generate(2)
    gmsh.option.setNumber("General.AbortOnError", 0)


def _apply(spacing: Spacing) -> None:
    """Make the law gmsh's sizes: by formulas, which are faster than a function, or where images are many."""
    if spacing.sides is None:
        spacing.apply()
    else:
        gmsh.model.mesh.setSizeCallback(LocalSizes(spacing))


def _read(domain: FluidDomain, sides: Sequence[int], tied: Sequence[int]) -> StraightCells:
    """gmsh's cells; each surface has the tag of the body or wall that its nodes lie on.

    sides: of layers, with the tag 0; tied: of a periodic domain, with the tag after the last wall's.
    """
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    order = np.argsort(tags)
    used, tets = np.unique(gmsh.model.mesh.getElementsByType(TETRAHEDRON)[1], return_inverse=True)
    if len(used) == 0:
        raise MeshError(f"gmsh made no tetrahedra; {REMEDY}")
    vertices = coordinates.reshape(-1, 3)[order][np.searchsorted(tags[order], used)]
    to_bodies = [body.off(vertices) for body in domain.ellipsoids] or [
        lengths(vertices - x) - a for x, a in zip(domain.centres, domain.radii, strict=True)
    ]
    away = np.abs(np.column_stack([*to_bodies, domain.container.distances(vertices)]))
    facets, values = [], []
    for _, face in gmsh.model.getEntities(2):
        corners = gmsh.model.mesh.getElementsByType(TRIANGLE, face)[1]
        mine = np.searchsorted(used, corners).astype(np.int64).reshape(-1, 3)
        tag = 0 if face in sides else away.shape[1] + 1
        if face not in sides and face not in tied:
            tag = int(away[mine.ravel()].max(axis=0).argmin()) + 1
        facets.append(mine)
        values.append(np.full(len(mine), tag))
    cells = tets.reshape(-1, 4).astype(np.int64)
    return StraightCells(vertices, cells, np.concatenate(facets), np.concatenate(values))


def _with_prisms(cells: StraightCells, layer: GapPrisms, spacing: Spacing) -> StraightCells:
    """With the prisms of a layer; its side is no boundary any more."""
    y, triangles = pattern(layer, spacing)
    inner, n = len(y) - layer.on_edge, len(cells.vertices)
    places = [layer.gap.places(y, side) for side in range(2)]
    on_side = np.unique(cells.facets[cells.tags == 0])
    tree = scipy.spatial.cKDTree(cells.vertices[on_side])
    places_of, vertices = [], [cells.vertices]
    for side in range(2):
        distance, on_edge = tree.query(places[side][inner:])
        if distance.max() > ON_CURVE * layer.rho:
            raise MeshError("gmsh moved the rim of a gap; try another discretisation.cells_per_gap")
        places_of.append(np.concatenate([n + side * inner + np.arange(inner), on_side[on_edge]]))
        vertices.append(places[side][:inner])
    below, above = places_of
    edge_places = np.arange(inner, len(y))
    u, v = np.sort([edge_places, np.roll(edge_places, -1)], axis=0)
    sides = {tuple(sorted(facet)) for facet in cells.facets[cells.tags == 0].tolist()}
    forwards = [tuple(sorted((below[i], below[j], above[j]))) in sides for i, j in zip(u, v, strict=True)]
    backwards = np.column_stack([u, v])[~np.array(forwards)]
    on_edges = np.isin(cells.facets, np.concatenate([below[inner:], above[inner:]])).all(axis=1)
    mine = on_edges & (cells.tags == 0)
    return StraightCells(
        np.concatenate(vertices),
        np.concatenate([cells.cells, split_prisms(triangles, below, above, backwards)]),
        np.concatenate([cells.facets[~mine], below[triangles], above[triangles]]),
        np.concatenate([cells.tags[~mine], *(np.full(len(triangles), tag) for tag in layer.gap.tags)]),
    )


def _upright(cells: StraightCells) -> Indices:
    """The cells, those with a negative volume mirrored."""
    mirrored = volumes(cells.vertices, cells.cells) < 0.0
    return np.where(mirrored[:, None], cells.cells[:, [0, 2, 1, 3]], cells.cells)
