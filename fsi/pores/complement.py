"""A lower bound of the apparent viscosity of a cell or channel, from stresses in equilibrium in its pores.

In the plane a stress in equilibrium has Airy's function phi, sigma = (phi_yy, -phi_xy; -phi_xy, phi_xx).
Bodies without force and torque leave phi and grad phi single-valued; apart from that phi is free on their
circles. By the complementary principle (the least dissipation W at a mean strain rate E, |Omega| the area)

    W >= 2 |Omega| Sigma : E - 1/mu int over the fluid of (sigma' : sigma') / 2

for all of them, Sigma the mean stress. Of deviators (s, d) = (sigma_xy, (sigma_xx - sigma_yy) / 2)

    1/mu int (sigma' : sigma') / 2 = 1/(4 mu) int 4 phi_xy^2 + (phi_yy - phi_xx)^2,

the form of psi. So the least of it at a mean stress is found by the elements of psi, with functions on bodies
that leave it free there (`free_functions`), and a mean stress (s, d) is a mean gradient, G = s diag(-1, 1) +
d [[0, 1], [1, 0]]. With |Omega| (s, d) M (s, d) / mu this least and e = (E_xy, E_xx), the best stress gives

    W >= 4 mu |Omega| e M^-1 e,   mu_app / mu >= e M^-1 e / |e|^2.

Walls of a channel that slide have power 2 s E_xy |Omega| in a stress that is free on them too. They bear
opposite forces, and a pressure costs nothing, so that s alone counts: mu_app / mu >= 1 / M_ss.

The lower bound is as exact as the upper one: but for quadrature.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from fsi.bodies.configuration import Array
from fsi.pores.assembly import Batch
from fsi.pores.carrier import carried, stream
from fsi.pores.definite import Cholesky
from fsi.pores.orders import KNOTS, RIGID, numbers_of
from fsi.pores.pattern import Index
from fsi.pores.regions import NEXT, OTHER
from fsi.pores.surfaces import WALL, BoundingSurfaces
from fsi.pores.system import PoreSystem
from fsi.pores.topology import Pores

_STRESSES = (np.diag([-1.0, 1.0]), np.array([[0.0, 1.0], [1.0, 0.0]]))


def least_viscosity(pores: Pores, modes: Index, E: Array) -> float:
    """Below the apparent viscosity over mu of a cell in the mean strain rate E, bodies without loads.

    Or of a channel whose walls slide. By stresses with these numbers of modes for the necks, (K,).
    """
    surfaces = replace(pores.surfaces, hollow=True)
    stresses = PoreSystem.of(0, replace(pores, surfaces=surfaces), modes, 1.0)
    if surfaces.bounds:
        return 4.0 * _area(surfaces) / float(_least(stresses, _STRESSES[:1])[0, 0])
    M = _least(stresses, _STRESSES) / (4.0 * _area(surfaces))
    e = np.array([E[0, 1], E[0, 0]])
    return float(e @ np.linalg.solve(M, e) / (e @ e))


def _area(surfaces: BoundingSurfaces) -> float:
    """Of a cell, or of a channel between its two walls."""
    if not surfaces.bounds:
        return abs(float(np.linalg.det(surfaces.periods)))
    low, high = surfaces.centre[-2:]
    return float(np.linalg.norm(surfaces.periods[0])) * abs(float(surfaces.normal[-1] @ (high - low)))


def _least(system: PoreSystem, gradients: Sequence[Array]) -> Array:
    """The products of the stresses that dissipate least at these mean gradients of phi, (G, G)."""
    numbering, surfaces = system.assembly.numbering, system.pores.surfaces
    loads, alone = np.zeros((system.size, len(gradients))), np.zeros((len(gradients), len(gradients)))
    for batch in system.assembly.batches:
        q = np.stack([_carried(system, batch, G) for G in gradients], axis=2)
        Kq = np.einsum("eij,ejg->eig", batch.forms.K, q)
        np.subtract.at(loads, batch.unknown.ravel(), Kq.reshape(-1, len(gradients)))
        alone += np.einsum("eig,eih->gh", q, Kq)
    free = np.ones(system.size, bool)
    rigid = numbering.surface[:-1][surfaces.free, None] + np.arange(RIGID)
    free[rigid] = False  # knots do what they do
    # phi = 1, and in a channel phi = y, cost nothing: f and g of one knot are held.
    neck = int(np.argmax(numbering.knots))
    knot = int(numbering.neck[neck] + numbering.modes[neck])
    free[[knot, knot + 2] if surfaces.bounds else [knot]] = False
    y = Cholesky(system.assembly.lower, free).solve(loads[free])
    return np.asarray(alone - y.T @ loads[free])


def _carried(system: PoreSystem, batch: Batch, G: Array) -> Array:
    """`carried`, walls not by rigid numbers but at their knots, which strain them, (n, m)."""
    q, orders = carried(system, batch, G), batch.orders
    shapes, k = system.shapes.of(batch.pore), 0
    for v in range(3):
        wall = shapes.kind[:, v] == WALL
        q[wall, k : k + RIGID] = 0.0
        k += numbers_of(orders.fluid[v])
    for v in range(3):
        k += orders.modes[v]
        if orders.knots[v]:
            last = k + orders.knots[v] - KNOTS  # a wall is the second surface of a neck
            for end, vertex in enumerate((NEXT[v], OTHER[v])):
                wall = shapes.kind[:, vertex] == WALL
                x = shapes.foot[wall, v, end] - shapes.centre[wall, 0]
                q[wall, last : last + KNOTS] = _at_knot(x, shapes.normal[wall, vertex], G)
            k += orders.knots[v]
    return q


def _at_knot(x: Array, n: Array, G: Array) -> Array:
    """f, f', g, g' of the flow u = G x on a wall of normals n, (n, KNOTS)."""
    e, u = np.column_stack([n[:, 1], -n[:, 0]]), x @ G.T
    slope = np.column_stack([-u[:, 1], u[:, 0]])
    bend = np.array([[-G[1, 0], G[0, 0]], [G[0, 0], G[0, 1]]])
    along, across = np.sum(e * slope, axis=1), np.sum(n * slope, axis=1)
    return np.column_stack([stream(G, x), along, across, np.sum((e @ bend) * n, axis=1)])
