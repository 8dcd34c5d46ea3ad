"""The whole boundary: nodes on bodies, on the walls of the container, and on the axis or the cut, if any."""

import numpy as np

from fsi.arrays import Array
from fsi.meshes.geometry.container import FluidDomain
from fsi.meshes.planar.opened import opened
from fsi.meshes.planar.outlines import outline_rings
from fsi.meshes.planar.rings import half_ring, rings
from fsi.meshes.planar.sizing import PIECES, Curve, Surfaces
from fsi.meshes.resolution import Resolution


def boundary(domain: FluidDomain, resolution: Resolution) -> list[Curve]:
    """All curves: bodies (tags 1 ... N), walls (N + 1 ...), and the axis or the cut with the last tag.

    Raises MeshError where a body touches another or a wall.
    """
    surfaces = Surfaces.of(domain, resolution)
    if surfaces.lattice.dimension:
        return opened(surfaces)
    every, container = range(surfaces.bodies), domain.container
    if surfaces.placed:
        around = outline_rings(surfaces, every)
    elif container.axisymmetric:
        around = [half_ring(surfaces, i) for i in every]
    else:
        around = rings(surfaces, every)
    return around + surfaces.walls(container.outline()) + (axis(surfaces) if container.axisymmetric else [])


def axis(surfaces: Surfaces) -> list[Curve]:
    """The pieces of the axis r = 0 between the bodies, with the tag after the last wall's."""
    container, order = surfaces.container, np.argsort(surfaces.centres[:, 1])
    tag = surfaces.bodies + 1 + len(container.walls)
    low, high = container.axis()
    ends = np.array([surfaces.on_axis(i)[:, 1] for i in order]).reshape(-1, 2)
    bottoms, tops = [*ends[:, 0], high], [low, *ends[:, 1]]

    def at(z: Array, _: object = None) -> Array:
        return np.column_stack([np.zeros_like(z), z])

    return [Curve(tag, at(z)) for z in surfaces.lines(at, np.column_stack([tops, bottoms]), PIECES)]
