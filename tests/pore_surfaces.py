"""Arrangements whose exact values are known, as surfaces."""

import json
from pathlib import Path

import numpy as np

from fsi.arrays import Array
from fsi.bodies.configuration import Motion
from fsi.pores.solve import PoreFlow, PoreLoading, solve_pores
from fsi.pores.surfaces import CONTAINER, DISC, WALL, BoundingSurfaces
from fsi.pores.system import PoreSystem

REFERENCE = Path(__file__).parent / "reference"


def channel(centres: Array, radii: Array, length: float, height: float) -> BoundingSurfaces:
    """Discs between walls at y = 0 and y = height, periodic along x."""
    N = len(centres)
    kind = np.array([DISC] * N + [WALL] * 2, np.int8)
    centre = np.vstack([centres, [[0.0, 0.0], [0.0, height]]])
    normal = np.vstack([np.zeros((N, 2)), [[0.0, 1.0], [0.0, -1.0]]])
    radius = np.concatenate([radii, [0.0, 0.0]])
    return BoundingSurfaces(kind, centre, radius, normal, np.zeros(N + 2, bool), np.array([[length, 0.0]]))


def cell(centres: Array, radii: Array, vectors: Array) -> BoundingSurfaces:
    """Discs in a cell with these lattice vectors."""
    N = len(centres)
    zero = np.zeros((N, 2))
    return BoundingSurfaces(
        np.zeros(N, np.int8), np.asarray(centres), radii, zero, np.zeros(N, bool), vectors
    )


def box(centres: Array, radii: Array, lower: Array, upper: Array) -> BoundingSurfaces:
    """Discs in a closed box."""
    N, (x, y), (X, Y) = len(centres), lower, upper
    kind = np.array([DISC] * N + [WALL] * 4, np.int8)
    centre = np.vstack([centres, [[x, y], [X, y], [X, Y], [x, Y]]])
    normal = np.vstack([np.zeros((N, 2)), [[0.0, 1.0], [-1.0, 0.0], [0.0, -1.0], [1.0, 0.0]]])
    radius = np.concatenate([radii, np.zeros(4)])
    return BoundingSurfaces(kind, centre, radius, normal, np.zeros(N + 4, bool), np.zeros((0, 2)))


def round_container(centres: Array, radii: Array, radius: float) -> BoundingSurfaces:
    """Discs in a round container about the origin."""
    N = len(centres)
    kind = np.array([DISC] * N + [CONTAINER], np.int8)
    centre, own = np.vstack([centres, [[0.0, 0.0]]]), np.append(radii, radius)
    return BoundingSurfaces(kind, centre, own, np.zeros((N + 1, 2)), np.zeros(N + 1, bool), np.zeros((0, 2)))


def couette() -> tuple[BoundingSurfaces, Array, float]:
    """Ten discs in shear, with (U_x, U_y, omega) of each and the apparent viscosity, to 1e-9."""
    data = json.loads((REFERENCE / "couette_N10.json").read_text())
    surfaces = channel(np.array(data["centers"]), np.ones(10), data["L"], data["H"])
    answer = data["answer"]
    return surfaces, np.array(answer["U_V_x_V_y_omega"]), answer["apparent_viscosity"]


def square_array(c: float) -> BoundingSurfaces:
    """One disc of radius 1 in a square cell, area fraction c."""
    return cell(np.array([[0.1, 0.2]]), np.ones(1), np.eye(2) * np.sqrt(np.pi / c))


def free(N: int, F: Array | None = None) -> Motion:
    """Free bodies under loads F."""
    return Motion(np.zeros((N, 3), bool), np.zeros((N, 3)), np.zeros((N, 3)) if F is None else F)


def sheared(system: PoreSystem, height: float) -> PoreFlow:
    """Free bodies between walls at speeds -height / 2 and height / 2."""
    walls = np.array([[-0.5 * height, 0.0, 0.0], [0.5 * height, 0.0, 0.0]])
    return solve_pores(system, PoreLoading(free(system.bodies), walls, np.zeros((2, 2))))


def resistance(system: PoreSystem, walls: int) -> Array:
    """R of all modes by unit motions, (3 N, 3 N)."""
    N, rows = system.bodies, []
    for unit in np.eye(3 * N):
        motion = Motion(np.ones((N, 3), bool), unit.reshape(N, 3), np.zeros((N, 3)))
        loading = PoreLoading(motion, np.zeros((walls, 3)), np.zeros((2, 2)))
        rows.append(solve_pores(system, loading).F.ravel())
    return np.array(rows)
