"""Tips of bodies that are sharper than sizes of elements follow have a node each."""

from __future__ import annotations

import numpy as np
import pytest

from fsi.case.shapes.ellipse import Ellipse
from fsi.meshes.build import build
from fsi.meshes.geometry.container import FluidDomain
from fsi.meshes.geometry.outline import Outline
from fsi.meshes.geometry.placed import Placed
from fsi.meshes.geometry.round import Round
from fsi.meshes.planar.boundary import boundary
from fsi.meshes.resolution import Resolution

DEFAULT = Resolution(0.45, 32, 0.33)


def outline(b: float) -> Outline:
    """Of an ellipse with the half axes 1 and b, whose tips have the radius b^2, at t = 0 and 1/2."""
    return Ellipse(kind="ellipse", axes=(1.0, b)).outline


@pytest.mark.parametrize("b", [0.0012, 0.003])
def test_an_element_goes_around_no_tip(b: float) -> None:
    """It did at the far tip where the number of nodes was odd: the node next to it was 9e-5 away.

    A cell beside that element turned over: its scaled Jacobian was -1.
    """
    body = Placed(outline(b), np.zeros(2), 0.3)
    domain = FluidDomain(Round(10.0), np.zeros((1, 2)), np.ones(1), placed=(body,))
    nodes = boundary(domain, DEFAULT)[0].nodes
    away = np.linalg.norm(nodes[:, None] - body.at(np.array([0.0, 0.5])).x, axis=2).min(axis=0)
    assert np.all(away <= 1e-12)
    assert build(domain, DEFAULT, 4).instead == ""


def test_tips_are_those_that_are_sharper_than_a_thousandth_of_the_radius() -> None:
    """b^2 < 1e-3, in any unit of length."""
    assert outline(0.0317).tips == ()
    for factor in (1.0, 1e3):
        assert outline(0.0316).scaled(factor).tips == pytest.approx([0.0, 0.5], abs=1e-12)
