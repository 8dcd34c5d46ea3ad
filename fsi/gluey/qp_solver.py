"""`min 1/2 |u - u*|_M^2  s.t.  b + J u >= 0`: the velocity nearest to u* that lets no gap become negative.

Its dual, over the set K of impulses p that are allowed (p >= 0; friction and films bound more), is

    min_{p in K}  1/2 p.W p + c.p,   W = J M^-1 J^T + diag(compliance),   c = b + J u*,   u = u* + M^-1 J^T p.

It is solved by the projected gradient with momentum, which begins anew whenever it points uphill:
Y. Nesterov, Dokl. Akad. Nauk SSSR 269 (1983) 543; B. O'Donoghue & E. Candes, Found. Comput. Math. 15 (2015)
715, for rows scaled to the unit diagonal. That is quick where few bodies touch. In a crowd, where
information must travel through all of it, Newton's method (`fsi.gluey.augmented_lagrangian`) goes on; where
there are only gaps an interior point method tells it first what touches (`fsi.gluey.interior_points`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import LinearOperator, eigsh

from fsi.arrays import Array
from fsi.bodies.rows import MANY, gram, products
from fsi.gluey.augmented_lagrangian import Impulses, Program, minimise
from fsi.gluey.interior_points import by_interior_points


@dataclass(frozen=True, slots=True)
class ContactResponse:
    """Rows without viscosity: p >= 0 keeps `r + compliance p >= 0`, or a bound on p takes slip away.

    Attributes:
        least: smallest impulse of the normal rows, 0 or -inf where the gap is held, shape (C,).
        limits: largest friction of each contact, (K,).
        first: where the rows of friction begin.
        compliance: of all rows, (rows,).
    """

    least: Array
    limits: Array
    first: int
    compliance: Array

    @classmethod
    def of_gaps(cls, rows: int) -> ContactResponse:
        """Gaps that may open, nothing else."""
        return cls(np.zeros(rows), np.zeros(0), rows, np.zeros(rows))

    @property
    def only_gaps(self) -> bool:
        """True if every row is a gap that may open: no friction, no film, none held closed."""
        return len(self.compliance) == len(self.least) and bool(np.all(self.least == 0.0))

    def scales(self, weight: Array) -> Array:
        """Of the rows of one contact's friction the largest: their bound is a disc, and p along the slip.

        A row that moves nothing has the scale of others.
        """
        shared = weight.copy()
        if len(self.limits):
            of_friction = shared[self.first :].reshape(len(self.limits), -1)
            of_friction[:] = of_friction.max(axis=1, keepdims=True)
        shared[shared == 0.0] = shared.max(initial=0.0) or 1.0
        return shared

    def onto(self, p: Array) -> Array:
        """The projection onto the impulses that are allowed."""
        allowed = p.copy()
        C = len(self.least)
        np.maximum(p[:C], self.least, out=allowed[:C])
        if len(self.limits):
            slip = p[self.first :].reshape(len(self.limits), -1)
            size = np.linalg.norm(slip, axis=1)
            shrink = np.minimum(1.0, self.limits / np.where(size > 0.0, size, 1.0))
            allowed[self.first :] = (slip * shrink[:, None]).ravel()
        return allowed

    def impulse(self, r: Array, p_old: Array, sigma: Array) -> tuple[Array, sp.spmatrix]:
        """`P_K(p_old' - s r)` with `s = 1/(compliance + 1/sigma)`, and its derivative."""
        s = 1.0 / (self.compliance + 1.0 / sigma)
        free = s * (p_old / sigma - r)
        p = self.onto(free)
        C, slope = len(self.least), s.copy()
        slope[:C] = np.where(free[:C] > self.least, s[:C], 0.0)
        D = sp.diags(slope).tocsr()
        if len(self.limits):
            D = sp.block_diag([sp.diags(slope[: self.first]), self._bounded(free, s)], format="csr")
        return p, D

    def _bounded(self, free: Array, s: Array) -> sp.spmatrix:
        """s times the derivative of the projection: I inside, `limit/|q| (I - q q/|q|^2)` outside."""
        slip = free[self.first :].reshape(len(self.limits), -1)
        across = slip.shape[1]
        size = np.linalg.norm(slip, axis=1)
        out = size > self.limits
        direction = slip / np.where(size > 0.0, size, 1.0)[:, None]
        blocks = np.tile(np.eye(across), (len(slip), 1, 1))
        tangent = blocks - direction[:, :, None] * direction[:, None, :]
        shrink = self.limits / np.where(size > 0.0, size, 1.0)
        blocks[out] = (shrink[:, None, None] * tangent)[out]
        blocks *= s[self.first :].reshape(-1, across)[:, :1, None]
        count = np.arange(len(slip) + 1)
        return sp.bsr_matrix((blocks, count[:-1], count), shape=(across * len(slip),) * 2)

    def residual(self, r: Array, p: Array, weight: Array) -> float:
        """The natural residual `|p - P_K(p - (r + compliance p)/w)| w`, w: of `scales`, + compliance."""
        w = weight + self.compliance
        return float((np.abs(p - self.onto(p - (r + self.compliance * p) / w)) * w).max(initial=0.0))


# How often the gradient's residual is looked at, and how many iterations may be spent: it is given up as soon
# as its mean rate so far asks for more.
CHECK_EVERY, JUDGE_EVERY, MOST_ITERATIONS = 10, 250, 5000
# Of the residual after JUDGE_EVERY iterations: gaps that open faster are left out of the following ones,
# which so cost half. They are looked at again in the end, at most so often.
NEAR, LOOKS = 10.0, 4


def project(program: Program, p: Array, response: ContactResponse, tolerance: float) -> Impulses:
    """Solve the dual from impulses p, (rows,), to a `kkt`, a velocity, below the tolerance.

    `kkt` is the largest natural residual `|p - P_K(p - (W p + c) / W_ii)| W_ii`, a rate of a gap. It may
    exceed the tolerance, which is the caller's to judge.
    """
    dual = _Dual.of(program, response)
    if response.only_gaps:
        p, iterations = _of_gaps(dual, program, p, tolerance)
    else:
        reached = _by_gradient(dual, _Reached(p), tolerance, MOST_ITERATIONS)
        p, iterations = reached.p, reached.iterations
    u = program.velocity(p)
    kkt = response.residual(program.rate(u), p, response.scales(program.weight))
    if kkt <= tolerance:
        return Impulses(p, u, kkt, iterations, 0)
    if response.only_gaps:
        p = by_interior_points(program)
    return replace(minimise(program, p, response, tolerance), iterations=iterations)


def _of_gaps(dual: _Dual, program: Program, p: Array, tolerance: float) -> tuple[Array, int]:
    """The gradient's impulses, and its iterations, most of them without rows that stay open."""
    weight = program.weight
    reached = _by_gradient(dual, _Reached(p), tolerance, JUDGE_EVERY)
    p = reached.p
    for _ in range(LOOKS):
        r = program.rate(program.velocity(p))
        kkt = dual.response.residual(r, p, weight)
        if kkt <= tolerance:
            break
        near = np.flatnonzero((p > 0.0) | (r < NEAR * kkt))
        begin = replace(reached, p=p[near])
        reached = _by_gradient(dual.of_gaps(near), begin, tolerance, MOST_ITERATIONS)
        p = np.zeros(len(p))
        p[near] = reached.p
        if reached.residual > tolerance:
            break
    return p, reached.iterations


@dataclass(frozen=True, slots=True)
class _Reached:
    """Where the gradient is.

    Attributes:
        p: impulses, shape (rows,).
        iterations: since the first.
        first: the first residual.
        residual: the best since then.
    """

    p: Array
    iterations: int = 0
    first: float = np.inf
    residual: float = np.inf


# From y and z with a momentum one step: the new z, and whether it is uphill; y is taken to the next one.
type Descent = Callable[[Array, Array, float], tuple[Array, bool]]


@dataclass(frozen=True, slots=True)
class _Dual:
    """The dual in `z = p / scale`, in which a step of length 1 against the gradient is stable.

    Attributes:
        B, product: `z -> W z`, with `W = B B^T + diag(stiff)`.
        stiff: the scaled compliances, (rows,).
        c, scale: (rows,).
        step: that length in z of rows with unit diagonal.
        response: which impulses are allowed.
    """

    B: sp.csr_matrix
    product: Callable[[Array], Array]
    stiff: Array
    c: Array
    scale: Array
    step: float
    response: ContactResponse

    @classmethod
    def of(cls, program: Program, response: ContactResponse) -> _Dual:
        """Rows scaled to the unit diagonal, then by the largest eigenvalue."""
        J, compliance = program.J, response.compliance
        s = 1.0 / np.sqrt(response.scales(program.weight) + compliance)
        moved = np.unique(J.indices)  # what no row moves costs time
        B = sp.csr_matrix(sp.diags(s) @ J[:, moved] @ sp.diags(1.0 / np.sqrt(program.mass[moved])))
        stiff = s * s * compliance
        step = 1.0 / _largest(gram(B, stiff), len(s))
        B *= np.sqrt(step)
        s *= np.sqrt(step)
        stiff *= step
        return cls(B, gram(B, stiff), stiff, s * program.rate(program.u_star), s, step, response)

    def of_gaps(self, chosen: NDArray[np.intp]) -> _Dual:
        """That of these rows, gaps all of them; fewer rows have no larger an eigenvalue."""
        B, stiff = self.B[chosen], np.zeros(len(chosen))
        response = ContactResponse.of_gaps(len(chosen))
        return _Dual(B, gram(B, stiff), stiff, self.c[chosen], self.scale[chosen], self.step, response)

    def gradient(self, z: Array) -> Array:
        """`W z + c`."""
        g = self.product(z)
        g += self.c
        return g

    def onto(self, z: Array) -> Array:
        """The projection onto the impulses that are allowed; z may be overwritten."""
        if self._only_normal:
            return np.maximum(z, self._least, out=z)
        return self.response.onto(self.scale * z) / self.scale

    @property
    def _only_normal(self) -> bool:
        return len(self.response.least) == len(self.scale)

    @property
    def _least(self) -> Array:
        least: Array = self.response.least / self.scale
        return least

    def residual(self, z: Array) -> float:
        """The largest natural residual, a rate."""
        misses = np.abs(z - self.onto(z - self.gradient(z) / self.step))
        return float((misses * (self.step / self.scale)).max(initial=0.0))

    def descent(self) -> Descent:
        """Projected steps of length 1 against the gradient, compiled for many rows that are all normal."""
        if self._only_normal and len(self.scale) > MANY:
            return partial(products(self.B, self.stiff).descend, self.c, self._least)
        return self._descend

    def _descend(self, y: Array, z: Array, momentum: float) -> tuple[Array, bool]:
        new = self.gradient(y)
        new = self.onto(np.subtract(y, new, out=new))
        moves = new - z
        y -= new
        uphill = bool(y @ moves > 0.0)
        y[:] = new if uphill else new + momentum * moves
        return new, uphill


def _by_gradient(dual: _Dual, begin: _Reached, tolerance: float, most: int) -> _Reached:
    """Goes on until the residual is tolerated or falls too slowly, to `most` iterations since the first."""
    z, descend = dual.onto(begin.p / dual.scale), dual.descent()
    y, theta = z.copy(), 1.0
    best, first = np.inf, begin.first
    for iteration in range(begin.iterations, most):
        if iteration % CHECK_EVERY == 0:
            best = min(best, dual.residual(z))
            first = best if iteration == 0 else first
            judged = iteration > begin.iterations and iteration % JUDGE_EVERY == 0
            if best <= tolerance or (judged and _in_vain(iteration, first, best, tolerance)):
                return _Reached(dual.scale * z, iteration, first, best)
        following = 0.5 * (1.0 + np.sqrt(1.0 + 4.0 * theta * theta))
        z, uphill = descend(y, z, (theta - 1.0) / following)
        theta = 1.0 if uphill else following
    return _Reached(dual.scale * z, most, first, best)


def _in_vain(iteration: int, first: float, best: float, tolerance: float) -> bool:
    """True if the mean rate from the first residual to the best asks for more than MOST_ITERATIONS."""
    if tolerance == 0.0:
        return True
    return bool(MOST_ITERATIONS * np.log(best / first) > iteration * np.log(tolerance / first))


def _largest(W: Callable[[Array], Array], rows: int) -> float:
    """An upper bound of the largest eigenvalue of W, by Lanczos with a margin for its tolerance."""
    if rows < 3:
        return float(np.linalg.norm(np.column_stack([W(e) for e in np.eye(rows)]), 2)) if rows else 1.0
    operator = LinearOperator((rows, rows), matvec=W, dtype=float)
    start = np.cos(np.arange(rows, dtype=float))  # any vector that is not special, the same in every run
    few = min(5, rows)  # vectors kept: with 20 products are as many, and a crowd's take thrice their time
    largest = eigsh(operator, k=1, which="LA", tol=1e-2, v0=start, ncv=few, return_eigenvectors=False)
    return 1.05 * float(largest[0])
