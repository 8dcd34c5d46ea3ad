"""The order parameter and the tumbling rate of bodies that are longer than wide."""

from __future__ import annotations

import numpy as np
import pytest

from fsi.bodies.configuration import Configuration
from fsi.bodies.order import order_columns
from fsi.case.shapes.ellipse import Ellipse
from fsi.meshes.geometry.outline import Outline

LONG, TALL = (Ellipse(kind="ellipse", axes=axes).outline for axes in ((2.0, 1.0), (1.0, 2.0)))


def at(angles: list[float], *outlines: Outline) -> Configuration:
    n = len(angles)
    return Configuration(np.zeros((n, 2)), np.array(angles), np.full(n, 2.0), outlines)


def test_the_order_is_that_of_axes_not_of_angles() -> None:
    """Parallel ones have S = 1, crossed ones 0; two at an angle d have |cos d|."""
    U = np.array([[0.0, 0.0, -0.2], [0.0, 0.0, -0.8], [0.0, 0.0, 9.0]])
    disc = Outline.disc(1.0)
    parallel = order_columns(at([0.3, 0.3 - 0.5 * np.pi, 0.0], LONG, TALL, disc), U)
    assert parallel == pytest.approx({"order_parameter": 1.0, "tumbling_rate": -0.5})
    crossed = order_columns(at([0.3, 0.3, 0.0], LONG, TALL, disc), U)
    assert crossed["order_parameter"] == pytest.approx(0.0, abs=1e-12)
    apart = order_columns(at([0.1, 0.1 + 0.7, 0.0], LONG, LONG, disc), U)
    assert apart["order_parameter"] == pytest.approx(np.cos(0.7), rel=1e-12)


def test_of_discs_and_of_one_body_there_is_nothing_to_say() -> None:
    assert order_columns(at([0.0, 0.0]), np.zeros((2, 3))) == {}
    assert order_columns(at([0.0, 0.0], LONG, Outline.disc(1.0)), np.zeros((2, 3))) == {}
