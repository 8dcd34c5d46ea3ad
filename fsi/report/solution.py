"""What the commands show of a solved flow at one instant: a JSON object, or tables.

Here, unlike in the arrays, a force is the one that the FLUID exerts on the body, `-F`.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table
from rich.text import Text

from fsi.arrays import Array
from fsi.bodies.gaps import find_gaps
from fsi.bodies.opened import lubricating, way_out
from fsi.case.case import Case
from fsi.integration.errors import ErrorEstimate, StressErrors
from fsi.integration.state import Measured
from fsi.observables.bulk_stress import BulkStress
from fsi.observables.solved_flow import SolvedFlow
from fsi.report.case import components
from fsi.report.console import checks_table, print_mesh_instead, table
from fsi.report.gaps import gaps_json, print_gaps

# Changes of the results in a container of half the radius, where there is one.
type Truncation = Mapping[str, float] | None


def solution_json(
    case: Case, solution: SolvedFlow, errors: ErrorEstimate, truncated: Truncation
) -> dict[str, Any]:
    """The object that `fsi solve --json` prints; `truncation` is there where it could be measured."""
    d = case.dimension
    bodies = bodies_json(case, solution.U, solution.F)
    for body, U, F in zip(bodies, errors.U, errors.F, strict=True):
        body |= {"velocity_error": U[:d].tolist(), "angular_velocity_error": turning(U[d:])}
        body |= {"force_error": F[:d].tolist(), "torque_error": turning(F[d:])}
    data: dict[str, Any] = {
        "name": case.name,
        "bodies": bodies,
        **_dissipation_json(solution, errors),
        "checks": {name: float(value) for name, value in solution.checks.items()},
        "discretisation": case.discretisation.model_dump(exclude_none=True),
        "dofs": int(solution.dofs),
        "cells": int(solution.cells),
        "solver": _solver(solution),
        "seconds": float(sum(solution.seconds.values())),
        "seconds_by_phase": {phase: float(spent) for phase, spent in solution.seconds.items()},
    }
    if solution.slip_dissipation is not None:
        data["slip_dissipation"] = float(solution.slip_dissipation)
    if solution.law_dissipation is not None:
        data["law_dissipation"] = float(solution.law_dissipation)
    if case.configuration().shaped:
        data["gaps"] = gaps_json(case)
    data |= driven_json(solution, errors)
    if solution.mesh_instead:
        data["mesh_instead"] = solution.mesh_instead
    if solution.bulk is not None and errors.stress is not None:
        _add_stress(data, solution.bulk, errors, errors.stress)
    return data if truncated is None else data | {"truncation": dict(truncated)}


def driven_json(found: Measured, errors: Measured) -> dict[str, Any]:
    """What a stress drives and a flux needs, with their estimated errors."""
    data: dict[str, Any] = {}
    if found.wall_speeds:
        data |= {"wall_speeds": dict(found.wall_speeds), "wall_speed_errors": dict(errors.wall_speeds)}
    if found.shear_rate is not None:
        data |= {"shear_rate": found.shear_rate, "shear_rate_error": errors.shear_rate}
    if found.dp_dx is not None:
        data |= {"pressure_gradient": found.dp_dx, "pressure_gradient_error": errors.dp_dx}
    if found.flux is not None:
        data |= {"flux": found.flux, "flux_error": errors.flux}
    return data


def driven_lines(found: Measured, errors: Measured) -> Iterator[str]:
    """The same for a reader."""
    for wall, speed in found.wall_speeds.items():
        error = errors.wall_speeds[wall]
        yield f"{wall} slides at {speed:z.8g} ± {error:.0e} along x, as its stress drives it"
    if found.shear_rate is not None:
        rate = f"{found.shear_rate:z.8g} ± {errors.shear_rate:.0e}"
        yield f"the cell is sheared at the rate {rate}, as its stress drives it"
    if found.dp_dx is not None:
        yield f"the mean dp/dx is {found.dp_dx:z.8g} ± {errors.dp_dx:.0e}, as the net flux needs it"
    if found.flux is not None:
        yield f"the net flux along x is {found.flux:z.8g} ± {errors.flux:.0e}, of fluid and bodies"


def _dissipation_json(solution: SolvedFlow, errors: ErrorEstimate) -> dict[str, Any]:
    """JSON has no infinite numbers: null, and the reason."""
    if solution.jumps:
        return {"dissipation": None, "dissipation_error": None, "dissipation_infinite": _why(solution)}
    return {"dissipation": float(solution.dissipation), "dissipation_error": float(errors.dissipation)}


def _why(solution: SolvedFlow) -> str:
    pairs = ", ".join(f"{one} and {other}" for one, other in solution.jumps)
    return f"the velocity jumps where walls meet: {pairs}"


def bodies_json(case: Case, U: Array, F: Array) -> list[dict[str, Any]]:
    """Each body with its velocity and the force that the fluid exerts on it, -F; U, F: (N, modes)."""
    d, bodies = case.dimension, []
    exerted = -F + 0.0  # no -0.0
    for name, x, V, load in zip(case.names, case.configuration().centres, U, exerted, strict=True):
        body = {"name": name, "position": x.tolist()}
        body |= {"velocity": V[:d].tolist(), "angular_velocity": turning(V[d:])}
        bodies.append(body | {"force": load[:d].tolist(), "torque": turning(load[d:])})
    return bodies


def _laws_line(case: Case, dissipation: float) -> str:
    """Which gaps the mesh has wider than they are, and what the laws there dissipate."""
    below, q, container = case.lubrication.below, case.configuration(), case.container()
    assert below is not None  # with whom there are laws
    gaps = find_gaps(q, container, below)
    solid = tuple(case.wall_velocity(0.0))
    walls = lubricating(container, solid)
    opened = int((gaps.pair_gaps < below).sum() + (gaps.wall_gaps[:, walls] < below).sum())
    meshed = f"gaps below {below:g}, meshed at least as wide as that: {opened}"
    said = f"{meshed}; {dissipation:.6g} of the dissipation is that of laws there"
    if case.geometry != "planar" or (widest := way_out(q, container, below, solid)) == below:
        return said
    return f"{said}; no law knows the pressure of fluid that gaps of {widest:.3g} or less shut in"


def _solver(solution: SolvedFlow) -> str:
    return f"GMRES with {solution.iterations} iterations" if solution.iterations else "direct solver"


def _add_stress(data: dict[str, Any], bulk: BulkStress, errors: ErrorEstimate, bars: StressErrors) -> None:
    if bulk.apparent_viscosity is not None:
        data["apparent_viscosity"] = bulk.apparent_viscosity
        data["apparent_viscosity_error"] = errors.apparent_viscosity
    data["mean_stress"] = bulk.mean.tolist()
    data["mean_stress_of_fluid"] = bulk.fluid.tolist()
    data["mean_stress_of_forces"] = bulk.forces.tolist()
    data["mean_stress_error"] = bars.mean.tolist()
    data["mean_stress_of_fluid_error"] = bars.fluid.tolist()
    data["normal_stress_difference"] = bulk.normal_stress_difference
    data["normal_stress_difference_error"] = bars.normal_stress_difference
    if bulk.second_difference is not None:
        data["second_normal_stress_difference"] = bulk.second_difference
        data["second_normal_stress_difference_error"] = bars.differences["N_2"]
    for body, S, error in zip(data["bodies"], bulk.stresslets, bars.stresslets, strict=True):
        body |= {"stresslet": S.tolist(), "stresslet_error": error.tolist()}


def turning(components: Array) -> float | list[float]:
    """A number in the plane, a list of three in space."""
    return float(components[0]) if len(components) == 1 else components.tolist()


def print_solution(
    console: Console, case: Case, solution: SolvedFlow, errors: ErrorEstimate, truncated: Truncation
) -> None:
    """The same for a reader: a table of the bodies, then one of the checks."""
    console.print(_bodies_table(case, solution, errors))
    if case.configuration().shaped:
        print_gaps(console, case)
    if solution.bulk is not None and errors.stress is not None:
        console.print(_stress_table(solution.bulk, errors, errors.stress))
    console.print(checks_table("check, relative", solution.checks | truncation_checks(truncated)))
    if solution.law_dissipation is not None:
        console.print(_laws_line(case, solution.law_dissipation), highlight=False)
    for line in driven_lines(solution, errors):
        console.print(line, highlight=False)
    console.print(_cost(case, solution, errors))
    print_mesh_instead(console, solution.mesh_instead)


def truncation_checks(truncated: Truncation) -> dict[str, float]:
    """The changes of the results in a container of half the radius, as rows of checks."""
    changes = (truncated or {}).items()
    return {f"truncation: change of {name} when the radius is halved": value for name, value in changes}


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


def _bodies_table(case: Case, solution: SolvedFlow, errors: ErrorEstimate) -> Table:
    """Velocities and forces; an error only where the number is a result."""
    held = case.motion(0.0).held

    def numbers(i: int, k: int) -> tuple[str, ...]:
        of_U = "" if held[i, k] else f"{errors.U[i, k]:.0e}"
        of_F = f"{errors.F[i, k]:.0e}" if held[i, k] else ""
        V, *forces = (f"{x[i, k]:.8g}" for x in (solution.U, 0.0 - solution.F, 0.0 - solution.traction_F))
        return V, of_U, forces[0], of_F, forces[1]

    planar = case.geometry == "planar"
    caption = "forces and torques per unit length, rotation counterclockwise" if planar else ""
    headings = ("velocity", "±", "force of the fluid", "±", "by its traction")
    return bodies_table(case, headings, numbers, caption)


def _stress_table(bulk: BulkStress, errors: ErrorEstimate, bars: StressErrors) -> Table:
    mu, error = bulk.apparent_viscosity, errors.apparent_viscosity
    viscosity = "" if mu is None else f"apparent viscosity {mu:.8g} ± {error:.0e}, "
    parts = {
        "fluid": (bulk.fluid, bars.fluid),
        "stresslets of the bodies": (
            bulk.mean - bulk.fluid - bulk.forces,
            bars.stresslets.sum(axis=0) / bulk.volume,
        ),
    }
    if bulk.forces.any():
        parts["forces between bodies"] = bulk.forces, np.zeros_like(bulk.forces)
    parts["together"] = bulk.mean, bars.mean
    upper = np.triu_indices(len(bulk.mean))
    rows = []
    for name, (part, bar) in parts.items():
        numbers = zip(part[upper], bar[upper], strict=True)
        rows.append((name, *(text for x, error in numbers for text in (f"{x:.8g}", f"{error:.0e}"))))
    differences = bulk.differences.items()
    between = ", ".join(f"{name} = {N:.8g} ± {bars.differences[name]:.0e}" for name, N in differences)
    caption = f"{viscosity}{between}; the mean pressure of the fluid, less G.x, is zero"
    names = ("xyz"[i] + "xyz"[j] for i, j in zip(*upper, strict=True))
    headings = tuple(heading for name in names for heading in (name, "±"))
    return table(("stress, mean over fluid and bodies",), headings, rows, caption=caption)


def _cost(case: Case, solution: SolvedFlow, errors: ErrorEstimate) -> Text:
    phases = ", ".join(f"{phase} {spent:.2f}" for phase, spent in solution.seconds.items())
    mesh, dissipation = case.discretisation, f"{solution.dissipation:.8g} ± {errors.dissipation:.0e}"
    if solution.jumps:
        dissipation = f"infinite ({_why(solution)})"
    if solution.slip_dissipation is not None:
        dissipation += f" in the fluid, {solution.slip_dissipation:.8g} by friction on what it slides along"
    return Text(
        f"degree {mesh.degree}, cells_per_gap {mesh.cells_per_gap:.4g}, "
        f"cells_per_circle {mesh.cells_per_circle}, growth {mesh.growth:.4g}; "
        f"dissipation {dissipation}; {solution.cells} cells, {solution.dofs} unknowns, "
        f"{_solver(solution)}, {sum(solution.seconds.values()):.2f} CPU s ({phases})"
    )
