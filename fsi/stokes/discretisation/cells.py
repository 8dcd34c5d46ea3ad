"""The Stokes matrices of single cells, and the elimination of what stands in one cell alone.

With the unknowns of a cell ordered as outer ones o, shared with other cells, and inner ones i,

    [ S_oo  E_oi ]   [ outer ]           E = [ A  B^T ]
    [ E_io  E_ii ]   [ inner ]               [ B   0  ]

is factorised as L D L^T from its last row up to the first inner one: what is left of the outer rows is

    S = E_oo - E_oi E_ii^-1 E_io,

the loads of inner unknowns go to the outer ones, b_o - E_oi E_ii^-1 b_i, and once those are known the inner
ones follow from E_ii x_i = b_i - E_io x_o. So the flow, all reactions and all identities stay what they are.
Inner pressures stand before inner velocities, whose block is positive definite and goes first. That what is
left of the pressures is regular too: for a bubble g = w q of the pressure, w vanishing on the sides and q of
degree k - 4, the velocity v = r g is one of those within the cell, and  int g div v = int g^2  in the plane.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, fields
from functools import cache
from typing import Any

import basix
import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from fsi.arrays import Array, Indices
from fsi.meshes.build import coordinate_element
from fsi.meshes.cells.curved import SIMPLEX, barycentric, reference_points
from fsi.stokes.discretisation.forms import Forms, points_degree, pressure_element, velocity_element
from fsi.stokes.discretisation.groups import Groups
from fsi.stokes.discretisation.loops import Numbers, loops, pointer
from fsi.stokes.discretisation.nodes import inner_nodes
from fsi.stokes.discretisation.shared_rows import SharedRows

BENT = 1e-12  # distance of a node from its place in a straight cell, in sizes of the cell


@dataclass(frozen=True, slots=True)
class Tables:
    """The bases on the reference cell, as `Cells` of cells.h has them."""

    weights: Array
    of_map: Array
    of_u: Array
    of_p: Array
    stiffness: Array
    divergence: Array


@cache
def tables(order: int, degree: int, dimension: int, axisymmetric: bool) -> Tables:
    """For cells of that order and velocities of that degree.

    On straight cells integrals are those on the reference cell times constants, a fifth of the work of points
    of quadrature; these two are exact with points for degree 2 k - 2.
    """
    u, p = velocity_element(degree, dimension).sub_elements[0], pressure_element(degree, dimension)
    points, weights = basix.make_quadrature(
        SIMPLEX[dimension], points_degree(order, degree, dimension, axisymmetric)
    )
    of_map = coordinate_element(order, dimension).sub_elements[0].tabulate(1, points)
    of_u, of_p = u.tabulate(1, points), p.tabulate(0, points)[0]
    exact, exact_weights = basix.make_quadrature(SIMPLEX[dimension], 2 * (degree - 1))
    derivatives, values = u.tabulate(1, exact)[1:], p.tabulate(0, exact)[0]
    stiffness = np.einsum("q,aqi,bqj->abij", exact_weights, derivatives, derivatives)
    divergence = np.einsum("q,qk,aqi->aki", exact_weights, values, derivatives)
    by_points = (np.swapaxes(of_map, 0, 1), np.swapaxes(of_u, 0, 1), of_p)
    return Tables(weights, *map(np.ascontiguousarray, (*by_points, stiffness, divergence)))


class StokesCells:
    """The Stokes matrices of this rank's cells, on the mesh as it is when they are added up.

    Attributes:
        condensed: whether inner unknowns are eliminated.
        shared: rows that this rank's cells share with others'.
        rows: of x on each cell in local numbers, outer ones first, (cells, n).
        inner: how many of the rows of a cell are inner ones.
        matrices: E of each cell, its lower triangle, (cells, n (n + 1) / 2); None for the iterative solver.
        factors: the inner rows of the L and D of each cell, (cells, inner, n).
    """

    def __init__(self, forms: Forms, *, condensed: bool) -> None:
        """Collective. condensed: whether inner unknowns are eliminated, else none count."""
        self._forms, self.shared, self.condensed = forms, SharedRows(forms), condensed
        V, Q, d = forms.V.dofmap, forms.Q.dofmap, forms.V.dofmap.index_map_bs
        topology = forms.mesh.topology
        cells = topology.index_map(topology.dim).size_local
        velocities = (d * V.list[:cells, :, None] + np.arange(d, dtype=np.int32)).reshape(cells, -1)
        every = np.hstack([velocities, self.shared.pressures + Q.list[:cells]])
        inner = inner_rows(forms) if condensed else np.empty(0, dtype=np.int64)
        self.inner, outer = len(inner), np.setdiff1d(np.arange(every.shape[1]), inner)
        order = np.concatenate([outer, inner])
        self._place = np.argsort(order).astype(np.int32)
        self.rows: Numbers = np.ascontiguousarray(every[:, order], dtype=np.int32)
        self.factors, n = np.empty((cells, self.inner, every.shape[1])), every.shape[1]
        self.matrices = np.empty((cells, n * (n + 1) // 2)) if condensed else None
        self._sizes_of_cells = {"nodes": V.list.shape[1], "pressures": Q.list.shape[1], "inner": self.inner}

    @property
    def outer(self) -> Numbers:
        """The outer rows of x on each cell, (cells, n - inner)."""
        return self.rows[:, : self.rows.shape[1] - self.inner]

    @property
    def inner_here(self) -> Indices:
        """The inner rows of x on this rank, which are its own."""
        inner = np.zeros(self.shared.size, dtype=bool)
        inner[self.rows[:, self.rows.shape[1] - self.inner :]] = True
        return np.flatnonzero(self.shared.owned(inner))

    def add(self, sum_: Any, groups: Groups, values: Array, kept: Array) -> None:
        """Add up what groups of cells leave of their matrices; sum_: a `Sum` of cells.h."""
        matrices = loops().ffi.NULL if self.matrices is None else pointer(self.matrices)
        with self._in_c() as cells:
            loops().lib.add_cells(
                cells, sum_, groups.structure, pointer(groups.room), pointer(values), pointer(kept), matrices,
                pointer(self.factors), pointer(groups.factors),
            )  # fmt: skip

    def dissipation(self) -> float:
        """int 2 mu e : e of the flow in u of the forms, point by point; collective."""
        forms = self._forms
        with self._in_c() as cells:
            here = loops().lib.squared_strain_rate(
                cells, pointer(forms.V.dofmap.list), pointer(forms.u.x.array)
            )
        return 2.0 * forms.viscosity * float(MPI.COMM_WORLD.allreduce(here))

    @contextmanager
    def _in_c(self) -> Iterator[Any]:
        """The cells on the mesh as it is, as `Cells` of cells.h."""
        forms, geometry = self._forms, self._forms.mesh.geometry
        d, points = geometry.dim, geometry.dofmaps[0]
        bases = tables(geometry.cmaps[0].degree, forms.degree, d, forms.axisymmetric)
        arrays: dict[str, NDArray[Any]] = {name.name: getattr(bases, name.name) for name in fields(Tables)}
        arrays |= {"straight": _straight(forms), "x": geometry.x, "geometry": points, "place": self._place}
        known = {"dimension": d, "axisymmetric": int(forms.axisymmetric), "mu": forms.viscosity}
        known |= {"cells": len(self.rows), "points": points.shape[1], "count": len(bases.weights)}
        held = {name: pointer(array) for name, array in arrays.items()}
        yield loops().ffi.new("Cells *", self._sizes_of_cells | known | held)

    def times(self, x: Array) -> Array:
        """M x for some columns x (rows, k), in their precision; collective."""
        assert self.matrices is not None, "kept for the direct solver alone"
        every = np.ascontiguousarray(self.shared.with_ghosts(x).T)
        product, lib = np.zeros_like(every), loops().lib
        loop = lib.times_cells if x.dtype == np.float64 else lib.times_cells_extended
        sizes = (*self.rows.shape, every.shape[1], len(every))
        loop(*sizes, *map(pointer, (self.rows, self.matrices, every, product)))
        return self.shared.summed(product.T)

    def reduced(self, b: Array) -> Array:
        """The loads with those of inner unknowns given to the outer ones, this rank's rows; collective."""
        every = self.shared.with_ghosts(b)
        every[self.shared.ghosts] = 0.0
        loops().lib.reduce_loads(*self._sizes, *map(pointer, (self.rows, self.factors, every)))
        return np.asarray(self.shared.summed(every))

    def recovered(self, x: Array, b: Array) -> Array:
        """The values of all unknowns from those of the outer ones and reduced loads; collective."""
        every, loads = self.shared.with_ghosts(x), self.shared.with_ghosts(b)
        loops().lib.recover(*self._sizes, *map(pointer, (self.rows, self.factors, loads, every)))
        return self.shared.owned(every)

    @property
    def _sizes(self) -> tuple[int, int, int]:
        return (*self.rows.shape, self.inner)


def inner_rows(forms: Forms) -> Indices:
    """Which rows (u, p) of a cell belong to no other: pressures, then velocities."""
    d, velocities = forms.V.dofmap.index_map_bs, forms.V.dofmap.list.shape[1]
    of_u, of_p = (inner_nodes(space) for space in (forms.V, forms.Q))
    return np.concatenate([d * velocities + of_p, (d * of_u[:, None] + np.arange(d)).ravel()])


def _straight(forms: Forms) -> NDArray[np.int8]:
    """Which cells of this rank are images of the reference cell under maps of degree 1."""
    mesh, d = forms.mesh, forms.mesh.topology.dim
    points = mesh.geometry.dofmaps[0][: mesh.topology.index_map(d).size_local]
    x = np.take(mesh.geometry.x[:, :d].T, points.T, axis=1)  # (d, nodes, cells)
    weights = barycentric(reference_points(mesh.geometry.cmaps[0].degree, d))
    away = weights @ x[:, : d + 1]
    away -= x
    off = np.abs(away, out=away).max(axis=(0, 1))
    return np.asarray(off <= BENT * np.ptp(x[:, : d + 1], axis=1).max(axis=0), dtype=np.int8)
