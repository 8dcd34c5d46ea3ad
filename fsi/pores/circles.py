"""The circles in pores in which fluid discs may stand: inscribed ones, and where those do not do, others."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.machine.compiled import compiled, internal
from fsi.pores.links import Corner, Links, across, corner, moved, step
from fsi.pores.power import locate
from fsi.pores.shape import clearance, distance, from_neck, inscribed, is_flat, length_of, neck
from fsi.pores.surfaces import CONTAINER, DISC, Bodies, Shapes

_LEAST = 0.025  # radius of a circle beside a disc near a neck over the length of that
_MOST = 200  # pores that one circle reaches into
# Radii of circles beside a body that lies across a neck, over its radius. In containers, which it may nearly
# touch, there are smaller ones; elsewhere those would ask for ever smaller ones.
_BESIDE = 2.0 ** np.arange(-5.0, 5.0, 0.5)
_IN_CONTAINERS = 2.0 ** np.arange(-7.0, 5.0, 0.5)


class Circles(NamedTuple):
    """The circles in pores, next to their bodies there.

    One is asked for where a body lies across the opposite neck, or where the pore is flat, if that counts:
    then it is one near that neck, but beside containers.

    Attributes:
        centre: nan for none, (T, 2).
        radius: nan for none, (T,).
        asked: the radius that one must have to stand where it is asked for, else infinite, (T,).
    """

    centre: Array
    radius: Array
    asked: Array


@compiled
def circles_in_pores(shapes: Shapes, links: Links, flat: bool) -> Circles:
    """Those of all pores, with circles asked for in flat ones if that counts."""
    circles = _no_circles(len(links.body))
    for t in range(len(links.body)):
        _take_circle(shapes, links, t, flat, circles)
    return circles


@compiled
def renewed(shapes: Shapes, links: Links, known: Circles, kept: NDArray[np.bool_]) -> Circles:
    """Those of all pores, (T,), flat or not, of which the first have known ones, some of these kept."""
    circles = _no_circles(len(links.body))
    for t in range(len(links.body)):
        if t < len(kept) and kept[t] and known.asked[t] == np.inf:  # it depends on its own bodies alone
            circles.centre[t, 0], circles.centre[t, 1] = known.centre[t, 0], known.centre[t, 1]
            circles.radius[t] = known.radius[t]
        else:
            _take_circle(shapes, links, t, False, circles)
    return circles


@internal
def _no_circles(pores: int) -> Circles:
    """Room for those of so many pores; none is asked for."""
    return Circles(np.empty((pores, 2)), np.empty(pores), np.full(pores, np.inf))


@internal
def _take_circle(shapes: Shapes, links: Links, t: int, flat: bool, circles: Circles) -> None:
    """Find the circle in pore t, and whether it is asked for."""
    a, b, c = corner(shapes, links, t, 0), corner(shapes, links, t, 1), corner(shapes, links, t, 2)
    circle = inscribed(shapes, a, b, c)
    for _ in range(3):
        a, b, c = b, c, a
        if clearance(shapes, c, a, b) <= 0.0:
            circle, circles.asked[t] = _beyond_neck(shapes, links, t, (a, b, c)), 0.0
        elif flat and is_flat(shapes, c, a, b):
            circles.asked[t] = 0.0
            if shapes.kind[c[0]] != CONTAINER:
                circle = _on_neck(shapes, links, t, (a, b))
            if shapes.kind[c[0]] == DISC:
                beyond = _beyond_neck(shapes, links, t, (a, b, c))
                circle = beyond if beyond[2] > circle[2] else circle
                circles.asked[t] = _LEAST * length_of(shapes, a, b)
    circles.centre[t, 0], circles.centre[t, 1], circles.radius[t] = circle


@internal
def _beyond_neck(
    shapes: Shapes, links: Links, t: int, corners: tuple[Corner, Corner, Corner]
) -> tuple[float, float, float]:
    """The largest of some circles beside disc c on the normal of the neck ab of pore t, free of bodies."""
    a, b, c = corners
    ex, ey = neck(shapes, a, b)
    length, r = np.hypot(ex, ey), shapes.radius[c[0]]
    x, y, rho = 0.0, 0.0, 0.0
    for part in _IN_CONTAINERS if shapes.kind[-1] == CONTAINER else _BESIDE:
        away = part * r
        u, v = c[1] + (r + away) * ey / length, c[2] - (r + away) * ex / length
        free = _covered(shapes, links, t, (u, v, away))[1]
        if free > rho:
            x, y, rho = u, v, free
    return x, y, rho


@internal
def _on_neck(shapes: Shapes, links: Links, t: int, ends: tuple[Corner, Corner]) -> tuple[float, float, float]:
    """The largest of three circles on the neck ab of pore t, free of bodies."""
    a, b = ends if shapes.kind[ends[0][0]] == DISC else (ends[1], ends[0])
    ex, ey = neck(shapes, a, b)
    length, gap = np.hypot(ex, ey), length_of(shapes, a, b)
    x, y, rho = 0.0, 0.0, 0.0
    for part in (0.5, 0.25, 0.75):
        along = (shapes.radius[a[0]] + part * gap) / length
        u, v = a[1] + along * ex, a[2] + along * ey
        free = _covered(shapes, links, t, (u, v, gap))[1]
        if free > rho:
            x, y, rho = u, v, free
    return x, y, rho


@compiled
def separate(shapes: Shapes, links: Links, wanted: Bodies, circles: Array) -> tuple[Bodies, Array]:
    """Of the wanted pores' circles those that share no pore with one before: pores and radii, (n,) both.

    The circles, rows x, y, radius, least radius, (T, 4), are cut back to the fluid, if that leaves the least.
    """
    taken = np.zeros(len(links.body), np.bool_)
    chosen, free = np.empty(len(wanted), np.int64), np.empty(len(wanted))
    n = 0
    for t in wanted:
        pores, rho = _covered(shapes, links, t, (circles[t, 0], circles[t, 1], circles[t, 2]))
        shared = False
        for p in pores:
            shared = shared or taken[p]
        if rho > circles[t, 3] and not shared:
            for p in pores:
                taken[p] = True
            chosen[n], free[n] = t, rho
            n += 1
    return chosen[:n], free[:n]


@internal
def _covered(
    shapes: Shapes, links: Links, t: int, circle: tuple[float, float, float]
) -> tuple[Bodies, float]:
    """The pores that a circle near pore t may reach into, and its radius cut back to what is free of bodies.

    A body may reach across necks, so that pores beyond those of the circle are looked at too.
    """
    x, y, rho = circle
    found = np.zeros((_MOST, 3), np.int64)  # a pore, and by how many periods the circle is translated there
    point = int(np.int64(0))  # of one type with numbers of surfaces, so that nothing is compiled twice
    found[0] = locate(shapes, links, t, (point, x, y))
    n, done = 1, 0
    while done < n:
        p, at = found[done, 0], found[done, 1:]
        _, u, v = moved(shapes, (point, x, y), at[0], at[1])
        done += 1
        for k in range(3):
            rho = min(rho, distance(shapes, u, v, corner(shapes, links, p, k)))
            if links.twin[3 * p + k] < 0:
                continue
            _, a, b, d = across(shapes, links, p, k)
            rho = min(rho, distance(shapes, u, v, d))
            if n == _MOST or (done > 1 and from_neck(shapes, u, v, a, b) > rho):
                continue
            dm, dn = step(shapes, links, p, k)
            new = (links.twin[3 * p + k] // 3, at[0] + dm, at[1] + dn)
            known = False
            for q in range(n):
                known = known or (found[q, 0] == new[0] and found[q, 1] == new[1] and found[q, 2] == new[2])
            if not known:
                found[n] = new
                n += 1
    return found[:n, 0].copy(), rho
