"""Surfaces along which fluid slides (Navier 1823), in the discrete system.

With the velocity w of a surface, rigid motion and what moves along it, the slip is s = u - w, n points out of
the fluid, and nu = - n.sigma n is its pressure on the surface:

    s.n = 0,    sigma n = - nu n - (mu / b) s      on the surface.

The nodal slip is an unknown of its own, u = w + s, and so is nu. Tested with s' and nu' the rows are

    lambda + N s + G^T nu = 0        N: (mu / b) int s.s'
             G s          = 0        G: int nu' n.s

with the nodal reaction lambda = M x - b. So the loads rigid^T lambda of a body and the power of its motion
are exact, and with s' = s the friction takes the power

    - s.lambda = (mu / b) int |s|^2 >= 0.

That s.n vanishes is asked for on the curved cells themselves, with n their own normal and nu of the degree of
u (Verfuerth 1987, Numer. Math. 50:697): a normal at a node would be the wrong one between nodes, and fluid
would leak through. With nu = 1 no fluid at all goes through the surface of a body. On plane walls it is
simply the normal component of s that is not there. Where a sliding wall meets one that fluid sticks to, it
sticks to both. There s is given, and nu of a curved wall is no unknown but of a lower degree on the facet
beside that corner, as mortars are at crosspoints (Bernardi, Maday and Patera 1994): it has as many unknowns
as s has along n, and the functions nu' still add up to 1.
"""

from dataclasses import dataclass, replace

import basix
import numpy as np
from dolfinx import fem
from numpy.typing import NDArray

from fsi.arrays import Array, Indices
from fsi.stokes.discretisation.constraints import DofLayout
from fsi.stokes.discretisation.forms import EQUISPACED, Forms
from fsi.stokes.discretisation.nodal_matrix import NO_COLUMN
from fsi.stokes.discretisation.nodes import BoundaryNodes, facets_with
from fsi.stokes.discretisation.shared_rows import SharedRows
from fsi.stokes.problem import StokesProblem

FACET = {2: basix.CellType.interval, 3: basix.CellType.triangle}


def with_slip(layout: DofLayout, problem: StokesProblem, nodes: BoundaryNodes) -> DofLayout:
    """The layout with the rows of the slip and of the normal traction; the same where nothing slides."""
    container, boundary, d = problem.container, problem.boundary, layout.dimension
    if not problem.sliding:
        return layout
    stuck = np.zeros(layout.rows, dtype=bool)
    stuck[d * nodes.axis.astype(np.int64)] = True
    on_walls, carriers, shaped = [], [], list[tuple[NDArray[np.int64], int]]()
    every = zip(container.walls, container.corner_axes, container.plane, container.spheres, strict=True)
    for wall, axis, plane, sphere in every:
        rows = d * nodes.wall_nodes[wall].astype(np.int64)[:, None] + np.arange(d)
        if wall in boundary.slip_lengths:
            on_walls.append(rows.ravel())
            if plane:
                stuck[rows[:, axis]] = True
            elif sphere is not None:
                carriers.append(rows[:, -1])
            else:
                shaped.append((rows, axis))
        elif wall in boundary.velocities:
            stuck[rows] = True
    # Where a wall with a shape meets one that fluid sticks to, nu is `continued`.
    carriers += [rows[~stuck[rows[:, axis]], -1] for rows, axis in shaped]
    of_walls = np.unique(np.concatenate([*on_walls, np.empty(0, dtype=np.int64)]))
    of_bodies = layout.on_body[np.isin(layout.body, list(problem.surfaces.slip_lengths))]
    carriers.append(of_bodies[of_bodies % d == d - 1])
    slip = np.concatenate([of_walls[~stuck[of_walls]], of_bodies])
    return replace(layout, slip=slip, normal=np.concatenate(carriers), sliding=True)


@dataclass(frozen=True, slots=True)
class SlidingFacets:
    """The matrices N and G on the facets of this rank along which fluid slides.

    Attributes:
        shared: rows that this rank's cells share with others'.
        rows: of u at the nodes of each facet in local numbers, (E, n, d).
        friction: (mu / b) int phi_i phi_j ds of each, (E, n, n).
        normal: int phi_i phi_j n ds, (E, n, n, d).
        apart: at the corners of walls how far g is from the wall's own velocity, (E, n, d); else zero.
    """

    shared: SharedRows
    rows: Indices
    friction: Array
    normal: Array
    apart: Array

    def triplets(self, columns: Indices) -> tuple[Indices, Indices, Array]:
        """Rows, columns and values of N and G among the unknowns y; columns: those of P, with ghosts."""
        n, d = self.rows.shape[1:]
        s, nu = columns[self.rows, 0], columns[self.rows[:, :, -1], -1]
        here, there = np.repeat(s[:, :, None], n, axis=2), np.repeat(s[:, None], n, axis=1)
        of_friction = np.repeat(self.friction[..., None], d, axis=3)
        tested = np.repeat(np.repeat(nu[:, :, None, None], n, axis=2), d, axis=3)
        normal = continued(self.normal, nu == NO_COLUMN)
        parts = [(here, there, of_friction), (tested, there, normal), (there, tested, normal)]
        row, column, value = (np.concatenate([part[k].ravel() for part in parts]) for k in range(3))
        known = (row != NO_COLUMN) & (column != NO_COLUMN)
        return row[known], column[known], value[known]

    def forces(self, slip: Array) -> tuple[Array, float]:
        """N s as nodal forces on this rank's rows of x, and its facets' (mu / b) int |s|^2; collective.

        slip: u - w on the rows of x that have one, g being w, zero elsewhere.
        """
        s = self.shared.with_ghosts(slip)[self.rows] + self.apart
        forces = np.einsum("eij,ejc->eic", self.friction, s)
        every = np.zeros(self.shared.size)
        np.add.at(every, self.rows, forces)
        return self.shared.summed(every), float(np.sum(s * forces))


def sliding_facets(
    problem: StokesProblem, forms: Forms, shared: SharedRows, nodes: BoundaryNodes, g: Array
) -> SlidingFacets:
    """N and G on this rank's facets, for given velocities g on the rows of x; collective."""
    fluid, boundary, d = problem.fluid, problem.boundary, problem.fluid.dimension
    g_with_ghosts = shared.with_ghosts(g)
    lengths = {i + 1: b for i, b in problem.surfaces.slip_lengths.items()}
    lengths |= {fluid.wall_tag(wall): b for wall, b in boundary.slip_lengths.items()}
    parts = []
    for tag, b in lengths.items():
        of_facets, sign = _nodes_of(forms, facets_with(fluid, tag, tag), nodes.with_ghosts)
        rows = d * of_facets[:, :, None] + np.arange(d)
        mass, normal = masses(nodes.with_ghosts[of_facets], forms.degree, axisymmetric=forms.axisymmetric)
        apart = np.zeros(rows.shape)
        if tag > fluid.bodies:
            u = boundary.velocities[problem.container.walls[tag - fluid.bodies - 1]]
            x = nodes.with_ghosts[of_facets]
            apart = g_with_ghosts[rows] - u(x.reshape(-1, d)).reshape(x.shape)
        parts.append((rows, problem.viscosity / b * mass, sign[:, None, None, None] * normal, apart))
    return SlidingFacets(shared, *(np.concatenate([part[k] for part in parts]) for k in range(4)))


def masses(x: Array, degree: int, *, axisymmetric: bool) -> tuple[Array, Array]:
    """int phi_i phi_j ds, (E, n, n), and int phi_i phi_j n ds, (E, n, n, d), of curved facets.

    x: their nodes in the order of basix, (E, n, d). The sign of n follows from that order.
    """
    d = x.shape[2]
    element = basix.create_element(basix.ElementFamily.P, FACET[d], degree, EQUISPACED)
    # The integrands of G are polynomials of this degree; with an axis they carry r.
    points, weights = basix.make_quadrature(FACET[d], (d + 1 + axisymmetric) * degree)
    phi, *dphi = element.tabulate(1, points)[:, :, :, 0]
    tangents = [np.einsum("qn,end->eqd", along, x) for along in dphi]
    n = np.stack([tangents[0][..., 1], -tangents[0][..., 0]], axis=2) if d == 2 else np.cross(*tangents)
    n = n * weights[:, None]
    if axisymmetric:
        n *= 2.0 * np.pi * (x[:, :, 0] @ phi.T)[..., None]
    products = np.einsum("qi,qj->qij", phi, phi)
    mass = np.tensordot(np.linalg.norm(n, axis=2), products, 1)
    return mass, np.moveaxis(np.tensordot(n.swapaxes(1, 2), products, 1), 1, -1)


def continued(normal: Array, absent: NDArray[np.bool_]) -> Array:
    """int phi_i phi_j n ds where some nodes have no nu: phi_i are then such that nu is of a lower degree.

    normal: of facets with all nodes, (E, n, n, d); absent: which have none, (E, n). Only in the plane facets
    have nodes of both kinds. The values of nu there are those of the polynomial through all others, so that
    phi_i of these still add up to 1.
    """
    degree, normal = absent.shape[1] - 1, normal.copy()
    nodes = basix.create_element(basix.ElementFamily.P, FACET[2], degree, EQUISPACED).points[:, 0]
    for e in np.flatnonzero(absent.any(axis=1) & ~absent.all(axis=1)):
        none, others = np.flatnonzero(absent[e]), np.flatnonzero(~absent[e])
        powers = np.vander(nodes, len(others))
        weights = powers[none] @ np.linalg.inv(powers[others])
        normal[e, others] += np.tensordot(weights.T, normal[e, none], 1)
    return normal


def _nodes_of(forms: Forms, facets: NDArray[np.int32], x: Array) -> tuple[Indices, Array]:
    """The velocity nodes of facets, (E, n), and what turns the normal of that order out of the cell, (E,)."""
    V, d = forms.V, x.shape[1]
    entities = fem.compute_integration_domains(fem.IntegralType.exterior_facet, forms.mesh.topology, facets)
    cells, local = entities[::2], entities[1::2]
    closure = np.array(V.element.basix_element.entity_closure_dofs[d - 1])
    of_cells = V.dofmap.list[cells]
    of_facets = np.take_along_axis(of_cells, closure[local], axis=1).astype(np.int64)
    corners = x[of_facets[:, :d]]
    along = corners[:, 1:] - corners[:, :1]
    n = np.column_stack([along[:, 0, 1], -along[:, 0, 0]]) if d == 2 else np.cross(along[:, 0], along[:, 1])
    outwards = corners.mean(axis=1) - x[of_cells[:, : d + 1]].mean(axis=1)
    return of_facets, np.sign(np.einsum("ec,ec->e", n, outwards))
