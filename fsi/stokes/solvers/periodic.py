"""Periodic flow: `u = E x + periodic`, `p = G.x + periodic`, on a domain opened along its cut.

Nodes on one side of the cut (slaves) have their images on the other (masters): at a lattice vector e

    u(x + e) = u(x) + E e,      p(x + e) = p(x) + G.e,

which is a row of P and a jump in g. The traction jumps by -G.e n; with test functions that do not jump it
loads the slaves by  - (G.e) <n, v>. The same holds on arcs of bodies that the cut has left at another image
than the rest of the body, so that every force is that of one image in one pressure field.

The mean pressure gradient G is given, or follows from the forces (in a cell without walls it balances them),
or is found such that the mean velocity has its given value. So is the speed of a wall whose stress is given.
Where all bodies of a cell without walls are free, the flow is determined up to a translation: one body rests,
and then the mean of u - E x over fluid and bodies is brought to zero.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from dolfinx import mesh as dolfinx_mesh
from mpi4py import MPI
from numpy.typing import NDArray

from fsi.bodies.configuration import Array, Configuration, Inertia, Motion
from fsi.meshes.build import FluidMesh
from fsi.meshes.geometry.lattice import matching_points
from fsi.stokes.discretisation.forms import Forms
from fsi.stokes.discretisation.nodes import facets_with
from fsi.stokes.problem import StokesProblem, wall_area
from fsi.stokes.solvers.elimination import NodalSolution, StokesSystem, nodal_vector, wall_force

type Solver = Callable[..., list[NodalSolution]]


@dataclass(frozen=True, slots=True)
class MeanFlow:
    """What is imposed on the whole of a periodic flow.

    Attributes:
        gradient: E, (d, d).
        pressure_gradient: G, (d,), NaN where it is unknown.
        velocity: mean of u - E x over fluid and bodies, (d,), for where G is unknown or all is `drifting`.
        drifting: components in which nothing but this mean fixes a translation of everything, bool (d,).
    """

    gradient: Array
    pressure_gradient: Array
    velocity: Array
    drifting: NDArray[np.bool_]


def mean_flow(problem: StokesProblem) -> MeanFlow:
    """The mean flow of a channel with dp/dx, or None and a net flux; or of a cell."""
    container, motion, boundary = problem.container, problem.motion, problem.boundary
    d = container.dimension
    if len(container.periods) == d:
        held = motion.held[:, :d].any(axis=0)
        G = np.where(held, np.nan, motion.F[:, :d].sum(axis=0) / container.volume)
        return MeanFlow(container.mean_gradient, G, np.zeros(d), ~held)
    # The flux is that through a section across x, of the channel's height and in space its width in y.
    area = container.volume / float(np.linalg.norm(container.periods[0]))
    G, velocity = np.zeros((2, d))
    G[0] = np.nan if boundary.pressure_gradient is None else boundary.pressure_gradient
    velocity[0] = (boundary.net_flux or 0.0) / area
    return MeanFlow(container.mean_gradient, G, velocity, np.zeros(d, dtype=bool))


class Jumps:
    """What a velocity gradient and a pressure gradient put into g and b of a domain that was opened."""

    def __init__(self, system: StokesSystem) -> None:
        self.layout, fluid, q = system.layout, system.problem.fluid, system.problem.q
        r = system.nodes.x[self.layout.on_body // q.dimension] - q.centres[self.layout.body]
        # How far the node of each row on a body lies from that of the body at q_i, (on_body, d).
        self._to_body = fluid.lattice.shift(fluid.lattice.nearest(r))
        # Lattice vectors e and the nodal <n, v> over all that lies at e, on slaves and on opened bodies.
        self._normals = _normals(fluid, system.forms, q)

    def of_velocity(self, E: Array) -> Array:
        """The part of g for u(x + e) = u(x) + E e, this rank's rows."""
        layout, g, d = self.layout, np.zeros(self.layout.rows), self.layout.dimension
        of_flow = layout.slave < layout.velocities
        slave = layout.slave[of_flow]
        g[slave] = (layout.away[of_flow] @ E.T)[np.arange(len(slave)), slave % d]
        g[layout.on_body] = (self._to_body @ E.T)[np.arange(len(layout.on_body)), layout.on_body % d]
        return g

    def of_pressure(self, G: Array) -> tuple[Array, Array]:
        """The parts of g and of b for p(x + e) = p(x) + G.e, this rank's rows."""
        layout, g, b = self.layout, np.zeros(self.layout.rows), np.zeros(self.layout.rows)
        of_pressure = layout.slave >= layout.velocities
        g[layout.slave[of_pressure]] = layout.away[of_pressure] @ G
        for e, normal in self._normals:
            b[: len(normal)] -= (G @ e) * normal
        return g, b


def _normals(fluid: FluidMesh, forms: Forms, q: Configuration) -> list[tuple[Array, Array]]:
    """Lattice vectors e and <n, v> over the facets at e: slaves of the cut, and arcs of bodies."""
    comm, lattice = MPI.COMM_WORLD, fluid.lattice
    on_cut = facets_with(fluid, fluid.cut_tag, fluid.cut_tag)
    facets = np.concatenate([facets_with(fluid, 1, fluid.bodies), on_cut])
    tags = fluid.facet_tags.values[np.searchsorted(fluid.facet_tags.indices, facets)]
    d = fluid.dimension
    middle = dolfinx_mesh.compute_midpoints(fluid.mesh, d - 1, facets)[:, :d]
    m = np.zeros((len(facets), lattice.dimension), dtype=np.int64)
    on_body = tags <= fluid.bodies
    body = tags[on_body] - 1
    m[on_body] = lattice.nearest(middle[on_body] - q.centres[body])
    first = np.full((fluid.bodies, lattice.dimension), np.iinfo(np.int64).max)
    np.minimum.at(first, body, m[on_body])
    comm.Allreduce(MPI.IN_PLACE, first, op=MPI.MIN)
    m[on_body] -= first[body]
    # How far facets of the cut lie from their images there: zero for masters.
    everywhere = comm.allgather(middle[~on_body])
    pairs = matching_points(np.concatenate(everywhere), lattice)
    shifts = np.zeros((sum(map(len, everywhere)), lattice.dimension), dtype=np.int64)
    shifts[pairs.slave] = pairs.shift
    before = sum(map(len, everywhere[: comm.rank]))
    m[~on_body] = shifts[before : before + len(everywhere[comm.rank])]
    normals = []
    for e in np.unique(np.concatenate(comm.allgather(m)), axis=0):
        if e.any():
            here = facets[np.all(m == e, axis=1)]
            normals.append((lattice.shift(e[None])[0], nodal_vector(forms.bind("normal", here))))
    return normals


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
        """The mean of u - E x, (d,); collective."""
        q, comm = self._problem.q, MPI.COMM_WORLD
        u = solution.x[: len(self.weights)] - (self.x @ E.T).ravel()
        V = solution.U[:, : q.dimension] - q.centres @ E.T
        of_fluid = np.asarray(comm.allreduce(u @ self.weights, op=MPI.SUM))
        return np.asarray((of_fluid + q.volumes @ V) / self._problem.container.volume)


@dataclass(frozen=True, slots=True)
class Drive:
    """What may drive a flow as much as is needed for a number to have a given value.

    Attributes:
        g, b: what the unit of it puts into the offset and the loads, this rank's rows.
        wall: that it moves along x, None of a pressure gradient.
        measured: the number, of a flow and the mean gradient in it; linear in both.
        wanted: its value.
    """

    g: Array
    b: Array
    wall: str | None
    measured: Callable[[NodalSolution, Array], float]
    wanted: float


def _pushed(system: StokesSystem, mean: MeanFlow, jump: Jumps, component: int) -> Drive:
    """A component of the pressure gradient, for the mean velocity."""
    average = Averages(system)
    g, b = jump.of_pressure(np.eye(len(mean.velocity))[component])

    def velocity(flow: NodalSolution, E: Array) -> float:
        return float(average.velocity(flow, E)[component])

    return Drive(g, b, None, velocity, float(mean.velocity[component]))


def _pulled(system: StokesSystem, wall: str, stress: float) -> Drive:
    """The speed of a wall along x, for the force along x that it exerts over its area."""
    g = np.zeros_like(system.g)
    g[system.layout.dimension * system.nodes.wall_nodes[wall].astype(np.int64)] = 1.0

    def traction(flow: NodalSolution, _: Array) -> float:
        return float(wall_force(system, flow.reaction, wall)[0]) / wall_area(system.problem.container)

    return Drive(g, np.zeros_like(system.b), wall, traction, stress)


def solve_periodic(system: StokesSystem, solver: Solver) -> tuple[StokesSystem, NodalSolution]:
    """The flow with the mean of its problem, and the system with the loads that it took; collective.

    It is linear in G and in the speeds of walls that a stress moves: the flow for what is known of them, plus
    what each unknown one drives alone. Raises SolveError: as the solver.
    """
    problem, motion = system.problem, system.problem.motion
    mean, jump = mean_flow(problem), Jumps(system)
    E, G = mean.gradient, np.nan_to_num(mean.pressure_gradient)
    # Where everything may drift, the first body rests at first.
    held = motion.held.copy()
    d = problem.q.dimension
    held[:1, :d] |= mean.drifting
    g, b = jump.of_pressure(G)
    known = replace(
        system, g=system.g + g + jump.of_velocity(E), b=system.b + b,
        problem=replace(problem, motion=replace(motion, held=held)),
    )  # fmt: skip
    unknown = np.flatnonzero(np.isnan(mean.pressure_gradient))
    drives = [_pushed(system, mean, jump, int(component)) for component in unknown]
    drives += [_pulled(system, wall, stress) for wall, stress in problem.boundary.stresses.items()]
    speeds: dict[str, float] = {}
    resting = Motion(held, np.zeros_like(motion.U), np.zeros_like(motion.F))
    inertia = problem.inertia and Inertia(problem.inertia.D, np.zeros_like(problem.inertia.U0))
    at_rest = replace(problem, motion=resting, inertia=inertia)
    solution, *driven = solver(
        known, *(replace(known, g=each.g, b=each.b, problem=at_rest) for each in drives)
    )
    total_g, total_b = known.g, known.b
    if drives:
        response = np.array([[each.measured(flow, np.zeros((d, d))) for flow in driven] for each in drives])
        missing = np.array([each.wanted - each.measured(solution, E) for each in drives])
        sizes = np.linalg.solve(response, missing)
        G[unknown] = sizes[: len(unknown)]
        for s, flow, drive in zip(sizes, driven, drives, strict=True):
            solution, total_g, total_b = _sum(solution, flow, s), total_g + s * drive.g, total_b + s * drive.b
            speeds |= {} if drive.wall is None else {drive.wall: float(s)}
    if mean.drifting.any():
        average = Averages(system)
        drift = np.where(mean.drifting, mean.velocity - average.velocity(solution, E), 0.0)
        u = solution.x.copy()
        u[: len(average.weights)] += np.tile(drift, len(average.x))
        U = solution.U.copy()
        U[:, :d] += drift
        solution = replace(solution, x=u, U=U)
    moved = replace(problem, boundary=problem.boundary.sliding(speeds))
    loaded = replace(system, g=total_g, b=total_b, problem=moved)
    return loaded, replace(solution, pressure_gradient=G, wall_speeds=speeds)


def _sum(one: NodalSolution, other: NodalSolution, s: float) -> NodalSolution:
    x, reaction = one.x + s * other.x, one.reaction + s * other.reaction
    load, U = one.load + s * other.load, one.U + s * other.U
    residual, iterations = max(one.residual, other.residual), max(one.iterations, other.iterations)
    return NodalSolution(x, reaction, load, U, residual, iterations)
