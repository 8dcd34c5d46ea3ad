"""How gmsh's spheres must be turned so that their seams spare the prisms of narrow gaps.

A sphere of gmsh has an edge, the half circle from pole to pole at which its longitude begins. Where that
crosses the edge of a layer of prisms it splits a side of the layer, which then has five corners and cannot
be structured.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from fsi.meshes.geometry.containers import Array
from fsi.meshes.spatial.gap_prisms import GapPrisms

CLEARANCE = 0.05  # radians between a seam and an edge
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


def seam_turn(tag: int, radius: float, layers: Sequence[GapPrisms]) -> Turn:
    """How to turn the sphere with that facet tag: not at all where its seam spares the layers as it is.

    It also spares a layer around a pole, whose edge has a corner on it.
    """
    axes, widths = _caps(tag, radius, layers)
    at_pole = np.abs(axes[:, 2]) > POLE
    if _clearance(AS_IT_IS, axes[~at_pole], widths[~at_pole]) > CLEARANCE:
        return AS_IT_IS
    return max(TURNS, key=lambda turn: _clearance(turn, axes, widths))


def _caps(tag: int, radius: float, layers: Sequence[GapPrisms]) -> tuple[Array, Array]:
    """Directions of the layers on a sphere, (k, 3), and the angles from their axes to their edges, (k,)."""
    mine = [layer for layer in layers if tag in layer.gap.tags]
    signs = [1.0 if layer.gap.tags[0] == tag else -1.0 for layer in mine]
    axes = np.array([sign * layer.gap.along for sign, layer in zip(signs, mine, strict=True)]).reshape(-1, 3)
    return axes, np.arcsin(np.array([layer.rho / radius for layer in mine]))


def _clearance(turn: Turn, axes: Array, widths: Array) -> float:
    """The smallest angle between the turned seam and an edge, negative where the seam crosses it."""
    seam = Rotation.from_rotvec(turn.angle * turn.axis).apply(SEAM)
    away = np.arccos(np.clip(axes @ seam.T, -1.0, 1.0)).min(axis=1)
    return float((away - widths).min(initial=np.inf))
