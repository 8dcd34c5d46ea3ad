"""The coefficients of the expansions at small gaps against the exact functions."""

from __future__ import annotations

from math import inf, pi

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fsi.lubrication import exact, spheres
from fsi.lubrication.expansions import SHAPES, Mode, Shape, basis, coefficients
from fsi.lubrication.fitting import design
from fsi.lubrication.named_laws import exact_resistance

CASES: list[tuple[Shape, Mode, float]] = [
    *((shape, "squeeze", ratio) for shape in SHAPES for ratio in (1.0, 2.0, 7.0, inf)),
    *((shape, mode, inf) for shape in SHAPES for mode in ("shear", "rotation")),
    *(("discs", mode, ratio) for mode in ("shear", "rotation") for ratio in (1.0, 2.0, 7.0)),
]


@pytest.mark.parametrize(("shape", "mode", "ratio"), CASES)
def test_coefficients_are_those_of_the_exact_functions(shape: Shape, mode: Mode, ratio: float) -> None:
    """Least squares without noise; 1e-5 tells the older constant 0.971264 of a plane from this one."""
    s = np.geomspace(1e-6, 0.1, 60)
    K = exact_resistance(shape, mode, s, ratio)
    terms = basis(shape, mode)[:9]  # with more, rounding shows
    phi = design(terms, s) / K[:, None]
    size = np.linalg.norm(phi, axis=0)
    found = dict(zip(terms, np.linalg.lstsq(phi / size, np.ones_like(s))[0] / size, strict=True))
    known = coefficients(shape, mode, ratio)
    assert len(known) >= 2
    for term, value in known.items():
        assert_allclose(found[term], value, rtol=1e-5, atol=1e-5, err_msg=str(term))


@pytest.mark.parametrize("radii", [(1.0, 1.0), (1.0, 3.0), (0.3, 2.0)])
def test_squeezed_spheres_have_no_net_force(radii: tuple[float, float]) -> None:
    """The velocities that give opposite unit forces, from the 2 x 2 resistances, differ by one over it."""
    for gap in (1e-3, 0.1, 3.0):
        columns = [spheres.line_forces(gap, radii, 1.0, unit) for unit in ((1.0, 0.0), (0.0, 1.0))]
        velocity = np.linalg.solve(np.array(columns, dtype=float).T, [1.0, -1.0])
        found = spheres.relative_resistance(gap, *radii, 1.0)
        assert_allclose(found, 1.0 / (velocity[0] - velocity[1]), rtol=1e-10)


def test_squeezed_discs_between_equal_ones_and_a_plane() -> None:
    """An infinite radius is the plane; the order does not matter; far away L tends to ln(d^2/(a b))."""
    q = np.array([1e-6, 1e-2, 1.0, 20.0])
    assert_allclose(
        exact.relative_resistance(q, 2.0, inf, 1.0), exact.normal_resistance(q, 2.0, 1.0), rtol=1e-14
    )
    assert_allclose(
        exact.relative_resistance(q, 2.0, 0.5, 1.0), exact.relative_resistance(q, 0.5, 2.0, 1.0), rtol=1e-14
    )
    far = exact.relative_resistance(1e8, 2.0, 0.5, 1.0)
    assert_allclose(far, 4.0 * pi / (np.log(1e16 / (2.0 * 0.5)) - 1.0), rtol=1e-7)
