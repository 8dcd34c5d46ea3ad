"""Spheres on a line against published and 40-digit values, other forms of the solution, identities."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from fsi.lubrication import spheres
from fsi.lubrication.expansions import expansion
from fsi.lubrication.named_laws import GapFilm, leading_law

REFERENCE = Path(__file__).parents[1] / "reference"
DRAG = 6.0 * np.pi
# The references carry 16 digits (the pair's, at a gap of 0.01, only 14); so do the sums.
RTOL = 3e-15
gaps = st.floats(-8.0, 2.0).map(lambda exponent: 10.0**exponent)
radii = st.floats(-2.0, 2.0).map(lambda exponent: 10.0**exponent)


def read(name: str) -> Any:
    """A reference file's content."""
    return json.loads((REFERENCE / f"{name}.json").read_text())


def matrix(gap: float, a: float, b: float) -> NDArray[np.float64]:
    """R_ij by unit velocities, viscosity 1."""
    columns = [spheres.line_forces(gap, (a, b), 1.0, v) for v in ((1.0, 0.0), (0.0, 1.0))]
    return np.array(columns).T


@pytest.mark.parametrize("row", read("sphere_wall_normal")["rows"], ids=lambda row: f"{row['q_over_a']:g}")
def test_plane_reference(row: dict[str, float]) -> None:
    assert_allclose(spheres.normal_resistance(row["q_over_a"], 1.0, 1.0) / DRAG, row["lambda"], rtol=RTOL)


@pytest.mark.parametrize("row", read("two_spheres")["rows"], ids=lambda row: f"{row['gap_over_a']:g}")
def test_pair_reference(row: dict[str, float]) -> None:
    gap = row["gap_over_a"]
    assert_allclose(2.0 * spheres.pair_resistance(gap, 1.0, 1.0) / DRAG, row["approach"], rtol=2e-14)
    for force in spheres.line_forces(gap, (1.0, 1.0), 1.0, (1.0, 1.0)):
        assert_allclose(force / DRAG, row["same_velocity"], rtol=2e-14)


def test_no_digit_is_lost_in_a_thin_film() -> None:
    """Values at q/a = 1e-8 (3e5 modes) and 1e-6 (radii 1, 2), summed mode by mode in 40 digits for this test.

    The plainly coded R_11 + R_12 has no digit left there.
    """
    assert_allclose(spheres.normal_resistance(1e-8, 1.0, 1.0) / DRAG, 100000004.65541609027, rtol=RTOL)
    assert_allclose(2.0 * spheres.pair_resistance(1e-8, 1.0, 1.0) / DRAG, 50000009.634886546345, rtol=RTOL)
    same, _ = spheres.line_forces(1e-8, (1.0, 1.0), 1.0, (1.0, 1.0))
    assert_allclose(same / DRAG, 0.64514142609394399859, rtol=RTOL)
    expected = [[8377671.0995543214, -8377664.22489517218], [-8377664.22489517218, 8377696.88244843428]]
    assert_allclose(matrix(1e-6, 1.0, 2.0), expected, rtol=RTOL)
    together = spheres.line_forces(1e-6, (1.0, 2.0), 1.0, (1.0, 1.0))
    assert_allclose(together, [6.87465914922348895, 32.6575532621003403], rtol=RTOL)


def four_exponentials(gap: float, a: float, b: float) -> NDArray[np.float64]:
    """R_ij from the 4 x 4 systems of no-slip, mode by mode."""
    d = a + b + gap
    al, be = (
        np.arccosh((d * d + a * a - b * b) / (2 * a * d)),
        np.arccosh((d * d + b * b - a * a) / (2 * b * d)),
    )
    total = np.zeros((2, 2))
    for n in range(1, int(30.0 / min(al, be))):
        low, high = n - 0.5, n + 1.5
        rates = np.array([low, -low, high, -high])
        rows = [
            np.exp(rates * al),
            rates * np.exp(rates * al),
            np.exp(-rates * be),
            rates * np.exp(-rates * be),
        ]

        def uniform(xi: float, low: float = low, high: float = high) -> NDArray[np.float64]:
            """The mode of a uniform flow, and its slope."""
            parts = 2.0 * high * np.exp(-low * xi), -2.0 * low * np.exp(-high * xi)
            return np.array([sum(parts), -low * parts[0] - high * parts[1]])

        sides = np.zeros((4, 2))
        sides[:2, 0], sides[2:, 1] = uniform(al), uniform(be) * [1.0, -1.0]
        modes = np.linalg.solve(np.array(rows), sides)
        weight = n * (n + 1.0) / ((2.0 * n - 1.0) * (2.0 * n + 3.0))
        total += 2.0 * weight * np.array([modes[0] + modes[2], modes[1] + modes[3]])
    resistance: NDArray[np.float64] = 2.0 * np.pi * a * np.sinh(al) * total
    return resistance


@pytest.mark.parametrize(("gap", "a", "b"), [(0.3, 1.0, 2.0), (2.0, 0.5, 1.5), (0.5, 1.0, 1.0)])
def test_closed_form_solves_each_mode(gap: float, a: float, b: float) -> None:
    """The systems are ill-conditioned: they keep ten digits."""
    assert_allclose(matrix(gap, a, b), four_exponentials(gap, a, b), rtol=1e-9)


def test_series_of_maude_and_of_stimson_and_jeffery() -> None:
    """Their forms for equal spheres, as printed, at a gap where these still keep thirteen digits."""
    gap = 1.0
    al = np.arccosh(1.0 + 0.5 * gap)
    n = np.arange(1.0, 40.0)
    m, weight = 2.0 * n + 1.0, 4.0 / 3.0 * np.sinh(al) * n * (n + 1.0) / ((2.0 * n - 1.0) * (2.0 * n + 3.0))
    square = (m * np.sinh(al)) ** 2
    two, double = 2.0 * np.sinh(m * al), m * np.sinh(2.0 * al)
    approach = weight @ ((4.0 * np.cosh(0.5 * m * al) ** 2 + square) / (two - double) - 1.0)
    together = weight @ (1.0 - (4.0 * np.sinh(0.5 * m * al) ** 2 - square) / (two + double))
    assert_allclose(matrix(gap, 1.0, 1.0) @ [1.0, -1.0] / DRAG, [approach, -approach], rtol=1e-13)
    assert_allclose(matrix(gap, 1.0, 1.0) @ [1.0, 1.0] / DRAG, [together, together], rtol=1e-12)


@given(gaps, radii, radii)
def test_unequal_pair_identities(s: float, a: float, b: float) -> None:
    """Reciprocity, exchange of the spheres, positivity, and C_i = R_i1 + R_i2 as far as that has digits."""
    gap = s * min(a, b)
    R, exchanged = matrix(gap, a, b), matrix(gap, b, a)
    assert_allclose(R[0, 1], R[1, 0], rtol=1e-15)
    assert_allclose(exchanged, R[::-1, ::-1], rtol=1e-12)
    together = np.array(spheres.line_forces(gap, (a, b), 1.0, (1.0, 1.0)))
    assert_allclose(together, R @ [1.0, 1.0], rtol=1e-12, atol=1e-12 * np.max(R))
    # A sphere that follows or leads another needs less force than alone, but some.
    assert np.all(together > 0.0)
    assert np.all(together < DRAG * np.array([a, b]) * (1.0 + 1e-12))
    assert R[0, 1] < 0.0


@given(gaps, gaps)
def test_resistance_falls_with_the_gap(s: float, factor: float) -> None:
    further = s * (1.0 + factor)
    for law in (spheres.normal_resistance, spheres.pair_resistance, spheres.concentric_resistance):
        assert law(s, 1.0, 1.0) >= law(further, 1.0, 1.0) > 0.0


@given(gaps, radii, st.floats(-3.0, 3.0), st.floats(-3.0, 3.0))
def test_forces_are_linear_in_the_velocities(s: float, b: float, v: float, w: float) -> None:
    """Through the velocity that both share, or by the matrix."""
    R = matrix(s, 1.0, b)
    forces = spheres.line_forces(s, (1.0, b), 1.0, (v, w))
    assert_allclose(forces, R @ [v, w], rtol=1e-12, atol=1e-13 * np.max(R) * (abs(v) + abs(w)) + 1e-300)


def test_huge_sphere_is_a_plane() -> None:
    """Within O(a/b): one digit more for each factor 10 of the radius."""
    for gap in (1.0, 0.01):
        plane = float(spheres.normal_resistance(gap, 1.0, 1.0))
        errors = np.array([matrix(gap, 1.0, b)[0, 0] / plane - 1.0 for b in (1e4, 1e5, 1e6)])
        assert np.all(np.abs(errors) < [3e-4, 3e-5, 3e-6])
        assert_allclose(errors[:2] / errors[1:], 10.0, rtol=0.02)


def test_far_apart_each_feels_the_other_s_stokeslet() -> None:
    """Two points with coupling 3/(2 d) less its finite-size part; the rest is O(1/d^4)."""
    a, b, d = 1.0, 2.0, 300.0
    mobility = np.array([[1.0 / a, 0.0], [0.0, 1.0 / b]])
    mobility[0, 1] = mobility[1, 0] = 1.5 / d - 0.5 * (a**2 + b**2) / d**3
    assert_allclose(matrix(d - a - b, a, b) / DRAG, np.linalg.inv(mobility), rtol=0.0, atol=40.0 / d**4)


@pytest.mark.parametrize("ratio", [1.0, 2.0, 5.0])
def test_lubrication_of_unequal_spheres(ratio: float) -> None:
    """X^A_11 of D. J. Jeffrey and Y. Onishi, J. Fluid Mech. 139 (1984) 261: g_1/xi + g_2 ln(1/xi) + const.

    With xi = 2 q/(a + b). What is left differs by O(xi) between xi and 2 xi: 1 % of g_2 would differ by 1e-3.
    """
    xi = np.array([2e-6, 1e-6])
    q = 0.5 * xi * (1.0 + ratio)
    force, _ = spheres.line_forces(q, (1.0, ratio), 1.0, (1.0, 0.0))
    g2 = ratio * (1.0 + 7.0 * ratio + ratio**2) / (5.0 * (1.0 + ratio) ** 3)
    reduced = ratio / (1.0 + ratio)
    leading = leading_law(GapFilm("spheres", 1.0, ratio)).kappa(q, reduced)
    rest = force - leading + DRAG * g2 * np.log(xi)
    assert_allclose(rest[0], rest[1], rtol=0.0, atol=1e-3 * DRAG * 0.1)
    assert_allclose(leading * xi / DRAG, 2.0 * ratio**2 / (1.0 + ratio) ** 3)


def squeezed(s: NDArray[np.float64], ratio: float, terms: int) -> NDArray[np.float64]:
    """The first terms of K, s over the reduced radius."""
    return expansion("spheres", "squeeze", ratio, terms).value(s)


def test_plane_expansion_converges() -> None:
    """Each term more leaves an error of the size of the next; the ratios to the leading one are known."""
    s = np.array([0.1, 0.01, 1e-3, 1e-4])
    exact = spheres.normal_resistance(s, 1.0, 1.0)
    leading = exact / squeezed(s, np.inf, 1) - 1.0
    assert_allclose(leading[:3], [0.1459157, 0.0189617, 0.0023533], atol=1e-7, rtol=0.0)
    for terms, following in (
        (1, 0.2 * np.log(1 / s)),
        (2, 0.97128),
        (3, s * np.log(1 / s) / 21),
        (4, 0.167 * s),
    ):
        error = (exact - squeezed(s, np.inf, terms)) / DRAG
        assert_allclose(error[2:] / np.broadcast_to(following, 4)[2:], 1.0, atol=0.75 if terms % 2 else 0.02)
    fifth = (exact - squeezed(s, np.inf, 4)) / DRAG - 0.16701700481 * s
    assert np.all(np.abs(fifth[:3]) < 0.1 * s[:3] ** 2 * np.log(1.0 / s[:3]))


def test_pair_expansion_converges() -> None:
    """Equal spheres of radius 1 have the reduced radius 1/2, so that K counts 2 s and halves."""
    s = np.array([1e-2, 1e-3, 1e-4])
    expanded = [0.5 * squeezed(2.0 * s, 1.0, terms) for terms in (1, 4)]
    error = (spheres.pair_resistance(s, 1.0, 1.0) - expanded[1]) / (3.0 * np.pi)
    assert_allclose(error / s, error[-1] / s[-1], rtol=0.05)
    assert abs(error[-1] / s[-1]) < 1.0
    assert_allclose(expanded[0], 1.5 * np.pi / s, rtol=1e-15)


def test_concentric_container() -> None:
    """The polynomials as printed, the film of a close container, and the far limit 1 + 9 l/4."""
    for ratio in (0.1, 0.5, 0.9):
        factor = (1 - ratio**5) / (1 - 9 / 4 * ratio + 5 / 2 * ratio**3 - 9 / 4 * ratio**5 + ratio**6)
        gap = 1.0 / ratio - 1.0
        assert_allclose(spheres.concentric_resistance(gap, 1.0, 1.0) / DRAG, factor, rtol=1e-11)
    # Thin film, p' = 12 mu times the flux, integrated over the sphere: 8 pi mu a (a/q)^3.
    assert_allclose(spheres.concentric_resistance(1e-6, 1.0, 1.0), 8.0 * np.pi * 1e18, rtol=1e-5)
    assert_allclose(spheres.concentric_resistance(1e4, 1.0, 1.0) / DRAG - 1.0, 2.25e-4, rtol=1e-3)


def test_dimensions() -> None:
    """Forces go like mu a U; a forgotten factor a or mu is wrong by 2 or 3."""
    q, a, mu = 0.3, 2.0, 3.0
    s = q / a
    for law in (spheres.normal_resistance, spheres.pair_resistance, spheres.concentric_resistance):
        assert_allclose(law(q, a, mu), mu * a * law(s, 1.0, 1.0))
    assert_allclose(matrix(q, a, 1.0), a * matrix(s, 1.0, 1.0 / a))


def test_arrays_broadcast() -> None:
    q, a = np.array([[0.1], [0.2]]), np.array([1.0, 2.0, 3.0])
    assert spheres.normal_resistance(q, a, 1.0).shape == (2, 3)
    assert spheres.line_forces(q, (a, 1.0), 1.0, (1.0, np.zeros(3)))[1].shape == (2, 3)


@pytest.mark.parametrize("gap", [0.0, -0.1, np.nan])
def test_no_law_for_overlap(gap: float) -> None:
    for law in (spheres.normal_resistance, spheres.pair_resistance, spheres.concentric_resistance):
        with pytest.raises(ValueError, match="gap > 0"):
            law(gap, 1.0, 1.0)
