"""What drives a periodic flow as much as is needed for a number to have a given value.

A pressure gradient brings the mean velocity of a cell or the flux of a channel to it, the speed of a wall the
force on that wall, and the rate of shear of a cell its mean stress. Flows are linear in each of them.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from mpi4py import MPI

from fsi.arrays import Array
from fsi.meshes.geometry.lattice import unit_shear
from fsi.stokes.problem import wall_area
from fsi.stokes.solvers.system import NodalSolution, StokesSystem, nodal_vector, wall_force
from fsi.stokes.stress import bulk_stress


class Averages:
    """Averages over the fluid and the bodies of a periodic domain together.

    Attributes:
        weights: int v_c over the fluid for each row of u, (rows of u, d), of this rank.
        x: this rank's velocity nodes, (n, d).
    """

    def __init__(self, system: StokesSystem) -> None:
        self._problem, self.x, forms, columns = system.problem, system.nodes.x, system.forms, []
        d = system.layout.dimension
        for direction in np.eye(d):
            forms.f.x.array[:] = np.tile(direction, len(forms.f.x.array) // d)
            columns.append(nodal_vector(forms.bind("load")))
        self.weights = np.column_stack(columns)

    def velocity(self, solution: NodalSolution, E: Array) -> Array:
        """The mean of u - E x, (d,); collective.

        Over what is meshed, which has another volume than the domain: so that of a constant is this constant,
        and bodies are as fast beside each other wherever the origin is.
        """
        q, comm = self._problem.q, MPI.COMM_WORLD
        u = solution.x[: len(self.weights)] - (self.x @ E.T).ravel()
        V = solution.U[:, : q.dimension] - q.centres @ E.T
        here = np.append(u @ self.weights, self.weights[:, 0].sum())
        *of_fluid, volume = comm.allreduce(here, op=MPI.SUM)
        return np.asarray((of_fluid + q.volumes @ V) / (volume + q.volumes.sum()))

    def centroid(self) -> Array:
        """Of the fluid as it is meshed, (d,); collective."""
        weights = self.weights[:: self.x.shape[1], 0]  # int phi of each node
        of_x, volume = MPI.COMM_WORLD.allreduce(weights @ self.x), MPI.COMM_WORLD.allreduce(weights.sum())
        return np.asarray(of_x / volume)


@dataclass(frozen=True, slots=True)
class Drive:
    """One of these, by the unit of it.

    Attributes:
        g, b: what it puts into the offset and the loads, this rank's rows.
        gradient: what it adds to the mean velocity gradient, (d, d).
        measured: the number, of a system, its flow and the mean gradient in it; linear in all.
        wanted: its value.
    """

    g: Array
    b: Array
    gradient: Array
    measured: Callable[[StokesSystem, NodalSolution, Array], float]
    wanted: float


def pushed(system: StokesSystem, of_unit: tuple[Array, Array], component: int) -> Drive:
    """A component of the pressure gradient, for none of the mean velocity; of_unit: its g and b."""
    average, d = Averages(system), system.layout.dimension

    def mean_velocity(_: StokesSystem, flow: NodalSolution, E: Array) -> float:
        return float(average.velocity(flow, E)[component])

    return Drive(*of_unit, np.zeros((d, d)), mean_velocity, 0.0)


def pumped(system: StokesSystem, of_unit: tuple[Array, Array], flux: float) -> Drive:
    """The pressure gradient along a channel, for its flux; of_unit: its g and b."""
    d = system.layout.dimension

    def found(at: StokesSystem, flow: NodalSolution, _: Array) -> float:
        return flux_of(at, of_unit, flow)

    return Drive(*of_unit, np.zeros((d, d)), found, flux)


def flux_of(system: StokesSystem, of_unit: tuple[Array, Array], flow: NodalSolution) -> float:
    """The flux Q of fluid and bodies along a channel; collective.

    By the power -L Q of the pressure gradient 1 over a period L, of_unit: its g and b. So the power balance
    has the same Q.
    """
    g, b = of_unit
    power = float(system.layout.comm.allreduce(b @ flow.x - flow.reaction @ g))
    return -power / float(np.linalg.norm(system.problem.container.periods[0]))


def pulled(system: StokesSystem, wall: str, stress: float) -> Drive:
    """The speed of a wall along x, for the force along x that it exerts over its area."""
    g, d = np.zeros_like(system.g), system.layout.dimension
    g[d * system.nodes.wall_nodes[wall].astype(np.int64)] = 1.0

    def traction(at: StokesSystem, flow: NodalSolution, _: Array) -> float:
        return float(wall_force(at, flow.reaction, wall)[0]) / wall_area(at.problem.container)

    return Drive(g, np.zeros_like(system.b), np.zeros((d, d)), traction, stress)


def sheared(system: StokesSystem, of_velocity: Callable[[Array], Array], stress: float) -> Drive:
    """The rate of shear of a cell, for the mean stress of fluid and bodies; of_velocity: g of a gradient."""
    E = unit_shear(system.layout.dimension)

    def mean_stress(at: StokesSystem, flow: NodalSolution, _: Array) -> float:
        # Whatever the level of the pressure is, it adds nothing beside the diagonal.
        return float(bulk_stress(at, flow, flow.reaction).mean[0, -1])

    return Drive(of_velocity(E), np.zeros_like(system.b), E, mean_stress, stress)
