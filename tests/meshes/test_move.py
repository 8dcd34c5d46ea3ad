"""Moved meshes: discs stay discs, too large a move is refused, and the forces are those of a new mesh."""

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray

from fsi.bodies.configuration import Configuration
from fsi.meshes.build import FluidMesh
from fsi.meshes.moving import move
from fsi.meshes.moving.move import Mover
from fsi.meshes.resolution import Resolution
from fsi.stokes.problem import StokesProblem
from fsi.stokes.solve import solve
from tests.flows import SMALL_BOX, discs, held, mesh, resting, solved

Q = discs([(-1.0, 0.1), (1.1, -0.2)], [0.8, 0.5])
STEP = np.array([[0.06, -0.04], [-0.03, 0.05]])


@contextmanager
def mover(fluid: FluidMesh) -> Iterator[Mover]:
    moving = Mover(fluid, Q.centres)
    try:
        yield moving
    finally:
        moving.close()


@pytest.mark.parametrize("order", [2, 3, 4, 5, 6])
def test_discs_stay_exactly_discs(order: int) -> None:
    """All nodes of their edges are carried along, and turn by one angle about their centre.

    Turned by linear displacements, they would leave their circle by 1e-4.
    """
    fluid = mesh(SMALL_BOX, Q, order=order)
    base = fluid.mesh.geometry.x.copy()
    with mover(fluid) as moving:
        quality = moving.move(Q.centres + STEP)
    assert quality is not None
    assert quality > 0.5
    shift = fluid.mesh.geometry.x[:, :2] - base[:, :2]
    for body in range(len(Q)):
        from_surface = np.hypot(*(base[:, :2] - Q.centres[body]).T) - Q.radii[body]
        on_edges = np.abs(from_surface) < 1e-5
        assert np.count_nonzero(on_edges) == order * len(fluid.facet_tags.find(body + 1))
        before = (base[on_edges, :2] - Q.centres[body]) @ [1.0, 1.0j]
        after = (base[on_edges, :2] + shift[on_edges] - Q.centres[body] - STEP[body]) @ [1.0, 1.0j]
        turn = after / before
        np.testing.assert_allclose(turn, turn[0], atol=1e-13)
        assert abs(turn[0]) == pytest.approx(1.0, abs=1e-13)
        assert abs(np.angle(turn[0])) > 1e-3


def test_walls_stay_and_no_place_moves_further_than_the_discs() -> None:
    fluid = mesh(SMALL_BOX, Q)
    base = fluid.mesh.geometry.x.copy()
    with mover(fluid) as moving:
        moving.move(Q.centres + STEP)
    shift = fluid.mesh.geometry.x - base
    on_wall = np.abs(SMALL_BOX.distances(base[:, :2])).min(axis=1) < 1e-12
    np.testing.assert_array_equal(shift[on_wall], 0.0)
    # A maximum principle, up to the obtuse cells that a triangulation may have.
    from_surface = np.hypot(*(base[:, None, :2] - Q.centres).transpose(2, 0, 1)) - Q.radii
    on_disc = np.abs(from_surface).min(axis=1) < 1e-5
    assert np.all(np.abs(shift).max(axis=0) <= np.abs(shift[on_disc]).max(axis=0) * (1.0 + 1e-12))


def test_no_displacement_changes_nothing() -> None:
    fluid = mesh(SMALL_BOX, Q)
    base = fluid.mesh.geometry.x.copy()
    with mover(fluid) as moving:
        assert moving.move(Q.centres) == pytest.approx(fluid.quality, rel=1e-14)
    np.testing.assert_array_equal(fluid.mesh.geometry.x, base)


def test_a_move_does_not_depend_on_the_way() -> None:
    """Bitwise: what a resumed run needs."""
    fluid = mesh(SMALL_BOX, Q)
    with mover(fluid) as moving:
        moving.move(Q.centres + STEP)
        straight = fluid.mesh.geometry.x.copy()
        moving.move(Q.centres - 0.3 * STEP)
        moving.move(Q.centres + STEP)
    np.testing.assert_array_equal(fluid.mesh.geometry.x, straight)


@given(arrays(np.float64, (3, 2, 2), elements=st.floats(-2.0, 2.0, width=32)))
def test_distortion_is_the_ratio_of_singular_values(gradients: NDArray[np.float64]) -> None:
    """By LAPACK; without the square root of a flat cell's it would be twice as large."""
    gradients += np.eye(2)
    stretches = np.linalg.svd(gradients, compute_uv=False)
    found, regular = move._distortion(gradients), stretches[:, 1] > 1e-4
    expected = stretches[regular, 0] / stretches[regular, 1]
    np.testing.assert_allclose(found[regular], expected, rtol=1e-6)
    flat = (stretches[:, 1] < 1e-9) & (stretches[:, 0] > 1e-3)
    assert np.all(found[flat] > 1e4)


@pytest.mark.parametrize("step", [10.0, 1000.0], ids=["distorted", "through the wall"])
def test_too_large_a_move_is_refused_and_undone(step: float) -> None:
    fluid = mesh(SMALL_BOX, Q)
    base = fluid.mesh.geometry.x.copy()
    with mover(fluid) as moving:
        moving.move(Q.centres + STEP)
        assert moving.move(Q.centres + step * STEP) is None
    np.testing.assert_array_equal(fluid.mesh.geometry.x, base)


def test_forces_on_a_moved_mesh_are_those_of_a_new_one() -> None:
    """Within the error of either mesh, 5e-7 against a finer one; without the move they differ by 3 %."""
    there = Configuration(Q.centres + STEP, Q.angles, Q.radii)
    motion = held([1.0, 0.0, 0.0], [0.0, -1.0, 0.5])
    new = solved(SMALL_BOX, there, motion).F
    fluid = mesh(SMALL_BOX, Q)
    with mover(fluid) as moving:
        moving.move(there.centres)
        moved = solve(StokesProblem(fluid, SMALL_BOX, there, motion, resting(SMALL_BOX))).F
    np.testing.assert_allclose(moved, new, atol=3e-6 * np.abs(new).max())


@pytest.mark.parametrize(
    ("jacobian", "distortion", "accepted"),
    [(0.21, 1.9, True), (0.19, 1.0, False), (-1.0, 1.0, False), (0.9, 2.1, False)],
)
def test_a_moved_mesh_is_refused_below_a_fifth_or_beyond_twice_the_stretch(
    jacobian: float, distortion: float, accepted: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Literal limits: one cell of the moved mesh has that scaled Jacobian or that ratio of stretches."""

    def but_one(value: float) -> NDArray[np.float64]:
        return np.append(np.ones(7), value)

    monkeypatch.setattr(move, "scaled_jacobian", lambda *_: but_one(jacobian))
    monkeypatch.setattr(move, "_distortion", lambda _: but_one(distortion))
    fluid = mesh(SMALL_BOX, Q, Resolution(0.5, 12, 1.0))
    base = fluid.mesh.geometry.x.copy()
    with mover(fluid) as moving:
        quality = moving.move(Q.centres + STEP)
    assert quality == (jacobian if accepted else None)
    assert np.array_equal(fluid.mesh.geometry.x, base) is not accepted
