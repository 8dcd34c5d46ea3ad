"""Resistance matrices: against direct solves, exact solutions, and on several ranks."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.case.load import parse_case
from fsi.lubrication import exact
from fsi.meshes.build import FluidMesh
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.round import Round
from fsi.meshes.resolution import Resolution
from fsi.observables.resistance import Resistance, difference
from fsi.stokes.problem import Boundary, StokesProblem
from fsi.stokes.resistance import case_resistance, held_at_rest, resistance_with_error, solve_resistance
from fsi.stokes.solve import solve
from tests.flows import (
    HALF_PLANE,
    SMALL_BOX,
    at_rest,
    disc_over_plane,
    discs,
    free,
    held,
    mesh,
    resting,
)

MU = 0.7
THREE = discs([(-1.8, -0.6), (-0.2, 0.3), (1.6, -0.4)], [0.8, 0.6, 1.0])
NAMES = ("first", "middle", "last")
OPEN = Boundary({"bottom": at_rest}, {"left": 0.0, "right": 0.0, "top": 0.0})


@pytest.fixture(scope="module")
def fluid() -> FluidMesh:
    return mesh(SMALL_BOX, THREE, Resolution(0.7, 20, 0.4))


@pytest.fixture(scope="module")
def three(fluid: FluidMesh) -> Resistance:
    return solve_resistance(held_at_rest(fluid, SMALL_BOX, THREE, MU), NAMES)


def at_default(container: Container, q: Configuration, names: tuple[str, ...]) -> Resistance:
    """At mu = 1."""
    return solve_resistance(held_at_rest(mesh(container, q), container, q), names)


def all_together(q: Configuration, V: tuple[float, float], omega: float) -> Array:
    """Velocities (N, 3) of bodies that move as one rigid body around the origin."""
    x, y = q.centres.T
    return np.column_stack([V[0] - omega * y, V[1] + omega * x, np.full(len(q), omega)])


def test_labels(three: Resistance) -> None:
    assert three.modes.velocities[:4] == ("first.V_x", "first.V_y", "first.omega", "middle.V_x")
    assert three.modes.loads[-3:] == ("last.F_x", "last.F_y", "last.T")


def test_symmetric_positive_and_all_identities(three: Resistance) -> None:
    assert three.R.shape == (9, 9)
    assert_allclose(three.R, three.R.T, rtol=0, atol=0)
    assert three.eigenvalues[0] > 1.0
    assert set(three.checks) == {
        "power", "momentum", "angular_momentum", "net_flux", "residual", "reciprocity",
    }  # fmt: skip
    assert max(three.checks.values()) < 1e-11


@pytest.mark.parametrize("boundary", [resting(SMALL_BOX), OPEN], ids=["closed", "open"])
def test_columns_are_direct_solves(fluid: FluidMesh, boundary: Boundary) -> None:
    """To 1e-12 of the largest possible entry; open walls stay open."""
    found = solve_resistance(held_at_rest(fluid, SMALL_BOX, THREE, MU, tuple(boundary.pressures)), NAMES)
    motions = (held(*unit.reshape(3, 3)) for unit in np.eye(9))
    direct = np.column_stack(
        [solve(StokesProblem(fluid, SMALL_BOX, THREE, motion, boundary, MU)).F.ravel() for motion in motions]
    )
    assert difference(found.R, direct, found.modes.scale) < 1e-12


def test_dissipation_of_a_common_rigid_motion(fluid: FluidMesh, three: Resistance) -> None:
    """U.R.U = 2 mu int e:e; without the couplings between the bodies it is 2.3 times as much."""
    U = all_together(THREE, (0.4, -0.3), 0.8)
    direct = solve(StokesProblem(fluid, SMALL_BOX, THREE, held(*U), resting(SMALL_BOX), MU))
    assert U.ravel() @ three.R @ U.ravel() == pytest.approx(direct.dissipation, rel=1e-11)
    alone = sum(u @ three.R[k : k + 3, k : k + 3] @ u for u, k in zip(U, (0, 3, 6), strict=True))
    assert alone > 2.0 * direct.dissipation


def test_mobility_moves_free_bodies(fluid: FluidMesh, three: Resistance) -> None:
    F = np.array([[0.0, -1.0, 0.2], [0.5, 0.0, 0.0], [0.0, 0.3, -0.4]])
    U = solve(StokesProblem(fluid, SMALL_BOX, THREE, free(*F), resting(SMALL_BOX), MU)).U
    assert three.mobility is not None
    assert_allclose((three.mobility @ F.ravel()).reshape(3, 3), U, rtol=0, atol=1e-11 * np.abs(U).max())


@pytest.mark.parametrize("gap", [1.0, 0.1, 1e-3])
def test_disc_beside_a_plane(gap: float) -> None:
    """Jeffrey and Onishi 1981: a diagonal matrix. The leading normal force alone is 10 % off at gap 0.1."""
    found = at_default(HALF_PLANE, disc_over_plane(gap), ("disc",))
    laws = (exact.parallel_resistance, exact.normal_resistance, exact.rotation_resistance)
    expected = np.diag([float(law(gap, 1.0, 1.0)) for law in laws])
    assert difference(found.R, expected, found.modes.scale) < 1e-4


@pytest.mark.parametrize("gap", [1.0, 1e-2])
def test_two_discs_far_from_walls(gap: float) -> None:
    """The pair's closed form along the line of centres; R_11 alone gives twice as much at a small gap."""
    q = discs([(-1.0 - gap / 2, 0.0), (1.0 + gap / 2, 0.0)], [1.0, 1.0])
    R = at_default(Box((-1000.0, -1000.0), (1000.0, 1000.0)), q, ("a", "b")).R
    expected = float(exact.pair_resistance(gap, 1.0, 1.0))
    assert 0.5 * (R[0, 0] - R[0, 3]) == pytest.approx(expected, rel=1e-4)
    assert R[0, 3] == R[3, 0]
    # Mirrored in the x axis, F_x stays and the others change sign; in the y axis the bodies change places.
    assert np.abs(R[np.ix_([0, 3], [1, 2, 4, 5])]).max() < 1e-4 * R[0, 0]
    mirror = np.kron([[0.0, 1.0], [1.0, 0.0]], np.diag([-1.0, 1.0, -1.0]))
    assert_allclose(mirror @ R @ mirror, R, rtol=0, atol=1e-5 * R[0, 0])


def test_two_spheres_have_one_mode_each() -> None:
    """Maude 1961 at gap 0.1 a: half the difference of R_11 and R_12 is the drag of an approach."""
    rows = json.loads((Path(__file__).parents[1] / "reference" / "two_spheres.json").read_text())["rows"]
    expected = next(row["approach"] for row in rows if row["gap_over_a"] == 0.1)
    found = at_default(Round(500.0, axisymmetric=True), discs([(0, -1.05), (0, 1.05)], [1, 1]), ("a", "b"))
    assert found.modes.velocities == ("a.V_z", "b.V_z")
    assert found.modes.loads == ("a.F_z", "b.F_z")
    assert (found.R[0, 0] - found.R[0, 1]) / (6.0 * np.pi) == pytest.approx(expected, rel=1e-5)
    assert found.checks["reciprocity"] < 1e-9


def test_without_a_wall_at_rest_there_is_no_mobility(fluid: FluidMesh) -> None:
    """Rigid motions of everything need no load; all other motions do."""
    found = solve_resistance(held_at_rest(fluid, SMALL_BOX, THREE, open_walls=SMALL_BOX.walls), NAMES)
    assert found.mobility is None
    for V, omega in (((1.0, 0.0), 0.0), ((0.0, 1.0), 0.0), ((0.0, 0.0), 1.0)):
        load = found.R @ all_together(THREE, V, omega).ravel()
        assert np.abs(load).max() < 1e-9 * found.eigenvalues[-1]
    assert found.eigenvalues[3] > 1.0


def test_the_tolerance_of_a_case_holds_its_resistance_matrix() -> None:
    """By default meshes as coarse as these err by 3e-4; the error is that against a finer mesh."""
    data: dict[str, Any] = {
        "name": "one disc",
        "fluid": {"viscosity": MU},
        "domain": {"lower": [-2.0, 0.0], "upper": [2.0, 4.0]},
        "bodies": [{"name": "disc", "radius": 1.0, "position": [0.3, 1.2]}],
        "discretisation": {"cells_per_circle": 8, "growth": 1.0, "cells_per_gap": 0.3},
    }
    finer = {"cells_per_circle": 24, "growth": 0.4, "cells_per_gap": 1.0}
    fine = case_resistance(parse_case(data | {"discretisation": finer}))
    for tolerance in (None, 1e-4):
        given = data["discretisation"] | ({} if tolerance is None else {"tolerance": tolerance})
        found = resistance_with_error(parse_case(data | {"discretisation": given}))
        true = difference(found.resistance.R, fine.R, fine.modes.scale)
        assert true < found.error < 4.0 * true
        for entries, finer_entries, bars in (
            (found.resistance.R, fine.R, found.errors.R),
            (found.resistance.mobility, fine.mobility, found.errors.mobility),
        ):
            assert entries is not None
            assert finer_entries is not None
            assert bars is not None
            ratios = np.abs(entries - finer_entries) / bars
            assert np.all(ratios < 1.0)
            assert np.median(ratios) > 0.5
        assert (found.error > 1e-4) if tolerance is None else (found.error <= tolerance)
