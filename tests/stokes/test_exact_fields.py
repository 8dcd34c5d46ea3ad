"""Fields of exact flows as the files have them: strain rates with an axis, tractions that turn a disc."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import pyvista as pv

from fsi.bodies.configuration import Configuration, Motion
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.cell import Cell
from fsi.meshes.geometry.round import Round
from fsi.meshes.resolution import Resolution
from fsi.stokes.problem import Boundary
from fsi.stokes.traction import traction
from tests.flows import discs, held, solved
from tests.periodic import in_channel

COARSE = Resolution(0.5, 12, 1.0)
NOBODY = Configuration.unturned(np.empty((0, 2)), np.empty(0))
NOTHING = Motion(np.empty((0, 3), dtype=bool), np.empty((0, 3)), np.empty((0, 3)))


def test_strain_rate_with_an_axis_has_the_hoop_strain(tmp_path: Path) -> None:
    """u = (-r/2, z) stretches with e = diag(-1/2, 1, -1/2): sqrt(2 e:e) = sqrt(3), on the axis too.

    Without the hoop strain it is sqrt(5/2), and there without its limit.
    """
    container = Box((0.0, -1.0), (1.0, 1.0), axisymmetric=True)
    walls = dict.fromkeys(container.walls, lambda x: x * np.array([-0.5, 1.0]))
    flow = solved(container, NOBODY, NOTHING, Boundary(walls, {}), COARSE)
    found = pv.read(tmp_path / flow.write(tmp_path, 0)["fluid"][0])
    assert np.abs(found.points[:, 0]).min() < 1e-15
    np.testing.assert_allclose(found["strain_rate"], np.sqrt(3.0), rtol=1e-10)
    np.testing.assert_allclose(found["vorticity"], 0.0, atol=1e-10)
    np.testing.assert_allclose(found["pressure"], 0.0, atol=1e-9)
    assert flow.dissipation == pytest.approx(3.0 * 2.0 * np.pi, rel=1e-12)  # mu 3 times the volume


def test_rates_at_nodes_are_means_over_the_cells_there(tmp_path: Path) -> None:
    """u = (y, 0): a rate of 1 and a vorticity of -1 at every node, of one cell or of eight."""
    box = Box((0.0, 0.0), (2.0, 1.0))
    walls = dict.fromkeys(box.walls, lambda x: np.column_stack([x[:, 1], np.zeros(len(x))]))
    flow = solved(box, NOBODY, NOTHING, Boundary(walls, {}), COARSE)
    found = pv.read(tmp_path / flow.write(tmp_path, 0)["fluid"][0])
    np.testing.assert_allclose(found["strain_rate"], 1.0, rtol=1e-10)
    np.testing.assert_allclose(found["vorticity"], -1.0, rtol=1e-10)


def test_the_traction_that_turns_a_disc_in_a_round_container() -> None:
    """T = 4 pi mu omega a^2 R^2/(R^2 - a^2), by reactions, the integral of sigma_h n, and the traction.

    grad u in place of its symmetric part would give half of it and more: u = A r + B/r turns, too.
    """
    found = solved(Round(2.0), discs([(0.0, 0.0)], [1.0]), held((0.0, 0.0, 1.0)))
    exact = 4.0 * np.pi * 4.0 / 3.0
    assert found.F[0, 2] == pytest.approx(exact, rel=1e-7)
    assert found.traction_F[0, 2] == pytest.approx(exact, rel=1e-5)
    x, t = found.surface.x, traction(found.surface)
    around = x[:, 0] * t[:, 1] - x[:, 1] * t[:, 0]
    np.testing.assert_allclose(around, exact / (2.0 * np.pi), rtol=1e-3)


def test_the_traction_of_a_sphere_in_a_concentric_ball_adds_up_to_its_force() -> None:
    """On surfaces of revolution: the traction times 2 pi r ds is the force."""
    ball = Round(4.0, axisymmetric=True)
    U = np.array([[0.0, 1.0, 0.0]])
    found = solved(ball, discs([(0.0, 0.0)], [1.0]), held(U[0]))
    surface, t = found.surface, traction(found.surface)
    order = np.argsort(np.arctan2(surface.x[:, 1], surface.x[:, 0]))
    x, t_z = surface.x[order], t[order, 1]
    angle = np.arctan2(x[:, 1], x[:, 0])
    total = np.trapezoid(2.0 * np.pi * x[:, 0] * t_z, angle)
    assert total == pytest.approx(found.F[0, 1], rel=2e-3)


def test_the_pressure_has_no_mean() -> None:
    """A disc that moves along x in the middle of a box: p is odd in x, so that any constant would show."""
    found = solved(Box((-3.0, -2.0), (3.0, 2.0)), discs([(0.0, 0.0)], [1.0]), held((1.0, 0.0, 0.0)))
    _, p = found.evaluate(np.array([[1.5, 0.3], [-1.5, 0.3], [2.5, -1.0], [-2.5, -1.0]]))
    np.testing.assert_allclose(p[::2] + p[1::2], 0.0, atol=1e-3 * np.abs(p).max())
    assert np.abs(p).min() > 1.0


def test_the_traction_integral_across_the_cut_of_a_cell_is_the_force() -> None:
    """A disc at the corner of its cell is in four parts at four images, where p differs by its mean rise.

    The integral is good to 1e-4 here; without the rise, or with twice it, it would be off by a third, and by
    half a percent with loads of the cut where it meets the disc.
    """
    cell = Cell(((1.0, 0.0), (0.0, 1.0)), ((0.0, 0.0), (0.0, 0.0)))
    q, motion = discs([(0.01, 0.99)], [0.3]), held((1.0, 0.0, 0.0))
    found = solved(cell, q, motion, Boundary({}, {}), Resolution(1.0, 48, 0.2))
    assert found.traction_F[0] == pytest.approx(found.F[0], abs=2e-4 * found.F[0, 0])


def test_the_traction_integral_in_a_channel_with_a_pressure_gradient_is_the_force() -> None:
    """To 3e-6, as without a gradient, wherever the disc is; loads of the cut, which meets it, are 9e-3."""
    channel = Box((0.0, 0.0), (8.0, 6.0), periodic=("x",))
    for x in (3.0, 7.5):
        found = in_channel(channel, discs([(x, 3.2)], [1.0]), held((0.0, 0.0, 0.0)), -1.0)
        assert found.traction_F[0, 0] == pytest.approx(found.F[0, 0], rel=1e-5)
