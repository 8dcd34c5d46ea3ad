"""What a case must satisfy to be run with the gluey model."""

import numpy as np

from fsi.bodies.gaps import find_gaps
from fsi.case.case import Case
from fsi.case.checks.without_flow import ROUNDING, check_estimates, check_rest
from fsi.case.section import refusal, toml_text
from fsi.errors import InputError


def check_gluey(case: Case) -> None:
    """Raise InputError, one line with key, value and remedy, for the first thing that cannot be."""
    if not case.bodies:
        raise InputError("bodies: missing; give [[bodies]], [[grids]] or bodies_from")
    check_estimates(case)
    check_rest(case)
    _check_walls(case)
    _check_names(case)
    for k, force in enumerate(case.forces):
        force.require_contact(f"forces.{k}")
    _check_contacts(case)


def _check_walls(case: Case) -> None:
    """Walls are plane, and the lattice stands along the axes, several bodies wide."""
    container, largest = case.container(), case.configuration().radii.max()
    for name, plane in zip(container.walls, container.plane, strict=True):
        # A gap in a round wall is concave, so that a step, which keeps its linearisation, would overlap.
        if not plane and name not in container.far_walls:
            raise InputError(
                f"domain.shape = {toml_text(case.domain.shape)}: the gluey model knows no contact with the "
                'round wall; give "box", "half-plane" or "unbounded"'
            )
    periods = container.periods
    if np.count_nonzero(periods) > len(periods):
        raise refusal(
            "domain", case.domain, "the gluey model wants periods along the axes; give such vectors"
        )
    if np.any(periods) and (shortest := periods[periods != 0.0].min()) < 8.0 * largest:
        raise InputError(
            f"domain: a period of {shortest:g} is below four diameters, {8.0 * largest:g}, and a step sees "
            "the nearest image of a body alone; widen it"
        )


def _check_names(case: Case) -> None:
    sides = {f"wall {name}" for name in (*case.domain.walls, *(wall.name for wall in case.gluey.walls))}
    for i, name in enumerate(case.names):
        if name in sides:
            raise refusal(f"bodies.{i}.name", name, "contacts.csv calls a wall so; give another one")
    taken = {*case.domain.walls, *case.names}
    for i, wall in enumerate(case.gluey.walls):
        if wall.name in taken:
            raise refusal(
                f"gluey.walls.{i}.name", wall.name, "a wall or body has this name; give another one"
            )
        taken.add(wall.name)


def _check_contacts(case: Case) -> None:
    """Bodies and walls touch at most, and films have gaps."""
    q, container, bodies = case.configuration(), case.container(), case.names
    gaps = find_gaps(q, container, reach=0.0)
    between_bodies = zip(gaps.pairs, gaps.pair_gaps, strict=True)
    touching = [(gap, f"{bodies[i]} and {bodies[j]}") for (i, j), gap in between_bodies]
    of_planes = [(q.centres - np.array(wall.point)) @ wall.unit_normal - q.radii for wall in case.gluey.walls]
    to_walls = np.column_stack([container.distances(q.centres) - q.radii[:, None], *of_planes])
    names = [*container.walls, *(wall.name for wall in case.gluey.walls)]
    overlaps = np.argwhere(to_walls <= 0.0)
    touching += [(to_walls[i, w], f"{bodies[i]} and wall {names[w]}") for i, w in overlaps]
    if not touching:
        return
    deepest, between = min(touching)
    if deepest < -ROUNDING * q.radii.min():
        raise InputError(f"bodies: {between} overlap by {-deepest:.3g}; move them apart")
    if case.gluey.variant == "film":
        raise InputError(
            f'bodies: {between} touch, where gluey.variant = "film" needs a gap; move them apart or give '
            '"shifted"'
        )
