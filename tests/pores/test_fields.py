"""The fields between pores have values at every point of the fluid, and at none in a body."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import fsi
from fsi.arrays import Array

CELL = np.array([[6.0, 0.0], [1.0, 5.0]])
WALLS = {"walls": {"top": [1.0, 0.0]}}
# Circles of fluid stand several periods from each other; a small disc stands beside a large one, or in a
# corner that large pores have to themselves.
CASES: dict[str, tuple[dict[str, Any], list[tuple[float, list[float]]]]] = {
    "wide channel": ({"lower": [0, 0], "upper": [40, 40], "periodic": ["x"], **WALLS}, [(1.0, [20.0, 20.0])]),
    "unlike discs": (
        {"shape": "cell", "vectors": CELL.tolist(), "shear": 1.0},
        [(1.0, [1.6, 1.5]), (0.02, [1.6 + 0.8 * 1.02001, 1.5 + 0.6 * 1.02001])],
    ),
    "small disc": ({"lower": [0, 0], "upper": [5, 4.5], "periodic": ["x"], **WALLS}, [(0.1, [2.0, 0.15])]),
}


def solved(domain: dict[str, Any], discs: list[tuple[float, list[float]]]) -> fsi.Solution:
    bodies = [{"name": f"disc {i}", "radius": a, "position": x} for i, (a, x) in enumerate(discs)]
    data: dict[str, Any] = {"name": "t", "model": "pores", "fluid": {"viscosity": 1.0}, "domain": domain}
    return fsi.solve(fsi.make_case(**data, bodies=bodies, pores={"modes": 1}))


def points_in(domain: dict[str, Any], n: int) -> tuple[Array, Array]:
    """Random points of one period, (n, 2), and the images of a point there are around, (m, 2)."""
    t = np.random.default_rng(4).uniform(size=(n, 2))
    around = np.stack(np.meshgrid([-1, 0, 1], [-1, 0, 1]), axis=-1).reshape(-1, 2)
    if "vectors" in domain:
        return t @ CELL, around @ CELL
    return t * domain["upper"], around * [domain["upper"][0], 0.0]


@pytest.mark.parametrize("name", CASES)
def test_all_points_of_the_fluid_have_a_velocity(name: str) -> None:
    """With images of circles one period away alone, or the eight nearest pores, up to a tenth had none."""
    domain, discs = CASES[name]
    x, images = points_in(domain, 4000)
    inside = np.zeros(len(x), bool)
    for a, centre in discs:
        from_images = x[:, None] - (np.array(centre) + images)
        inside |= (np.hypot(*np.moveaxis(from_images, -1, 0)) < a).any(axis=1)
    assert np.array_equal(np.isnan(solved(domain, discs).velocity(x)[:, 0]), inside)


def test_points_on_a_circle_are_those_of_the_fluid_there() -> None:
    """To rounding half of them lie inside; a disc that moves freely has the velocity of its surface there."""
    domain, discs = CASES["small disc"]
    solution, (a, centre) = solved(domain, discs), discs[0]
    angle = np.linspace(0.0, 2.0 * np.pi, 200)
    r = a * np.column_stack([np.cos(angle), np.sin(angle)])
    body = solution["disc 0"]
    exact = body.velocity + body.angular_velocity * np.column_stack([-r[:, 1], r[:, 0]])
    np.testing.assert_allclose(solution.velocity(centre + r), exact, atol=1e-9)
