"""The sphere beside a plane against published and 40-digit values, asymptotics, far fields and identities."""

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from fsi.lubrication import sphere_beside_plane as exact
from fsi.lubrication.expansions import Mode, expansion

PATH = Path(__file__).parents[1] / "reference" / "sphere_wall_tangential.json"
ROWS = json.loads(PATH.read_text())["rows"]
gaps = st.floats(-6.0, 1.5).map(lambda exponent: 10.0**exponent)


def factors(s: float) -> list[float]:
    """The reference's F_t, T_t, F_r, T_r, F_s, T_s without their signs, from the public functions."""
    force, torque = exact.held_in_shear(s, 1.0, 1.0, 1.0)
    coupling = float(exact.coupling_resistance(s, 1.0, 1.0))
    return [
        float(exact.parallel_resistance(s, 1.0, 1.0)) / (6.0 * np.pi),
        coupling / (8.0 * np.pi),
        coupling / (6.0 * np.pi),
        float(exact.rotation_resistance(s, 1.0, 1.0)) / (8.0 * np.pi),
        -float(force) / (6.0 * np.pi * (1.0 + s)),
        float(torque) / (4.0 * np.pi),
    ]


@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row['eps']:g}")
def test_reference_rows(row: dict[str, float]) -> None:
    """The reference holds 12 digits in its smallest entries, F_r = (4/3) T_t: reciprocity, to 1e-13."""
    expected = [abs(row[key]) for key in ("Ft", "Tt", "Fr", "Tr", "Fs", "Ts")]
    assert_allclose(factors(row["eps"]), expected, rtol=2e-12)


def test_forty_digit_values() -> None:
    """The module's equations solved in 40 to 60 digits for this test, r_n as plain second differences."""
    tiny = [
        8.3225688095924637,
        1.1886007869692405,
        5.8971044237282435,
        1.700617483063763,
        0.94398658558516621,
    ]
    wide = [
        1.0538015671216321,
        6.178077601628689e-6,
        1.0002348741741631,
        1.0535552324171423,
        0.99986553520271631,
    ]
    for s, expected in ((1e-6, tiny), (10.0, wide)):
        found = np.delete(factors(s), 2)
        # The second is what cancels of 1 to 6e-6, by processor 2e-10.
        rtol = [1e-13, 1e-9, 1e-13, 1e-12, 1e-11]
        assert np.all(np.abs(found / np.array(expected) - 1.0) < rtol)


def test_expansions() -> None:
    """Errors fall like s ln s; a constant wrong in its sixth digit would leave 1e-5.

    A and C are those of `fsi.lubrication.expansions`; B is `8 pi mu a^2 (ln(1/s)/10 - 0.192953)`.
    """
    s = np.array([1e-3, 1e-8])
    modes: tuple[Mode, ...] = ("shear", "rotation")
    A, C = (expansion("spheres", mode, np.inf, 3).value(s) for mode in modes)
    for law, expected, unit in (
        (exact.parallel_resistance, A, 6.0 * np.pi),
        (exact.coupling_resistance, 8.0 * np.pi * (-0.1 * np.log(s) - 0.192953), 8.0 * np.pi),
        (exact.rotation_resistance, C, 8.0 * np.pi),
    ):
        error = np.abs(law(s, 1.0, 1.0) - expected) / unit
        assert error[0] < 5e-3
        assert error[1] < 1e-6


def test_far_from_the_plane() -> None:
    """Series of Faxen and of Goldman, Cox and Brenner in l = a/h."""
    s = 30.0
    ratio = 1.0 / (1.0 + s)
    faxen = 1 / (1 - 9 / 16 * ratio + ratio**3 / 8 - 45 / 256 * ratio**4 - ratio**5 / 16)
    parallel, coupling, _, rotation, force, torque = factors(s)
    assert_allclose(parallel, faxen, rtol=1e-8)
    assert_allclose(coupling, 3 / 32 * ratio**4 * (1 - 3 / 8 * ratio), rtol=0.02)
    assert_allclose(rotation, 1 + 5 / 16 * ratio**3, rtol=1e-6)
    assert_allclose(force, 1 + 9 / 16 * ratio, rtol=2e-3)
    assert_allclose(torque, 1 - 3 / 16 * ratio**3, rtol=1e-6)


@given(gaps)
def test_resistance_is_positive(s: float) -> None:
    """A, B, C > 0 and AC > B^2: every motion costs power; a nearer plane costs more."""
    laws = (exact.parallel_resistance, exact.coupling_resistance, exact.rotation_resistance)
    A, B, C = (float(law(s, 1.0, 1.0)) for law in laws)
    assert min(A, B, C, A * C - B * B) > 0.0
    for law, value in zip(laws, (A, B, C), strict=True):
        assert float(law(1.5 * s, 1.0, 1.0)) < value * (1.0 + 1e-7)


@given(gaps)
def test_free_sphere_balances_its_load(s: float) -> None:
    """It lags behind the flow at its centre and turns clockwise, slower than half the shear rate."""
    force, torque = exact.held_in_shear(s, 1.0, 1.0, 2.0)
    speed, spin = exact.free_in_shear(s, 1.0, 2.0)
    A, B, C = (
        law(s, 1.0, 1.0)
        for law in (exact.parallel_resistance, exact.coupling_resistance, exact.rotation_resistance)
    )
    assert_allclose(A * speed + B * spin, -force, rtol=1e-12)
    assert_allclose(B * speed + C * spin, -torque, rtol=1e-10)
    assert 0.0 < speed < 2.0 * (1.0 + s)
    assert -1.0 < spin < 0.0


@pytest.mark.parametrize(("angle", "ratio"), [(0.5, 0.7669), (0.3, 0.6538)])
def test_free_sphere_of_goldman_cox_and_brenner(angle: float, ratio: float) -> None:
    """V/(h gamma) of the table in their second paper, at h/a = cosh(angle), to its four digits."""
    height = np.cosh(angle)
    speed, _ = exact.free_in_shear(height - 1.0, 1.0, 1.0)
    assert_allclose(speed / height, ratio, rtol=0.0, atol=2e-4)


def test_dimensions() -> None:
    """A goes like mu a, B like mu a^2, C like mu a^3; a forgotten factor is wrong by 2 or 3."""
    q, a, mu, rate = 0.3, 2.0, 3.0, 5.0
    s = q / a
    laws = (exact.parallel_resistance, exact.coupling_resistance, exact.rotation_resistance)
    for power, law in zip((1, 2, 3), laws, strict=True):
        assert_allclose(law(q, a, mu), mu * a**power * law(s, 1.0, 1.0))
    force, torque = exact.held_in_shear(s, 1.0, 1.0, 1.0)
    assert_allclose(
        exact.held_in_shear(q, a, mu, rate), (mu * rate * a**2 * force, mu * rate * a**3 * torque)
    )
    speed, spin = exact.free_in_shear(s, 1.0, 1.0)
    assert_allclose(exact.free_in_shear(q, a, rate), (rate * a * speed, rate * spin))


def test_arrays_broadcast() -> None:
    q, a = np.array([[0.1], [0.2]]), np.array([1.0, 2.0, 3.0])
    assert exact.parallel_resistance(q, a, 1.0).shape == (2, 3)
    assert exact.held_in_shear(q, a, 1.0, 1.0)[1].shape == (2, 3)


@pytest.mark.parametrize("gap", [0.0, -0.1, np.nan, 1e-11])
def test_no_law_for_overlap_or_too_small_a_gap(gap: float) -> None:
    with pytest.raises(ValueError, match=r"^gap "):
        exact.parallel_resistance(gap, 1.0, 1.0)
