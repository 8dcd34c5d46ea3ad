"""The traction that nodal reactions stand for.

The multiplier lives in the dual of the velocity trace: one force per node. The trace t whose integrals
int t . v are sum lambda . v for every trace v takes up the errors of these forces in what swings from node to
node: in space it is off by half of the largest traction, most of all at vertices. So its gradient along the
surface is not to jump either:

    int t . v ds + sum of h^2 A [grad t] : [grad v] = sum lambda . v    for every trace v,

a sum over nodes that two facets share, inside their common side (in the plane at its end), where the gradient
jumps by [grad t] between them; h^2 A is the mean of both, of the square of the longest side and the area. For
a smooth t it is as small as what interpolation leaves out, and for a constant v zero: t adds up to the force
of the reactions. To their torque it does but for the jumps of the normals of curved facets, 1e-4 of it in
space. Such penalties are those of Burman and Hansbo 2004, CMAME 193:1437. With a tenth of it, or ten times as
much, the largest errors differ by less than a half.

On an axis v_r is zero where r is: the reaction there is that of the axis, and t_r is zero.

A surface has few nodes, so root solves there. Where a periodic domain is opened at a body, one node of its
surface stands there twice, at two images, and each copy has the reaction of the fluid on its own side: v and
t have one value at both.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import basix
import numpy as np
import scipy  # its modules load when they are used

from fsi.arrays import Array, Indices
from fsi.meshes.geometry.lattice import SAME_PLACE
from fsi.meshes.geometry.matching import on_torus
from fsi.stokes.discretisation.forms import EQUISPACED
from fsi.stokes.discretisation.slip import FACET, masses
from fsi.stokes.fields import Surface

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix


def traction(surface: Surface) -> Array:
    """Traction sigma n at the surface nodes (n, d), n out of the fluid."""
    facets, d = surface.facets, surface.x.shape[1]
    if len(facets) == 0:
        return np.empty((0, d))
    mass, _ = masses(surface.x[facets], surface.degree, axisymmetric=surface.axisymmetric)
    place = places(surface)
    of_facets = place[facets]
    rows, columns = np.repeat(of_facets, facets.shape[1], axis=1), np.tile(of_facets, (1, facets.shape[1]))
    A = scipy.sparse.csc_matrix((mass.ravel(), (rows.ravel(), columns.ravel())))
    A += _roughness(surface, of_facets, mass.sum(axis=(1, 2)))
    reaction = np.zeros((A.shape[0], d))
    np.add.at(reaction, place, surface.reaction)
    t = _solved(A, reaction)
    if surface.axisymmetric:
        r = surface.x[:, 0]
        off_axis = np.flatnonzero(r > SAME_PLACE * r.max())
        t[:, 0] = 0.0
        t[off_axis, 0] = _solved(A[off_axis][:, off_axis], reaction[off_axis, 0])
    return t[place]


def _solved(A: csc_matrix, b: Array) -> Array:
    """A^-1 b of a symmetric positive definite matrix, factorised as such."""
    symmetric = {"permc_spec": "MMD_AT_PLUS_A", "diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True}}
    x: Array = scipy.sparse.linalg.splu(A.tocsc(), **symmetric).solve(b)
    return x


def places(surface: Surface) -> Indices:
    """For each node (n,) the number of its place: images on one body have the same, 0, 1, ... all told."""
    x, lattice = surface.x, surface.lattice
    place = np.arange(len(x))
    if lattice.dimension == 0:
        return place
    of_node = np.empty(len(x))
    of_node[surface.facets] = surface.body[:, None]
    torus = np.column_stack([on_torus(x, lattice), lattice.longest() * of_node])
    one, other = (
        scipy.spatial.cKDTree(torus).query_pairs(SAME_PLACE * lattice.longest(), output_type="ndarray").T
    )
    place[np.maximum(one, other)] = np.minimum(one, other)
    return np.unique(place, return_inverse=True)[1]


def _roughness(surface: Surface, of_facets: Indices, areas: Array) -> csc_matrix:
    """The matrix of sum h^2 A [grad t] : [grad v], by places; those of the nodes of facets are (E, n)."""
    x, (E, n) = surface.x[surface.facets], of_facets.shape
    corners = x[:, : x.shape[2]]
    h = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    place = of_facets.ravel()
    shared = np.flatnonzero(np.bincount(place)[place] == 2)
    pairs = shared[np.argsort(place[shared])].reshape(-1, 2)
    root = np.sqrt((h**2 * areas)[pairs // n].mean(axis=1))[:, None, None, None]
    jumps = root * _gradients(x, surface.degree).reshape(E * n, n, -1)[pairs]
    jumps[:, 1] *= -1.0
    # One row for each component of each jump.
    rows = np.arange(jumps[:, 0, 0].size).reshape(len(pairs), 1, 1, -1)
    rows, columns = np.broadcast_arrays(rows, of_facets[pairs // n][..., None])
    size = (len(pairs) * x.shape[2], place.max() + 1)
    D = scipy.sparse.csr_matrix((jumps.ravel(), (rows.ravel(), columns.ravel())), size)
    return (D.T @ D).tocsc()


def _gradients(x: Array, degree: int) -> Array:
    """At each node of facets x (E, n, d) the gradients along them of all shape functions, (E, n, n, d)."""
    element = basix.create_element(basix.ElementFamily.P, FACET[x.shape[2]], degree, EQUISPACED)
    slopes = np.moveaxis(element.tabulate(1, element.points)[1:, :, :, 0], 0, -1)
    tangents = np.einsum("anj,enc->eacj", slopes, x)
    gradients: Array = np.einsum("anj,eajc->eanc", slopes, np.linalg.pinv(tangents))
    return gradients
