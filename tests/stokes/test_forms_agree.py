"""Differential tests: saddle-point form with multiplier against eliminated form, and invariances."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fsi.bodies.configuration import Configuration, Inertia, Motion
from fsi.meshes.geometry.box import Box
from fsi.meshes.resolution import Resolution
from fsi.stokes.problem import Boundary, SolverOptions, StokesProblem
from fsi.stokes.solution import StokesSolution
from fsi.stokes.solve import solve
from tests.flows import SMALL_BOX, at_rest, discs, free, held, mesh, resting, shear, solved

COARSE = Resolution(0.7, 14, 0.5)
TWO = discs([(-1.2, -0.3), (1.1, 0.4)], [0.8, 1.0])
LID = Boundary({**resting(SMALL_BOX).velocities, "top": lambda x: np.tile([1.0, 0.0], (len(x), 1))}, {})
OPEN = Boundary({"bottom": at_rest, "top": at_rest}, {"left": 3.0, "right": 0.0})
# Held in x, free in y and in rotation; and the other way round, with every kind of load.
MIXED = Motion(
    np.array([[True, False, False], [False, True, False]]),
    np.array([[0.5, 0.0, 0.0], [0.0, -0.25, 0.0]]),
    np.array([[0.0, -2.0, 1.0], [1.5, 0.0, -0.5]]),
)
MOTIONS = {
    "free": free((0.0, -1.0, 0.2), (0.3, 0.0, 0.0)),
    "held": held((1.0, 0.0, 0.0), (0.0, 1.0, 1.0)),
    "mixed": MIXED,
}


def solutions(
    motion: Motion, boundary: Boundary, inertia: Inertia | None = None
) -> tuple[StokesSolution, StokesSolution]:
    fluid = mesh(SMALL_BOX, TWO, COARSE)
    problem = StokesProblem(fluid, SMALL_BOX, TWO, motion, boundary, 0.7, inertia)
    eliminated, multiplier = (
        solve(problem, SolverOptions(formulation=form)) for form in ("eliminated", "multiplier")
    )
    return eliminated, multiplier


@pytest.mark.parametrize("name", MOTIONS)
@pytest.mark.parametrize("boundary", [LID, OPEN], ids=["lid", "open"])
def test_multiplier_and_eliminated_form_agree(name: str, boundary: Boundary) -> None:
    """U, the nodal tractions lambda, loads and pressure, to 1e-9 of their size; a wrong sign in K gives 1."""
    eliminated, multiplier = solutions(MOTIONS[name], boundary)
    for field in ("U", "F", "traction_F"):
        a, b = getattr(eliminated, field), getattr(multiplier, field)
        assert_allclose(a, b, rtol=0, atol=1e-9 * np.abs(a).max(), err_msg=field)
    scale = np.abs(eliminated.surface.reaction).max()
    assert_allclose(eliminated.surface.reaction, multiplier.surface.reaction, rtol=0, atol=1e-9 * scale)
    assert_allclose(eliminated.flow.p, multiplier.flow.p, rtol=0, atol=1e-9 * np.abs(eliminated.flow.p).max())
    assert eliminated.dissipation == pytest.approx(multiplier.dissipation, rel=1e-9)


def test_both_forms_agree_with_inertia() -> None:
    """And satisfy F = F_ext - D (U - U0) to rounding."""
    D, U0 = np.array([[5.0, 5.0, 2.0]] * 2), np.array([[0.1, -0.2, 0.3]] * 2)
    motion = MOTIONS["free"]
    eliminated, multiplier = solutions(motion, LID, Inertia(D, U0))
    assert_allclose(eliminated.U, multiplier.U, atol=1e-10)
    for solution in (eliminated, multiplier):
        assert_allclose(solution.F, motion.F - D * (solution.U - U0), atol=1e-9)


def test_loads_and_given_velocities_come_out_as_they_went_in() -> None:
    for solution in solutions(MIXED, LID):
        held_modes = MIXED.held
        assert_allclose(solution.U[held_modes], MIXED.U[held_modes], atol=1e-14)
        assert_allclose(solution.F[~held_modes], MIXED.F[~held_modes], atol=1e-9)


def test_mobility_inverts_resistance() -> None:
    """Free bodies under the loads that held bodies needed move as those did."""
    motion = held((0.3, -0.2, 0.5), (-0.4, 0.1, 0.2))
    fluid = mesh(SMALL_BOX, TWO, COARSE)
    F = solve(StokesProblem(fluid, SMALL_BOX, TWO, motion, LID)).F
    U = solve(StokesProblem(fluid, SMALL_BOX, TWO, free(*F), LID)).U
    assert_allclose(U, motion.U, atol=1e-11)


def test_reciprocity() -> None:
    """Lorentz: F^a . U^b = F^b . U^a for any two motions between resting walls."""
    fluid = mesh(SMALL_BOX, TWO, COARSE)
    rest = resting(SMALL_BOX)
    a, b = (
        solve(StokesProblem(fluid, SMALL_BOX, TWO, held(*U), rest))
        for U in ([(1.0, 0.2, 0.0), (0.0, -0.7, 0.4)], [(0.0, 0.5, 1.0), (-0.3, 0.0, 0.0)])
    )
    assert (a.F * b.U).sum() == pytest.approx((b.F * a.U).sum(), rel=1e-10)
    assert (a.F * a.U).sum() > 0


def test_dissipation_is_the_power_of_the_bodies() -> None:
    solution = solved(SMALL_BOX, TWO, MOTIONS["held"], resolution=COARSE)
    assert solution.dissipation == pytest.approx(float((solution.F * solution.U).sum()), rel=1e-10)


def test_permuting_the_bodies_permutes_the_result() -> None:
    """To the mesh error, since another start node makes another mesh."""
    swapped = Configuration(TWO.centres[::-1], TWO.angles, TWO.radii[::-1])
    F = solved(SMALL_BOX, TWO, held((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))).F
    G = solved(SMALL_BOX, swapped, held((0.0, 1.0, 0.0), (1.0, 0.0, 0.0))).F
    assert_allclose(F, G[::-1], atol=1e-4 * np.abs(F).max())


def test_a_quarter_turn_turns_the_result() -> None:
    box = Box((-2.0, -3.0), (2.0, 3.0))
    turn = np.array([[0.0, -1.0], [1.0, 0.0]])
    q = Configuration(TWO.centres @ turn.T, TWO.angles, TWO.radii)
    F = solved(SMALL_BOX, TWO, held((1.0, 0.0, 0.3), (0.0, 1.0, 0.0))).F
    G = solved(box, q, held((0.0, 1.0, 0.3), (-1.0, 0.0, 0.0))).F
    assert_allclose(G[:, :2], F[:, :2] @ turn.T, atol=1e-4 * np.abs(F).max())
    assert_allclose(G[:, 2], F[:, 2], atol=1e-4 * np.abs(F).max())


def test_a_uniform_motion_of_everything_costs_nothing() -> None:
    """Walls and bodies move together: no force, no dissipation, and the checks know that all is rounding."""
    moving = Boundary({wall: lambda x: np.tile([1.0, 2.0], (len(x), 1)) for wall in SMALL_BOX.walls}, {})
    solution = solved(SMALL_BOX, TWO, free(np.zeros(3), np.zeros(3)), moving, COARSE)
    assert_allclose(solution.U, [[1.0, 2.0, 0.0]] * 2, atol=1e-12)
    assert solution.dissipation < 1e-20


def test_a_pressure_difference_drives_a_channel() -> None:
    """A small free disc on the centreline moves with u = (dp/L) (H^2/4 - y^2) / (2 mu).

    The ends do not have a parallel profile: they take some 2 % off the length L, but the same to any. So the
    resistance to 1/U grows with L as it must, 2 mu / (dp H^2/4) for each length.
    """
    inverse = []
    for half in (5.0, 10.0):
        boundary = Boundary({"bottom": at_rest, "top": at_rest}, {"left": 40.0, "right": 0.0})
        channel = Box((-half, -1.0), (half, 1.0))
        U = solved(channel, discs([(0.0, 0.0)], [0.02]), free(np.zeros(3)), boundary).U[0]
        inverse.append(1.0 / U[0])
        assert abs(U[1]) < 1e-6 * U[0]
    assert (inverse[1] - inverse[0]) / 10.0 == pytest.approx(2.0 / 40.0, rel=2e-3)  # (2/3) (a/H)^2 is 3e-4
    assert inverse[0] == pytest.approx(10.0 / 20.0, rel=0.025)


def test_a_disc_in_simple_shear_turns_at_half_the_vorticity() -> None:
    """omega = -gamma / 2 in unbounded shear, by symmetry; walls 50 radii away change it by (a/H)^2."""
    box = Box((-50.0, -50.0), (50.0, 50.0))
    boundary = Boundary(dict.fromkeys(box.walls, shear), {})
    U = solved(box, discs([(0.0, 0.0)], [1.0]), free(np.zeros(3)), boundary).U[0]
    assert_allclose(U, [0.0, 0.0, -0.5], atol=5e-4)
