"""How gmsh's spheres must be turned so that their seams spare the plugs of narrow gaps.

A sphere of gmsh has an edge, the half circle from pole to pole at which its longitude begins. Where that
crosses the rim of a plug it splits a side of the plug, which then has five corners and cannot be structured.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from fsi.meshes.geometry.containers import Array
from fsi.meshes.spatial.gap_prisms import Plug

CLEARANCE = 0.05  # radians between a seam and a rim
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


def seam_turn(tag: int, radius: float, plugs: Sequence[Plug]) -> Turn:
    """How to turn the sphere with that facet tag: not at all where its seam spares the plugs as it is.

    It also spares a plug around a pole, whose rim has a corner on it.
    """
    axes, widths = _caps(tag, radius, plugs)
    at_pole = np.abs(axes[:, 2]) > POLE
    if _clearance(AS_IT_IS, axes[~at_pole], widths[~at_pole]) > CLEARANCE:
        return AS_IT_IS
    return max(TURNS, key=lambda turn: _clearance(turn, axes, widths))


def _caps(tag: int, radius: float, plugs: Sequence[Plug]) -> tuple[Array, Array]:
    """Directions of the plugs on a sphere, (k, 3), and the angles from their axes to their rims, (k,)."""
    mine = [plug for plug in plugs if tag in plug.gap.tags]
    signs = [1.0 if plug.gap.tags[0] == tag else -1.0 for plug in mine]
    axes = np.array([sign * plug.gap.along for sign, plug in zip(signs, mine, strict=True)]).reshape(-1, 3)
    return axes, np.arcsin(np.array([plug.rho / radius for plug in mine]))


def _clearance(turn: Turn, axes: Array, widths: Array) -> float:
    """The smallest angle between the turned seam and a rim, negative where the seam crosses it."""
    seam = Rotation.from_rotvec(turn.angle * turn.axis).apply(SEAM)
    away = np.arccos(np.clip(axes @ seam.T, -1.0, 1.0)).min(axis=1)
    return float((away - widths).min(initial=np.inf))
