"""Films in the preconditioner: how wide they are, and that iterations do not grow as they close."""

import fsi.meshes.backend  # noqa: F401

import numpy as np
from numpy.testing import assert_allclose

from fsi.bodies.configuration import Configuration
from fsi.case.case import Case
from fsi.case.load import parse_case
from fsi.meshes.geometry.cell import Cell
from fsi.meshes.geometry.ellipsoid import Ellipsoid
from fsi.stokes.model import StokesModel
from fsi.stokes.solvers.schur import widths


def beside_plane(gap: float, **domain: object) -> Case:
    sphere = {"name": "sphere", "radius": 1.0, "position": [0.0, 0.0, 1.0 + gap], "force": [1.0, 0.0, -1.0]}
    return parse_case(
        {
            "name": "narrow", "geometry": "spatial", "fluid": {"viscosity": 0.7}, "bodies": [sphere],
            "domain": {"shape": "half-plane", "radius": 20.0} | domain,
            "discretisation": {"degree": 2, "cells_per_circle": 10, "growth": 0.8, "solver": "iterative"},
        }
    )  # fmt: skip


def test_widths_of_films() -> None:
    """Between a sphere and a plane, images of a sphere, and beside an ellipsoid."""
    one = beside_plane(0.02)
    x = np.array([[0.0, 0.0, 0.01], [0.1, 0.0, 0.005], [0.0, 0.0, 2.52]])
    exact = [0.02, 0.005 + np.hypot(0.1, 1.015) - 1.0, 0.5 + 2.52]
    assert_allclose(widths(x, one.configuration(), one.container()), exact, atol=1e-12)
    cell = Cell(((2.1, 0.0, 0.0), (0.0, 3.0, 0.0), (0.5, 0.0, 3.0)), ((0.0,) * 3,) * 3)
    q = Configuration.unturned(np.array([[7.0, -4.0, 0.3]]), np.array([1.0]))
    assert_allclose(widths(np.array([[8.05, 2.0, 0.3]]), q, cell), 0.1, atol=1e-12)
    form = Ellipsoid(np.array([2.0, 1.0, 0.5]))
    q = Configuration(np.array([[0.0, 0.0, 0.53]]), np.zeros((1, 3)), np.array([2.0]), ellipsoids=(form,))
    assert_allclose(widths(np.array([[0.0, 0.0, 0.01]]), q, one.container()), 0.03, rtol=0.05)


def test_iterations_do_not_grow_as_a_gap_closes() -> None:
    """At a gap of 1e-3 radii the mass matrix of the pressure alone takes 304, with an eighth of K 50."""
    one = beside_plane(1e-3)
    assert StokesModel(one)(one.configuration(), 0.0).iterations < 45


def test_open_walls_hold_the_level_of_the_pressure() -> None:
    """K knows nothing of it: where its inverse acts on the level too it takes 318 iterations."""
    one = beside_plane(0.05, walls={"far": "open"})
    assert StokesModel(one)(one.configuration(), 0.0).iterations < 50
