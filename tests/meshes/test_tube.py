"""The round tube in space: what it answers, its curved cells, and what is refused."""

from __future__ import annotations

import fsi.meshes.backend  # noqa: F401

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mpi4py import MPI
from numpy.testing import assert_allclose

from fsi.meshes.build import build
from fsi.meshes.errors import TouchingError
from fsi.meshes.geometry.container import FluidDomain
from fsi.meshes.geometry.tube import Tube
from fsi.meshes.resolution import Resolution
from tests.meshes.spheres import volume

TUBE = Tube(2.0, 5.0)
COARSE = Resolution(0.5, 10, 0.8)


@settings(max_examples=30, deadline=None)
@given(st.tuples(*[st.floats(-1.4, 1.4)] * 3))
def test_its_normals_are_gradients_of_its_distances(place: tuple[float, ...]) -> None:
    x, step = np.array([place]), 1e-6
    if np.hypot(x[0, 0], x[0, 1]) < 1e-3:
        return  # on the axis the nearest point of the side is any
    forth, back = (TUBE.distances(x + sign * step * np.eye(3)) for sign in (1.0, -1.0))
    np.testing.assert_allclose((forth - back).T / (2.0 * step), TUBE.normals(x)[0], atol=1e-5)


def test_its_formulas_are_its_distances() -> None:
    x, y, z = 0.7, -1.1, 1.9
    formulas = [formula.replace("^", "**").replace("sqrt", "np.sqrt") for formula in TUBE.distance_formulas()]
    found = [eval(formula, {"np": np, "x": x, "y": y, "z": z}) for formula in formulas]
    np.testing.assert_allclose(found, TUBE.distances(np.array([[x, y, z]]))[0], rtol=1e-14)


@pytest.mark.parametrize(("order", "tolerance"), [(2, 5e-5), (3, 1e-6)])
def test_curved_cells_fill_it(order: int, tolerance: float) -> None:
    """Straight cells of this mesh miss 2.7 % of the volume."""
    fluid = build(FluidDomain(TUBE, np.array([[0.6, 0.0, 0.3]]), np.array([0.8])), COARSE, order)
    exact = np.pi * (4.0 * 5.0 - 4.0 / 3.0 * 0.8**3)
    assert MPI.COMM_WORLD.size == 1
    assert volume(fluid) == pytest.approx(exact, rel=tolerance)


def test_a_gap_that_is_too_narrow_is_refused() -> None:
    domain = FluidDomain(TUBE, np.array([[1.19, 0.0, 0.0]]), np.array([0.8]))
    with pytest.raises(TouchingError, match=r"to a cylinder is below 0\.02 of its radius"):
        build(domain, COARSE, 2)


def test_lines_of_pictures_lie_on_the_side() -> None:
    edges = Tube(2.0, 12.0).edges
    assert_allclose(np.linalg.norm(edges[..., :2], axis=-1), 2.0, rtol=1e-12)
    assert_allclose([edges[..., 2].min(), edges[..., 2].max()], [-6.0, 6.0])
