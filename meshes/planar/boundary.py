"""The whole boundary: nodes on bodies, on the walls of the container, and on the axis or the cut, if any."""

import numpy as np

from fsi.meshes.geometry.container import Array, FluidDomain
from fsi.meshes.planar.opened import opened
from fsi.meshes.planar.outlines import outline_rings
from fsi.meshes.planar.rings import half_ring, rings
from fsi.meshes.planar.sizing import PIECES, Curve, Resolution, Surfaces


def boundary(domain: FluidDomain, resolution: Resolution) -> list[Curve]:
    """All curves: bodies (tags 1 ... N), walls (N + 1 ...), and the axis or the cut with the last tag.

    Raises MeshError where a body touches another or a wall.
    """
    surfaces = Surfaces.of(domain, resolution)
    if surfaces.lattice.dimension:
        return opened(surfaces)
    if surfaces.placed:
        return outline_rings(surfaces) + [surfaces.wall(curve) for curve in domain.container.outline()]
    every, walls = range(surfaces.bodies), domain.container.outline()
    if not domain.container.axisymmetric:
        return rings(surfaces, every) + [surfaces.wall(curve) for curve in walls]
    halves = [half_ring(surfaces, i) for i in every]
    return halves + [surfaces.wall(curve) for curve in walls] + axis(surfaces)


def axis(surfaces: Surfaces) -> list[Curve]:
    """The pieces of the axis r = 0 between the bodies, with the tag after the last wall's."""
    container, order = surfaces.container, np.argsort(surfaces.centres[:, 1])
    tag = surfaces.bodies + 1 + len(container.walls)
    low, high = container.axis()
    bottoms = [*(surfaces.centres[order, 1] - surfaces.radii[order]), high]
    tops = [low, *(surfaces.centres[order, 1] + surfaces.radii[order])]

    def at(z: Array, _: object = None) -> Array:
        return np.column_stack([np.zeros_like(z), z])

    return [Curve(tag, at(z)) for z in surfaces.lines(at, np.column_stack([tops, bottoms]), PIECES)]
