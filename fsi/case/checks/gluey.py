"""What a case must satisfy to be run with the gluey model: walls at rest, bodies that at most touch."""

from __future__ import annotations

import numpy as np

from fsi.bodies.gaps import find_gaps
from fsi.case.case import Case
from fsi.case.section import toml_text
from fsi.errors import InputError

# Of the smallest radius: an overlap that is rounding in a contact.
_ROUNDING = 1e-10


def check_gluey(case: Case) -> None:
    """Raise InputError, one line with key, value and remedy, for the first thing that cannot be."""
    if not case.bodies:
        raise InputError("bodies: missing; give [[bodies]], [[grids]] or bodies_from")
    _check_walls(case)
    _check_names(case)
    _check_contacts(case)


def _check_walls(case: Case) -> None:
    """Walls are at rest, and the lattice stands along the axes, several bodies wide."""
    for name, wall in case.domain.walls.items():
        if not wall.rests:
            raise InputError(
                f"domain.walls.{name} = {toml_text(wall)}: walls of the gluey model are solid and at rest; "
                "drop it"
            )
    container, largest = case.container(), case.configuration().radii.max()
    if container.mean_gradient.any() or case.domain.mean_drive() != (0.0, None):
        raise InputError(
            f"domain = {toml_text(case.domain)}: no fluid drives gluey bodies; drop shear, extension, "
            "pressure_gradient or net_flux"
        )
    periods = container.periods
    if np.count_nonzero(periods) > len(periods):
        raise InputError(
            f"domain = {toml_text(case.domain)}: the gluey model wants periods along the axes; give such "
            "vectors"
        )
    if np.any(periods) and periods[periods != 0.0].min() < 8.0 * largest:
        raise InputError(
            f"domain = {toml_text(case.domain)}: a period is below four diameters, so that bodies meet their "
            "own images; widen it"
        )


def _check_names(case: Case) -> None:
    taken = {*case.domain.walls, *case.names}
    for i, wall in enumerate(case.gluey.walls):
        if wall.name in taken:
            raise InputError(
                f"gluey.walls.{i}.name = {toml_text(wall.name)}: a wall or body has this name; give another "
                "one"
            )
        taken.add(wall.name)


def _check_contacts(case: Case) -> None:
    """Bodies and walls touch at most, and films have gaps."""
    q, container = case.configuration(), case.container()
    gaps = find_gaps(q, container, reach=0.0)
    touching = [
        (gap, f"{case.names[i]} and {case.names[j]}")
        for (i, j), gap in zip(gaps.pairs, gaps.pair_gaps, strict=True)
    ]
    of_planes = [
        (np.array(wall.normal) / np.linalg.norm(wall.normal)) @ (q.centres - np.array(wall.point)).T - q.radii
        for wall in case.gluey.walls
    ]
    to_walls = np.column_stack([container.distances(q.centres) - q.radii[:, None], *of_planes])
    names = [*container.walls, *(wall.name for wall in case.gluey.walls)]
    touching += [
        (to_walls[i, w], f"{case.names[i]} and wall {names[w]}") for i, w in np.argwhere(to_walls <= 0.0)
    ]
    if not touching:
        return
    deepest, between = min(touching)
    if deepest < -_ROUNDING * q.radii.min():
        raise InputError(f"bodies: {between} overlap by {-deepest:.3g}; move them apart")
    if case.gluey.variant == "film":
        raise InputError(
            f'bodies: {between} touch, where gluey.variant = "film" needs a gap; move them apart or give '
            '"shifted"'
        )
