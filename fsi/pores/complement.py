"""The stress in equilibrium that dissipates least in pores of cells and channels: a lower bound, a pressure.

In the plane a stress in equilibrium has Airy's function phi, sigma = (phi_yy, -phi_xy; -phi_xy, phi_xx).
Bodies without force and torque leave phi and grad phi single-valued; apart from that phi is free on their
circles. By the complementary principle (the least dissipation W at a mean strain rate E, |Omega| the area)

    W >= 2 |Omega| Sigma : E - 1/mu int over the fluid of (sigma' : sigma') / 2

for all of them, Sigma the mean stress. Of deviators (s, d) = (sigma_xy, (sigma_xx - sigma_yy) / 2)

    1/mu int (sigma' : sigma') / 2 = 1/(4 mu) int 4 phi_xy^2 + (phi_yy - phi_xx)^2,

the form of psi. So the least of it at a mean stress is found by the elements of psi, with functions on bodies
that leave it free there (`free_functions`), and a mean stress (s, d) is a mean gradient, G = s diag(-1, 1) +
d [[0, 1], [1, 0]]. With |Omega| (s, d) M (s, d) / mu this least and e = (E_xy, E_xx), the best stress gives

    (s, d) = 2 mu M^-1 e,   W >= 4 mu |Omega| e M^-1 e,   mu_app / mu >= e M^-1 e / |e|^2.

Walls of a channel that slide have power 2 s E_xy |Omega| in a stress that is free on them too. They bear
opposite forces, and a pressure costs nothing, so that s alone counts: mu_app / mu >= 1 / M_ss.

The lower bound is as exact as the upper one: but for quadrature. And as the two come together, the best
stress tends to that of the flow, with its pressure (`fsi.pores.pressure`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from fsi.bodies.configuration import Array
from fsi.pores.assembly import Batch
from fsi.pores.carrier import carried, stream
from fsi.pores.definite import Cholesky
from fsi.pores.orders import KNOTS, RIGID, numbers_of
from fsi.pores.pattern import Index
from fsi.pores.regions import NEXT, OTHER
from fsi.pores.surfaces import WALL
from fsi.pores.system import PoreSystem
from fsi.pores.topology import Pores

_STRESSES = (np.diag([-1.0, 1.0]), np.array([[0.0, 1.0], [1.0, 0.0]]))


@dataclass(frozen=True, slots=True, eq=False)
class AiryStress:
    """A stress in equilibrium, by the numbers of its phi: those of psi of a `PoreFlow`, and used like them.

    Attributes:
        system: whose numbers these are; bodies are hollow.
        x: all numbers, what they have more than the mean stress carries along, (n,).
        mean: (phi_y, -phi_x) = mean x of the mean stress, (2, 2).
    """

    system: PoreSystem
    x: Array
    mean: Array

    @property
    def gradient(self) -> Array:
        """By which (phi_y, -phi_x) differs from image to image, which no stress tells: nothing, (2, 2)."""
        return np.zeros((2, 2))

    def numbers(self, batch: Batch) -> Array:
        """Of the pores of a batch, (n, m), but for what phi has of linear functions of each pore."""
        return np.asarray(self.x[batch.unknown] + _carried(self.system, batch, self.mean))


@dataclass(frozen=True, slots=True, eq=False)
class LeastStresses:
    """The stresses of least dissipation at mean stresses, bodies without loads.

    Attributes:
        system: of phi, whose bodies are hollow; of fluid of viscosity 1.
        means: the mean stresses, of s and, of a cell, of d, as G above.
        x: numbers beside each, (n, 1) or (n, 2).
        M: their products, as above, (1, 1) or (2, 2).
    """

    system: PoreSystem
    means: tuple[Array, ...]
    x: Array
    M: Array

    @classmethod
    def of(cls, pores: Pores, modes: Index) -> LeastStresses:
        """With these numbers of modes for the necks of a cell or channel, (K,). Raises SolveError."""
        surfaces = replace(pores.surfaces, hollow=True)
        system = PoreSystem.of(0, replace(pores, surfaces=surfaces), modes, 1.0)
        means = _STRESSES[:1] if surfaces.bounds else _STRESSES
        x, products = _least(system, means)
        return cls(system, means, x, products / (4.0 * surfaces.area))

    def viscosity(self, E: Array) -> float:
        """Below the apparent viscosity over mu in the mean strain rate E, of a channel that of its walls."""
        e = self._rates(E)
        return float(e @ np.linalg.solve(self.M, e) / (e @ e))

    def stress(self, E: Array, mu: float) -> AiryStress:
        """The best of them in the mean strain rate E, of fluid of viscosity mu."""
        means = 2.0 * mu * np.linalg.solve(self.M, self._rates(E))
        mean = sum((k * G for k, G in zip(means, self.means, strict=True)), np.zeros((2, 2)))
        return AiryStress(self.system, self.x @ means, mean)

    def _rates(self, E: Array) -> Array:
        """e, of a channel E_xy alone."""
        return np.array([E[0, 1], E[0, 0]])[: len(self.means)]


def _least(system: PoreSystem, means: Sequence[Array]) -> tuple[Array, Array]:
    """The stresses that dissipate least beside these means: their numbers (n, G), and products (G, G)."""
    numbering, surfaces = system.assembly.numbering, system.pores.surfaces
    loads, alone = np.zeros((system.size, len(means))), np.zeros((len(means), len(means)))
    for batch in system.assembly.batches:
        q = np.stack([_carried(system, batch, G) for G in means], axis=2)
        Kq = np.einsum("eij,ejg->eig", batch.forms.K, q)
        np.subtract.at(loads, batch.unknown.ravel(), Kq.reshape(-1, len(means)))
        alone += np.einsum("eig,eih->gh", q, Kq)
    free = np.ones(system.size, bool)
    rigid = numbering.surface[:-1][surfaces.free, None] + np.arange(RIGID)
    free[rigid] = False  # knots do what they do
    # phi = 1, and in a channel phi = y, cost nothing: f and g of one knot are held.
    neck = int(np.argmax(numbering.knots))
    knot = int(numbering.neck[neck] + numbering.modes[neck])
    free[[knot, knot + 2] if surfaces.bounds else [knot]] = False
    x = np.zeros_like(loads)
    x[free] = Cholesky(system.assembly.lower, free).solve(loads[free])
    return x, np.asarray(alone - x.T @ loads)


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
