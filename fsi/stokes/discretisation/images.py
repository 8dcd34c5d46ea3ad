"""Rows of nodes on the sides of a periodic domain, tied to those of their images."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.meshes.build import FluidMesh, FunctionSpace, matching_nodes
from fsi.stokes.discretisation.constraints import DofLayout


def tied(layout: DofLayout, fluid: FluidMesh, spaces: Sequence[tuple[FunctionSpace, Array]]) -> DofLayout:
    """The layout with its slaves; collective.

    spaces: that of the velocities and, if the layout has them, that of the pressures, with their nodes on
    this rank, ghosts last, (n, d).
    """
    pairs = [matching_nodes(fluid, space, x) for space, x in spaces]
    maps, d = [space.dofmap.index_map for space, _ in spaces], layout.dimension
    here = [*(numbers.local_range[0] for numbers in maps), maps[0].size_local, layout.rows]
    starts = np.array(layout.comm.allgather(here))
    first_row = np.concatenate([[0], np.cumsum(starts[:, -1])])

    def rows(numbers: NDArray[np.int64], space: int, component: int) -> NDArray[np.int64]:
        """Global rows of nodes, given by their global numbers, of velocities (0) or pressures (1)."""
        owner = np.searchsorted(starts[:, space], numbers, side="right") - 1
        local = numbers - starts[owner, space]
        of_rank = d * local + component if space == 0 else d * starts[owner, -2] + local
        return np.asarray(first_row[owner] + of_rank)

    parts = [(pairs[0], 0, component) for component in range(d)] + [(p, 1, 0) for p in pairs[1:]]
    slave = np.concatenate([rows(p.slave, space, c) for p, space, c in parts])
    master = np.concatenate([rows(p.master, space, c) for p, space, c in parts])
    shift = fluid.lattice.shift(np.concatenate([p.shift for p, _, _ in parts]))
    slave -= first_row[layout.comm.rank]
    mine = (slave >= 0) & (slave < layout.rows)
    # What is given, or rigid, needs no image, but what slides there does.
    slave, master, shift = slave[mine], master[mine], shift[mine]
    slides = np.isin(slave, layout.slip)
    free = ~np.isin(slave, np.concatenate([layout.fixed, layout.on_body]))
    return replace(
        layout, slave=slave[free], master=master[free], away=shift[free],
        slip_slave=slave[slides], slip_master=master[slides],
    )  # fmt: skip
