"""How a disc or sphere settles onto a plane under a constant normal force, against the exact law."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.table import Table

from fsi.arrays import Array
from fsi.case.case import Case
from fsi.case.section import toml_text
from fsi.errors import InputError
from fsi.levels import VISCOUS
from fsi.lubrication import exact, spheres
from fsi.postprocess.run.run import Run
from fsi.report.console import table

_ROWS = 12


@dataclass(frozen=True, slots=True)
class Settling:
    """Gap histories at the steps of a run.

    Attributes:
        time: of the steps, (steps,).
        gap: that of the run, (steps,).
        exact: that of the exact law, (steps,).
        radius: of the body.
        body: "disc" or "sphere".
    """

    time: Array
    gap: Array
    exact: Array
    radius: float
    body: str

    @property
    def difference(self) -> Array:
        """Relative difference of the gap from the exact one."""
        return self.gap / self.exact - 1.0


def read_settling(run: Run) -> Settling:
    """The computed and the exact gap history of a run. Raises InputError, as does `exact_gap`."""
    case, table = run.case, run.columns("bodies")
    exact, a = exact_gap(case, table["t"]), case.bodies[0].radius
    height = table["xyz"[case.dimension - 1]]
    return Settling(table["t"], height - a, exact, a, _kind(case))


def _kind(case: Case) -> str:
    return "sphere" if case.spheres else "disc"


def exact_gap(case: Case, t: Array) -> Array:
    """The exact gap at times t of the only body of a case, a disc or a sphere.

    Raises InputError: it is not one body in a viscous fluid above a plane under a constant normal force.
    """
    force, body = _normal_force(case), case.bodies[0]
    law = spheres.settling_gap if case.spheres else exact.settling_gap
    return law(t, body.position[-1] - body.radius, body.radius, case.fluid.viscosity, force)


def asymptotic_gap(case: Case, t: Array) -> Array:
    """What `exact_gap` tends to at late times under a force F towards the plane; infinite at t = 0.

    Disc: `(a/2) (12 pi mu a / (|F| t))^2`. Sphere: `exp(-t |F| / (6 pi mu a^2))` through the last time.

    Raises InputError: as for the exact gap, or the force points away from the plane.
    """
    force, body, mu = _normal_force(case), case.bodies[0], case.fluid.viscosity
    if force > 0.0:
        raise InputError(f"bodies.0.force = {list(body.force)}: points away from the plane; no gap closes")
    if case.spheres:
        rate = -force / (6.0 * np.pi * mu * body.radius**2)
        return np.asarray(exact_gap(case, t[-1:]) * np.exp(-rate * (t - t[-1])))
    with np.errstate(divide="ignore"):
        return np.asarray(0.5 * body.radius * (12.0 * np.pi * mu * body.radius / (-force * t)) ** 2)


def _normal_force(case: Case) -> float:
    """The constant normal force on the only body; InputError where the exact law does not apply."""
    if not case.level.viscous:
        model = f'model = "{case.model}": has no viscous fluid, in which the exact law lets bodies settle'
        raise InputError(f"{model}; give a run of {', '.join(VISCOUS[:-1])} or {VISCOUS[-1]}")
    if "plane" not in case.container().walls:
        raise InputError(f'domain.shape = "{case.domain.shape}": the exact settling law needs "half-plane"')
    if len(case.bodies) != 1:
        count = f"bodies: there are {len(case.bodies)}"
        raise InputError(f"{count}; the exact settling law is that of one {_kind(case)}")
    body = case.bodies[0]
    if body.velocity[-1] != "free":
        moves = f"bodies.0.velocity = {list(body.velocity)}"
        raise InputError(f'{moves}: a {_kind(case)} that settles has [.., "free"]')
    *sideways, force = body.force
    if not isinstance(force, float | int) or force == 0.0 or any(part != 0.0 for part in sideways):
        needed = "[0.0, 0.0, F_z]" if case.dimension == 3 else "[0.0, F_y]"
        raise InputError(f"bodies.0.force = {list(body.force)}: the exact law needs a constant {needed}")
    _require_plain_body(case)
    _require_plain_walls(case)
    return float(force)


def _require_plain_body(case: Case) -> None:
    """Raise InputError unless its force alone drives the body, to whose surface fluid sticks."""
    body = case.bodies[0]
    if body.shape is not None:
        shape = f"bodies.0.shape = {toml_text(body.shape)}"
        raise InputError(f"{shape}: the exact settling law is that of a {_kind(case)}; give a radius")
    swims = body.surface_velocity if body.swims else None
    unknown = {"mass": body.mass, "slip_length": body.slip_length, "surface_velocity": swims}
    for key, value in unknown.items():
        if value:
            raise InputError(f"bodies.0.{key} = {toml_text(value)}: the exact settling law has none; drop it")
    if case.forces:
        force = f"forces.0 = {toml_text(case.forces[0])}"
        raise InputError(f"{force}: the exact settling law has none; drop it, or add it to bodies.0.force")


def _require_plain_walls(case: Case) -> None:
    """Raise InputError unless walls are straight, rest and fluid sticks to them."""
    if case.domain.profiled:
        raise InputError("domain.profiles: the exact settling law needs straight walls; drop it")
    for name, wall in case.domain.walls.items():
        if wall.slip or not wall.rests:
            value = f"domain.walls.{name} = {toml_text(wall)}"
            raise InputError(f"{value}: the exact settling law needs walls at rest that fluid sticks to")


def chosen_rows(gap: Array) -> NDArray[np.intp]:
    """Indices of at most twelve steps, evenly spread over log(gap), first and last included."""
    wanted = np.linspace(np.log(gap[0]), np.log(gap[-1]), _ROWS)
    return np.unique(np.abs(np.log(gap)[:, None] - wanted).argmin(axis=0))


def settling_table(history: Settling) -> Table:
    """The history as a table, closed by the step of the largest difference."""
    t, gap, exact, difference = history.time, history.gap, history.exact, history.difference
    rows = [*chosen_rows(history.gap), int(np.abs(history.difference).argmax())]
    cells = [[f"{t[k]:.6g}", f"{gap[k]:.3e}", f"{exact[k]:.3e}", f"{difference[k]:+.1e}"] for k in rows]
    headings = ("t", "gap", "exact gap", "relative difference")
    caption = f"last line: the largest difference of all {len(t)} steps"
    listed = table((), headings, cells, title=f"{history.body} settling onto a plane", caption=caption)
    listed.rows[-2].end_section = True
    return listed


def settling_data(history: Settling) -> dict[str, Any]:
    """The whole history."""
    columns = {"t": history.time, "gap": history.gap, "exact_gap": history.exact}
    return {"radius": history.radius} | {name: values.tolist() for name, values in columns.items()}
