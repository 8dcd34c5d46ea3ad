"""Points of a periodic domain that are images of each other."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array, Indices
from fsi.meshes.errors import MeshError
from fsi.meshes.geometry.container import lengths
from fsi.meshes.geometry.lattice import SAME_PLACE, Lattice, positive


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
    shift: Indices


def matching_points(x: Array, lattice: Lattice) -> PeriodicPairs:
    """The pairs among points x (n, d), each of which has images among them, by their numbers 0 ... n - 1.

    Of all images of a point, in the plane two, in space also four on an edge and eight at a corner, the first
    is the master of all others. Raises MeshError where a point has no image.
    """
    import scipy  # late: `fsi check` does without

    torus, longest = on_torus(x, lattice), lattice.longest()
    same = scipy.spatial.cKDTree(torus).query_pairs(_ON_TORUS * SAME_PLACE * longest, output_type="ndarray")
    # In a narrow gap neighbours may be as near as that; they are no nearer on the torus than they are here.
    spacing = scipy.spatial.cKDTree(x).query(x, k=2)[0][:, 1]
    same = same[lengths(torus[same[:, 0]] - torus[same[:, 1]]) < 0.5 * spacing[same].min(axis=1)]
    graph = scipy.sparse.coo_array((np.ones(len(same)), same.T), shape=(len(x), len(x)))
    places, place = scipy.sparse.csgraph.connected_components(graph, directed=False)
    _, any_there = np.unique(place, return_index=True)
    m = np.rint(lattice.coordinates(x - x[any_there[place]])).astype(np.int64)
    order = np.lexsort((*m.T[::-1], place))
    master = order[np.searchsorted(place[order], np.arange(places))]
    shift = m - m[master[place]]
    difference = x - x[master[place]]
    off = np.abs(difference - lattice.shift(shift)).max(initial=0.0)
    slave = positive(shift)
    alone = np.bincount(place, minlength=places).min(initial=2) < 2
    if alone or off >= SAME_PLACE * longest or slave.sum() != len(x) - places:
        raise MeshError("the two sides of a periodic domain do not match; shift all bodies a little")
    return PeriodicPairs(np.flatnonzero(slave), master[place[slave]], shift[slave])


_ON_TORUS = 2.0 * np.pi  # the circumference of a circle on the torus over its period


def on_torus(x: Array, lattice: Lattice) -> Array:
    """Points as points of a torus in space, where images coincide."""
    turn = 2.0 * np.pi * lattice.coordinates(x)
    size = np.sqrt(np.square(lattice.vectors).sum(axis=1))
    across = x - lattice.coordinates(x) @ lattice.vectors
    return np.column_stack([np.cos(turn) * size, np.sin(turn) * size, across])
