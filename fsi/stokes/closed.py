"""What walls move through the boundary of a mesh, where its cells are curved.

A cylinder that moves along its axis moves no fluid through itself, but its curved facets do: n_z is not zero
between nodes, and int u.n over them is the difference of the areas of the meshed ends. Without an open wall
the discrete problem has no solution then. So a part of the normal e is taken from the velocity of the
cylinder,

    u -= (int u.n / int e.n) e,      of the order of the error of the mesh, h^(2k),

with integrals over all walls.
"""

import numpy as np

from fsi.arrays import Array
from fsi.stokes.discretisation.constraints import DofLayout
from fsi.stokes.discretisation.forms import Forms
from fsi.stokes.discretisation.nodes import BoundaryNodes, facets_with
from fsi.stokes.problem import StokesProblem
from fsi.stokes.solvers.system import nodal_vector


def closed(problem: StokesProblem, forms: Forms, nodes: BoundaryNodes, layout: DofLayout, g: Array) -> Array:
    """The velocities g of walls, this rank's rows of x, without a net flux through cylinders; collective."""
    fluid, container = problem.fluid, problem.container
    cylinders = [k for k, s in enumerate(container.spheres) if s is not None and not s.bends_all_ways]
    if not cylinders or problem.boundary.pressures:
        return g
    e = np.zeros((layout.velocity_nodes, layout.dimension))
    for k in cylinders:
        on_side = nodes.wall_nodes[container.walls[k]]
        e[on_side] = container.normals(nodes.x[on_side])[:, k]
    on_walls = facets_with(fluid, fluid.bodies + 1, fluid.bodies + len(container.walls))
    n, velocities = nodal_vector(forms.bind("normal", on_walls)), layout.velocities
    of_g, of_e = layout.comm.allreduce(np.array([n @ g[:velocities], n @ e.ravel()]))
    closed_g = g.copy()
    closed_g[:velocities] -= (of_g / of_e) * e.ravel()
    return closed_g
