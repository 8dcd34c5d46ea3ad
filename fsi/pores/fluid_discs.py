"""Fluid discs: circles of fluid that stand in wide and flat pores as bodies do, so that no pore is.

The flow in a fluid disc is a free polynomial. Where pores are wide beside their bodies' radii a fluid disc is
put into the largest inscribed circles, again and again; so a large void is filled by large ones in its middle
and by smaller ones towards the bodies.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fsi.machine.compiled import compiled, internal
from fsi.meshes.geometry.lattice import reduced
from fsi.pores.links import Corner, Links, across, corner, moved, step
from fsi.pores.power import locate
from fsi.pores.shape import clearance, distance, from_neck, inscribed, is_flat, length_of, neck
from fsi.pores.start import surrounding, widest_view
from fsi.pores.surfaces import CONTAINER, DISC, Array, Bodies, BoundingSurfaces, NoPoresError, Shapes
from fsi.pores.topology import Pores, linked, numbered, pores_of, with_more_discs

_ROUNDS = 60
_ROUNDS_OF_FLAT = 8  # circles in flat pores may make others flat, now and then without end
_LEAST = 0.025  # radius of a circle beside a disc near a neck over the length of that
_MOST = 200  # pores that one circle reaches into
_TRIALS = 20  # circles beside a body that lies across a neck


@dataclass(frozen=True, slots=True)
class Wide:
    """Which pores are wide.

    Attributes:
        least: inscribed radius over the least radius of its bodies, above which a pore is.
        wall: the same beside walls and containers.
        empty: the same of a pore without bodies over the mean radius of its fluid discs.
        curved: the same beside a container, whose arc may be long.
        share: radius of a fluid disc over that of the inscribed circle.

    Between three fluid discs whose circles touched there is one of 1.10 radii, between two and a wall one of
    1.00 (for a share of 0.55), in a corner one of 0.65: with a lesser `empty` there would be no end of them.
    """

    least: float = 0.65
    wall: float = 0.6
    empty: float = 1.2
    curved: float = 0.96
    share: float = 0.55


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


def pores_without_wide(surfaces: BoundingSurfaces) -> Pores:
    """The pores between these surfaces and fluid discs. Raises NoPoresError: there are none."""
    return pores_of(*_with_fluid_discs(surfaces, Wide()))


def with_fluid_discs(surfaces: BoundingSurfaces, wide: Wide = Wide()) -> BoundingSurfaces:
    """These surfaces and fluid discs in all wide pores, in flat ones, and where bodies lie across necks.

    Raises NoPoresError where there is no end of it, because bodies overlap.
    """
    return _with_fluid_discs(surfaces, wide)[0]


def _with_fluid_discs(surfaces: BoundingSurfaces, wide: Wide) -> tuple[BoundingSurfaces, Links]:
    """The same, and their pores, linked as from the first; some may stay flat (see `Level.finer_rule`)."""
    surfaces, links = _without_wide(_surrounded(surfaces, wide.share), wide)
    for _ in range(_ROUNDS_OF_FLAT):
        more, _, _ = _more(surfaces, links, circles_in_pores(surfaces.shapes(), links, flat=True), wide)
        if more is surfaces:
            break
        surfaces, links = _without_wide(more, wide)
    return surfaces, links


def _without_wide(surfaces: BoundingSurfaces, wide: Wide) -> tuple[BoundingSurfaces, Links]:
    """With fluid discs until no pore is wide: the last round finds no more."""
    for _ in range(_ROUNDS):
        more, links = _filled(surfaces, wide)
        if more is surfaces:
            return surfaces, links
        surfaces = more
    raise NoPoresError("there is no end of circles of fluid between the bodies")


def _filled(surfaces: BoundingSurfaces, wide: Wide) -> tuple[BoundingSurfaces, Links]:
    """With fluid discs until no pore is wide, and these pores, in which they are put one after the other.

    While bodies lie across necks such pores may hide one from a new disc, which is then taken out.
    """
    links = linked(surfaces)
    apart = _apart(surfaces, links)
    if not apart.all():
        surfaces = surfaces.only(apart)
        links = linked(surfaces)
    circles = circles_in_pores(surfaces.shapes(), links, flat=False)
    for _ in range(_ROUNDS):
        more, links, circles = _more(surfaces, links, circles, wide)
        if more is surfaces:
            break
        surfaces = more
    return surfaces, links


def _more(
    surfaces: BoundingSurfaces, links: Links, circles: Circles, wide: Wide
) -> tuple[BoundingSurfaces, Links, Circles]:
    """With fluid discs in wide pores, and where they are asked for, that share none; the same if none is.

    With them their pores, and the circles in these, none asked for in flat ones.
    """
    radius = np.minimum(circles.radius, _touches_its_images(surfaces.periods))
    least = np.where(np.isfinite(circles.asked), circles.asked, _wide_from(surfaces, links, wide))
    wanted = np.flatnonzero(radius > least)
    wanted = wanted[np.argsort(-radius[wanted], kind="stable")]
    pores, radius = separate(
        surfaces.shapes(), links, wanted, np.column_stack([circles.centre, radius, least])
    )
    if len(pores) == 0:
        return surfaces, links, circles
    surfaces = surfaces.with_fluid(circles.centre[pores], wide.share * radius)
    links, kept = with_more_discs(surfaces, links, pores)
    return surfaces, links, _renewed(surfaces.shapes(), links, circles, kept)


def _touches_its_images(periods: Array) -> float:
    """The radius of a circle that does, infinite without periods, (P, 2)."""
    shortest = np.linalg.norm(reduced(periods), axis=1).min() if len(periods) else np.inf
    return float(0.5 * shortest)


def _apart(surfaces: BoundingSurfaces, links: Links) -> NDArray[np.bool_]:
    """All surfaces but fluid discs that overlap another, (B,)."""
    pores = numbered(surfaces, links)
    apart = np.ones(len(surfaces), bool)
    apart[pores.necks[pores.neck_gap <= 0.0]] = False
    return apart | ~surfaces.fluid


def _surrounded(surfaces: BoundingSurfaces, share: float) -> BoundingSurfaces:
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


def _wide_from(surfaces: BoundingSurfaces, links: Links, wide: Wide) -> Array:
    """The inscribed radius from which each pore is wide, (T,)."""
    radius, bound = surfaces.radius[links.body], surfaces.kind[links.body] != DISC
    body = np.where(bound | surfaces.fluid[links.body], np.inf, radius).min(axis=1)
    mean = np.where(bound, 0.0, radius).sum(axis=1) / (~bound).sum(axis=1)
    beside = np.where(bound.any(axis=1), wide.wall, wide.least)
    curved = (surfaces.kind[links.body] == CONTAINER).any(axis=1)
    limit: Array = np.where(
        np.isfinite(body), beside * body, np.where(curved, wide.curved, wide.empty) * mean
    )
    return limit


@compiled
def circles_in_pores(shapes: Shapes, links: Links, flat: bool) -> Circles:
    """Those of all pores, with circles asked for in flat ones if that counts."""
    circles = _no_circles(len(links.body))
    for t in range(len(links.body)):
        _take_circle(shapes, links, t, flat, circles)
    return circles


@compiled
def _renewed(shapes: Shapes, links: Links, known: Circles, kept: NDArray[np.bool_]) -> Circles:
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
    for i in range(_TRIALS):
        away = r * 2.0 ** (0.5 * i - 5.0)
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
