"""The smaller container that shows what a finite one changes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from fsi.case.load import parse_case
from fsi.integration.errors import ErrorEstimate
from fsi.observables.scales import flow_scales
from fsi.observables.truncation import halved, truncation


@pytest.mark.parametrize("geometry", ["planar", "axisymmetric", "spatial"])
@pytest.mark.parametrize("shape", ["round", "half-plane"])
def test_the_smaller_container_has_half_the_radius(geometry: str, shape: str) -> None:
    """An effect of 1/R doubles then: its change is the effect itself. At R/1.2 it would be a fifth of it."""
    place = [0.0, 2.0] if geometry != "spatial" else [0.0, 0.0, 2.0]
    data: dict[str, Any] = {
        "name": "x", "geometry": geometry, "fluid": {"viscosity": 1.0},
        "domain": {"shape": shape, "radius": 40.0},
        "bodies": [{"name": "one", "radius": 1.0, "position": place}],
    }  # fmt: skip
    half = halved(parse_case(data))
    assert half is not None
    assert half.container().size() == parse_case(data).container().size() / 2.0
    assert half.domain.model_dump()["radius"] == 20.0
    assert halved(parse_case(data | {"domain": {"shape": shape, "radius": 5.0}})) is None  # no room


@pytest.mark.parametrize(("x", "real"), [(3.997, True), (0.9, True), (0.85, False)])
def test_a_container_with_a_wall_near_a_body_is_real(x: float, real: bool) -> None:
    """A gap of 0.003 in a disc of radius 5 was solved at radius 2.5 too; within 3/8 of 5, |x| + 1 < 1.875."""
    data: dict[str, Any] = {
        "name": "x", "fluid": {"viscosity": 1.0}, "domain": {"shape": "round", "radius": 5.0},
        "bodies": [{"name": "one", "radius": 1.0, "position": [x, 0.0]}],
    }  # fmt: skip
    assert (halved(parse_case(data)) is None) == real


@pytest.mark.parametrize(("geometry", "surface"), [("planar", np.pi), ("spatial", np.pi)])
def test_what_rounding_leaves_of_a_pressure_all_around_is_no_change(geometry: str, surface: float) -> None:
    """Radius 0.5, pressure 2: on 2 pi a, or 4 pi a^2, it pushes with 2 pi, of which 6e-11 is rounding.

    Forces of 1e-14 that differ by as much changed by the whole of themselves; a force of 1e-9 is none of it.
    """
    d = 2 if geometry == "planar" else 3
    case = parse_case(
        {
            "name": "at rest", "geometry": geometry, "fluid": {"viscosity": 1.0},
            "domain": {"shape": "round", "radius": 5.0, "walls": {"far": {"pressure": 2.0}}},
            "bodies": [{
                "name": "one", "radius": 0.5, "position": [0.0] * d, "velocity": [0.0] * d,
                "angular_velocity": 0.0 if d == 2 else [0.0] * 3,
            }],
        }
    )  # fmt: skip
    assert flow_scales(case, 0.0).thrust == pytest.approx(2.0 * surface, rel=1e-14)
    U = np.zeros((1, len(case.modes)))
    whole, half = (ErrorEstimate(U, np.full_like(U, F)) for F in (1e-14, 2e-14))
    assert truncation(case, whole, half) == {"force": 0.0}
    real = ErrorEstimate(U, np.full_like(U, 1e-9))
    assert truncation(case, real, half)["force"] == pytest.approx(1.0, rel=1e-4)
