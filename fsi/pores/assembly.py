"""K of all pores and fluid discs: a sparse form of the numbers of surfaces and the modes of necks."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from fsi.arrays import Array, Indices
from fsi.machine.threads import in_turn
from fsi.pores.forms import PoreForms, pore_forms
from fsi.pores.inner import inner_form
from fsi.pores.levels import LEVELS, level_of
from fsi.pores.narrow import Ties, functions_of, narrow_necks, ties_of
from fsi.pores.orders import KNOTS, RIGID, STRAINED, TIED, Orders, numbers_of
from fsi.pores.pattern import add_forms, pattern_of
from fsi.pores.pore_data import gathering
from fsi.pores.quadrature import Rule
from fsi.pores.regions import PoreShapes
from fsi.pores.shape import flat_ones
from fsi.pores.surfaces import DISC
from fsi.pores.topology import Pores

# Values of all functions at all points of the pores of a batch, of each derivative: some 100 MB of six.
_NUMBERS = 2_000_000
_DILUTE = 1e-3  # area fraction of bodies below which what points miss would show beside what bodies do
# Where psi is free: polynomials between feet, ten for so much of T, by which points gather, at both ends; and
# of how many modes bubbles and points are at least.
_FREE, _MOST, _GATHERED, _FINE = 20, 40, 3.0, 12


@dataclass(frozen=True, slots=True)
class Numbering:
    """Where the unknowns of surfaces and necks stand.

    Attributes:
        surface: first unknown of each surface, (B + 1,): U_x, U_y, omega, c, those of its order.
        neck: first unknown of each neck, and their end, (K + 1,): those of a narrow one, modes, then knots.
        order: as in `Orders.fluid`: of fluid discs, of bodies where there is a mean stress STRAINED, (B,).
        knots: of each neck, KNOTS for each foot on a surface where psi is free, (K,).
        narrow: which necks are narrow, (K,).
    """

    surface: Indices
    neck: Indices
    order: Indices
    knots: Indices
    narrow: NDArray[np.bool_]

    @property
    def unknowns(self) -> int:
        """All of them."""
        return int(self.neck[-1])

    @property
    def modes(self) -> Indices:
        """How many modes each neck has, (K,)."""
        return np.diff(self.neck) - self.knots - TIED * self.narrow


@dataclass(frozen=True, slots=True)
class Batch:
    """The forms of pores of the same orders.

    Attributes:
        pore: which, (n,).
        unknown: of each number of each, (n, m).
        orders: which functions they have.
        rule: their points of quadrature.
        forms: their dissipation.
        ties: constraints of narrow necks.
    """

    pore: Indices
    unknown: Indices
    orders: Orders
    rule: Rule
    forms: PoreForms
    ties: Ties

    def of_functions(self, numbers: Array) -> Array:
        """Numbers of all functions, (n, total), from those of pores and their bubbles, (n, m + bubbles)."""
        shared = functions_of(self.orders)
        return np.concatenate([numbers[:, shared], numbers[:, self.unknown.shape[1] :]], axis=1)


@dataclass(frozen=True, slots=True)
class FluidForms:
    """The forms inside fluid discs of one order.

    Attributes:
        disc: which surfaces, (n,).
        unknown: their numbers, (n, m).
        K: the form of a disc of radius 1, (m, m).
        per_area: 1 over the square of their radii, (n,).
    """

    disc: Indices
    unknown: Indices
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
        ties: B of the constraints B x = 0 of narrow necks, (t, n).
    """

    lower: sp.csr_matrix
    batches: list[Batch]
    numbering: Numbering
    fluid: list[FluidForms]
    ties: sp.csr_matrix

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


def number(pores: Pores, modes: Indices) -> Numbering:
    """The unknowns when necks have these numbers of modes, (K,)."""
    most = np.zeros(len(pores.surfaces), np.int64)
    np.maximum.at(most, pores.necks, modes[:, None])
    surfaces = pores.surfaces
    strained = (surfaces.kind == DISC) & (len(surfaces.periods) > 0) & ~surfaces.free
    of_bodies = np.where(strained, STRAINED, 0)
    order = np.where(surfaces.fluid, tabulated(lambda k: LEVELS[level_of(k)].fluid, most), of_bodies)
    surface = np.concatenate([[0], np.cumsum(tabulated(numbers_of, order))]).astype(np.int64)
    knots = KNOTS * np.sum(surfaces.free[pores.necks], axis=1)
    narrow = narrow_necks(pores)
    neck = surface[-1] + np.concatenate([[0], np.cumsum(TIED * narrow + modes + knots)]).astype(np.int64)
    return Numbering(surface, neck, order, knots, narrow)


def tabulated(function: Callable[[int], int], at: Indices) -> Indices:
    """A function of small numbers."""
    return np.array([function(k) for k in range(int(at.max(initial=0)) + 1)])[at]


def assemble(pores: Pores, shapes: PoreShapes, modes: Indices) -> Assembly:
    """K where necks have these numbers of modes; a pore is as fine as its finest neck."""
    numbering = number(pores, modes)
    necks = np.where(pores.sides >= 0, len(pores.surfaces) + pores.sides, -1)
    members = np.concatenate([pores.vertices, necks], axis=1)
    pattern = pattern_of(members, np.concatenate([numbering.surface[:-1], numbering.neck]))
    entries, batches = np.zeros(len(pattern.indices)), list[Batch]()
    rows = _rows_of_ties(pores, numbering)
    for batch in in_turn(partial(_batch, pores, shapes, numbering, rows), _parts(pores, shapes, numbering)):
        add_forms(entries, pattern, members[batch.pore], batch.forms.K)
        batches.append(batch)
    fluid = list(_fluid_forms(pores, numbering))
    for forms in fluid:
        add_forms(entries, pattern, forms.disc[:, None], forms.per_area[:, None, None] * forms.K)
    return Assembly(pattern.matrix(entries), batches, numbering, fluid, _constraints(batches, numbering))


class Part(NamedTuple):
    """Pores of the same orders: which, the functions that they have, and their points of quadrature."""

    pore: Indices
    orders: Orders
    rule: Rule


def _parts(pores: Pores, shapes: PoreShapes, numbering: Numbering) -> Iterator[Part]:
    """All pores, so many at a time that their numbers have room."""
    modes = np.where(pores.sides >= 0, numbering.modes[pores.sides], 0)
    flat = flat_ones(pores.surfaces.shapes(), pores.vertices, shapes.centre)
    if pores.surfaces.fraction < _DILUTE:
        flat[:] = True
    T = gathering(shapes)
    polynomials = np.clip(10 * np.ceil((T.sum(axis=1) - T.min(axis=1)) / _GATHERED), _FREE, _MOST)
    free = pores.surfaces.free[pores.vertices] * polynomials[:, None].astype(int)
    narrow = numbering.narrow[pores.sides] & (pores.sides >= 0)
    corner = (pores.sides < 0) & pores.surfaces.hollow
    kinds = np.column_stack([modes, numbering.order[pores.vertices], free, narrow, corner, flat])
    for kind in np.unique(kinds, axis=0):
        of_sides, of_vertices, are_free, are_narrow, are_corners, (is_flat,) = np.split(kind, range(3, 18, 3))
        level = LEVELS[level_of(int(of_sides.max()))]
        if are_free.any():
            level = LEVELS[level_of(max(level.modes, _FINE))]
        rule = level.finer_rule if is_flat else level.rule
        orders = Orders(
            _three(of_sides),
            _three(of_vertices),
            level.bubbles,
            level.neck_bubbles,
            _three(are_free),
            _three(are_narrow),
            _three(are_corners),
        )
        alike = np.flatnonzero(np.all(kinds == kind, axis=1))
        numbers = orders.total * 3 * (2 * rule.first * rule.across.shape[1] + rule.third.shape[1])
        for some in np.array_split(alike, min(len(alike), 1 + len(alike) * numbers // _NUMBERS)):
            yield Part(some, orders, rule)


def _batch(pores: Pores, shapes: PoreShapes, numbering: Numbering, rows: Indices, part: Part) -> Batch:
    some, orders, rule = part
    own = shapes.of(some)
    forms, ties = pore_forms(own, rule, orders), ties_of(own, orders, rows[some])
    return Batch(some, _unknowns(pores, some, orders, numbering), orders, rule, forms, ties)


def _rows_of_ties(pores: Pores, numbering: Numbering) -> Indices:
    """First row of the constraints that each side of each pore tells, (E, 3): once each; -1 for none."""
    rows = np.full(pores.sides.size, -1)
    neck, place = np.unique(pores.sides.ravel(), return_index=True)
    first = TIED * (np.cumsum(numbering.narrow) - 1)
    narrow = (neck >= 0) & numbering.narrow[neck]
    rows[place[narrow]] = first[neck[narrow]]
    return rows.reshape(-1, 3)


def _constraints(batches: Sequence[Batch], numbering: Numbering) -> sp.csr_matrix:
    """B of all constraints."""
    parts = [(np.empty(0), np.empty(0, np.int64), np.empty(0, np.int64))]
    for batch in batches:
        row, pore, coefficients = batch.ties
        rows = np.broadcast_to((row[:, None] + np.arange(TIED))[..., None], coefficients.shape)
        columns = np.broadcast_to(batch.unknown[pore][:, None], coefficients.shape)
        parts.append((coefficients.ravel(), rows.ravel(), columns.ravel()))
    value, rows, columns = (np.concatenate(part) for part in zip(*parts, strict=True))
    shape = (TIED * int(numbering.narrow.sum()), numbering.unknowns)
    B = sp.csr_matrix((value, (rows, columns)), shape=shape)
    B.eliminate_zeros()
    return B


def _three(numbers: Indices) -> tuple[int, int, int]:
    first, second, third = numbers.tolist()
    return first, second, third


def _unknowns(pores: Pores, chosen: Indices, orders: Orders, numbering: Numbering) -> Indices:
    """The unknowns of the shared functions of pores, (n, m)."""
    parts = []
    for v in range(3):
        numbers = np.arange(numbers_of(orders.fluid[v]))
        parts.append(numbering.surface[pores.vertices[chosen, v], None] + numbers)
    for v in range(3):
        numbers = np.arange(TIED * orders.narrow[v] + orders.modes[v] + orders.knots[v])
        parts.append(numbering.neck[pores.sides[chosen, v], None] + numbers)
    return np.concatenate(parts, axis=1)


def _fluid_forms(pores: Pores, numbering: Numbering) -> Iterator[FluidForms]:
    """The dissipation inside fluid discs."""
    for order in np.unique(numbering.order[pores.surfaces.fluid]):
        fluid = np.flatnonzero(numbering.order == order)
        own = np.pad(inner_form(int(order)), (RIGID, 0))
        unknown = numbering.surface[fluid, None] + np.arange(len(own))
        yield FluidForms(fluid, unknown, own, 1.0 / pores.surfaces.radius[fluid] ** 2)
