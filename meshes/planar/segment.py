"""Straight walls: nodes by their distance to the bodies."""

from __future__ import annotations

import numpy as np

from fsi.meshes.geometry.containers import Array
from fsi.meshes.planar.nodes_on_curves import equidistribute, resolve
from fsi.meshes.planar.sizing import Curve, Resolution, Surfaces, across

PIECES = 64  # to begin with


def wall_size(surfaces: Surfaces, resolution: Resolution, x: Array, longest: float) -> Array:
    """Element size at points of a wall."""
    if len(surfaces.radii) == 0:
        return np.full(len(x), longest)
    d = surfaces.to_bodies(x)
    h_body = 2.0 * np.pi * surfaces.radii.max() / resolution.cells_per_circle
    a = float(surfaces.radii.min())
    return np.minimum(
        np.minimum(across(d, a, resolution), np.maximum(h_body, resolution.growth * d)), longest
    )


def segment(surfaces: Surfaces, resolution: Resolution, tag: int, ends: Array) -> Curve:
    """A straight wall from ends[0] to ends[1]."""
    length = float(np.hypot(*(ends[1] - ends[0])))
    along = (ends[1] - ends[0]) / length
    s, h = resolve(
        lambda s: wall_size(surfaces, resolution, ends[0] + s[:, None] * along, 0.25 * length),
        0.0,
        length,
        PIECES,
    )
    s = equidistribute(s, 1.0 / h, least=4)
    nodes = ends[0] + s[:, None] * along
    nodes[[0, -1]] = ends
    return Curve(tag, nodes, closed=False, centre=None)
