"""Meshes of spheres that several tests share, and what they measure of them."""

from __future__ import annotations

from collections.abc import Sequence

import fsi.meshes.backend  # noqa: F401

import numpy as np
import ufl
from dolfinx import fem

from fsi.arrays import Array
from fsi.meshes.build import FluidMesh, build
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.container import Container, FluidDomain
from fsi.meshes.geometry.round import HalfPlane
from fsi.meshes.resolution import Resolution

CUBE = Box((-2.0, -2.0, -2.0), (2.0, 2.0, 2.0))
HALF_BALL = HalfPlane(30.0, dimension=3)
COARSE = Resolution(1.0, 12, 1.0)
USUAL = Resolution(1.0, 20, 0.5)
QUADRATURE = {"quadrature_degree": 12}


def mesh(
    container: Container,
    centres: Sequence[Sequence[float] | Array] | Array,
    radii: Sequence[float] | Array,
    resolution: Resolution = COARSE,
    order: int = 2,
) -> FluidMesh:
    x = np.array(centres, dtype=float).reshape(-1, 3)
    return build(FluidDomain(container, x, np.array(radii, dtype=float)), resolution, order)


def volume(fluid: FluidMesh) -> float:
    one = fem.Constant(fluid.mesh, 1.0)
    return float(np.real(fem.assemble_scalar(fem.form(one * ufl.dx(fluid.mesh, metadata=QUADRATURE)))))


def area(fluid: FluidMesh, tag: int) -> float:
    ds = ufl.ds(fluid.mesh, subdomain_data=fluid.facet_tags, metadata=QUADRATURE)
    return float(np.real(fem.assemble_scalar(fem.form(fem.Constant(fluid.mesh, 1.0) * ds(tag)))))


def cells(fluid: FluidMesh) -> Array:
    """Nodes of all cells, (T, nodes, 3)."""
    x: Array = fluid.mesh.geometry.x[fluid.mesh.geometry.dofmaps[0]]
    return x
