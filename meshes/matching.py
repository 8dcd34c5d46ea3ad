"""Which nodes of a function space are one and the same on the two sides of the cut of a periodic domain."""

from __future__ import annotations

from dataclasses import dataclass

import fsi.meshes.backend  # noqa: F401

import numpy as np
from dolfinx import fem
from mpi4py import MPI
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from fsi.meshes.aliases import FunctionSpace
from fsi.meshes.build import FluidMesh
from fsi.meshes.errors import MeshError
from fsi.meshes.geometry.containers import Array
from fsi.meshes.geometry.lattice import Integers, Lattice, positive

SAME_PLACE = 1e-9  # of the longest period


@dataclass(frozen=True, slots=True)
class PeriodicPairs:
    """Pairs of nodes or points, the same on all ranks: `slave` is the image of `master`.

        x_slave = x_master + shift @ vectors of the lattice

    Attributes:
        slave: numbers, of nodes global ones, (n,).
        master: the same, (n,); no number is in both.
        shift: integers, (n, k).
    """

    slave: NDArray[np.int64]
    master: NDArray[np.int64]
    shift: Integers


def matching_nodes(fluid: FluidMesh, space: FunctionSpace, x: Array) -> PeriodicPairs:
    """The pairs of nodes x of a Lagrange space on the cut; collective, none without periods.

    Raises:
        MeshError: a node on one side has none on the other.
    """
    comm, numbers = fluid.mesh.comm, space.dofmap.index_map
    if fluid.lattice.dimension == 0:
        nothing = np.empty(0, dtype=np.int64)
        return PeriodicPairs(nothing, nothing, nothing.reshape(0, 0))
    nodes = fem.locate_dofs_topological(space, 1, fluid.facet_tags.find(fluid.cut_tag))
    nodes = nodes[nodes < numbers.size_local]
    global_numbers = numbers.local_to_global(nodes.astype(np.int32)).astype(np.int64)
    parts = comm.allgather((global_numbers, x[nodes, :2]))
    every, on_cut = (np.concatenate([part[k] for part in parts]) for k in range(2))
    pairs = matching_points(on_cut, fluid.lattice)
    return PeriodicPairs(every[pairs.slave], every[pairs.master], pairs.shift)


def matching_points(x: Array, lattice: Lattice) -> PeriodicPairs:
    """The pairs among points x (n, 2), each of which has one image among them, by their numbers 0 ... n - 1.

    Raises:
        MeshError: a point has no image.
    """
    torus = on_torus(x, lattice)
    _, near = cKDTree(torus).query(torus, k=[1, 2])
    number = np.arange(len(x))
    partner = np.where(near[:, 0] == number, near[:, 1], near[:, 0])
    paired = bool(np.all(partner < len(x))) and np.array_equal(partner[partner], number)
    if paired:
        difference = x - x[partner]
        shift = np.rint(lattice.coordinates(difference)).astype(np.int64)
        off = np.abs(difference - lattice.shift(shift)).max(initial=0.0)
        paired = off < SAME_PLACE * lattice.longest()
    if not paired:
        raise MeshError("the two sides of a periodic domain do not match; was the mesh made elsewhere?")
    slave = positive(shift)
    return PeriodicPairs(number[slave], partner[slave], shift[slave])


def columns_of_masters(
    comm: MPI.Intracomm, master: NDArray[np.int64], rows: NDArray[np.int64], columns: NDArray[np.int64]
) -> tuple[NDArray[np.bool_], NDArray[np.int64]]:
    """Which rows in `master` are unknowns, (n,), and their columns; collective.

    Args:
        comm: all ranks.
        master: global numbers of the rows asked for, perhaps of other ranks, (n,).
        rows: global numbers of this rank's rows that are unknowns.
        columns: of these.
    """
    wanted = np.concatenate(comm.allgather(master))
    asked = np.isin(rows, wanted)
    answers = comm.allgather((rows[asked], columns[asked]))
    row, column = (np.concatenate([part[k] for part in answers]) for k in range(2))
    order = np.argsort(row)
    place = np.searchsorted(row[order], master)
    known = np.zeros(len(master), dtype=bool)
    inside = place < len(row)
    known[inside] = row[order][place[inside]] == master[inside]
    return known, column[order][place[known]]


def on_torus(x: Array, lattice: Lattice) -> Array:
    """Points as points of a torus in space, where images coincide."""
    turn = 2.0 * np.pi * lattice.coordinates(x)
    size = np.sqrt(np.square(lattice.vectors).sum(axis=1))
    across = x - lattice.coordinates(x) @ lattice.vectors
    return np.column_stack([np.cos(turn) * size, np.sin(turn) * size, across])
