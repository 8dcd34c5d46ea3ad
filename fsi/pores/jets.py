"""Functions of the plane with their first and second derivatives, written as formulas.

Products follow Leibniz' rule, so that trial functions are written as in a textbook and their strain rates
are exact. A formula is written down once, as a list of steps, each of which makes one function of others;
compiled loops then take the steps for a few points of a pore at a time, which stay in the processor's cache.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

LINEAR, ANY = 3, 6  # how many of f, f_x, f_y, f_xx, f_xy, f_yy need not vanish
(
    DISTANCE,
    AFFINE,
    HALF_SQUARE,
    PRODUCT,
    RECIPROCAL,
    SUM,
    SHIFTED,
    SCALED,
    TERM,
) = range(9)


class JetStep(NamedTuple):
    """One function made of others: its number, that of `first` and `second` or of a datum, and two numbers.

    Attributes:
        kind: DISTANCE ... TERM; see `fsi.pores.steps.take_steps`.
        out: the function that is made; of a TERM the trial function that it belongs to.
        first, second: functions; of those made of data the vertex, and the first column of the pore's data.
        alpha, beta: factors.
    """

    kind: int
    out: int
    first: int
    second: int
    alpha: float
    beta: float


@dataclass(slots=True)
class Formulas:
    """Steps that have been written down.

    Attributes:
        steps: in their order.
        degree: LINEAR or ANY, of each function.
    """

    steps: list[JetStep] = field(default_factory=list)
    degree: list[int] = field(default_factory=list)

    def made(self, kind: int, first: int, second: int, degree: int, factors: tuple[float, float]) -> int:
        """The number of a new function."""
        out = len(self.degree)
        self.steps.append(JetStep(kind, out, first, second, *factors))
        self.degree.append(degree)
        return out

    def distance(self, v: int, column: int) -> Jet:
        """The distance to surface v; data: centre, normal, sign, 1 for walls and 0 else."""
        return Jet(self, self.made(DISTANCE, v, column, ANY, (0.0, 0.0)))

    def affine(self, column: int) -> Jet:
        """c + g . (x - o); data: o, g, c."""
        return Jet(self, self.made(AFFINE, 0, column, LINEAR, (0.0, 0.0)))

    def half_square(self, v: int, column: int) -> Jet:
        """(|x - c|^2 - a^2) / 2 by the distance d to the circle, d (|x - c| + a) / 2; data: c, sign, a."""
        return Jet(self, self.made(HALF_SQUARE, v, column, ANY, (0.0, 0.0)))


@dataclass(frozen=True, slots=True)
class Jet:
    """A function with its derivatives, `factor` times the one of that number."""

    formulas: Formulas
    number: int
    factor: float = 1.0

    @property
    def degree(self) -> int:
        """LINEAR or ANY."""
        return self.formulas.degree[self.number]

    def _made(self, kind: int, other: Jet, degree: int, factors: tuple[float, float]) -> Jet:
        return Jet(self.formulas, self.formulas.made(kind, self.number, other.number, degree, factors))

    def __add__(self, other: Jet) -> Jet:
        return self._made(SUM, other, max(self.degree, other.degree), (self.factor, other.factor))

    def __sub__(self, other: Jet) -> Jet:
        return self + other.scaled(-1.0)

    def __mul__(self, other: Jet) -> Jet:
        if other.degree > self.degree:
            return other * self
        product = self._made(PRODUCT, other, ANY, (1.0, 0.0))
        return product.scaled(self.factor * other.factor)

    def scaled(self, factor: float) -> Jet:
        """A multiple by a number."""
        return Jet(self.formulas, self.number, self.factor * factor)

    def by(self, column: int) -> Jet:
        """A multiple by a datum of each pore."""
        number = self.formulas.made(SCALED, self.number, column, self.degree, (self.factor, 0.0))
        return Jet(self.formulas, number)

    def plus(self, number: float) -> Jet:
        """This and a constant."""
        return self._made(SHIFTED, self, self.degree, (self.factor, number))

    def reciprocal(self) -> Jet:
        """1 / f."""
        return self._made(RECIPROCAL, self, ANY, (1.0, 0.0)).scaled(1.0 / self.factor)

    def legendre(self, number: int) -> list[Jet]:
        """P_0(f), P_1(f), ... of |f| <= 1, by (k + 1) P_k+1 = (2 k + 1) f P_k - k P_k-1."""
        P = [self.scaled(0.0).plus(1.0), self]
        for k in range(1, number - 1):
            P.append((self * P[k]).scaled((2 * k + 1) / (k + 1)) - P[k - 1].scaled(k / (k + 1)))
        return P[:number]


type Product = tuple[Jet, Jet | None]
type Sum = Sequence[Product]
"""A function as a sum of products of two; None stands for 1."""


class JetProgram(NamedTuple):
    """The steps to some functions, for compiled loops: each in a place that is free again after its last use.

    Attributes:
        code: kind, out, first, second, degree of the first, and of the second, (steps, 6).
        factor: alpha and beta, (steps, 2).
        places: how many functions are kept at once.
        functions: how many there are.
    """

    code: NDArray[np.int64]
    factor: NDArray[np.float64]
    places: int
    functions: int


def program(formulas: Formulas, functions: Iterable[Sum]) -> JetProgram:
    """The steps to functions that are sums of products."""
    steps, seen, number = list[JetStep](), 0, 0
    for number, function in enumerate(functions, 1):  # each is written down when its turn comes
        steps += formulas.steps[seen:]
        seen = len(formulas.steps)
        for f, g in function:
            second, factor = (-1, f.factor) if g is None else (g.number, f.factor * g.factor)
            if second >= 0 and formulas.degree[second] > f.degree:
                f, second = Jet(formulas, second), f.number
            steps.append(JetStep(TERM, number - 1, f.number, second, factor, 0.0))
    return _placed(steps, formulas.degree, number)


def _sources(step: JetStep) -> tuple[int, ...]:
    """The functions that a step is made of."""
    if step.kind in (DISTANCE, AFFINE, HALF_SQUARE):
        return ()
    if step.kind in (SCALED, SHIFTED, RECIPROCAL) or step.second < 0:
        return (step.first,)
    return step.first, step.second


def _placed(steps: list[JetStep], degree: list[int], functions: int) -> JetProgram:
    """Steps with places in place of numbers; those without use are left out."""
    needed, kept = set[int](), list[tuple[JetStep, set[int]]]()
    for step in reversed(steps):
        if step.kind == TERM or step.out in needed:
            last = {source for source in _sources(step) if source not in needed}
            needed.update(last)
            kept.append((step, last))
    place, free, places, code = dict[int, int](), list[int](), 0, list[list[int]]()
    for step, last in reversed(kept):
        sources = _sources(step)
        first = place[step.first] if sources else step.first
        second = place[step.second] if len(sources) == 2 else step.second
        out = step.out
        if step.kind != TERM:
            if not free:
                free.append(places)
                places += 1
            out = place[step.out] = free.pop()
        degrees = [degree[source] for source in sources] + [0, 0]
        code.append([step.kind, out, first, second, *degrees[:2]])
        free.extend(place[source] for source in last)
    factor = [[step.alpha, step.beta] for step, _ in reversed(kept)]
    return JetProgram(np.array(code, np.int64), np.array(factor), places, functions)
