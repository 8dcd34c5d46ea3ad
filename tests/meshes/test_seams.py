"""Seams of gmsh's spheres spare the prisms of narrow gaps."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fsi.arrays import Array
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.container import FluidDomain
from fsi.meshes.resolution import Resolution
from fsi.meshes.spatial.gap_prisms import GapPrisms, choose, find_gaps
from fsi.meshes.spatial.seams import APART, AS_IT_IS, SEAM, seam_turn
from fsi.meshes.spatial.sizing import Spacing
from tests.meshes.spheres import mesh

BOX = Box((-3.0, -3.0, -3.0), (3.0, 3.0, 3.0))
RADII = [1.0, 0.5]
GAP = 0.01


def pair(direction: Array) -> Array:
    """Centres of two spheres with a narrow gap between them, the second in that direction."""
    return np.array([np.zeros(3), (sum(RADII) + GAP) * direction / np.linalg.norm(direction)])


def layers(centres: Array) -> list[GapPrisms]:
    spacing = Spacing(FluidDomain(BOX, centres, np.array(RADII)), Resolution(1.0, 14, 1.0))
    return choose(find_gaps(spacing), spacing)


@pytest.mark.parametrize(
    "direction", [[1.0, 0.0, 0.3], [-1.0, 0.05, 0.3], [0.02, 0.01, 1.0], [1.0, 0.1, 0.0]]
)
def test_no_rim_crosses_a_seam(direction: list[float]) -> None:
    """As they are, the seam of one of the two spheres would cross the rim."""
    found = layers(pair(np.array(direction)))
    assert len(found) == 1
    turned = 0
    for tag, sign in ((1, 1.0), (2, -1.0)):
        turn = seam_turn(np.array([tag]), RADII[tag - 1], found)
        turned += turn is not AS_IT_IS
        seam = Rotation.from_rotvec(turn.angle * turn.axis).apply(SEAM)
        nearest = np.arccos(np.clip(sign * seam @ found[0].gap.along, -1.0, 1.0)).min()
        assert nearest - np.arcsin(found[0].rho / RADII[tag - 1]) > APART
    assert turned > 0


def test_spheres_are_left_as_they_are_where_nothing_crosses() -> None:
    """Away from the seam, without any gap, and around a pole, where a corner of the rim lies on it."""
    for direction in ([0.0, 1.0, 0.2], [0.0, 0.0, 1.0]):
        found = layers(pair(np.array(direction)))
        assert seam_turn(np.array([1]), 1.0, found) is AS_IT_IS
    assert seam_turn(np.array([1]), 1.0, []) is AS_IT_IS


def test_a_gap_on_the_seam_is_meshed() -> None:
    """gmsh made no tetrahedra: a side of the layer of prisms had five corners."""
    assert mesh(BOX, pair(np.array([1.0, 0.05, 0.3])), RADII, Resolution(1.0, 12, 1.0)).quality > 0.1


def test_a_seam_is_turned_as_far_as_it_takes() -> None:
    """Gaps on the equator at 0, 22.5 and 45 degrees: a seam that passes there is in the way of one of them.

    Turns about z by one or two eighths of 180 degrees end on the second and third gap, and about x and y the
    seam still passes the first.
    """
    angles = np.array([0.0, 1.0, 2.0]) * np.pi / 8.0
    around = 1.18 * np.column_stack([np.cos(angles), np.sin(angles), np.zeros(3)])
    centres, radii = np.vstack([np.zeros(3), around]), np.array([1.0, 0.17, 0.17, 0.17])
    spacing = Spacing(FluidDomain(BOX, centres, radii), Resolution(1.0, 14, 1.0))
    found = [layer for layer in choose(find_gaps(spacing), spacing) if 1 in layer.gap.tags]
    assert len(found) == 3
    turn = seam_turn(np.array([1]), 1.0, found)
    seam = Rotation.from_rotvec(turn.angle * turn.axis).apply(SEAM)
    for layer in found:
        towards = layer.gap.along if layer.gap.tags[0] == 1 else -layer.gap.along
        nearest = np.arccos(np.clip(seam @ towards, -1.0, 1.0)).min()
        assert nearest - np.arcsin(layer.rho) > APART
