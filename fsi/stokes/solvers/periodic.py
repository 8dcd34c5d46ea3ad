"""Periodic flow: `u = E x + periodic`, `p = G.x + periodic`, on a domain opened along its cut.

Nodes on one side of the cut (slaves) have their images on the other (masters): at a lattice vector e

    u(x + e) = u(x) + E e,      p(x + e) = p(x) + G.e,

which is a row of P and a jump in g. The traction jumps by -G.e n; with test functions that do not jump it
loads the slaves by  - (G.e) <n, v>. The same holds on arcs of bodies that the cut has left at another image
than the rest of the body, so that every force is that of one image in one pressure field.

The mean pressure gradient G is given, or follows from the forces (in a cell without walls it balances them),
or is found such that the mean velocity has its given value. So are the speed of a wall whose stress is
given, and the rate of shear of a cell whose mean stress is given.
Where all bodies of a cell without walls are free, the flow is determined up to a translation: one body rests,
and then the mean of u - E x over fluid and bodies is brought to zero.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from dolfinx import mesh as dolfinx_mesh
from mpi4py import MPI
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration, Motion
from fsi.meshes.build import FluidMesh
from fsi.meshes.geometry.images import to_images
from fsi.meshes.geometry.matching import matching_points
from fsi.stokes.discretisation.forms import Forms
from fsi.stokes.discretisation.nodes import facets_with
from fsi.stokes.problem import StokesProblem
from fsi.stokes.solvers.drives import Averages, Drive, flux_of, pulled, pumped, pushed, sheared
from fsi.stokes.solvers.system import NodalSolution, Solver, StokesSystem, nodal_vector

type Facets = NDArray[np.int32]
type Images = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class MeanFlow:
    """What is imposed on the whole of a periodic flow.

    Attributes:
        gradient: E, (d, d).
        pressure_gradient: G, (d,), NaN where it is unknown.
        drifting: components in which nothing fixes a translation of everything but that the mean of u - E x
            over fluid and bodies is 0, bool (d,).
    """

    gradient: Array
    pressure_gradient: Array
    drifting: NDArray[np.bool_]


def mean_flow(problem: StokesProblem) -> MeanFlow:
    """The mean flow of a channel with dp/dx, or None and a net flux; or of a cell."""
    container, motion, boundary = problem.container, problem.motion, problem.boundary
    d = container.dimension
    if len(container.periods) == d:
        held = motion.held[:, :d].any(axis=0)
        G = np.where(held, np.nan, motion.F[:, :d].sum(axis=0) / container.volume)
        return MeanFlow(container.mean_gradient, G, ~held)
    G = np.zeros(d)
    G[0] = np.nan if boundary.pressure_gradient is None else boundary.pressure_gradient
    return MeanFlow(container.mean_gradient, G, np.zeros(d, dtype=bool))


class Jumps:
    """What a velocity gradient and a pressure gradient put into g and b of a domain that was opened."""

    def __init__(self, system: StokesSystem) -> None:
        self.layout, fluid, q = system.layout, system.problem.fluid, system.problem.q
        x = system.nodes.x[self.layout.on_body // q.dimension]
        # How far the node of each row on a body lies from that of the body at q_i, (on_body, d).
        self._to_body = q.to_images(fluid.lattice, self.layout.body, x)
        # Lattice vectors e and the nodal <n, v> over all that lies at e, of slaves and of opened bodies.
        self._slaves = _normals(fluid, system.forms, *_slaves(fluid))
        self._arcs = _normals(fluid, system.forms, *_arcs(fluid, q))

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
        b[: layout.velocities] = self._load(self._slaves, G) + self._load(self._arcs, G)
        return g, b

    def along_bodies(self, G: Array) -> Array:
        """The part of b along bodies alone: less it the traction of p there is that of one pressure field."""
        return self._load(self._arcs, G)

    def _load(self, normals: Sequence[tuple[Array, Array]], G: Array) -> Array:
        """- (G.e) <n, v>, this rank's rows of u."""
        load = np.zeros(self.layout.velocities)
        for e, normal in normals:
            load -= (G @ e) * normal
        return load


def _arcs(fluid: FluidMesh, q: Configuration) -> tuple[Facets, Images]:
    """Facets on bodies, and how many periods the arc of each lies from the first of its body."""
    facets, lattice = facets_with(fluid, 1, fluid.bodies), fluid.lattice
    body = fluid.facet_tags.values[np.searchsorted(fluid.facet_tags.indices, facets)] - 1
    m = to_images(lattice, q.centres, q.placed, body, _middle(fluid, facets))
    first = np.full((fluid.bodies, lattice.dimension), np.iinfo(np.int64).max)
    np.minimum.at(first, body, m)
    MPI.COMM_WORLD.Allreduce(MPI.IN_PLACE, first, op=MPI.MIN)
    return facets, m - first[body]


def _slaves(fluid: FluidMesh) -> tuple[Facets, Images]:
    """Facets of the cut, and how many periods each lies from its image there: zero for masters."""
    facets, comm = facets_with(fluid, fluid.cut_tag, fluid.cut_tag), MPI.COMM_WORLD
    everywhere = comm.allgather(_middle(fluid, facets))
    pairs = matching_points(np.concatenate(everywhere), fluid.lattice)
    shifts = np.zeros((sum(map(len, everywhere)), fluid.lattice.dimension), dtype=np.int64)
    shifts[pairs.slave] = pairs.shift
    before = sum(map(len, everywhere[: comm.rank]))
    return facets, shifts[before : before + len(facets)]


def _middle(fluid: FluidMesh, facets: Facets) -> Array:
    """The middles of facets, (facets, d)."""
    d = fluid.dimension
    return np.asarray(dolfinx_mesh.compute_midpoints(fluid.mesh, d - 1, facets)[:, :d])


def _normals(fluid: FluidMesh, forms: Forms, facets: Facets, m: Images) -> list[tuple[Array, Array]]:
    """Lattice vectors e and <n, v> over those facets that lie at e = m periods."""
    normals = []
    for e in np.unique(np.concatenate(MPI.COMM_WORLD.allgather(m)), axis=0):
        if e.any():
            here = facets[np.all(m == e, axis=1)]
            normals.append((fluid.lattice.shift(e[None])[0], nodal_vector(forms.bind("normal", here))))
    return normals


def solve_periodic(system: StokesSystem, solver: Solver) -> tuple[StokesSystem, NodalSolution, Array]:
    """The flow with the mean of its problem, its system with all loads, and those along bodies; collective.

    It is linear in G, in the speeds of walls that a stress moves and in the rate at which a stress shears a
    cell: the flow for what is known of them, plus what each unknown one drives alone. Raises SolveError: as
    the solver.
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
    drives, boundary = _drives(system, mean, jump), problem.boundary
    resting = Motion(held, np.zeros_like(motion.U), np.zeros_like(motion.F))
    alone = [replace(known, g=each.g, b=each.b, problem=problem.at_rest(resting)) for each in drives]
    solution, *driven = solver(known, *alone)
    total_g, total_b, sizes = known.g, known.b, np.zeros(len(drives))
    if drives:
        flows = [(of, flow, each.gradient) for of, flow, each in zip(alone, driven, drives, strict=True)]
        response = np.array([[each.measured(*flow) for flow in flows] for each in drives])
        missing = np.array([each.wanted - each.measured(known, solution, E) for each in drives])
        sizes = np.linalg.solve(response, missing)
        for s, flow, drive in zip(sizes, driven, drives, strict=True):
            solution, total_g, total_b = _sum(solution, flow, s), total_g + s * drive.g, total_b + s * drive.b
            E = E + s * drive.gradient
    if mean.drifting.any():
        average = Averages(system)
        drift = np.where(mean.drifting, -average.velocity(solution, E), 0.0)
        u = solution.x.copy()
        u[: len(average.weights)] += np.tile(drift, len(average.x))
        U = solution.U.copy()
        U[:, :d] += drift
        solution = replace(solution, x=u, U=U)
    G[unknown], of_walls, of_cell = np.split(sizes, np.cumsum([len(unknown), len(boundary.stresses)]))
    speeds = dict(zip(boundary.stresses, of_walls.tolist(), strict=True))
    rate = None if boundary.mean_stress is None else float(of_cell[0])
    moved = replace(problem, boundary=boundary.faster(speeds, rate or 0.0))
    loaded = replace(system, g=total_g, b=total_b, problem=moved)
    found = replace(solution, pressure_gradient=G, wall_speeds=speeds, shear_rate=rate)
    if len(problem.container.periods) < d and boundary.pressure_gradient is not None:
        found = replace(found, flux=flux_of(system, jump.of_pressure(np.eye(d)[0]), found))
    return loaded, found, jump.along_bodies(G)


def _drives(system: StokesSystem, mean: MeanFlow, jump: Jumps) -> list[Drive]:
    """Unknown components of the pressure gradient, walls that a stress moves, the shear of a cell."""
    boundary, units = system.problem.boundary, np.eye(len(mean.pressure_gradient))
    unknown = np.flatnonzero(np.isnan(mean.pressure_gradient))
    if len(system.problem.container.periods) < len(units):
        drives = [pumped(system, jump.of_pressure(units[i]), boundary.net_flux or 0.0) for i in unknown]
    else:
        drives = [pushed(system, jump.of_pressure(units[i]), int(i)) for i in unknown]
    drives += [pulled(system, wall, stress) for wall, stress in boundary.stresses.items()]
    if boundary.mean_stress is not None:
        drives.append(sheared(system, jump.of_velocity, boundary.mean_stress))
    return drives


def _sum(one: NodalSolution, other: NodalSolution, s: float) -> NodalSolution:
    x, reaction = one.x + s * other.x, one.reaction + s * other.reaction
    load, U = one.load + s * other.load, one.U + s * other.U
    residual, iterations = max(one.residual, other.residual), max(one.iterations, other.iterations)
    forces = one.law_forces + s * other.law_forces
    return NodalSolution(x, reaction, load, U, residual, iterations, law_forces=forces)
