"""What is wrong with a shape is told with the key that is, and what to give there."""

from __future__ import annotations

from math import sqrt
from typing import Any

import pytest

from fsi.case.load import parse_case
from fsi.errors import InputError
from tests.case_data import BOX


def line(shape: dict[str, Any]) -> str:
    """What is said of a body of this shape; nothing if it is one."""
    try:
        parse_case(BOX | {"bodies": [{"name": "body", "position": [0.0, 8.0], "shape": shape}]})
    except InputError as error:
        return str(error)
    return ""


TRIANGLE = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]


@pytest.mark.parametrize(
    ("corners", "words"),
    [
        (
            [[0.0, 0.0], [0.5, 0.0], *TRIANGLE[1:]],
            "[0.5, 0.0] is none, as both sides go the same way there; drop it",
        ),
        (TRIANGLE[::-1], "go around clockwise; turn their order round"),
        (
            [[0.0, 0.0], [1.0, 1.0], *TRIANGLE[1:]],
            "do not go around once; give them such that no sides cross",
        ),
    ],
)
def test_corners_of_polygons(corners: list[list[float]], words: str) -> None:
    """All ended with "give the shape of a body, a table with its kind"."""
    said = line({"kind": "polygon", "corners": corners, "rounding": 0.1})
    assert said == f"bodies.0.shape.corners = {corners}: {words}"


def test_arcs_of_a_triangle_are_within_its_inner_circle() -> None:
    """Its radius is 2 area / perimeter = 1 / (2 + sqrt 2) = 0.2929."""
    most = 1.0 / (2.0 + sqrt(2.0))
    triangle = {"kind": "polygon", "corners": TRIANGLE}
    assert not line(triangle | {"rounding": 0.999 * most})
    said = line(triangle | {"rounding": 0.293})
    assert said.startswith("bodies.0.shape.rounding = 0.293: a side is shorter than the arcs")
    assert said.endswith(f"; give less than {most:g}")


@pytest.mark.parametrize(
    ("key", "more", "words"),
    [
        (
            "cosines",
            {"cosines": [0.5], "sines": [0.5]},
            "their sizes and those of the sines add up to 1 or more; lower them",
        ),
        ("cosines", {"cosines": [0.1, 0.1]}, "has 2 coefficients for 1 orders; give one for each"),
        (
            "sines",
            {"cosines": [0.1], "sines": [0.1, 0.1]},
            "has 2 coefficients for 1 orders; give one for each",
        ),
    ],
)
def test_coefficients_of_rough_discs(key: str, more: dict[str, Any], words: str) -> None:
    said = line({"kind": "fourier", "radius": 1.0, "orders": [2], **more})
    assert said == f"bodies.0.shape.{key} = {more[key]}: {words}"


@pytest.mark.parametrize("alpha", [1.0, 0.5, 1.0 / 3.0])
def test_a_tip_is_longer_than_its_disc_is_flat(alpha: float) -> None:
    """SciPy told of f(a) and f(b).

    x / slope(x) = x^(1 - alpha) length^alpha / (1 + alpha) is the radius at the half width x = w, which is
    1e-14 radii where length / w = ((1 + alpha) / 1e-14)^(1 / alpha): 2 radii of a parabola, 2.25e14 for
    alpha = 1/2.
    """
    radius = 2.0
    most = radius * (1.0 + alpha) ** (1.0 / alpha) * 1e14 ** (1.0 / alpha - 1.0)
    tip = {"kind": "tip", "radius": radius, "alpha": alpha}
    assert not line(tip | {"length": 0.999 * most})
    said = line(tip | {"length": most})
    assert said.startswith(f"bodies.0.shape.length = {most}: makes a tip that is flatter than the disc")
    assert said.endswith(f"; give one below {most:g}")
    assert line(tip | {"length": 1e49}).endswith(said.partition(":")[2])
