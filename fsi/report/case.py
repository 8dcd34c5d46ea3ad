"""The summary of a case: its bodies with their gaps, its walls, how it is stepped."""

import numpy as np
from rich.console import Console
from rich.table import Table

from fsi.bodies.gaps import find_gaps
from fsi.case.case import Case
from fsi.case.section import toml_text
from fsi.meshes.geometry.lattice import Lattice
from fsi.report.console import table
from fsi.report.gaps import print_gaps


def components(case: Case) -> tuple[str, ...]:
    """What the modes are called."""
    if case.dimension == 3:
        return ("x", "y", "z", "rotation x", "rotation y", "rotation z")
    return ("r", "z", "rotation") if case.axisymmetric else ("x", "y", "rotation")


def print_case(console: Console, case: Case) -> None:
    """What a case holds: bodies with their smallest gaps, what is free or held, walls, how it is stepped."""
    rows = [(name, "at rest" if wall.rests else toml_text(wall)) for name, wall in case.domain.walls.items()]
    if case.bodies:
        console.print(_case_table(case))
        if case.configuration().shaped:
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
    held = case.held()
    for i, body in enumerate(case.bodies[:_MOST]):
        gap, neighbour = _nearest(case, i)
        position = ", ".join(f"{x:.6g}" for x in body.position)
        motion = ("held" if is_held else "free" for is_held in held[i, case.modes])
        shown.add_row(body.name, position, f"{body.radius:.6g}", f"{gap:.6g}", neighbour, *motion)
    return shown


def _nearest(case: Case, i: int) -> tuple[float, str]:
    """The smallest gap of body i and the name of what lies there, a body or a wall."""
    q, container = case.configuration(), case.container()
    if q.shaped:
        found = find_gaps(q, container, np.inf)
        of_i = np.flatnonzero((found.pairs == i).any(axis=1))
        least = np.append(found.pair_gaps[of_i], found.wall_gaps[i])
        names = [case.names[j] for j in found.pairs[of_i].sum(axis=1) - i] + list(container.walls)
        return float(least.min()), names[int(least.argmin())]
    lattice = Lattice(container.periods)
    apart = q.centres - q.centres[i]
    apart = apart - lattice.shift(lattice.nearest(apart))
    to_bodies = np.linalg.norm(apart, axis=1) - q.radii
    to_images = lattice.shift(lattice.near()[1:])
    to_bodies[i] = np.linalg.norm(to_images, axis=1).min(initial=np.inf) - q.radii[i]
    gaps = np.append(to_bodies, container.distances(q.centres[i : i + 1])) - q.radii[i]
    return float(gaps.min()), (*case.names, *container.walls)[int(gaps.argmin())]
