"""The summary of a case: its bodies with their gaps, its walls, how it is stepped."""

import numpy as np
from rich.console import Console
from rich.table import Table

from fsi.bodies.configuration import Configuration
from fsi.bodies.gaps import find_gaps
from fsi.case.case import Case
from fsi.case.section import toml_text
from fsi.case.walls import WallCondition
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.lattice import Lattice
from fsi.report.console import table


def components(case: Case) -> tuple[str, ...]:
    """What the modes are called."""
    if case.dimension == 3:
        return ("x", "y", "z", "rotation x", "rotation y", "rotation z")
    return ("r", "z", "rotation") if case.axisymmetric else ("x", "y", "rotation")


def _holds(wall: WallCondition) -> str:
    """What holds at a wall: fluid sticks to one at rest, or slides along it."""
    return "at rest" if wall.rests and not wall.slip else toml_text(wall)


def print_case(console: Console, case: Case) -> None:
    """What a case holds: bodies with their smallest gaps, what is free or held, walls, how it is stepped."""
    rows = [(name, _holds(wall)) for name, wall in case.domain.walls.items()]
    if case.bodies:
        console.print(_case_table(case))
        if case.configuration().shaped:
            from fsi.report.gaps import print_gaps

            print_gaps(console, case)
    if len(case.bodies) > _MOST:
        console.print(f"... {len(case.bodies) - _MOST} more bodies")
    if rows:
        console.print(table(("wall", "what holds there"), (), rows))
    console.print(_level(case), highlight=False)


_MOST = 60  # bodies that are listed


def _level(case: Case) -> str:
    """The level of a case, and how far and by which steps it goes."""
    matter = f", {case.macroscopic.parcels} parcels" if case.model == "macroscopic" else ""
    if case.time is None:
        return f"{case.model}{matter}, one instant"
    steps = f"by steps of {case.time.step:g}" if case.time.step is not None else ""
    if case.level.viscous:
        steps = f"{steps if case.scheme.fixed else ''} by the scheme {case.scheme.name}".strip()
    return f"{case.model}{matter}, to t = {case.time.end:g} {steps}"


def _case_table(case: Case) -> Table:
    words = ("body", "position", "radius", "smallest gap", "to")
    modes = (components(case)[k] for k in np.flatnonzero(case.modes))
    shown = table((*words, *modes), (), title=case.name, title_justify="left")
    held, q, container = case.held(), case.configuration(), case.container()
    for i, body in enumerate(case.bodies[:_MOST]):
        gap, k = _nearest(q, container, i)
        neighbour = (*case.names, *container.walls)[k]
        position = ", ".join(f"{x:.6g}" for x in body.position)
        motion = ("held" if is_held else "free" for is_held in held[i, case.modes])
        shown.add_row(body.name, position, f"{body.radius:.6g}", f"{gap:.6g}", neighbour, *motion)
    return shown


def _nearest(q: Configuration, container: Container, i: int) -> tuple[float, int]:
    """The smallest gap of body i, and what lies there: its place in the bodies followed by the walls."""
    if q.shaped:
        reach = 2.0 * float(q.radii.max())
        nearest = _nearest_within(q, container, i, reach)
        return nearest if nearest[0] <= reach else _nearest_within(q, container, i, np.inf)
    lattice = Lattice(container.periods)
    apart = q.centres - q.centres[i]
    apart = apart - lattice.shift(lattice.nearest(apart))
    to_bodies = np.linalg.norm(apart, axis=1) - q.radii
    to_images = lattice.shift(lattice.near()[1:])
    to_bodies[i] = np.linalg.norm(to_images, axis=1).min(initial=np.inf) - q.radii[i]
    gaps = np.append(to_bodies, container.distances(q.centres[i : i + 1])) - q.radii[i]
    return float(gaps.min()), int(gaps.argmin())


def _nearest_within(q: Configuration, container: Container, i: int, reach: float) -> tuple[float, int]:
    """The same by the outlines, of pairs up to a gap; infinite where there is none."""
    found = find_gaps(q, container, reach)
    of_i = np.flatnonzero((found.pairs == i).any(axis=1))
    sides = np.append(found.pairs[of_i].sum(axis=1) - i, len(q) + np.arange(len(container.walls)))
    gaps = np.append(found.pair_gaps[of_i], found.wall_gaps[i])
    if len(gaps) == 0:
        return np.inf, -1
    return float(gaps.min()), int(sides[gaps.argmin()])
