"""The level of the pressure, which a flow without open walls leaves free.

Open walls fix it. What the pressures outside have in common drives nothing and is no part of what is solved:
beside 1e4 of it small residuals are a flow. It is put back here.

Without such walls, with the mean pressure gradient G, and x_m the middle of a domain with walls, of a cell,
which moves, the origin, the pressure is taken to be

    p = G.(x - x_m) + p',      int p' = 0 over the fluid,

p' periodic. Without periods G is zero. Where a periodic domain has been opened for its mesh, which differs
from mesh to mesh, does not count then: the mean of p itself over what is meshed would know it.

The stresslet of a body is that in the pressure G.(x - q_i) + p' around its centre q_i, so that it is the same
in all cells in which its images stand.
"""

from dataclasses import dataclass

import numpy as np
from mpi4py import MPI

from fsi.arrays import Array
from fsi.meshes.geometry.images import to_images
from fsi.stokes.discretisation.nodes import facets_with
from fsi.stokes.solvers.drives import Averages
from fsi.stokes.solvers.system import NodalSolution, StokesSystem, nodal_vector


@dataclass(frozen=True, slots=True)
class PressureLevel:
    """What is to be taken off the pressure of a nodal solution.

    Attributes:
        of_fluid: for p above.
        of_tractions: for p around each body at q_i, off the pressure at the image that reactions mean, (N,).
        of_stresslets: for the pressure of its stresslet, (N,).
    """

    of_fluid: float
    of_tractions: Array
    of_stresslets: Array


def at_level(system: StokesSystem, reaction: Array, of_bodies: Array) -> Array:
    """Reactions on bodies, of each with such a level (N,) taken off the pressure; this rank's rows of u."""
    layout, fluid = system.layout, system.problem.fluid
    # Where p = 1 alone, sigma n = -n.
    normal = nodal_vector(system.forms.bind("normal", facets_with(fluid, 1, fluid.bodies)))
    off = np.zeros(layout.velocities)
    off[layout.on_body] = of_bodies[layout.body]
    return np.asarray(reaction[: layout.velocities] + off * normal)


def pressure_level(system: StokesSystem, solution: NodalSolution) -> PressureLevel:
    """The level of a solution; where walls are open, that of the outside is put back. Collective."""
    layout, problem = system.layout, system.problem
    q, G, none = problem.q, solution.pressure_gradient, np.zeros(len(problem.q))
    if problem.boundary.pressures:
        outside = problem.boundary.outside_level
        return PressureLevel(-outside, none - outside, none - outside)
    # The weights of the nodal values are the integrals of the shape functions.
    here = np.array([system.weights @ solution.x[layout.velocities :], system.weights.sum()])
    of_p, volume = layout.comm.allreduce(here)
    level = float(of_p / volume)
    if G is None or not G.any():
        return PressureLevel(level, level + none, level + none)
    middle = problem.container.middle if problem.container.walls else np.zeros(q.dimension)
    level -= float(G @ (Averages(system).centroid() - middle))
    of_tractions = level + _images(system) @ G
    return PressureLevel(level, of_tractions, of_tractions + (q.centres - middle) @ G)


def _images(system: StokesSystem) -> Array:
    """How far from q_i that image of a body is in whose pressure its reactions are, (N, d); collective."""
    layout, q, lattice = system.layout, system.problem.q, system.problem.fluid.lattice
    at = system.nodes.x[layout.on_body // layout.dimension]
    m = np.full((len(q), lattice.dimension), np.iinfo(np.int64).max)
    np.minimum.at(m, layout.body, to_images(lattice, q.centres, q.placed, layout.body, at))
    layout.comm.Allreduce(MPI.IN_PLACE, m, op=MPI.MIN)
    return lattice.shift(m)
