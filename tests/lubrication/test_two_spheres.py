"""Two spheres in any motion against published constants, closed forms, far fields and a plane."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_less

from fsi.lubrication import sphere_beside_plane as beside
from fsi.lubrication.spheres import normal_resistance
from fsi.lubrication.two_spheres import _across as across
from fsi.lubrication.two_spheres import in_far_ball, orders, pair_functions, pair_matrix

FORCE, COUPLING, TORQUE = 6.0 * np.pi, 4.0 * np.pi, 8.0 * np.pi
ratios = st.floats(0.2, 5.0)


def test_nearly_touching_spheres_have_the_published_constants() -> None:
    """Jeffrey and Onishi 1984: what is left beside the logarithms of touching equal spheres, four digits.

    Extrapolated over q ln q from two gaps. In units of 6 pi mu a, 4 pi mu a^2 and 8 pi mu a^3.
    """
    gaps, left = np.array([2e-3, 4e-3]), []
    for q in gaps.tolist():
        of, log = pair_functions(q, (1.0, 1.0), 1.0), np.log(1.0 / q)
        left.append(
            [
                *(of.YA[0] / FORCE - np.array([1.0, -1.0]) * log / 6.0),
                *(of.YB[0] / COUPLING - np.array([1.0, -1.0]) * log / 4.0),
                *(of.XC[0] / TORQUE),
                *(of.YC[0] / TORQUE - np.array([0.2, 0.05]) * log),
            ]
        )
    weights = gaps * np.log(1.0 / gaps)
    constants = (weights[1] * np.array(left[0]) - weights[0] * np.array(left[1])) / (weights[1] - weights[0])
    published = [0.9983, -0.2737, -0.2390, 0.0017, 1.0518, -0.1503, 0.7028, -0.0274]
    assert_allclose(constants, published, rtol=0, atol=3e-4)


@pytest.mark.parametrize("gap", [0.01, 0.1, 1.0])
def test_turning_about_the_line_of_centres(gap: float) -> None:
    """Equal spheres, both turning alike or against each other: Jeffery 1915, Proc. London Math. Soc. 14:327.

    T = 8 pi mu a^3 sinh^3(al) sum_n (-+1)^(n+1) / sinh^3(n al),  cosh al = 1 + gap / 2a.
    """
    al = np.arccosh(1.0 + 0.5 * gap)
    n = np.arange(1.0, 40.0 / al)
    terms = (np.sinh(al) / np.sinh(n * al)) ** 3
    of = pair_functions(gap, (1.0, 1.0), 1.0).XC / TORQUE
    assert_allclose(of[0, 0] + of[0, 1], terms @ (-1.0) ** (n + 1.0), rtol=1e-11)
    assert_allclose(of[0, 0] - of[0, 1], terms.sum(), rtol=1e-11)


@pytest.mark.slow
def test_a_small_sphere_sees_a_plane() -> None:
    """Beside a resting sphere that is ever larger; extrapolated in its curvature.

    What the term of second order changes, from 0.04 % of Y^C to 7 % of Y^B, is more than what is left.
    """
    gap = 0.5
    at = []
    for b in (7.5, 15.0, 30.0):
        of = pair_functions(gap, (1.0, b), 1.0)
        at.append(np.array([of.XA[0, 0], of.YA[0, 0], of.YB[0, 0], of.YC[0, 0]]))
    # There y points away from the plane, here z to the other sphere, turns count the other way: B is alike.
    along = (beside.parallel_resistance, beside.coupling_resistance, beside.rotation_resistance)
    functions = (normal_resistance, *along)
    plane = [float(f(gap, 1.0, 1.0)) for f in functions]
    coarse, linear = 2.0 * at[1] - at[0], 2.0 * at[2] - at[1]
    quadratic = (4.0 * linear - coarse) / 3.0
    assert np.all(np.abs(quadratic - plane) < np.abs(quadratic - linear))
    assert_array_less(np.abs(quadratic - linear), np.array([5e-3, 5e-3, 8e-2, 5e-4]) * np.abs(plane))


def test_far_mobilities() -> None:
    """x^a_12 = 3/(2s) - 1/s^3, y^a_12 = 3/(4s) + 1/(2 s^3), y^b_12, x^c_12, y^c_12 up to O(s^-6)."""
    s = 20.0
    mobility = np.linalg.inv(pair_matrix(np.array([[0.0, 0.0, 0.0], [0.0, 0.0, s]]), (1.0, 1.0), 1.0))
    M = mobility.reshape(2, 6, 2, 6)
    assert_allclose(FORCE * M[0, 2, 1, 2], 1.5 / s - 1.0 / s**3, rtol=0, atol=100.0 / s**7)
    assert_allclose(FORCE * M[0, 0, 1, 0], 0.75 / s + 0.5 / s**3, rtol=0, atol=100.0 / s**7)
    # A point force F x turns what lies at z = s by half the vorticity, F x cross s z / (8 pi mu s^3).
    assert_allclose(M[1, 4, 0, 0], -1.0 / (TORQUE * s**2), rtol=1e-6)
    assert_allclose(TORQUE * M[0, 5, 1, 5], 1.0 / s**3, rtol=1e-6)
    assert_allclose(TORQUE * M[0, 4, 1, 4], -0.5 / s**3, rtol=1e-5)


@given(gap=st.floats(0.02, 5.0), b=ratios, mu=ratios, direction=st.integers(0, 2**31))
@settings(max_examples=15, deadline=None)
def test_matrices_are_symmetric_positive_and_turn_along(
    gap: float, b: float, mu: float, direction: int
) -> None:
    """The X, A, C of both spheres come from different rows of the equations, which know of no reciprocity."""
    rng = np.random.default_rng(direction)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    centres = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0 + b + gap]])
    R, turned = pair_matrix(centres, (1.0, b), mu), pair_matrix(centres @ turn.T, (1.0, b), mu)
    every = np.kron(np.eye(4), turn)
    scale = np.abs(R).max()
    assert_allclose(R, R.T, rtol=0, atol=1e-11 * scale)
    assert_allclose(turned, every @ R @ every.T, rtol=0, atol=1e-11 * scale)
    assert np.linalg.eigvalsh(R)[0] > 0.0


@pytest.mark.parametrize(("gap", "b"), [(0.3, 0.4), (0.02, 1.0), (2.0, 3.0)])
def test_couplings_are_reciprocal(gap: float, b: float) -> None:
    """Forces by turns, which the matrix takes from torques by velocities, are the same by the equations."""
    radii = (1.0, b)
    loads = across(orders(gap, radii), radii, gap)
    loads[:2] *= FORCE * np.array(radii)[:, None]
    loads[2:] *= TORQUE * np.array(radii)[:, None] ** 2
    assert_allclose(loads, loads.T, rtol=0, atol=1e-13 * np.abs(loads).max())


def test_exchanged_spheres() -> None:
    of, back = pair_functions(0.3, (1.0, 0.4), 2.0), pair_functions(0.3, (0.4, 1.0), 2.0)
    for function, other in zip(of, back, strict=True):
        sign = -1.0 if function is of.YB else 1.0
        assert_allclose(function, sign * other[::-1, ::-1], rtol=1e-11)


def test_a_far_ball_holds_both_back() -> None:
    """Of one force the first reflection alone, as of a sphere at its centre: 1 - 9 a / 4 R."""
    mobility = np.linalg.inv(pair_matrix(np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 500.0]]), (1.0, 1e-6), 1.0))
    moved = in_far_ball(mobility, 100.0, 1.0)
    assert_allclose(FORCE * moved[0, 0], 1.0 - 2.25 / 100.0, rtol=1e-6)
    assert_allclose(moved[3:6, 3:6], mobility[3:6, 3:6])


def test_too_narrow_a_gap_is_refused() -> None:
    for gap in (1e-4, 0.0, -0.1, float("nan")):
        with pytest.raises(ValueError, match=r"gap = .*: takes .* multipoles, more than 1000"):
            pair_functions(gap, (1.0, 2.0), 1.0)
