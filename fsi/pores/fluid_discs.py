"""Fluid discs: circles of fluid that stand in wide and flat pores as bodies do, so that no pore is.

The flow in a fluid disc is a free polynomial. Where pores are wide beside their bodies' radii a fluid disc is
put into the largest inscribed circles, again and again; so a large void is filled by large ones in its middle
and by smaller ones towards the bodies.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.meshes.geometry.lattice import reduced
from fsi.pores.circles import Circles, circles_in_pores, renewed, separate
from fsi.pores.links import Links
from fsi.pores.shape import flat_ones
from fsi.pores.start import surrounding, widest_view
from fsi.pores.surfaces import CONTAINER, DISC, WALL, BoundingSurfaces, NoPoresError
from fsi.pores.topology import Pores, linked, numbered, pores_of, with_more_discs

_ALIKE = 9  # digits of radii that tell which circle is larger
_ROUNDS = 60
# Circles in flat pores may make others flat: of a disc in a tight container they go around it, one by one,
# and into the crescent where they nearly touch without end: there those of the first rounds are enough.
_ROUNDS_OF_FLAT, _ENOUGH = 200, 30
# Discs for each that was there, and besides, by far more than pores need: without them small circles beside
# small ones ask for ever smaller ones.
_MANY, _FEW = 5, 250


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


def pores_without_wide(surfaces: BoundingSurfaces) -> Pores:
    """The pores between these surfaces and fluid discs. Raises NoPoresError: there are none."""
    surfaces, links = _with_fluid_discs(surfaces, Wide())
    _require_short_corners(surfaces, links)
    return pores_of(surfaces, links)


def _require_short_corners(surfaces: BoundingSurfaces, links: Links) -> None:
    """Raise NoPoresError where a corner of a box is flat: modes do not bring its flow, nor tell of it."""
    corners = links.body[(surfaces.kind[links.body] == WALL).sum(axis=1) == 2]
    flat = np.flatnonzero(flat_ones(surfaces.shapes(), corners, surfaces.centre[corners]))
    if len(flat):
        sides = map(surfaces.side, corners[flat[0]])
        raise NoPoresError("the corner between {} is too long for its width", *sides)


def _with_fluid_discs(surfaces: BoundingSurfaces, wide: Wide) -> tuple[BoundingSurfaces, Links]:
    """With fluid discs in all wide pores, in flat ones, and where bodies lie across necks, and these pores.

    They are linked as from the first; some may stay flat (see `Level.finer_rule`). Raises NoPoresError where
    there is no end of it, because bodies overlap.
    """
    surfaces = _surrounded(surfaces, wide.share)
    surfaces, links = _without_wide(surfaces, wide, _MANY * _most(surfaces))
    enough, most = (surfaces, links), _most(surfaces)
    for count in range(_ROUNDS_OF_FLAT):
        more, _, _ = _more(surfaces, links, circles_in_pores(surfaces.shapes(), links, flat=True), wide)
        if more is surfaces:
            return surfaces, links
        try:
            surfaces, links = _without_wide(more, wide, most)
        except NoPoresError:
            return enough
        enough = (surfaces, links) if count < _ENOUGH else enough
    return enough


def _most(surfaces: BoundingSurfaces) -> int:
    """Discs, with those of fluid, beyond which there is no end of them."""
    return _MANY * surfaces.discs + _FEW


def _without_wide(surfaces: BoundingSurfaces, wide: Wide, most: int) -> tuple[BoundingSurfaces, Links]:
    """With fluid discs until no pore is wide: the last round finds no more. Raises NoPoresError."""
    for _ in range(_ROUNDS):
        more, links = _filled(surfaces, wide, most)
        if more is surfaces:
            return surfaces, links
        surfaces = more
        if surfaces.discs > most:
            break
    raise NoPoresError("there is no end of circles of fluid between the bodies")


def _filled(surfaces: BoundingSurfaces, wide: Wide, most: int) -> tuple[BoundingSurfaces, Links]:
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
        if surfaces.discs > most:
            break
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
    # Circles as large but for rounding, as symmetry leaves them, go by their numbers.
    size = np.round(radius[wanted] / radius[wanted].max(initial=0.0), _ALIKE)
    wanted = wanted[np.argsort(-size, kind="stable")]
    pores, radius = separate(
        surfaces.shapes(), links, wanted, np.column_stack([circles.centre, radius, least])
    )
    if len(pores) == 0:
        return surfaces, links, circles
    surfaces = surfaces.with_fluid(circles.centre[pores], wide.share * radius)
    links, kept = with_more_discs(surfaces, links, pores)
    return surfaces, links, renewed(surfaces.shapes(), links, circles, kept)


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
