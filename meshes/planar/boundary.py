"""The whole boundary: nodes on the bodies, on the walls of the container, and on the axis if there is one."""

from __future__ import annotations

import numpy as np

from fsi.meshes.geometry.containers import Array, FluidDomain
from fsi.meshes.planar.opened import opened
from fsi.meshes.planar.sizing import PIECES, Curve, Resolution, Surfaces, half_ring, rings


def boundary(domain: FluidDomain, resolution: Resolution) -> list[Curve]:
    """All curves: bodies (tags 1 ... N), walls (N + 1 ...), and the axis or the cut with the last tag.

    Raises:
        MeshError: a body touches another or a wall.
    """
    surfaces = Surfaces.of(domain, resolution)
    if surfaces.lattice.dimension:
        return opened(surfaces)
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

    def at(z: Array) -> Array:
        return np.column_stack([np.zeros_like(z), z])

    return [
        Curve(tag, at(surfaces.line(at, start, end, PIECES)), closed=False, centre=None)
        for start, end in zip(tops, bottoms, strict=True)
    ]
