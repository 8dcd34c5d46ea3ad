"""What the commands show: one instant as a JSON object or as tables, and the summary of a case.

Here, unlike in the arrays, a force is the one that the FLUID exerts on the body, `-F`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table
from rich.text import Text

from fsi.bodies.configuration import Array
from fsi.case.case import Case
from fsi.case.section import toml_text
from fsi.meshes.geometry.lattice import Lattice
from fsi.observables.bulk_stress import BulkStress
from fsi.observables.error_estimate import ErrorEstimate
from fsi.observables.truncation import Solution
from fsi.reduced.model import ReducedInstant
from fsi.report.console import checks_table, table


def components(case: Case) -> tuple[str, ...]:
    """What the modes are called."""
    if case.dimension == 3:
        return ("x", "y", "z", "rotation x", "rotation y", "rotation z")
    return ("r", "z", "rotation") if case.axisymmetric else ("x", "y", "rotation")


def solution_json(
    case: Case, solution: Solution, errors: ErrorEstimate, truncated: Mapping[str, float] | None
) -> dict[str, Any]:
    """The object that `fsi solve --json` prints; `truncation` is there where it could be measured."""
    d = case.dimension
    bodies = [
        body
        | {
            "velocity_error": errors.U[i, :d].tolist(),
            "angular_velocity_error": turning(errors.U[i, d:]),
            "force_error": errors.F[i, :d].tolist(),
            "torque_error": turning(errors.F[i, d:]),
        }
        for i, body in enumerate(bodies_json(case, solution.U, solution.F))
    ]
    data: dict[str, Any] = {
        "name": case.name,
        "bodies": bodies,
        "dissipation": float(solution.dissipation),
        "checks": {name: float(value) for name, value in solution.checks.items()},
        "discretisation": case.discretisation.model_dump(exclude_none=True),
        "dofs": int(solution.dofs),
        "cells": int(solution.cells),
        "solver": _solver(solution),
        "seconds": float(sum(solution.seconds.values())),
        "seconds_by_phase": {phase: float(spent) for phase, spent in solution.seconds.items()},
    }
    if solution.bulk is not None:
        _add_stress(data, solution.bulk, errors)
    return data if truncated is None else data | {"truncation": dict(truncated)}


def bodies_json(case: Case, U: Array, F: Array) -> list[dict[str, Any]]:
    """Each body with its velocity and the force that the fluid exerts on it, -F; U, F: (N, modes)."""
    q, d = case.configuration(), case.dimension
    exerted = -F + 0.0  # no -0.0
    return [
        {
            "name": name,
            "position": q.centres[i].tolist(),
            "velocity": U[i, :d].tolist(),
            "angular_velocity": turning(U[i, d:]),
            "force": exerted[i, :d].tolist(),
            "torque": turning(exerted[i, d:]),
        }
        for i, name in enumerate(case.names)
    ]


def _solver(solution: Solution) -> str:
    return f"FGMRES with {solution.iterations} iterations" if solution.iterations else "direct solver"


def _add_stress(data: dict[str, Any], bulk: BulkStress, errors: ErrorEstimate) -> None:
    if bulk.apparent_viscosity is not None:
        data["apparent_viscosity"] = bulk.apparent_viscosity
        data["apparent_viscosity_error"] = errors.apparent_viscosity
    data["mean_stress"] = bulk.mean.tolist()
    data["mean_stress_of_fluid"] = bulk.fluid.tolist()
    data["mean_stress_of_forces"] = bulk.forces.tolist()
    data["normal_stress_difference"] = bulk.normal_stress_difference
    for body, stresslet in zip(data["bodies"], bulk.stresslets.tolist(), strict=True):
        body["stresslet"] = stresslet


def turning(components: Array) -> float | list[float]:
    """A number in the plane, a list of three in space."""
    return float(components[0]) if len(components) == 1 else components.tolist()


def print_solution(
    console: Console,
    case: Case,
    solution: Solution,
    errors: ErrorEstimate,
    truncated: Mapping[str, float] | None,
) -> None:
    """The same for a reader: a table of the bodies, then one of the checks."""
    console.print(
        _bodies_table(case, solution, errors),
        *([] if solution.bulk is None else [_stress_table(solution.bulk, errors)]),
        _checks_table(solution, truncated),
        _cost(case, solution),
        sep="\n",
    )


def bodies_table(
    case: Case, headings: Sequence[str], numbers: Callable[[int, int], Sequence[str]], caption: str = ""
) -> Table:
    """A row for each body i and mode k, with `numbers(i, k)` below the headings."""
    names = ("body", "component", "motion")
    shown = table(names, headings, title=case.name, title_justify="left", caption=caption)
    held, modes = case.motion(0.0).held, np.flatnonzero(case.modes).tolist()
    for i, name in enumerate(case.names):
        for k in modes:
            body = name if k == modes[0] else ""
            motion = "held" if held[i, k] else "free"
            row = (body, components(case)[k], motion, *numbers(i, k))
            shown.add_row(*row, end_section=k == modes[-1])
    return shown


def _bodies_table(case: Case, solution: Solution, errors: ErrorEstimate) -> Table:
    """Velocities and forces; an error only where the number is a result."""
    held = case.motion(0.0).held

    def numbers(i: int, k: int) -> tuple[str, ...]:
        return (
            f"{solution.U[i, k]:.8g}",
            "" if held[i, k] else f"{errors.U[i, k]:.0e}",
            f"{0.0 - solution.F[i, k]:.8g}",
            f"{errors.F[i, k]:.0e}" if held[i, k] else "",
            f"{0.0 - solution.traction_F[i, k]:.8g}",
        )

    planar = case.geometry == "planar"
    caption = "forces and torques per unit length, rotation counterclockwise" if planar else ""
    headings = ("velocity", "±", "force of the fluid", "±", "by its traction")
    return bodies_table(case, headings, numbers, caption)


def _stress_table(bulk: BulkStress, errors: ErrorEstimate) -> Table:
    mu, error = bulk.apparent_viscosity, errors.apparent_viscosity or 0.0
    viscosity = "" if mu is None else f"apparent viscosity {mu:.8g} ± {error:.0e}, "
    parts = {"fluid": bulk.fluid, "stresslets of the bodies": bulk.mean - bulk.fluid - bulk.forces}
    if bulk.forces.any():
        parts["forces between bodies"] = bulk.forces
    parts["together"] = bulk.mean
    return table(
        ("stress, mean over fluid and bodies",),
        ("xx", "xy", "yy"),
        ((name, *(f"{part[i, j]:.8g}" for i, j in ((0, 0), (0, 1), (1, 1)))) for name, part in parts.items()),
        caption=f"{viscosity}N_1 = {bulk.normal_stress_difference:.8g}; "
        "the mean pressure of the fluid is zero",
    )


def _checks_table(solution: Solution, truncated: Mapping[str, float] | None) -> Table:
    changes = (truncated or {}).items()
    halved = {f"truncation: change of {name} when the radius is halved": value for name, value in changes}
    return checks_table("check, relative", solution.checks | halved)


def _cost(case: Case, solution: Solution) -> Text:
    phases = ", ".join(f"{phase} {spent:.2f}" for phase, spent in solution.seconds.items())
    mesh = case.discretisation
    return Text(
        f"degree {mesh.degree}, cells_per_gap {mesh.cells_per_gap:.4g}, "
        f"cells_per_circle {mesh.cells_per_circle}, growth {mesh.growth:.4g}; "
        f"dissipation {solution.dissipation:.8g}; {solution.cells} cells, {solution.dofs} unknowns, "
        f"{_solver(solution)}, "
        f"{sum(solution.seconds.values()):.2f} CPU s ({phases})"
    )


def print_case(console: Console, case: Case) -> None:
    """What a case holds: bodies with their smallest gaps, what is free or held, walls."""
    console.print(_case_table(case), _walls_table(case), sep="\n")


def _walls_table(case: Case) -> Table:
    conditions = case.domain.walls.items()
    rows = ((name, "at rest" if wall.rests else toml_text(wall)) for name, wall in conditions)
    return table(("wall", "what holds there"), (), rows)


def _case_table(case: Case) -> Table:
    words = ("body", "position", "radius", "smallest gap", "to")
    modes = (components(case)[k] for k in np.flatnonzero(case.modes))
    shown = table((*words, *modes), (), title=case.name, title_justify="left")
    held = case.motion(0.0).held
    for i, body in enumerate(case.bodies):
        gap, neighbour = _nearest(case, i)
        position = ", ".join(f"{x:.6g}" for x in body.position)
        motion = ("held" if is_held else "free" for is_held in held[i, case.modes])
        shown.add_row(body.name, position, f"{body.radius:.6g}", f"{gap:.6g}", neighbour, *motion)
    return shown


def _nearest(case: Case, i: int) -> tuple[float, str]:
    """The smallest gap of body i and the name of what lies there, a body or a wall."""
    q, container = case.configuration(), case.container()
    lattice = Lattice(container.periods)
    apart = q.centres - q.centres[i]
    apart = apart - lattice.shift(lattice.nearest(apart))
    to_bodies = np.linalg.norm(apart, axis=1) - q.radii
    to_images = lattice.shift(lattice.near()[1:])
    to_bodies[i] = np.linalg.norm(to_images, axis=1).min(initial=np.inf) - q.radii[i]
    gaps = np.append(to_bodies, container.distances(q.centres[i : i + 1])) - q.radii[i]
    return float(gaps.min()), (*case.names, *container.walls)[int(gaps.argmin())]


# Of what a step records.
SHOWN = ("dissipation", "lubrication_viscosity", "momentum", "power", "balance", "residual")


def instant_json(case: Case, instant: ReducedInstant) -> dict[str, Any]:
    """The object that `fsi solve --json` prints; the force of a contact is positive where the gap opens."""
    return {
        "name": case.name,
        "bodies": bodies_json(case, instant.U, instant.F),
        "contacts": _contacts(case, instant),
        **{name: float(value) for name, value in instant.record.items()},
    }


def print_instant(console: Console, case: Case, instant: ReducedInstant) -> None:
    """The same for a reader: the bodies, their lubricated gaps, one line of numbers."""
    bodies = bodies_table(
        case,
        ("velocity", "force of the fluid"),
        lambda i, k: (f"{instant.U[i, k]:.8g}", f"{0.0 - instant.F[i, k]:.8g}"),
    )
    keys = ("gap", "rate", "force")
    gaps = table(
        ("gap between", "and"),
        ("gap", "its rate", "force"),
        ((*row["between"], *(f"{row[key]:.8g}" for key in keys)) for row in _contacts(case, instant)),
        title="lubricated gaps; forces > 0 where they open",
    )
    console.print(bodies, gaps, sep="\n")
    numbers = (f"{name} {instant.record[name]:.8g}" for name in SHOWN if name in instant.record)
    console.print("  ".join(numbers), highlight=False)


def _contacts(case: Case, instant: ReducedInstant) -> list[dict[str, Any]]:
    """Each gap within the reach of its law: its sides, D, D', lambda."""
    pairs, sides = instant.pairs, (*case.names, *case.container().walls)
    columns = zip(pairs.i, pairs.j, pairs.gap, instant.rates, instant.force, strict=True)
    return [
        {"between": [sides[i], sides[j]], "gap": float(D), "rate": float(rate), "force": float(force)}
        for i, j, D, rate, force in columns
    ]
