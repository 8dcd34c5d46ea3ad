"""The constraints of the discrete Stokes system, as one prolongation P and one offset g.

All unknowns x = (u, p) are written with the independent ones y = (u inside, p, free modes of U):

    x = P y + g

The rows of P are unit rows for free unknowns, the rigid modes `V + omega x r` at the nodes on bodies, and
empty for given wall velocities, which stand in g together with the held modes. Where fluid slides along a
surface, y has the slip s = u - w as well, in a column of its own (see `slip`). On one side of the cut of a
periodic domain the rows are those of the nodes' images on the other, and the jump from image to image stands
in g. `rigid`, called K in the saddle-point system of `multiplier`, is the part for all M N modes, M of each
body: u = rigid U on the bodies, and the total load of any nodal reaction is  (F, T) = rigid^T lambda.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from fsi.arrays import Array, Indices
from fsi.bodies.configuration import MODES, Configuration, rigid_motion
from fsi.meshes.build import FluidMesh, columns_of_masters
from fsi.meshes.geometry.lattice import Lattice
from fsi.stokes.discretisation.nodal_matrix import NO_COLUMN, NodalMatrix
from fsi.stokes.discretisation.nodes import BoundaryNodes

# For each component of the velocity the modes that give it: its translation, rotations about the other axes.
ACTING = {2: ((0, 2), (1, 2)), 3: ((0, 4, 5), (1, 5, 3), (2, 3, 4))}


@dataclass(frozen=True, slots=True)
class DofLayout:
    """How the rows of x = (u, p) are shared out over the ranks; local numbers but where said.

    Attributes:
        comm: the ranks.
        dimension: d, components of the velocity.
        velocity_nodes: of this rank, d rows each.
        pressure_nodes: of this rank, a row each, after those of u.
        fixed: rows whose value is given: walls, the pinned pressure, u_r on an axis.
        on_body: rows of nodes on bodies.
        body: the body of each of these.
        modes: M N, all owned by rank 0.
        axisymmetric: V_z is a body's only mode.
        slave: rows whose unknowns are those of other rows, at their images.
        master: these other rows, global numbers.
        away: how far each slave lies from its master, (slaves, d).
        inner: rows that are eliminated within cells.
        slip: those of the given ones and of those on bodies that have an unknown slip.
        normal: one row for each node with an unknown normal traction.
        sliding: whether any rank has such rows.
        slip_slave: rows with a slip that is that of other rows, at their images.
        slip_master: these other rows, global numbers.
    """

    comm: MPI.Intracomm
    dimension: int
    velocity_nodes: int
    pressure_nodes: int
    fixed: Indices
    on_body: Indices
    body: Indices
    modes: int
    axisymmetric: bool
    slave: Indices = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    master: Indices = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    away: Array = field(default_factory=lambda: np.empty((0, 2)))
    inner: Indices = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    slip: Indices = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    normal: Indices = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    sliding: bool = False
    slip_slave: Indices = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    slip_master: Indices = field(default_factory=lambda: np.empty(0, dtype=np.int64))

    @property
    def rows(self) -> int:
        """Rows that this rank owns."""
        return self.velocities + self.pressure_nodes

    @property
    def velocities(self) -> int:
        """Rows of u that this rank owns."""
        return self.dimension * self.velocity_nodes

    @property
    def free(self) -> NDArray[np.bool_]:
        """Which rows are unknowns of y: neither given, nor on a body, nor images, nor inner, (rows,)."""
        free = np.ones(self.rows, dtype=bool)
        free[self.constrained] = free[self.inner] = False
        return free

    @property
    def constrained(self) -> Indices:
        """The other rows, but for the inner ones."""
        return np.concatenate([self.fixed, self.slave, self.on_body])

    @property
    def modes_of_each(self) -> int:
        """M, modes of each body."""
        return len(MODES[self.dimension])

    @property
    def modes_here(self) -> int:
        """Modes that this rank owns."""
        return self.modes if self.comm.rank == 0 else 0


def dof_layout(
    fluid: FluidMesh, nodes: BoundaryNodes, walls: Iterable[str], pressure_nodes: int, pin: int | None
) -> DofLayout:
    """The rows of walls with given velocity, of the axis and of bodies; without slaves.

    pin: the local number of a pressure node whose value is given, on its owner only.
    """
    with_velocity = [nodes.wall_nodes[wall] for wall in walls]
    wall_nodes = np.unique(np.concatenate([*with_velocity, np.empty(0, dtype=np.int32)])).astype(np.int64)
    d = fluid.dimension
    axis = d * nodes.axis.astype(np.int64)
    fixed = np.union1d((d * wall_nodes[:, None] + np.arange(d)).ravel(), axis)
    if pin is not None:
        fixed = np.append(fixed, d * len(nodes.x) + pin)
    on_body = (d * nodes.body_nodes.astype(np.int64)[:, None] + np.arange(d)).ravel()
    body = np.repeat(nodes.body, d)
    # Where a sphere meets the axis, u_r = 0 is given.
    off_axis = ~np.isin(on_body, axis)
    return DofLayout(
        MPI.COMM_WORLD, d, len(nodes.x), pressure_nodes, fixed, on_body[off_axis], body[off_axis],
        len(MODES[d]) * fluid.bodies, fluid.container.axisymmetric,
    )  # fmt: skip


@dataclass(frozen=True, slots=True)
class RigidModes:
    """The matrix `rigid`, (rows, M N), and its entries on this rank.

    Attributes:
        matrix: itself.
        rows: that have entries, local numbers, (n,).
        modes: columns of the entries of each row, (n, k).
        values: of these entries, (n, k).
    """

    matrix: PETSc.Mat
    rows: Indices
    modes: Indices
    values: Array

    def entries(self) -> tuple[Indices, Indices, Array]:
        """Rows, modes and values, (n k,) each; the matrix itself would give them row by row."""
        return np.repeat(self.rows, self.modes.shape[1]), self.modes.ravel(), self.values.ravel()


def rigid_modes(layout: DofLayout, nodes: BoundaryNodes, q: Configuration, lattice: Lattice) -> RigidModes:
    """The matrix `rigid`: nodal velocities (rows of x) of the unit modes of every body, `V + omega x r`.

    r begins at the centre of the body's image there. With an axis the modes V_x and omega are empty.
    """
    node, component = np.divmod(layout.on_body, layout.dimension)
    acting = np.array(ACTING[layout.dimension])[component]
    x = nodes.x[node]
    r = x - q.centres[layout.body] - q.to_images(lattice, layout.body, x)
    values = np.take_along_axis(rigid_motion(r)[np.arange(len(r)), component], acting, axis=1)
    columns = layout.modes_of_each * layout.body[:, None] + acting
    rows = layout.on_body
    if layout.axisymmetric:
        along = component == 1
        rows, columns, values = rows[along], columns[along, :1], values[along, :1]
    sizes = layout.rows, (layout.modes_here, layout.modes)
    return RigidModes(NodalMatrix(sizes, rows, columns, values).matrix, rows, columns, values)


class Prolongation:
    """P, with those modes in y that are unknowns.

    With `eliminate_bodies` false, the nodes on bodies stay unknowns and P has no modes: this is the space of
    the multiplier form. A row with a slip has a column for it, and after that those of the modes. What
    stands for the pressure on a sliding surface moves no fluid: its weights are zero, but its columns
    give P^T M P the places that it needs.

    Attributes:
        columns: of the entries of each row of this rank, (rows, w), NO_COLUMN where there is none.
        weights: of these entries, (rows, w).
        constrained: rows where g may stand, in the order of the layout.
        here: columns that this rank owns.
        modes: those of modes, on all ranks.
        sliding: whether there are columns of slips.
        matrix: P itself.
    """

    def __init__(
        self, layout: DofLayout, rigid: RigidModes, unknown: NDArray[np.bool_], eliminate_bodies: bool = True
    ) -> None:
        """Make P. unknown: which of all modes stand in y, bool (M N,)."""
        free, self.constrained, self.sliding = layout.free, layout.constrained, layout.sliding
        if not eliminate_bodies:
            free[layout.on_body] = True
            free[np.concatenate([layout.fixed, layout.slave])] = False
        free[layout.slip] = True
        free[layout.slip_slave] = False
        normal = np.setdiff1d(layout.normal, layout.slip_slave)
        free_here = int(free.sum()) + len(normal)
        first = layout.comm.exscan(free_here) or 0
        mode_columns = np.full(layout.modes, NO_COLUMN, dtype=np.int64)
        if eliminate_bodies:
            # Rank 0 owns the modes: they come after its free unknowns.
            root_free = layout.comm.bcast(free_here)
            mode_columns[unknown] = root_free + np.arange(unknown.sum())
            first += int(unknown.sum()) if layout.comm.rank > 0 else 0
        self.modes = mode_columns[mode_columns != NO_COLUMN]
        self.here = free_here + (len(self.modes) if layout.comm.rank == 0 else 0)
        rows = np.flatnonzero(free)
        k = rigid.modes.shape[1]
        self.columns = np.full((layout.rows, k + 2 * layout.sliding), NO_COLUMN)
        self.columns[rows, 0] = first + np.arange(len(rows))
        of_normal = first + np.arange(len(rows), free_here)
        first_row = layout.comm.exscan(layout.rows) or 0
        known, of_master = columns_of_masters(
            layout.comm, layout.master, first_row + rows, self.columns[rows, 0]
        )
        self.columns[layout.slave[known], 0] = of_master
        self.weights = np.ones(self.columns.shape)
        if layout.sliding:
            self.columns[normal, -1], self.weights[:, -1] = of_normal, 0.0
            for place in (0, -1):
                known, of_master = columns_of_masters(
                    layout.comm,
                    layout.slip_master,
                    first_row + np.arange(layout.rows),
                    self.columns[:, place],
                )
                self.columns[layout.slip_slave[known], place] = of_master
        self._modes = slice(1, k + 1) if layout.sliding else slice(0, k)
        if eliminate_bodies:
            self.columns[rigid.rows, self._modes] = mode_columns[rigid.modes]
        self._rigid_rows = rigid.rows if eliminate_bodies else rigid.rows[:0]
        self.weights[self._rigid_rows, self._modes] = rigid.values[: len(self._rigid_rows)]
        sizes, rows = (layout.rows, (self.here, None)), np.arange(layout.rows)
        self._nodal = NodalMatrix(sizes, rows, self.columns, self.weights)
        self.matrix = self._nodal.matrix

    def update(self, rigid: RigidModes) -> None:
        """P with other values of the same rigid modes, in place."""
        self.weights[self._rigid_rows, self._modes] = rigid.values[: len(self._rigid_rows)]
        self._nodal.fill(self.weights)


def wall_offset(
    layout: DofLayout, nodes: BoundaryNodes, velocities: dict[str, Array], corner_axes: dict[str, int]
) -> Array:
    """Given velocities of the wall nodes in an array over this rank's rows, zero elsewhere.

    velocities: for each wall its velocity at its own nodes, shape (nodes, d). Where walls meet, each keeps
    its normal component, so that nothing leaks through the corner of a moving lid.
    """
    d = layout.dimension
    g = np.zeros(layout.rows)
    u_of_nodes = g[: layout.velocities].reshape(-1, d)
    times_met = np.zeros(layout.velocity_nodes, dtype=int)
    for wall, u in velocities.items():
        node = nodes.wall_nodes[wall].astype(np.int64)
        times_met[node] += 1
        u_of_nodes[node] = u
    for wall, u in velocities.items():
        node = nodes.wall_nodes[wall].astype(np.int64)
        corner = times_met[node] > 1
        axis = corner_axes[wall]
        u_of_nodes[node[corner], axis] = u[corner, axis]
    u_of_nodes[nodes.axis, 0] = 0.0
    return g
