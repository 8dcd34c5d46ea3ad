"""Functions of the plane with their first and second derivatives, at Q points of each of n pores.

Products follow Leibniz' rule, so that trial functions are written as in a textbook and their strain rates are
exact.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fsi.bodies.configuration import Array
from fsi.pores.compiled import compiled


class Jet:
    """f, f_x, f_y, f_xx, f_xy, f_yy at points, (6, n, Q); numbers may be given for each pore, (n, 1)."""

    __slots__ = ("f",)

    def __init__(self, f: Array) -> None:
        self.f = f

    @classmethod
    def linear(cls, value: Array, gx: Array | float, gy: Array | float) -> Jet:
        """A linear function of given values (n, Q) and gradient, (n, 1) or a number."""
        f = np.zeros((6, *value.shape))
        f[0], f[1], f[2] = value, gx, gy
        return cls(f)

    def __add__(self, other: Jet) -> Jet:
        return Jet(self.f + other.f)

    def __sub__(self, other: Jet) -> Jet:
        return Jet(self.f - other.f)

    def __mul__(self, other: Jet) -> Jet:
        out = np.empty_like(self.f)
        _multiply(self.f.reshape(6, -1), other.f.reshape(6, -1), out.reshape(6, -1))
        return Jet(out)

    def scaled(self, factor: Array | float) -> Jet:
        """A multiple by a number, of each pore (n, 1) or of all."""
        return Jet(self.f * factor)

    def plus(self, number: float) -> Jet:
        """This and a constant."""
        f = self.f.copy()
        f[0] += number
        return Jet(f)

    def reciprocal(self) -> Jet:
        """1 / f."""
        out = np.empty_like(self.f)
        _reciprocal(self.f.reshape(6, -1), out.reshape(6, -1))
        return Jet(out)

    def legendre(self, number: int) -> list[Jet]:
        """P_0(f), P_1(f), ... of |f| <= 1, by (k + 1) P_k+1 = (2 k + 1) f P_k - k P_k-1."""
        one = np.zeros_like(self.f)
        one[0] = 1.0
        P = [Jet(one), self]
        for k in range(1, number - 1):
            P.append(Jet(((2 * k + 1) * (self * P[k]).f - k * P[k - 1].f) / (k + 1)))
        return P[:number]


type Sum = Sequence[tuple[Jet, Jet | None]]
"""A function as a sum of products of two; None stands for 1."""


def strain(function: Sum, out: Array) -> None:
    """2 psi_xy and psi_yy - psi_xx, the two numbers of the strain rate, into out, (2, n, Q)."""
    out[:] = 0.0
    for f, g in function:
        if g is None:
            out[0] += 2.0 * f.f[4]
            out[1] += f.f[5] - f.f[3]
        else:
            _add_strain(f.f, g.f, out)


def value(function: Sum) -> Jet:
    """The function with its derivatives."""
    terms = [f.f if g is None else (f * g).f for f, g in function]
    return Jet(np.sum(terms, axis=0))


@compiled
def _multiply(f: Array, g: Array, out: Array) -> None:
    for q in range(f.shape[1]):
        a, b = f[0, q], g[0, q]
        ax, ay, bx, by = f[1, q], f[2, q], g[1, q], g[2, q]
        out[0, q] = a * b
        out[1, q] = ax * b + a * bx
        out[2, q] = ay * b + a * by
        out[3, q] = f[3, q] * b + 2.0 * ax * bx + a * g[3, q]
        out[4, q] = f[4, q] * b + ax * by + ay * bx + a * g[4, q]
        out[5, q] = f[5, q] * b + 2.0 * ay * by + a * g[5, q]


@compiled
def _add_strain(f: Array, g: Array, out: Array) -> None:
    for e in range(f.shape[1]):
        for q in range(f.shape[2]):
            a, b = f[0, e, q], g[0, e, q]
            ax, ay, bx, by = f[1, e, q], f[2, e, q], g[1, e, q], g[2, e, q]
            out[0, e, q] += 2.0 * (f[4, e, q] * b + ax * by + ay * bx + a * g[4, e, q])
            yy = f[5, e, q] * b + 2.0 * ay * by + a * g[5, e, q]
            out[1, e, q] += yy - (f[3, e, q] * b + 2.0 * ax * bx + a * g[3, e, q])


@compiled
def _reciprocal(f: Array, out: Array) -> None:
    for q in range(f.shape[1]):
        v = 1.0 / f[0, q]
        d, dd = -v * v, 2.0 * v * v * v
        fx, fy = f[1, q], f[2, q]
        out[0, q], out[1, q], out[2, q] = v, d * fx, d * fy
        out[3, q] = d * f[3, q] + dd * fx * fx
        out[4, q] = d * f[4, q] + dd * fx * fy
        out[5, q] = d * f[5, q] + dd * fy * fy
