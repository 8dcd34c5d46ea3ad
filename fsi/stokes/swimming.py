"""Bodies whose surface moves along itself: squirmers (Lighthill 1952, Blake 1971).

In the plane, with theta from the axis of the body, which stands at its angle, and positive counterclockwise,

    w = sum_n B_n sin(n theta) e_theta,

and on a sphere, whose axis p is e_z, in space turned with the body, on an axis -e_z at an angle of pi, with
theta from p,

    w = sum_n B_n 2 / (n (n + 1)) sin theta P_n'(cos theta) e_theta = B_1 sin theta e_theta + ...

A free one in unbounded fluid swims along its axis with B_1 / 2, a sphere with 2 B_1 / 3: minus the mean of w
over the surface.
"""

import numpy as np
import scipy  # its modules load when they are used
from mpi4py import MPI

from fsi.arrays import Array
from fsi.stokes.discretisation.constraints import DofLayout
from fsi.stokes.discretisation.forms import Forms
from fsi.stokes.discretisation.nodes import BoundaryNodes, facets_with
from fsi.stokes.problem import StokesProblem
from fsi.stokes.solvers.system import nodal_vector


def tangential(directions: Array, axis: Array, modes: Array, *, planar: bool) -> Array:
    """The velocity w (n, d) along the surface in these directions from the centre.

    directions: unit vectors, (n, d); axis: that of the body, (d,); modes: B_1, B_2, ...
    """
    n = np.arange(1, len(modes) + 1)
    cos = directions @ axis
    if planar:
        theta = np.arctan2(axis[0] * directions[:, 1] - axis[1] * directions[:, 0], cos)
        w = np.sin(np.outer(theta, n)) @ modes
        return np.asarray(w[:, None] * np.column_stack([-directions[:, 1], directions[:, 0]]))
    # sin theta e_theta = cos theta e - p
    coefficients = np.concatenate([[0.0], 2.0 * modes / (n * (n + 1))])
    speed = np.polynomial.legendre.legval(cos, np.polynomial.legendre.legder(coefficients))
    return np.asarray(speed[:, None] * (cos[:, None] * directions - axis))


def swimming_velocity(problem: StokesProblem, forms: Forms, nodes: BoundaryNodes, layout: DofLayout) -> Array:
    """w at the nodes on bodies, in an array over this rank's rows, zero elsewhere; collective.

    Between nodes w is not quite tangential: a part of e is taken from it, such that no fluid goes through
    the surface of a body.
    """
    g, swimming = np.zeros(layout.rows), problem.surfaces.swimming
    if not swimming:
        return g
    q, fluid, d = problem.q, problem.fluid, layout.dimension
    r = nodes.x[nodes.body_nodes] - q.centres[nodes.body]
    r -= fluid.lattice.shift(fluid.lattice.nearest(r))
    e = r / np.linalg.norm(r, axis=1)[:, None]
    w, axes = np.zeros_like(e), _axes(problem)
    for i, modes in swimming.items():
        here, planar = nodes.body == i, d == 2 and not layout.axisymmetric
        w[here] = tangential(e[here], axes[i], modes, planar=planar)
    on_bodies = forms.bind("normal", facets_with(fluid, 1, fluid.bodies))
    n = nodal_vector(on_bodies).reshape(-1, d)[nodes.body_nodes]
    through = np.zeros((2, len(q)))
    for row, field in zip(through, (w, e), strict=True):
        np.add.at(row, nodes.body, np.sum(field * n, axis=1))
    layout.comm.Allreduce(MPI.IN_PLACE, through)
    w -= (through[0] / np.where(through[1] == 0.0, 1.0, through[1]))[nodes.body, None] * e
    rows = d * nodes.body_nodes.astype(np.int64)[:, None] + np.arange(d)
    g[rows] = w
    g[layout.fixed] = 0.0
    return g


def _axes(problem: StokesProblem) -> Array:
    """The axis of each body, (N, d)."""
    q = problem.q
    if problem.container.axisymmetric:
        return np.copysign([[0.0, 1.0]], np.cos(q.angles)[:, None])
    if q.dimension == 2:
        return np.column_stack([np.cos(q.angles), np.sin(q.angles)])
    from_rotvec = scipy.spatial.transform.Rotation.from_rotvec
    return np.asarray(from_rotvec(q.angles).apply([0.0, 0.0, 1.0]))
