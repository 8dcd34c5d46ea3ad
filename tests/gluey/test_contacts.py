"""Rates of slip by hand, and memories that belong to their pairs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fsi.arrays import Array
from fsi.bodies.configuration import rigid_motion
from fsi.case.gluey import ContactLaw
from fsi.gluey.contacts import Room, find_contacts, slip_rows
from fsi.gluey.step import advance
from fsi.gluey.system import GlueyState, System
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.unbounded import Unbounded
from tests.gluey.test_step import H, bodies


def slip(centres: Array, radii: Array, U: Array) -> Array:
    """The slip of two touching bodies that have the velocities U (2, modes)."""
    d = centres.shape[1]
    contacts = find_contacts(
        centres, radii, Room(np.empty((0, d)), np.empty((0, d)), Unbounded(dimension=d)), 1.0
    )
    found: Array = slip_rows(contacts, radii, U.shape[1]) @ U.ravel()
    return found


RADII = np.array([0.5, 0.3])
BESIDE = np.array([[0.0, 0.0], [0.8, 0.0]])


@pytest.mark.parametrize(
    ("spins", "expected"),
    [
        ((2.0, 0.0), -2.0 * 0.5),
        ((0.0, 2.0), -2.0 * 0.3),
        ((3.0, -5.0), 0.0),  # two gears: 3 * 0.5 = 5 * 0.3
        ((3.0, 5.0), -3.0),
    ],
)
def test_slip_of_two_discs_that_turn(spins: tuple[float, float], expected: float) -> None:
    """Along y, as the second lies to the right: -a_j omega_j of its left side less a_i omega_i."""
    U = np.array([[0.0, 0.0, spins[0]], [0.0, 0.0, spins[1]]])
    assert_allclose(slip(BESIDE, RADII, U), [expected], atol=1e-15)


@pytest.mark.parametrize("d", [2, 3])
def test_a_rigid_motion_of_touching_bodies_has_no_slip(d: int) -> None:
    """In space with axes along and across the line of centres; a wrong sign leaves twice a spin's share."""
    towards = np.array([0.6, 0.8, 0.0][:d]) if d == 2 else np.array([2.0, -1.0, 2.0]) / 3.0
    centres = np.array([0.3, -0.7, 0.2])[:d] + np.stack([np.zeros(d), 0.8 * towards])
    motion = np.arange(1.0, 1.0 + (3 if d == 2 else 6))
    U = rigid_motion(centres) @ motion
    assert_allclose(slip(centres, RADII, U), 0.0, atol=1e-14)


@pytest.mark.parametrize("d", [2, 3])
def test_friction_keeps_the_angular_momentum_of_a_pair_that_arrives(d: int) -> None:
    """Arms meet in the gap D = h w/2; radii in their place lose mu_f p D = 5e-4 with p = w/4, w = 1."""
    system, state = bodies([[0.0] * d, [1.0 + 0.5 * H] + [0.0] * (d - 1)], lambda _: np.zeros((2, d)))
    system = replace(system, law=ContactLaw(gamma_min=0.0, friction=0.4))
    U = np.zeros_like(state.U)
    U[0, :2] = 1.0, 1.0
    before = replace(state, U=U)
    after, touching, _ = advance(system, before, 0.0, H)
    assert_allclose(touching.solid, 0.25)
    lost = angular_momentum(system, after) - angular_momentum(system, before)
    assert_allclose(lost, 0.0, atol=1e-14)
    assert np.abs(after.U[:, d:]).max() > 0.1


def angular_momentum(system: System, state: GlueyState) -> Array:
    """`sum x x m v + I omega`, about z alone in the plane."""
    d = state.centres.shape[1]
    x, v = (np.pad(of, ((0, 0), (0, 3 - d))) for of in (state.centres, state.U[:, :d]))
    orbital = np.cross(x, system.mass[:, :1] * v).sum(axis=0)
    total: Array = orbital[-1 if d == 2 else 0 :] + (system.mass * state.U)[:, d:].sum(axis=0)
    return total


def test_a_body_that_arrives_at_a_wall_has_its_radius_for_an_arm() -> None:
    """A disc of radius 0.5 that turns 0.1 above a floor: a omega; an arm that reached to it has 0.6."""
    room = Room(np.zeros((1, 2)), np.array([[0.0, 1.0]]), Unbounded(dimension=2))
    contacts = find_contacts(np.array([[0.0, 0.6]]), np.array([0.5]), room, 1.0)
    rate = slip_rows(contacts, np.array([0.5]), 3) @ np.array([0.0, 0.0, 1.0])
    assert_allclose(np.abs(rate), [0.5], rtol=1e-15)


def test_what_one_pair_forgets_no_other_pair_does() -> None:
    """Three pairs are pushed together with 1, 2, 3; the first is torn apart: the others keep f t.

    The list of memories loses its first entry then, and who looks up by place in the list finds the next one.
    """
    push = np.array([1.0, 2.0, 3.0])
    centres = np.array([[x, 10.0 * k] for k in range(3) for x in (0.0, 1.0)])

    def force(t: float) -> Array:
        pull = np.array([-4.0, 0.0, 0.0])
        strength = push if t < 0.2 else pull
        return np.array([[sign * f, 0.0] for f in strength for sign in (1.0, -1.0)])

    system, state = bodies(centres, force)
    for k in range(40):
        state, _, _ = advance(system, state, k * H, H)
        if k == 19:
            assert_allclose(state.gamma, -0.2 * push, rtol=1e-9)
    assert_allclose(state.gamma, [-0.4, -0.6], rtol=1e-9)
    assert np.all(state.centres[2:, 0] == pytest.approx([0.0, 1.0, 0.0, 1.0], abs=1e-9))


def test_of_several_images_the_nearest_one_touches() -> None:
    """A cell of 3 by 3, discs of radius 0.2 at 0.4 and 2.8: the gap is 0.2 across its end, 2 inside."""
    room = Room(np.empty((0, 2)), np.empty((0, 2)), Box((0.0, 0.0), (3.0, 3.0), periodic=("x", "y")))
    found = find_contacts(np.array([[0.4, 1.0], [2.8, 1.0]]), np.full(2, 0.2), room, 5.0)
    assert_allclose(found.D, [0.2])
    assert_allclose(found.n, [[-1.0, 0.0]])
