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

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fsi.bodies.configuration import Array
from fsi.stokes.discretisation.forms import MATRICES, Forms
from fsi.stokes.discretisation.jit import compile_c
from fsi.stokes.discretisation.nodes import inner_nodes
from fsi.stokes.discretisation.shared_rows import Index, SharedRows

type Numbers = NDArray[np.int32]


@cache
def loops() -> Any:
    """The loops over cells in machine code, with `ffi` and `lib`; collective."""
    here = Path(__file__).parent
    return compile_c(here / "cells.h", here / "cells.c")


def pointer(values: NDArray[Any]) -> Any:
    """An array as the loops take it, which must outlive it."""
    kind = {"b": "int8_t", "i": "int32_t", "l": "int64_t", "L": "uintptr_t", "h": "int16_t",
            "d": "double", "g": "long double"}  # fmt: skip
    assert values.flags.c_contiguous
    return loops().ffi.from_buffer(f"{kind[values.dtype.char]}[]", values)


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
        self._velocities, self._pressures = velocities.shape[1], Q.list.shape[1]
        inner = inner_rows(forms) if condensed else np.empty(0, dtype=np.int64)
        self.inner, outer = len(inner), np.setdiff1d(np.arange(every.shape[1]), inner)
        order = np.concatenate([outer, inner])
        self._source = _sources(self._velocities, self._pressures)[np.ix_(order, order)].copy()
        self.rows: Numbers = np.ascontiguousarray(every[:, order], dtype=np.int32)
        self.factors, n = np.empty((cells, self.inner, every.shape[1])), every.shape[1]
        self.matrices = np.empty((cells, n * (n + 1) // 2)) if condensed else None
        self._kind, self._kernels = forms.kinds(), {name: forms.kernels(name) for name in MATRICES}

    @property
    def outer(self) -> Numbers:
        """The outer rows of x on each cell, (cells, n - inner)."""
        return self.rows[:, : self.rows.shape[1] - self.inner]

    @property
    def inner_here(self) -> Index:
        """The inner rows of x on this rank, which are its own."""
        inner = np.zeros(self.shared.size, dtype=bool)
        inner[self.rows[:, self.rows.shape[1] - self.inner :]] = True
        return np.flatnonzero(inner[self.shared.own])

    def add(self, sum_: Any, values: Array, kept: Array) -> None:
        """Add up the matrices of all cells; sum_: a `Sum` of cells.h."""
        geometry, mu = self._forms.mesh.geometry, np.array([self._forms.viscosity])
        points = geometry.dofmaps[0]
        arrays: dict[str, NDArray[Any]] = {
            "a": self._kernels["a"], "b": self._kernels["b"], "kind": self._kind, "x": geometry.x,
            "geometry": points, "mu": mu, "source": self._source,
        }  # fmt: skip
        sizes = {"cells": len(self.rows), "points": points.shape[1], "velocities": self._velocities,
                 "pressures": self._pressures, "inner": self.inner}  # fmt: skip
        held = {name: pointer(array) for name, array in arrays.items()}
        cells = loops().ffi.new("Cells *", sizes | held)
        matrices = loops().ffi.NULL if self.matrices is None else pointer(self.matrices)
        loops().lib.add_cells(cells, sum_, pointer(values), pointer(kept), matrices, pointer(self.factors))

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
        return np.asarray(every[self.shared.own])

    @property
    def _sizes(self) -> tuple[int, int, int]:
        return (*self.rows.shape, self.inner)


def inner_rows(forms: Forms) -> Index:
    """Which rows (u, p) of a cell belong to no other: pressures, then velocities."""
    d, velocities = forms.V.dofmap.index_map_bs, forms.V.dofmap.list.shape[1]
    of_u, of_p = (inner_nodes(space) for space in (forms.V, forms.Q))
    return np.concatenate([d * velocities + of_p, (d * of_u[:, None] + np.arange(d)).ravel()])


def _sources(velocities: int, pressures: int) -> Numbers:
    """Where the entries of E = [A B^T; B 0] stand in A, B and a zero, one after the other."""
    A = np.arange(velocities**2).reshape(velocities, velocities)
    B = A.size + np.arange(pressures * velocities).reshape(pressures, velocities)
    zero = np.full((pressures, pressures), A.size + B.size)
    return np.block([[A, B.T], [B, zero]]).astype(np.int32)
