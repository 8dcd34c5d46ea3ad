"""Random bodies of all shapes are what their kinds say; see `bench/random_cases.py`."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pytest
from typer import Typer
from typer.testing import CliRunner

from bench import bars, random_ellipsoids, random_shapes
from bench.bars import Value, main, values
from bench.random_cases import SHAPED, random_case
from fsi.bodies.gaps import find_gaps
from fsi.case.case import Case

ON_AXIS = [name for name in SHAPED if "cylinder" in name or "axisymmetric" in name]
IN_SPACE = [name for name in SHAPED if "in space" in name]


@lru_cache
def drawn(kind: str) -> list[Case]:
    return [random_case(kind, seed) for seed in (1, 2)]


def smallest_gap(case: Case) -> float:
    return find_gaps(case.configuration(), case.container()).smallest()


@pytest.mark.slow
def test_bodies_on_an_axis_have_shapes_and_narrow_gaps() -> None:
    cases = [case for kind in ON_AXIS for case in drawn(kind)]
    for case in cases:
        assert case.axisymmetric
        assert case.bodies[0].shape is not None
        assert all(body.position[0] == 0.0 for body in case.bodies)
    gaps = [smallest_gap(case) / min(body.radius for body in case.bodies) for case in cases]
    assert 0.9 * random_shapes.NARROWEST <= min(gaps) < 1e-3


def test_ellipsoids_in_space_are_turned_and_as_close_as_is_meshed() -> None:
    cases = [case for kind in IN_SPACE for case in drawn(kind)]
    for case in cases:
        assert case.bodies[0].shape is not None
        assert np.all(case.bodies[0].angle)
    gaps = [
        smallest_gap(case) / min(body.ellipsoid.half_axes.min() for body in case.bodies) for case in cases
    ]
    assert random_ellipsoids.NARROWEST <= min(gaps) < 0.1


def test_a_tight_cylinder_is_nearly_filled() -> None:
    """The narrowest gap to it is at most a tenth of its radius."""
    for case in drawn("shapes, tight cylinder"):
        right = case.container().walls.index("right")
        to_tube = find_gaps(case.configuration(), case.container()).wall_gaps[:, right]
        assert to_tube.min() <= 0.1 * case.container().faces["right"][1]


def test_fluid_slides_along_some_bodies_and_some_swim() -> None:
    bodies = [body for kind in ON_AXIS if "slip" in kind for case in drawn(kind) for body in case.bodies]
    assert any(body.slip_length for body in bodies)
    assert any(body.swims for body in bodies)
    assert not any(body.slip_length for case in drawn("shapes, cylinder") for body in case.bodies)


def test_cases_of_the_plane_are_those_that_were_counted() -> None:
    """Regression: the fourth case of this kind when docs/accuracy.md was written."""
    case = random_case("shapes, cell", 3)
    assert [body.shape.model_dump()["kind"] for body in case.bodies if body.shape] == ["spline", "ellipse"]
    np.testing.assert_allclose(case.bodies[0].position, [4.635154764951489, 3.0308265381123314], rtol=1e-12)


def test_shapes_are_all_kinds_of_them(monkeypatch: pytest.MonkeyPatch) -> None:
    tried = []

    def value(kind: str, seed: int, _degree: int | None) -> list[Value]:
        tried.append(kind)
        return [Value(kind, seed, "U[0, 1]", 0.5, 1.0)]

    monkeypatch.setattr(bars, "values", value)
    app = Typer()
    app.command()(main)
    done = CliRunner().invoke(app, ["--kinds", "shapes", "--cases", str(len(SHAPED))])
    assert done.exit_code == 0, done.output
    assert tried == list(SHAPED)
    assert {*ON_AXIS, *IN_SPACE} < {*tried}


@pytest.mark.slow
@pytest.mark.parametrize("kind", [*ON_AXIS, *IN_SPACE])
def test_bars_hold_beside_all_shapes(kind: str) -> None:
    found = values(kind, 1000)
    assert found
    assert all(value.inside for value in found)
