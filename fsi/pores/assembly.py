"""K of all pores and fluid discs: a sparse form of the numbers of surfaces and the modes of necks."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp

from fsi.bodies.configuration import Array
from fsi.machine.threads import in_turn
from fsi.pores.forms import PoreForms, pore_forms
from fsi.pores.inner import inner_form
from fsi.pores.levels import LEVELS, level_of
from fsi.pores.orders import KNOTS, RIGID, STRAINED, Orders, numbers_of
from fsi.pores.pattern import Index, add_forms, pattern_of
from fsi.pores.quadrature import Rule
from fsi.pores.regions import PoreShapes
from fsi.pores.shape import flat_ones
from fsi.pores.surfaces import DISC
from fsi.pores.topology import Pores

# Values of all functions at all points of the pores of a batch, of each derivative: some 100 MB of six.
_NUMBERS = 2_000_000
# Polynomials between feet where psi is free, for each order of fluid discs, and the most there are; of how
# many modes they take the points at least: with too few points a lower bound comes out too high.
_FREE, _MOST, _FINE = 3, 20, 12


@dataclass(frozen=True, slots=True)
class Numbering:
    """Where the unknowns of surfaces and necks stand.

    Attributes:
        surface: first unknown of each surface, (B + 1,): U_x, U_y, omega, c, those of its order.
        neck: first unknown of each neck, and their end, (K + 1,): modes, then knots.
        order: as in `Orders.fluid`: of fluid discs, of bodies where there is a mean stress STRAINED, (B,).
        knots: of each neck, KNOTS for each foot on a surface where psi is free, (K,).
    """

    surface: Index
    neck: Index
    order: Index
    knots: Index

    @property
    def unknowns(self) -> int:
        """All of them."""
        return int(self.neck[-1])

    @property
    def modes(self) -> Index:
        """How many modes each neck has, (K,)."""
        return np.diff(self.neck) - self.knots


@dataclass(frozen=True, slots=True)
class Batch:
    """The forms of pores of the same orders.

    Attributes:
        pore: which, (n,).
        unknown: of each function of each, (n, m).
        orders: which functions they have.
        rule: their points of quadrature.
        forms: their dissipation.
    """

    pore: Index
    unknown: Index
    orders: Orders
    rule: Rule
    forms: PoreForms


@dataclass(frozen=True, slots=True)
class FluidForms:
    """The forms inside fluid discs of one order.

    Attributes:
        disc: which surfaces, (n,).
        unknown: their numbers, (n, m).
        K: the form of a disc of radius 1, (m, m).
        per_area: 1 over the square of their radii, (n,).
    """

    disc: Index
    unknown: Index
    K: Array
    per_area: Array


@dataclass(frozen=True, slots=True)
class Assembly:
    """The assembled form.

    Attributes:
        lower: the lower triangle of the form, (n, n); of fluid of viscosity 1.
        batches: the forms of the pores.
        numbering: of the unknowns.
        fluid: the forms inside fluid discs.
    """

    lower: sp.csr_matrix
    batches: list[Batch]
    numbering: Numbering
    fluid: list[FluidForms]

    @property
    def K(self) -> sp.csr_matrix:
        """All entries, symmetric and positive semidefinite, made of the triangle where they are asked for."""
        return sp.csr_matrix(self.lower + sp.tril(self.lower, -1).T)

    def inside(self, y: Array) -> Array:
        """What fluid discs add to K y."""
        found = np.zeros(len(y))
        for forms in self.fluid:
            own = forms.unknown
            found[own] = forms.per_area[:, None] * (y[own] @ forms.K)
        return found


def number(pores: Pores, modes: Index) -> Numbering:
    """The unknowns when necks have these numbers of modes, (K,)."""
    most = np.zeros(len(pores.surfaces), np.int64)
    np.maximum.at(most, pores.necks, modes[:, None])
    surfaces = pores.surfaces
    strained = (surfaces.kind == DISC) & (len(surfaces.periods) > 0) & ~surfaces.free
    of_bodies = np.where(strained, STRAINED, 0)
    order = np.where(surfaces.fluid, tabulated(lambda k: LEVELS[level_of(k)].fluid, most), of_bodies)
    surface = np.concatenate([[0], np.cumsum(tabulated(numbers_of, order))]).astype(np.int64)
    knots = KNOTS * np.sum(surfaces.free[pores.necks], axis=1)
    neck = surface[-1] + np.concatenate([[0], np.cumsum(modes + knots)]).astype(np.int64)
    return Numbering(surface, neck, order, knots)


def tabulated(function: Callable[[int], int], at: Index) -> Index:
    """A function of small numbers."""
    return np.array([function(k) for k in range(int(at.max(initial=0)) + 1)])[at]


def assemble(pores: Pores, shapes: PoreShapes, modes: Index) -> Assembly:
    """K where necks have these numbers of modes; a pore is as fine as its finest neck."""
    numbering = number(pores, modes)
    necks = np.where(pores.sides >= 0, len(pores.surfaces) + pores.sides, -1)
    members = np.concatenate([pores.vertices, necks], axis=1)
    pattern = pattern_of(members, np.concatenate([numbering.surface[:-1], numbering.neck]))
    entries, batches = np.zeros(len(pattern.indices)), list[Batch]()
    for batch in in_turn(partial(_batch, pores, shapes, numbering), _parts(pores, shapes, numbering)):
        add_forms(entries, pattern, members[batch.pore], batch.forms.K)
        batches.append(batch)
    fluid = list(_fluid_forms(pores, numbering))
    for forms in fluid:
        add_forms(entries, pattern, forms.disc[:, None], forms.per_area[:, None, None] * forms.K)
    return Assembly(pattern.matrix(entries), batches, numbering, fluid)


class Part(NamedTuple):
    """Pores of the same orders: which, the functions that they have, and their points of quadrature."""

    pore: Index
    orders: Orders
    rule: Rule


def _parts(pores: Pores, shapes: PoreShapes, numbering: Numbering) -> Iterator[Part]:
    """All pores, so many at a time that their numbers have room."""
    modes = np.where(pores.sides >= 0, numbering.modes[pores.sides], 0)
    flat = flat_ones(pores.surfaces.shapes(), pores.vertices, shapes.centre)
    free = pores.surfaces.free[pores.vertices]
    kinds = np.column_stack([modes, numbering.order[pores.vertices], free, flat])
    for kind in np.unique(kinds, axis=0):
        level = LEVELS[level_of(int(kind[:3].max()))]
        points = LEVELS[level_of(max(level.modes, _FINE))] if kind[6:9].any() else level
        rule = points.finer_rule if kind[9] else points.rule
        orders = Orders(
            _three(kind[:3]),
            _three(kind[3:6]),
            level.bubbles,
            level.neck_bubbles,
            _three(kind[6:9] * min(_FREE * level.fluid, _MOST)),
        )
        alike = np.flatnonzero(np.all(kinds == kind, axis=1))
        numbers = orders.total * 3 * (2 * rule.first * rule.across.shape[1] + rule.third.shape[1])
        for some in np.array_split(alike, 1 + len(alike) * numbers // _NUMBERS):
            yield Part(some, orders, rule)


def _batch(pores: Pores, shapes: PoreShapes, numbering: Numbering, part: Part) -> Batch:
    some, orders, rule = part
    forms = pore_forms(shapes.of(some), rule, orders)
    return Batch(some, _unknowns(pores, some, orders, numbering), orders, rule, forms)


def _three(numbers: Index) -> tuple[int, int, int]:
    first, second, third = numbers.tolist()
    return first, second, third


def _unknowns(pores: Pores, chosen: Index, orders: Orders, numbering: Numbering) -> Index:
    """The unknowns of the shared functions of pores, (n, m)."""
    parts = []
    for v in range(3):
        numbers = np.arange(numbers_of(orders.fluid[v]))
        parts.append(numbering.surface[pores.vertices[chosen, v], None] + numbers)
    for v in range(3):
        numbers = np.arange(orders.modes[v] + orders.knots[v])
        parts.append(numbering.neck[pores.sides[chosen, v], None] + numbers)
    return np.concatenate(parts, axis=1)


def _fluid_forms(pores: Pores, numbering: Numbering) -> Iterator[FluidForms]:
    """The dissipation inside fluid discs."""
    for order in np.unique(numbering.order[pores.surfaces.fluid]):
        fluid = np.flatnonzero(numbering.order == order)
        own = np.pad(inner_form(int(order)), (RIGID, 0))
        unknown = numbering.surface[fluid, None] + np.arange(len(own))
        yield FluidForms(fluid, unknown, own, 1.0 / pores.surfaces.radius[fluid] ** 2)
