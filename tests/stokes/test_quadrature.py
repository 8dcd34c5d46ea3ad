"""Integrals of polynomials are exact, on straight cells and on curved ones, with an axis and without."""

from __future__ import annotations

from functools import cache

import fsi.meshes.backend  # noqa: F401

import numpy as np
import pytest
import ufl
from dolfinx import fem
from dolfinx.mesh import exterior_facet_indices
from mpi4py import MPI

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.round import HalfPlane
from fsi.meshes.resolution import Resolution
from fsi.stokes.discretisation.cells import StokesCells
from fsi.stokes.discretisation.forms import Forms, pressure_element, velocity_element
from fsi.stokes.solvers.system import nodal_vector
from tests.flows import discs, mesh
from tests.stokes.matrices import added_up

MU, DEGREE = 0.7, 3
PLANE = Box((0.0, 0.0), (2.0, 1.0))
CYLINDER = Box((0.0, 0.0), (2.0, 1.0), axisymmetric=True)
COARSE = Resolution(0.5, 12, 1.0)


def cubic(x: Array) -> Array:
    """u = (x^3 + x y^2, y^3 - x^2 y), given points (3, n)."""
    return np.stack([x[0] ** 3 + x[0] * x[1] ** 2, x[1] ** 3 - x[0] ** 2 * x[1]])


@cache
def empty(axisymmetric: bool) -> Forms:
    """A container without bodies: all cells are straight."""
    nobody = Configuration.unturned(np.empty((0, 2)), np.empty(0))
    return Forms(mesh(CYLINDER if axisymmetric else PLANE, nobody, COARSE), DEGREE, MU)


@pytest.mark.parametrize("axisymmetric", [False, True])
def test_a_cubic_flow_is_integrated_exactly_on_straight_cells(axisymmetric: bool) -> None:
    """Loads of degree 6, with the weight r of degree 7; the dissipation by points and by A."""
    x, wx = np.polynomial.legendre.leggauss(12)
    X, Y = np.meshgrid(1.0 + x, 0.5 * (1.0 + x), indexing="ij")
    weights = np.outer(wx, 0.5 * wx) * (2.0 * np.pi * X if axisymmetric else 1.0)
    u = cubic(np.stack([X, Y]))
    e_e = (3.0 * X**2 + Y**2) ** 2 + (3.0 * Y**2 - X**2) ** 2  # the shear strain 2 x y - 2 x y vanishes
    if axisymmetric:
        e_e = e_e + (u[0] / X) ** 2
    forms = empty(axisymmetric)
    forms.u.interpolate(cubic)
    forms.f.interpolate(cubic)
    values = np.array(forms.u.x.array, dtype=np.float64)
    load = nodal_vector(forms.bind("load"))
    assert load @ values == pytest.approx(np.sum(weights * (u**2).sum(axis=0)), rel=1e-13)
    dissipation = 2.0 * MU * np.sum(weights * e_e)
    assert StokesCells(forms, condensed=True).dissipation() == pytest.approx(dissipation, rel=1e-13)
    A = added_up(forms)[: len(values), : len(values)]
    assert values @ (A @ values) == pytest.approx(dissipation, rel=1e-13)


@pytest.mark.parametrize("axisymmetric", [False, True])
def test_the_divergence_is_integrated_exactly_on_curved_cells(axisymmetric: bool) -> None:
    """q div u |J| is a polynomial of degree 2 k = 6 on cells of order 3, with the weight r of degree 9.

    Against the same integral with points enough for degree 16: two degrees fewer leave 1e-4 of it.
    """
    container = Box((0.0, -1.5), (2.0, 1.5), True) if axisymmetric else Box((-1.5, -1.5), (1.5, 1.5))
    fluid = mesh(container, discs([(0.0, 0.1)], [0.8]), COARSE)
    forms, random = Forms(fluid, DEGREE, MU), np.random.default_rng(0)
    u, p = random.standard_normal(len(forms.u.x.array)), random.standard_normal(len(forms.p.x.array))
    forms.u.x.array[:], forms.p.x.array[:] = u, p
    r = ufl.SpatialCoordinate(fluid.mesh)[0]
    div = ufl.div(forms.u)
    # With an axis times r, as u_r / r is not polynomial.
    integrand = forms.p * (2 * ufl.pi * (r * div + forms.u[0]) if axisymmetric else div)
    exactly = fem.form(-integrand * ufl.dx(metadata={"quadrature_degree": 16}))
    expected = fluid.mesh.comm.allreduce(fem.assemble_scalar(exactly), op=MPI.SUM)
    B = added_up(forms)[len(u) :, : len(u)]
    assert p @ (B @ u) == pytest.approx(expected, rel=1e-11)


def test_the_elements_are_those_of_taylor_and_hood() -> None:
    """Continuous, cubic for the velocity and quadratic for the pressure, which these degrees are for."""
    assert velocity_element(DEGREE, 2).embedded_superdegree == 3
    assert pressure_element(DEGREE, 2).embedded_superdegree == 2


@pytest.mark.parametrize("degree", [2, 3, 4])
def test_nothing_flows_through_curved_boundaries_in_space(degree: int) -> None:
    """u = (z, 0, 0) through all of a half-ball, and any u through each cell: degree 3 left 1e-7 of it."""
    container = HalfPlane(4.0, dimension=3)
    q = Configuration.unturned(np.array([[0.0, 0.0, 1.5]]), np.ones(1))
    forms = Forms(mesh(container, q, Resolution(0.5, 6, 1.0), degree), degree, MU)
    forms.u.interpolate(lambda x: np.stack([x[2], 0.0 * x[2], 0.0 * x[2]]))
    assert abs(forms.integrate("flux")) < 1e-13 * forms.integrate("speed on boundary")
    ones = np.ones(forms.Q.dofmap.index_map.size_local)
    B = added_up(forms)[-len(ones) :, : -len(ones)]
    inside = (B.T @ ones).reshape(-1, 3)
    inside[fem.locate_dofs_topological(forms.V, 2, exterior_facet_indices(forms.mesh.topology))] = 0.0
    assert np.abs(inside).max() < 1e-12
