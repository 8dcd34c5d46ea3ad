"""The length of a film, up to which the law of a pair of shapes is that of its nearest points."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from fsi.calibration.film import film_length
from fsi.calibration.finding import pair_of
from fsi.case.load import parse_case
from fsi.errors import InputError


def towards_a_plane(shape: dict[str, Any], angle: float = 0.0, **plan: Any) -> dict[str, Any]:
    body = {"name": "one", "shape": shape, "angle": angle, "position": [0.0, 3.0]}
    calibration = {"pair": ["one", "plane"], "range": [1e-5, 1e-2], "samples": 12} | plan
    data = {"name": "x", "fluid": {"viscosity": 1.0}, "bodies": [body], "calibration": calibration}
    return data | {"domain": {"shape": "half-plane", "radius": 1e3}}


def ellipse(a: float, b: float) -> dict[str, Any]:
    return {"kind": "ellipse", "axes": [a, b]}


def length(shape: dict[str, Any], angle: float = 0.0) -> float:
    return film_length(pair_of(parse_case(towards_a_plane(shape, angle))))


def test_beside_its_end_an_ellipse_has_the_radius_of_curvature() -> None:
    """b^2/a, where its parabola slopes by 1; the nominal size is 1."""
    assert length(ellipse(1.0, 0.25), np.pi / 2.0) == pytest.approx(0.0625, rel=1e-3)


def test_beside_its_flat_side_an_ellipse_has_its_thickness() -> None:
    """8 b/9: b (1 - cos t) over its parabola b sin(t)^2/2 is 2/(1 + cos t), 3/2 with cos t = 1/3.

    The radius of curvature is 4, 16 b. Points along the outline are 3 % apart.
    """
    assert length(ellipse(1.0, 0.25)) == pytest.approx(8.0 / 9.0 * 0.25, rel=0.03)


def test_a_tip_has_the_length_at_which_its_profile_slopes_by_one() -> None:
    """2 x^(4/3), x = (3/4)^3: 0.633, of a radius 1; its curvature has no bound."""
    tip = {"kind": "tip", "radius": 1.0, "alpha": 1.0 / 3.0, "length": 1.0}
    assert length(tip) == pytest.approx(2.0 * 0.75**4, rel=1e-3)


def test_another_lobe_that_is_nearly_as_near_shortens_it() -> None:
    """To a quarter of what it is higher, 0.0016; its parabola alone would end at 0.023."""
    shape = {"kind": "fourier", "radius": 1.0, "orders": [5], "cosines": [0.05]}
    theta = np.linspace(0.0, 2.0 * np.pi, 200_001)[:-1]
    y = (1.0 + 0.05 * np.cos(5.0 * theta)) * np.sin(theta + 0.3)
    low = np.sort(y[(y < np.roll(y, 1)) & (y < np.roll(y, -1))])
    assert length(shape, 0.3) == pytest.approx(0.25 * (low[1] - low[0]), rel=5e-3)


def test_samples_that_no_series_holds_are_refused_by_name() -> None:
    """All of them had a series, by priors of the nominal size: exponents up to 200 intervals off."""
    data = towards_a_plane(ellipse(1.0, 0.1), np.pi / 2.0, range=[5e-3, 0.5], samples=8)
    with pytest.raises(InputError, match=r"calibration\.range = .* takes 5 samples .*, 0\.01; give them"):
        pair_of(parse_case(data))
    data["calibration"]["form"] = "table"
    assert pair_of(parse_case(data)).shape == "shapes"


def test_flat_sides_have_no_power_law() -> None:
    """d^-3, of an exponent beyond those that are looked for; a table has it, and the stadium's end a law."""
    stadium = {"kind": "stadium", "length": 2.0, "radius": 0.4}
    nearly = {"kind": "superellipse", "axes": [1.0, 0.7], "exponent": 8.0}  # d^(-21/8)
    for shape in (stadium, nearly):
        with pytest.raises(InputError, match=r"calibration\.pair = .* flat where they are nearest"):
            pair_of(parse_case(towards_a_plane(shape)))
    assert pair_of(parse_case(towards_a_plane(stadium, form="table"))).shape == "shapes"
    assert length(stadium, np.pi / 2.0) == pytest.approx(8.0 / 9.0 * 0.4, rel=0.03)
