"""Fluid discs: circles of fluid that stand in wide pores as bodies do, so that no pore is wide.

The flow in a fluid disc is a free polynomial. Where pores are wide beside their bodies' radii a fluid disc is
put into the largest inscribed circles, again and again; so a large void is filled by large ones in its middle
and by smaller ones towards the bodies.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fsi.errors import SolveError
from fsi.pores.compiled import compiled
from fsi.pores.links import Links, corner, moved, step
from fsi.pores.power import locate
from fsi.pores.shape import distance, from_neck, inscribed
from fsi.pores.start import surrounding, widest_view
from fsi.pores.surfaces import CONTAINER, DISC, Array, Bodies, Shapes, Surfaces
from fsi.pores.topology import clearances, linked

_ROUNDS = 60
_MOST = 200  # pores that one circle reaches into
_IN_THE_WAY = 0.1  # of an inscribed circle is enough for a fluid disc where a body lies across a neck


@dataclass(frozen=True, slots=True)
class Wide:
    """Which pores are wide.

    Attributes:
        least: inscribed radius over the least radius of its bodies, above which a pore is.
        wall: the same beside walls and containers.
        empty: the same of a pore without bodies over the mean radius of its fluid discs.
        share: radius of a fluid disc over that of the inscribed circle.

    Between three fluid discs whose circles touched there is one of 1.10 radii, between two and a wall one of
    1.00 (for a share of 0.55), in a corner one of 0.65: with a lesser `empty` there would be no end of them.
    """

    least: float = 0.8
    wall: float = 0.6
    empty: float = 1.2
    share: float = 0.55


def with_fluid_discs(surfaces: Surfaces, wide: Wide = Wide()) -> Surfaces:
    """These surfaces and fluid discs in all wide pores, and where bodies lie across necks.

    Raises SolveError where there is no end of it, because bodies overlap.
    """
    surfaces = _surrounded(surfaces, wide.share)
    for _ in range(_ROUNDS):
        links = linked(surfaces)
        shapes = surfaces.shapes()
        circles = inscribed_circles(shapes, links)
        free = separate(shapes, links, circles, _wanted(surfaces, links, circles, wide))
        if len(free) == 0:
            return surfaces
        surfaces = surfaces.with_fluid(free[:, :2], wide.share * free[:, 2])
    raise SolveError("no end of fluid discs; do bodies overlap?")


def _surrounded(surfaces: Surfaces, share: float) -> Surfaces:
    """With fluid discs around the centre of a container, where pores can start."""
    if not np.any(surfaces.kind == CONTAINER):
        return surfaces
    centre, R = surfaces.centre[-1], surfaces.radius[-1]
    while surrounding(surfaces, np.arange(surfaces.discs)) is None:
        view = widest_view(surfaces)
        out = np.linspace(0.0, R, 101)[1:-1]
        x = centre + out[:, None] * [np.cos(view), np.sin(view)]
        away = np.linalg.norm(x[:, None] - surfaces.centre[:-1], axis=2) - surfaces.radius[:-1]
        free = np.minimum(np.minimum(out, R - out), away.min(axis=1, initial=np.inf))
        best = int(np.argmax(free))
        surfaces = surfaces.with_fluid(x[best : best + 1], share * free[best : best + 1])
    return surfaces


def _wanted(surfaces: Surfaces, links: Links, circles: Array, wide: Wide) -> Array:
    """The least radius of a circle in each pore for which a fluid disc is wanted, (T,)."""
    radius, bound = surfaces.radius[links.body], surfaces.kind[links.body] != DISC
    body = np.where(bound | surfaces.fluid[links.body], np.inf, radius).min(axis=1)
    mean = np.where(bound, 0.0, radius).sum(axis=1) / (~bound).sum(axis=1)
    beside = np.where(bound.any(axis=1), wide.wall, wide.least)
    limit: Array = np.where(np.isfinite(body), beside * body, wide.empty * mean)
    return np.where(_crossed(surfaces, links), _IN_THE_WAY * circles[:, 2], limit)


def _crossed(surfaces: Surfaces, links: Links) -> NDArray[np.bool_]:
    """The pores with a body across one of their necks, and their neighbours."""
    bad = clearances(surfaces.shapes(), links) <= 0.0
    twin = links.twin.reshape(-1, 3)
    neighbours: NDArray[np.bool_] = bad | (bad[twin // 3] & (twin >= 0)).any(axis=1)
    return neighbours


@compiled
def inscribed_circles(shapes: Shapes, links: Links) -> Array:
    """Centre and radius of the circle in each pore, next to its bodies there, nan for none, (T, 3)."""
    circles = np.empty((len(links.body), 3))
    for t in range(len(links.body)):
        a, b, c = corner(shapes, links, t, 0), corner(shapes, links, t, 1), corner(shapes, links, t, 2)
        circles[t, 0], circles[t, 1], circles[t, 2] = inscribed(shapes, a, b, c)
    return circles


@compiled
def separate(shapes: Shapes, links: Links, circles: Array, wanted: Array) -> Array:
    """Circles cut back to the fluid, above the radii wanted, none in a pore of a larger one, (n, 3)."""
    taken = np.zeros(len(links.body), np.bool_)
    free = np.empty((len(circles), 3))
    candidates = np.flatnonzero(circles[:, 2] > wanted)
    n = 0
    for t in candidates[np.argsort(-circles[candidates, 2], kind="mergesort")]:
        pores, rho = _covered(shapes, links, t, circles[t])
        if rho > wanted[t] and not np.any(taken[pores]):
            taken[pores] = True
            free[n, 0], free[n, 1], free[n, 2] = circles[t, 0], circles[t, 1], rho
            n += 1
    return free[:n]


@compiled
def _covered(shapes: Shapes, links: Links, t: int, circle: Array) -> tuple[Bodies, float]:
    """The pores that a circle near pore t reaches into, and its radius cut back to what is free of bodies."""
    x, y, rho = circle[0], circle[1], circle[2]
    found = np.zeros((_MOST, 3), np.int64)  # a pore, and by how many periods the circle is translated there
    found[0] = locate(shapes, links, t, (0, x, y))
    n, done = 1, 0
    while done < n:
        p, at = found[done, 0], found[done, 1:]
        _, u, v = moved(shapes, (0, x, y), at[0], at[1])
        done += 1
        for k in range(3):
            a, b = corner(shapes, links, p, (k + 1) % 3), corner(shapes, links, p, (k + 2) % 3)
            rho = min(rho, distance(shapes, u, v, a))
            if links.twin[3 * p + k] < 0 or n == _MOST or from_neck(shapes, u, v, a, b) > rho:
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
