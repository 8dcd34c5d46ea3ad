"""Points and weights in pores: three strips along the necks of each and the triangle that they leave.

A strip is ruled: the point P_i(t) on one surface runs from the foot of the neck to where the inscribed circle
touches, P_j(t) likewise on the other, and the strip is x = (1 - s) P_i(t) + s P_j(t), 0 < s, t < 1. The
points t gather in the neck as sinh(t T), T = arcsinh(span / sqrt(2 gap / (1/a_i + 1/a_j))). The three points
of touching span the triangle. All is smooth in each part, so that Gauss points converge exponentially;
distances to both surfaces of a strip are formed without cancellation, whatever the gap.
"""

from functools import cache
from typing import NamedTuple

import numpy as np

from fsi.bodies.configuration import Array
from fsi.pores.regions import NEXT, OTHER, PoreShapes, cross
from fsi.pores.surfaces import CONTAINER, WALL


class Rule(NamedTuple):
    """Gauss points on (0, 1) and their weights, (2, .): along strips, across strips, and in the triangle."""

    along: Array
    across: Array
    inside: Array


class Points(NamedTuple):
    """Q points of each of n pores.

    Attributes:
        x: coordinates, (n, Q, 2).
        weight: (n, Q).
        distance: to the three surfaces, (3, n, Q).
    """

    x: Array
    weight: Array
    distance: Array


def rule(along: int, across: int, inside: int) -> Rule:
    """The rule with these numbers of points."""
    return Rule(*(_gauss(n) for n in (along, across, inside)))


@cache
def _gauss(n: int) -> Array:
    x, w = np.polynomial.legendre.leggauss(n)
    return np.stack([(x + 1.0) / 2.0, w / 2.0])


def pore_points(shapes: PoreShapes, rule: Rule) -> Points:
    """The points of pores."""
    parts = [part(shapes, v, rule) for part in (_strip, _triangle) for v in range(3)]
    x, weight, distance = (np.concatenate(part, axis=-1) for part in zip(*parts, strict=True))
    return Points(np.moveaxis(x, 0, -1), weight, distance)


def distances(shapes: PoreShapes, x: Array) -> Array:
    """Distances of points (n, Q, 2) to the three surfaces, (3, n, Q)."""
    return np.stack([_distance(shapes, v, np.moveaxis(x, -1, 0)) for v in range(3)])


def _strip(shapes: PoreShapes, v: int, rule: Rule) -> tuple[Array, Array, Array]:
    """x (2, n, Q), weights and distances of the strips along side v."""
    i, j, n = NEXT[v], OTHER[v], len(shapes.gap)
    t, dt = _gathered(shapes, v, rule.along)
    s = rule.across[0]
    at_i, along_i = _arc(shapes, v, 0, t)
    at_j, along_j = _arc(shapes, v, 1, t)
    # The vector across is formed from what is small in a narrow neck.
    across = (shapes.gap[:, v, None] * shapes.direction[:, v]).T[..., None] + at_j - at_i
    tangent = (1.0 - s) * along_i[..., None] + s * along_j[..., None]
    weight = cross(across[..., None], tangent) * dt[..., None] * rule.across[1]
    step = s * across[..., None]
    from_i, from_j = (shapes.foot[:, v, end].T[..., None] + at for end, at in ((0, at_i), (1, at_j)))
    x = from_i[..., None] + step
    distance = np.empty((3, *weight.shape))
    distance[i] = _off(shapes, i, from_i, step)
    distance[j] = _off(shapes, j, from_j, (s - 1.0) * across[..., None])
    distance[v] = _distance(shapes, v, x)
    return x.reshape(2, n, -1), weight.reshape(n, -1), distance.reshape(3, n, -1)


def _triangle(shapes: PoreShapes, v: int, rule: Rule) -> tuple[Array, Array, Array]:
    """x, weights and distances of the third of the triangle between points of touching along side v.

    Points gather at its middle, so that no vertex of a pore is before another.
    """
    (u, du), A = rule.inside, np.moveaxis(shapes.touch, 0, -1)  # (3, 2, n)
    middle = A.mean(axis=0)[..., None]
    first, second = A[NEXT[v]][..., None] - middle, A[OTHER[v]][..., None] - middle
    x = middle + np.outer(u, 1.0 - u).ravel() * first + np.outer(u, u).ravel() * second
    weight = cross(first, second) * np.outer(u * du, du).ravel()
    return x, weight, np.stack([_distance(shapes, k, x) for k in range(3)])


def gathering(shapes: PoreShapes, v: int) -> Array:
    """T of side v, arcsinh(span / sqrt(2 gap / (1/a_i + 1/a_j))), (n,)."""
    curvature, span = np.zeros(len(shapes.gap)), np.zeros(len(shapes.gap))
    for end, k in enumerate((NEXT[v], OTHER[v])):
        sign = np.where(shapes.kind[:, k] == CONTAINER, -1.0, 1.0)
        bent = shapes.kind[:, k] != WALL
        curvature[bent] += sign[bent] / shapes.radius[bent, k]
        span += 0.5 * np.linalg.norm(shapes.touch[:, k] - shapes.foot[:, v, end], axis=1)
    gap = np.where(shapes.gap[:, v] > 0.0, shapes.gap[:, v], np.inf)  # a corner of two walls
    T: Array = np.arcsinh(span * np.sqrt(0.5 * np.maximum(curvature, 0.0) / gap))
    return T


def _gathered(shapes: PoreShapes, v: int, along: Array) -> tuple[Array, Array]:
    """t and its weights, (n, T)."""
    T = np.maximum(gathering(shapes, v), 1e-3)[:, None]
    tau, weight = along
    return np.sinh(tau * T) / np.sinh(T), weight * T * np.cosh(tau * T) / np.sinh(T)


def _arc(shapes: PoreShapes, v: int, end: int, t: Array) -> tuple[Array, Array]:
    """P(t) - foot on one surface of side v and P'(t), both (2, n, T); P(1) is the point of touching."""
    k = (NEXT[v], OTHER[v])[end]
    foot, touch = shapes.foot[:, v, end].T[..., None], shapes.touch[:, k].T[..., None]
    centre = shapes.centre[:, k].T[..., None]
    f, g = foot - centre, touch - centre
    full = np.arctan2(cross(f, g), np.sum(f * g, axis=0))
    sine, cosine, versine = np.sin(full * t), np.cos(full * t), 2.0 * np.sin(0.5 * full * t) ** 2
    turned = np.stack([-f[1], f[0]])
    wall = (shapes.kind[:, k] == WALL)[:, None]
    bent, rate = sine * turned - versine * f, full * (cosine * turned - sine * f)
    return np.where(wall, t * (touch - foot), bent), np.where(wall, touch - foot, rate)


def _off(shapes: PoreShapes, k: int, on: Array, step: Array) -> Array:
    """Distance to surfaces k, steps (2, n, T, S) away from points (2, n, T) on them.

    |x|^2 - a^2 = (|x| - a) (|x| + a) keeps the digits of small steps.
    """
    c, a = shapes.centre[:, k].T[..., None, None], shapes.radius[:, k, None, None]
    square = np.sum((2.0 * (on[..., None] - c) + step) * step, axis=0)
    sign = np.where(shapes.kind[:, k] == CONTAINER, -1.0, 1.0)[:, None, None]
    wall = (shapes.kind[:, k] == WALL)[:, None, None]
    flat = np.sum(shapes.normal[:, k].T[..., None, None] * step, axis=0)
    root = np.sqrt(np.maximum(a * a + square, 0.0))
    return np.where(wall, flat, sign * square / np.where(wall, 1.0, a + root))


def _distance(shapes: PoreShapes, k: int, x: Array) -> Array:
    """Distance of points (2, n, ...) to surfaces k."""
    shape = (-1,) + (1,) * (x.ndim - 2)
    r = x - shapes.centre[:, k].T.reshape(2, *shape)
    sign = np.where(shapes.kind[:, k] == CONTAINER, -1.0, 1.0).reshape(shape)
    flat = np.sum(r * shapes.normal[:, k].T.reshape(2, *shape), axis=0)
    wall = (shapes.kind[:, k] == WALL).reshape(shape)
    return np.where(wall, flat, sign * (np.hypot(r[0], r[1]) - shapes.radius[:, k].reshape(shape)))
