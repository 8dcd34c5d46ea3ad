"""The solids that gmsh's kernel cuts the fluid out of, and the sides of layers of prisms."""

from collections.abc import Sequence
from itertools import pairwise

import fsi.meshes.backend  # noqa: F401

import gmsh
import numpy as np

from fsi.meshes.errors import MeshError
from fsi.meshes.geometry.container import lengths
from fsi.meshes.geometry.ellipsoid import PlacedEllipsoid
from fsi.meshes.spatial.gap_prisms import GapPrisms
from fsi.meshes.spatial.seams import seam_turns
from fsi.meshes.spatial.sizing import Spacing

OVERLAP = 0.25  # how far a layer's cylinder enters either surface, in radii of the smaller body
ON_CURVE = 1e-5  # of a layer's radius: where gmsh's intersections lie


def add_fluid(spacing: Spacing, layers: Sequence[GapPrisms]) -> None:
    """The container without the bodies and the cylinders of the layers."""
    occ, holes, domain = gmsh.model.occ, [], spacing.domain
    whole = domain.container.solid(occ) if spacing.sides is None else spacing.sides.solid(occ)
    holes += [(3, _add_ellipsoid(body)) for body in domain.ellipsoids]
    if not domain.ellipsoids:
        for x, a, turn in zip(domain.centres, domain.radii, seam_turns(spacing, layers), strict=True):
            holes.append((3, occ.addSphere(*x, a)))
            if turn.angle:
                occ.rotate(holes[-1:], *x, *turn.axis, turn.angle)
    holes += [(3, _add_cylinder(layer)) for layer in layers]
    if holes:
        occ.cut([(3, whole)], holes)
    occ.synchronize()


def _add_ellipsoid(body: PlacedEllipsoid) -> int:
    """The unit sphere, stretched, turned and moved."""
    occ = gmsh.model.occ
    solid, angle = [(3, occ.addSphere(0.0, 0.0, 0.0, 1.0))], float(np.linalg.norm(body.angle))
    occ.dilate(solid, 0.0, 0.0, 0.0, *body.form.half_axes)
    if angle > 0.0:
        occ.rotate(solid, 0.0, 0.0, 0.0, *(body.angle / angle), angle)
    occ.translate(solid, *body.centre)
    return int(solid[0][1])


def _add_cylinder(layer: GapPrisms) -> int:
    """The cylinder of a layer, its side in four quarters as gmsh's structured surfaces have four corners."""
    occ, gap = gmsh.model.occ, layer.gap
    below, above = (float(height) for height in gap.heights(layer.rho))
    overlap = OVERLAP * gap.smallest
    foot = gap.centre + (below - overlap) * gap.along
    quarters, axes = pairwise(0.5 * np.pi * k for k in range(5)), (list(gap.along), list(gap.frame()[0]))
    arcs = [occ.addCircle(*foot, layer.rho, -1, start, end, *axes) for start, end in quarters]
    disc = occ.addPlaneSurface([occ.addCurveLoop(arcs)])
    occ.synchronize()
    solid = occ.extrude([(2, disc)], *((above - below + 2.0 * overlap) * gap.along))
    return next(int(tag) for dimension, tag in solid if dimension == 3)


def structure(layer: GapPrisms) -> list[int]:
    """One row of triangles on the side of a layer; returns the faces of the side."""
    gap, segments = layer.gap, {}
    heights = [float(height) for height in gap.heights(layer.rho)]
    for _, curve in gmsh.model.getEntities(1):
        (low,), (high,) = gmsh.model.getParametrizationBounds(1, curve)
        x = gmsh.model.getValue(1, curve, [low, 0.5 * (low + high), high]).reshape(3, 3) - gap.centre
        z = x @ gap.along
        from_axis = lengths(x - z[:, None] * gap.along)
        if np.abs(from_axis - layer.rho).max() > ON_CURVE * layer.rho:
            continue
        if min(abs(z[1] - height) for height in heights) < ON_CURVE * layer.rho:
            segments[curve] = layer.on_edge // 4
        elif heights[0] < z[1] < heights[1]:
            segments[curve] = 1
    for curve, number in segments.items():
        gmsh.model.mesh.setTransfiniteCurve(curve, number + 1)
    sides = []
    for _, face in gmsh.model.getEntities(2):
        bounds = {abs(curve) for _, curve in gmsh.model.getBoundary([(2, face)], oriented=False)}
        if bounds <= set(segments) and 1 in {segments[curve] for curve in bounds}:
            gmsh.model.mesh.setTransfiniteSurface(face)
            sides.append(face)
    if len(sides) != 4:
        remedy = "raise discretisation.cells_per_gap"
        raise MeshError(f"the gap at {{}} has no room for its cells; {remedy}", gap.middle())
    return sides
