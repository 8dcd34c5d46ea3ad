"""Nested meshes: every triangle split in four, new boundary vertices put on their circles."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import fsi.meshes.backend  # noqa: F401

import numpy as np

from fsi.bodies.configuration import Configuration
from fsi.meshes.build import FluidMesh, shared
from fsi.meshes.cells.curved import curve
from fsi.meshes.geometry.container import Container, FluidDomain
from fsi.meshes.planar.boundary import boundary
from fsi.meshes.planar.sizing import Curve
from fsi.meshes.planar.triangulate import StraightCells, triangulate
from fsi.meshes.resolution import Resolution


def nested_meshes(
    container: Container, q: Configuration, resolution: Resolution, order: int, levels: int
) -> Iterator[FluidMesh]:
    """The mesh of a resolution and its refinements, each with half the cell size."""
    domain = FluidDomain(container, q.centres, q.radii)
    curves = boundary(domain, resolution)
    straight = triangulate(curves)
    for level in range(levels):
        if level > 0:
            straight = refine(straight, curves)
        yield shared({"": partial(curve, straight, curves, order)}, domain)


def refine(straight: StraightCells, curves: list[Curve]) -> StraightCells:
    """Split every triangle by the midpoints of its sides."""
    vertices, triangles = straight.vertices, straight.cells
    edges, tags = straight.facets, straight.tags
    sides = np.stack([triangles[:, [1, 2]], triangles[:, [0, 2]], triangles[:, [0, 1]]], axis=1)
    unique, number = np.unique(np.sort(sides.reshape(-1, 2), axis=1), axis=0, return_inverse=True)
    middle = len(vertices) + number.reshape(-1, 3)
    midpoints = vertices[unique].mean(axis=1)
    keys = unique @ [len(vertices), 1]
    on = np.searchsorted(keys, np.sort(edges, axis=1) @ [len(vertices), 1])
    for piece in curves:
        if piece.centre is not None:
            mine = on[tags == piece.tag]
            from_centre = midpoints[mine] - piece.centre
            radius = np.hypot(*(piece.nodes[0] - piece.centre))
            midpoints[mine] = piece.centre + radius * from_centre / np.hypot(*from_centre.T)[:, None]
    a, b, c = triangles.T
    m, n, o = middle.T
    split = np.concatenate([np.column_stack(t) for t in ((a, o, n), (o, b, m), (n, m, c), (m, n, o))])
    middles = len(vertices) + on
    halves = np.concatenate(
        [np.column_stack([edges[:, 0], middles]), np.column_stack([middles, edges[:, 1]])]
    )
    return StraightCells(np.concatenate([vertices, midpoints]), split, halves, np.concatenate([tags, tags]))
