"""How a disc settles onto a plane, against the exact law: `python -m fsi.postprocess.analysis.settling RUN`.

Prints the gap history of a run with one disc above the plane of a half-plane under a constant normal
force, and draws it into RUN/settling.png.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter
from numpy.typing import NDArray
from rich.table import Table

from fsi.bodies.configuration import Array
from fsi.case.case import Case
from fsi.case.section import toml_text
from fsi.errors import InputError
from fsi.lubrication import exact, sphere_settling
from fsi.meshes.geometry.containers import HalfPlane
from fsi.postprocess.program import program, say
from fsi.postprocess.run.run import open_run

_ROWS = 12
_COMPUTED, _EXACT, _ERROR = "#0072b2", "#999999", "#d55e00"  # Okabe and Ito: told apart by every eye


@dataclass(frozen=True, slots=True)
class Settling:
    """Gap histories at the steps of a run, shapes (steps,), and the radius of the disc."""

    time: Array
    gap: Array
    exact: Array
    radius: float

    @property
    def difference(self) -> Array:
        """Relative difference of the gap from the exact one."""
        return self.gap / self.exact - 1.0


def read_settling(run: Path) -> Settling:
    """The computed and the exact gap history of a run.

    Raises:
        InputError: not a run folder, or not one disc above a plane under a constant normal force.
    """
    found = open_run(run)
    case, table = found.case, found.columns("bodies")
    disc = case.bodies[0]
    return Settling(table["t"], table["y"] - disc.radius, exact_gap(case, table["t"]), disc.radius)


def exact_gap(case: Case, t: Array) -> Array:
    """The exact gap at times t of the only body of a case, a disc or a sphere.

    Raises:
        InputError: it is not one body above a plane under a constant normal force.
    """
    force, body = _normal_force(case), case.bodies[0]
    law = sphere_settling.settling_gap if case.axisymmetric else exact.settling_gap
    return law(t, body.position[1] - body.radius, body.radius, case.fluid.viscosity, force)


def asymptotic_gap(case: Case, t: Array) -> Array:
    """What `exact_gap` tends to at late times under a force F towards the plane; infinite at t = 0.

    Disc: `(a/2) (12 pi mu a / (|F| t))^2`. Sphere: `exp(-t |F| / (6 pi mu a^2))` through the last time.

    Raises:
        InputError: as for the exact gap, or the force points away from the plane.
    """
    force, body, mu = _normal_force(case), case.bodies[0], case.fluid.viscosity
    if force > 0.0:
        raise InputError(f"bodies.0.force = {list(body.force)}: points away from the plane; no gap closes")
    if case.axisymmetric:
        rate = -force / (6.0 * np.pi * mu * body.radius**2)
        return np.asarray(exact_gap(case, t[-1:]) * np.exp(-rate * (t - t[-1])))
    with np.errstate(divide="ignore"):
        return np.asarray(0.5 * body.radius * (12.0 * np.pi * mu * body.radius / (-force * t)) ** 2)


def _normal_force(case: Case) -> float:
    """The constant F_y on the only disc; InputError where the exact law does not apply."""
    if not isinstance(case.container(), HalfPlane):
        raise InputError('domain.shape = "box": the exact settling law needs "half-plane"')
    if len(case.bodies) != 1:
        raise InputError(f"bodies: there are {len(case.bodies)}; the exact settling law is that of one disc")
    disc = case.bodies[0]
    if disc.velocity[1] != "free":
        raise InputError(f'bodies.0.velocity = {list(disc.velocity)}: a disc that settles has [.., "free"]')
    sideways, force = disc.force
    if not isinstance(force, float | int) or force == 0.0 or sideways != 0.0:
        raise InputError(f"bodies.0.force = {list(disc.force)}: the exact law needs a constant [0.0, F_y]")
    if disc.mass is not None:
        raise InputError(f"bodies.0.mass = {disc.mass}: the exact settling law has no inertia; drop the mass")
    for name, wall in case.domain.walls.items():
        if not wall.rests:
            raise InputError(
                f"domain.walls.{name} = {toml_text(wall)}: the exact settling law needs walls at rest"
            )
    return float(force)


def chosen_rows(gap: Array) -> NDArray[np.intp]:
    """Indices of at most twelve steps, evenly spread over log(gap), first and last included."""
    wanted = np.linspace(np.log(gap[0]), np.log(gap[-1]), _ROWS)
    return np.unique(np.abs(np.log(gap)[:, None] - wanted).argmin(axis=0))


def as_table(history: Settling) -> Table:
    """The history as a table, closed by the step of the largest difference."""
    table = Table(title="disc settling onto a plane")
    for heading in ("t", "gap", "exact gap", "relative difference"):
        table.add_column(heading, justify="right")
    rows = chosen_rows(history.gap)
    worst = int(np.abs(history.difference).argmax())
    for row in (*rows, worst):
        table.add_row(
            f"{history.time[row]:.6g}",
            f"{history.gap[row]:.6e}",
            f"{history.exact[row]:.6e}",
            f"{history.difference[row]:+.1e}",
            end_section=row == rows[-1],
        )
    table.caption = f"last line: the largest difference of all {len(history.time)} steps"
    return table


def plot(history: Settling, path: Path) -> None:
    """Draw the gap, computed and exact, above the difference, into a PNG file. Raises InputError."""
    with mpl.rc_context({"font.size": 11, "axes.spines.top": False, "axes.spines.right": False}):
        figure = Figure(figsize=(7.0, 6.5), layout="constrained")
        upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[2.5, 1.0])
        _draw_gap(upper, history)
        _draw_difference(lower, history)
        for axis in (upper.xaxis, upper.yaxis, lower.xaxis, lower.yaxis):
            axis.set_minor_formatter(NullFormatter())
        try:
            figure.savefig(path, dpi=160)
        except OSError as error:
            raise InputError(f"{path}: {error.strerror}; give a run folder that can be written") from None


def _draw_gap(axes: Axes, history: Settling) -> None:
    """Gap over radius against time."""
    later = history.time > 0.0
    t = history.time[later]
    axes.loglog(t, history.exact[later] / history.radius, color=_EXACT, lw=5, alpha=0.6, label="exact")
    axes.loglog(t, history.gap[later] / history.radius, "o-", color=_COMPUTED, ms=3.5, lw=1, label="computed")
    axes.set_ylabel("gap / radius")
    axes.set_title("disc settling onto a plane under a constant force", loc="left", fontsize=12)
    axes.legend(frameon=False)
    axes.grid(which="major", alpha=0.3)


def _draw_difference(axes: Axes, history: Settling) -> None:
    """Size of the relative difference against time; open marks where the gap is too small."""
    later = (history.time > 0.0) & (history.difference != 0.0)
    t, size, low = history.time[later], np.abs(history.difference[later]), history.difference[later] < 0.0
    axes.loglog(t, size, color=_ERROR, lw=1)
    axes.loglog(t[~low], size[~low], "o", color=_ERROR, ms=3.5, label="too wide")
    axes.loglog(t[low], size[low], "o", color=_ERROR, mfc="white", ms=3.5, label="too narrow")
    axes.set_ylabel("relative difference")
    axes.set_xlabel("time")
    axes.legend(frameon=False, ncols=2)
    axes.grid(which="major", alpha=0.3)


def show(run: Path) -> None:
    """Print the table and draw the plot of one run."""
    history = read_settling(run)
    plot(history, run / "settling.png")
    say(as_table(history), f"plot: {run / 'settling.png'}")


main = partial(program, __doc__, show)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
