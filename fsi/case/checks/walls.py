"""Walls as a domain names them and its container shapes them: those of one's own domains may not agree."""

import numpy as np

from fsi.case.case import Case
from fsi.case.section import toml_text
from fsi.errors import InputError
from fsi.meshes.geometry.curves import WallCurve

FOLLOWED = 1e-9  # of its length: so far a piece of a wall may be off what it follows


def check_walls(case: Case) -> None:
    """Raise InputError, which names the shape, where walls have other names or shapes than are told."""
    container, here = case.container(), f"domain.shape = {toml_text(case.domain.shape)}"
    if container.walls != tuple(case.domain.walls):
        raise InputError(
            f"{here}: its container has the walls {', '.join(container.walls) or 'none'}, its wall_names "
            f"{', '.join(case.domain.walls) or 'none'}; a key that decides the walls must stand in a base "
            "class, so that it is known before them (docs/layout.md)"
        )
    if container.dimension == 3 or not (case.level.meshed and container.walls) or case.domain.mesh:
        return
    for curve in container.outline():
        if not _off(curve) <= FOLLOWED * (curve.interval[1] - curve.interval[0]):
            raise InputError(
                f"{here}: a piece of its wall {container.walls[curve.wall]!r} {_fault(curve)}, and would "
                "be meshed as a polygon; give its WallCurve the centre of its circle, or the solid it follows"
            )


def _fault(curve: WallCurve) -> str:
    if curve.centre is not None:
        return "is no arc around its centre"
    return "is curved" if curve.solid is None else "is off the outline of its solid"


def _off(curve: WallCurve) -> float:
    """How far the piece is from what its nodes shall follow: a chord, a circle or an outline."""
    s = curve.samples
    x, (start, end) = curve.at(s), curve.ends
    if curve.centre is not None:
        return float(np.ptp(np.hypot(*(x - curve.centre).T)))
    if curve.solid is not None:
        return float(np.abs(curve.solid.signed_distance(x)[0]).max())
    fraction = (s - s[0]) / (s[-1] - s[0])
    return float(np.hypot(*(x - start - fraction[:, None] * (end - start)).T).max())
