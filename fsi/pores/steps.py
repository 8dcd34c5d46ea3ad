"""Compiled loops that take the steps of `fsi.pores.jets`, for a few points of a pore at a time."""

from typing import NamedTuple

import numpy as np

from fsi.bodies.configuration import Array
from fsi.pores.compiled import compiled
from fsi.pores.jets import (
    AFFINE,
    ANY,
    DISTANCE,
    HALF_SQUARE,
    PRODUCT,
    RECIPROCAL,
    SCALED,
    SUM,
    TERM,
    JetProgram,
)
from fsi.pores.quadrature import Points

_AT_ONCE = 96  # points


class Pore(NamedTuple):
    """The points of one pore, and its data.

    Attributes:
        data: numbers that its functions are made of.
        x: points, (Q, 2).
        distance: to its surfaces, (3, Q).
        root: factors of strain rates, (Q,).
    """

    data: Array
    x: Array
    distance: Array
    root: Array


def strain_rates(program: JetProgram, data: Array, points: Points) -> Array:
    """2 psi_xy and psi_yy - psi_xx times roots of weights, (n, functions, 2, Q); data of pores, (n, .)."""
    return _taken(program, data, points, 2)


def values(program: JetProgram, data: Array, points: Points) -> Array:
    """The functions with their derivatives, (n, functions, 6, Q)."""
    return _taken(program, data, points, ANY)


def _taken(program: JetProgram, data: Array, points: Points, components: int) -> Array:
    n, Q = points.weight.shape
    out = np.zeros((n, program.functions, components, Q))
    root = np.sqrt(np.abs(points.weight))
    jets = np.empty((program.places + 1, ANY, _AT_ONCE))
    _take_steps(program, Pore(data, points.x, points.distance, root), jets, out)
    return out


@compiled
def _take_steps(program: JetProgram, pores: Pore, jets: Array, out: Array) -> None:
    """All steps at all points of all pores; jets (places, 6, .) is where they work."""
    room, Q, code = jets.shape[2], pores.x.shape[1], program.code
    for e in range(len(pores.data)):
        data = pores.data[e]
        for q in range(0, Q, room):
            n = min(room, Q - q)
            x, root = pores.x[e][q:], pores.root[e][q : q + n]
            for s in range(len(code)):
                kind, o, i, j = code[s, 0], code[s, 1], code[s, 2], code[s, 3]
                alpha, beta = program.factor[s, 0], program.factor[s, 1]
                if kind == PRODUCT:
                    if code[s, 5] == ANY:
                        _product(n, jets[i], jets[j], jets[o])
                    else:
                        _product_with_linear(n, jets[i], jets[j], jets[o])
                elif kind == TERM and out.shape[2] == 2:
                    if j < 0:
                        _strain(alpha, jets[i], root, out[e, o, :, q:])
                    elif code[s, 5] == ANY:
                        _strain_of_product(alpha, jets[i], jets[j], root, out[e, o, :, q:])
                    else:
                        _strain_with_linear(alpha, jets[i], jets[j], root, out[e, o, :, q:])
                elif kind == TERM:
                    if j >= 0:
                        _product(n, jets[i], jets[j], jets[-1])
                        i = -1
                    for k in range(6):
                        for w in range(n):
                            out[e, o, k, q + w] += alpha * jets[i, k, w]
                elif kind == SUM:
                    _sum(n, program.factor[s], jets[i], jets[j], jets[o])
                elif kind == RECIPROCAL:
                    _reciprocal(n, jets[i], jets[o])
                elif kind == DISTANCE:
                    _distance(n, data[j:], x, pores.distance[i, e][q:], jets[o])
                elif kind == AFFINE:
                    _affine(n, data[j:], x, jets[o])
                elif kind == HALF_SQUARE:
                    _half_square(n, data[j:], x, pores.distance[i, e][q:], jets[o])
                else:  # SCALED or SHIFTED
                    factor = alpha * data[j] if kind == SCALED else alpha
                    for k in range(6):
                        for w in range(n):
                            jets[o, k, w] = factor * jets[i, k, w]
                    for w in range(n):
                        jets[o, 0, w] += beta


@compiled
def _product(n: int, f: Array, g: Array, out: Array) -> None:
    for w in range(n):
        a, ax, ay, b, bx, by = f[0, w], f[1, w], f[2, w], g[0, w], g[1, w], g[2, w]
        out[0, w] = a * b
        out[1, w] = ax * b + a * bx
        out[2, w] = ay * b + a * by
        out[3, w] = f[3, w] * b + 2.0 * ax * bx + a * g[3, w]
        out[4, w] = f[4, w] * b + ax * by + ay * bx + a * g[4, w]
        out[5, w] = f[5, w] * b + 2.0 * ay * by + a * g[5, w]


@compiled
def _product_with_linear(n: int, f: Array, g: Array, out: Array) -> None:
    for w in range(n):
        a, ax, ay, b, bx, by = f[0, w], f[1, w], f[2, w], g[0, w], g[1, w], g[2, w]
        out[0, w] = a * b
        out[1, w] = ax * b + a * bx
        out[2, w] = ay * b + a * by
        out[3, w] = f[3, w] * b + 2.0 * ax * bx
        out[4, w] = f[4, w] * b + ax * by + ay * bx
        out[5, w] = f[5, w] * b + 2.0 * ay * by


@compiled
def _strain(alpha: float, f: Array, root: Array, out: Array) -> None:
    for w in range(len(root)):
        out[0, w] += alpha * root[w] * 2.0 * f[4, w]
        out[1, w] += alpha * root[w] * (f[5, w] - f[3, w])


@compiled
def _strain_of_product(alpha: float, f: Array, g: Array, root: Array, out: Array) -> None:
    for w in range(len(root)):
        a, ax, ay, b, bx, by = f[0, w], f[1, w], f[2, w], g[0, w], g[1, w], g[2, w]
        factor = alpha * root[w]
        out[0, w] += factor * 2.0 * (f[4, w] * b + ax * by + ay * bx + a * g[4, w])
        out[1, w] += factor * ((f[5, w] - f[3, w]) * b + 2.0 * (ay * by - ax * bx) + a * (g[5, w] - g[3, w]))


@compiled
def _strain_with_linear(alpha: float, f: Array, g: Array, root: Array, out: Array) -> None:
    for w in range(len(root)):
        ax, ay, b, bx, by = f[1, w], f[2, w], g[0, w], g[1, w], g[2, w]
        factor = alpha * root[w]
        out[0, w] += factor * 2.0 * (f[4, w] * b + ax * by + ay * bx)
        out[1, w] += factor * ((f[5, w] - f[3, w]) * b + 2.0 * (ay * by - ax * bx))


@compiled
def _sum(n: int, factor: Array, f: Array, g: Array, out: Array) -> None:
    for k in range(6):
        for w in range(n):
            out[k, w] = factor[0] * f[k, w] + factor[1] * g[k, w]


@compiled
def _reciprocal(n: int, f: Array, out: Array) -> None:
    for w in range(n):
        v = 1.0 / f[0, w]
        d, dd = -v * v, 2.0 * v * v * v
        fx, fy = f[1, w], f[2, w]
        out[0, w], out[1, w], out[2, w] = v, d * fx, d * fy
        out[3, w] = d * f[3, w] + dd * fx * fx
        out[4, w] = d * f[4, w] + dd * fx * fy
        out[5, w] = d * f[5, w] + dd * fy * fy


@compiled
def _distance(n: int, data: Array, x: Array, d: Array, out: Array) -> None:
    """Data: centre, normal of a wall, sign, 1 for walls and 0 else."""
    sign, wall = data[4], data[5]
    for w in range(n):
        rx, ry = x[w, 0] - data[0], x[w, 1] - data[1]
        bend = (1.0 - wall) * sign / np.sqrt(rx * rx + ry * ry + wall)
        nx, ny = data[2] + bend * rx, data[3] + bend * ry
        out[0, w], out[1, w], out[2, w] = d[w], nx, ny
        out[3, w], out[4, w], out[5, w] = bend * ny * ny, -bend * nx * ny, bend * nx * nx


@compiled
def _affine(n: int, data: Array, x: Array, out: Array) -> None:
    """Data: where it has its constant, gradient, constant."""
    for w in range(n):
        out[0, w] = data[4] + data[2] * (x[w, 0] - data[0]) + data[3] * (x[w, 1] - data[1])
        out[1, w], out[2, w], out[3, w], out[4, w], out[5, w] = data[2], data[3], 0.0, 0.0, 0.0


@compiled
def _half_square(n: int, data: Array, x: Array, d: Array, out: Array) -> None:
    """Data: centre, sign, radius, factor."""
    sign, a, t = data[2], data[3], data[4]
    for w in range(n):
        rx, ry = x[w, 0] - data[0], x[w, 1] - data[1]
        out[0, w] = t * 0.5 * sign * d[w] * (np.sqrt(rx * rx + ry * ry) + a)
        out[1, w], out[2, w], out[3, w], out[4, w], out[5, w] = t * rx, t * ry, t, 0.0, t
