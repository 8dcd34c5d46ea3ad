"""How gmsh's spheres are turned so that their seams spare layers of prisms.

A sphere of gmsh has an edge, the half circle from pole to pole at which its longitude begins. Where that
crosses the edge of a layer of prisms it splits a side of the layer, which then has five corners and cannot be
structured.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy  # its modules load when they are used

from fsi.arrays import Array, Indices
from fsi.meshes.spatial.gap_prisms import GapPrisms
from fsi.meshes.spatial.sizing import Spacing

APART = 0.05  # radians between a seam and an edge
_LATITUDE = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 91)
SEAM = np.column_stack([np.cos(_LATITUDE), np.zeros(91), np.sin(_LATITUDE)])
POLE = 1.0 - 1e-12


@dataclass(frozen=True, slots=True)
class Turn:
    """A turn by an angle about an axis, (3,), through the centre of a sphere."""

    axis: Array
    angle: float


AS_IT_IS = Turn(np.array([0.0, 0.0, 1.0]), 0.0)
TURNS = [AS_IT_IS, *(Turn(axis, k * np.pi / 8.0) for axis in np.eye(3)[::-1] for k in range(1, 16))]


def seam_turns(spacing: Spacing, layers: Sequence[GapPrisms]) -> list[Turn]:
    """Of all spheres: images of one body turn alike, so that sides cut them at the same points."""
    of, radii = spacing.bodies, spacing.domain.radii
    bodies, first = np.unique(of, return_index=True)
    images = {i: np.flatnonzero(of == i) + 1 for i in bodies}
    turns = {i: seam_turn(images[i], float(radii[k]), layers) for i, k in zip(bodies, first, strict=True)}
    return [turns[i] for i in of]


def seam_turn(tags: Indices, radius: float, layers: Sequence[GapPrisms]) -> Turn:
    """How to turn a sphere and its images: not at all where their seam spares the layers as it is.

    It also spares a layer around a pole, whose edge has a corner on it.

    tags: of their facets.
    """
    axes, widths = _caps(tags, radius, layers)
    at_pole = np.abs(axes[:, 2]) > POLE
    if _clearance(AS_IT_IS, axes[~at_pole], widths[~at_pole]) > APART:
        return AS_IT_IS
    return max(TURNS, key=lambda turn: _clearance(turn, axes, widths))


def _caps(tags: Indices, radius: float, layers: Sequence[GapPrisms]) -> tuple[Array, Array]:
    """Directions of the layers on spheres, (k, 3), and the angles from their axes to their edges, (k,)."""
    # A layer between two images of one body is on both its sides.
    mine = [
        (sign, layer)
        for layer in layers
        for sign, tag in zip((1.0, -1.0), layer.gap.tags, strict=True)
        if tag in tags
    ]
    axes = np.array([sign * layer.gap.along for sign, layer in mine]).reshape(-1, 3)
    return axes, np.arcsin(np.array([layer.rho / radius for _, layer in mine]))


def _clearance(turn: Turn, axes: Array, widths: Array) -> float:
    """The smallest angle between the turned seam and an edge, negative where the seam crosses it."""
    seam = scipy.spatial.transform.Rotation.from_rotvec(turn.angle * turn.axis).apply(SEAM)
    away = np.arccos(np.clip(axes @ seam.T, -1.0, 1.0)).min(axis=1)
    return float((away - widths).min(initial=np.inf))
