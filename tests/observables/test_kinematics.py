"""Vorticity and strain rate of flows that everyone knows."""

import numpy as np
import pytest

from fsi.observables.kinematics import hoop_rate, strain_rate, vorticity


def test_rotation_is_all_vorticity() -> None:
    """u = omega x r: u_x = -3 y, u_y = 3 x."""
    G = np.array([[0.0, -3.0], [3.0, 0.0]])
    assert vorticity(G) == 6.0
    assert strain_rate(G) == 0.0


def test_simple_shear_turns_clockwise_at_its_rate() -> None:
    """u_x = 2 y."""
    G = np.array([[0.0, 2.0], [0.0, 0.0]])
    assert vorticity(G) == -2.0
    assert strain_rate(G) == pytest.approx(2.0, rel=1e-15)


def test_in_space_it_is_the_curl() -> None:
    """u = omega x r with omega = (1, 2, 3): curl u = 2 omega."""
    G = np.array([[0.0, -3.0, 2.0], [3.0, 0.0, -1.0], [-2.0, 1.0, 0.0]])
    np.testing.assert_allclose(vorticity(G), [2.0, 4.0, 6.0])
    assert strain_rate(G) == 0.0


def test_axisymmetric_stretching_has_a_hoop_strain() -> None:
    """u = (r, -2 z): e = diag(1, 1, -2), 2 e : e = 12; without the hoop strain it would be 10."""
    G = np.broadcast_to([[1.0, 0.0], [0.0, -2.0]], (2, 2, 2))
    r = np.array([0.0, 0.7])
    np.testing.assert_allclose(strain_rate(G, hoop_rate(r, r, G)), np.sqrt(12.0), rtol=1e-15)


def test_a_node_on_the_axis_has_the_limit_though_it_stands_there_to_rounding() -> None:
    """u_r = 3 r, given as zero at r = 0, 1e-17 and -1e-17."""
    r = np.array([2.0, 0.5, 0.0, 1e-17, -1e-17])
    u_r = np.array([6.0, 1.5, 0.0, 0.0, 0.0])
    G = np.zeros((5, 2, 2))
    G[:, 0, 0] = 3.0
    np.testing.assert_allclose(hoop_rate(r, u_r, G), 3.0, rtol=1e-15)
