"""The whole boundary: nodes on the bodies, on the walls of the container, and on the axis if there is one."""

from __future__ import annotations

from functools import partial

import numpy as np
from scipy.spatial import cKDTree

from fsi.meshes.geometry.containers import Array, Box, Container, HalfPlane, Round
from fsi.meshes.geometry.periodic import Cell, Channel
from fsi.meshes.planar.nodes_on_curves import equidistribute, resolve
from fsi.meshes.planar.opened import opened
from fsi.meshes.planar.segment import PIECES, segment, wall_size
from fsi.meshes.planar.sizing import Curve, Resolution, Surfaces, across, bodies


def boundary(container: Container, centres: Array, radii: Array, resolution: Resolution) -> list[Curve]:
    """All curves: bodies (tags 1 ... N), walls (N + 1 ...), and the axis with the last tag.

    Raises:
        MeshError: a body touches another or a wall.
    """
    if isinstance(container, Channel | Cell):
        return opened(container, centres, radii, resolution)
    surfaces = Surfaces(container, centres, radii, cKDTree(centres), len(radii))
    curves = bodies(surfaces, resolution) + walls(surfaces, resolution)
    return curves + axis(surfaces, resolution) if container.axisymmetric else curves


def walls(surfaces: Surfaces, resolution: Resolution) -> list[Curve]:
    """The container's walls with tags N + 1, ... in its order; a wall may have several pieces."""
    first = len(surfaces.radii) + 1
    match surfaces.container:
        case Box(lower=(x0, y0), upper=(x1, y1)):
            ends = {
                "left": ((x0, y1), (x0, y0)),
                "right": ((x1, y0), (x1, y1)),
                "bottom": ((x0, y0), (x1, y0)),
                "top": ((x1, y1), (x0, y1)),
            }
            return [
                segment(surfaces, resolution, first + k, np.array(ends[wall]))
                for k, wall in enumerate(surfaces.container.walls)
            ]
        case HalfPlane(radius=radius, axisymmetric=half):
            plane = segment(
                surfaces, resolution, first, np.array([[0.0 if half else -radius, 0.0], [radius, 0.0]])
            )
            return [plane, _arc(surfaces, resolution, first + 1, radius, 0.0, 0.5 * np.pi if half else np.pi)]
        case Round(radius=radius, axisymmetric=half):
            pieces = [(-0.5, 0.5)] if half else [(-0.5, 0.5), (0.5, 1.5)]
            return [_arc(surfaces, resolution, first, radius, a * np.pi, b * np.pi) for a, b in pieces]
        case other:
            raise TypeError(f"no mesh for the container {other!r}")


def axis(surfaces: Surfaces, resolution: Resolution) -> list[Curve]:
    """The pieces of the axis r = 0 between the bodies, with the tag after the last wall's."""
    container, order = surfaces.container, np.argsort(surfaces.centres[:, 1])
    tag = len(surfaces.radii) + 1 + len(container.walls)
    low, high = container.axis()
    bottoms = [*(surfaces.centres[order, 1] - surfaces.radii[order]), high]
    tops = [low, *(surfaces.centres[order, 1] + surfaces.radii[order])]
    pieces = []
    for start, end in zip(tops, bottoms, strict=True):
        z, h = resolve(partial(_axis_size, surfaces, resolution, end - start), start, end, PIECES)
        z = equidistribute(z, 1.0 / h, least=1)
        z[[0, -1]] = start, end
        pieces.append(Curve(tag, np.column_stack([np.zeros_like(z), z]), closed=False, centre=None))
    return pieces


def _axis_size(surfaces: Surfaces, resolution: Resolution, gap: float, z: Array) -> Array:
    """Element size at points of a piece of the axis, of the given length: the gap there."""
    if len(surfaces.radii) == 0:
        return np.full(len(z), 0.1 * gap)
    d = surfaces.to_bodies(np.column_stack([np.zeros_like(z), z]))
    h_body = 2.0 * np.pi * surfaces.radii.max() / resolution.cells_per_circle
    in_gap = across(np.full(len(z), gap), float(surfaces.radii.min()), resolution)
    return np.minimum(in_gap, np.maximum(h_body, resolution.growth * d))


def _arc(
    surfaces: Surfaces, resolution: Resolution, tag: int, radius: float, start: float, end: float
) -> Curve:
    """An arc around the origin between two angles, multiples of pi / 2."""

    def at(s: Array) -> Array:
        return radius * np.column_stack([np.cos(s / radius), np.sin(s / radius)])

    s, h = resolve(
        lambda s: wall_size(surfaces, resolution, at(s), 0.5 * radius), start * radius, end * radius, PIECES
    )
    nodes = at(equidistribute(s, 1.0 / h, least=8))
    # Exactly on the axes, where other curves begin.
    nodes[[0, -1]] = radius * np.round([[np.cos(a), np.sin(a)] for a in (start, end)])
    return Curve(tag, nodes, closed=False, centre=np.zeros(2))
