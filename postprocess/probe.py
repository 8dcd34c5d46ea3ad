"""Values of the flow at any point, exact: those of the finite element itself, not read off a drawing.

The field files hold the nodes of the element and its values there, so that its polynomials are known; in a
curved cell the point is found by Newton's method (`meshes.lagrange`). Vorticity and strain rate jump from
cell to cell; at a point they are those of the cell that holds it.
"""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from fsi.bodies import Array
from fsi.checkpoint import replace
from fsi.errors import InputError
from fsi.kinematics import hoop_rate, strain_rate, vorticity
from meshes.lagrange import gradient, locate, order_of, tabulate
from postprocess.run import Run

FLUID = "fluid"
OUTSIDE = "outside"
# Curved sides follow circles to 1e-5 radii or better: a point that is on a body to rounding counts as fluid.
_TOLERANCE = 1e-4


def probe(run: Run, points: Array, step: int | None = None) -> pd.DataFrame:
    """Velocity, pressure, vorticity and strain rate at points (n, 2), a row for each, at a step.

    Columns x, y (with an axis r, z), `where` ("fluid", the name of the body that holds the point, or
    "outside"), u_x, u_y (u_r, u_z), p, vorticity, strain_rate; NaN where there is no fluid. For their signs
    see `fsi.kinematics`. A point up to 1e-4 of a cell beyond the fluid's boundary counts as on it.

    Raises:
        InputError: the run has no fields of that step.
    """
    run.require_plane("probe")
    step = run.step(step)
    fluid = run.mesh(step)
    nodes = fluid.cell_connectivity.reshape(fluid.n_cells, -1)
    x, u = fluid.points[nodes][..., :2], fluid["velocity"][nodes][..., :2]
    points = np.asarray(points, dtype=float)
    cell, X = locate(x, points, _TOLERANCE)
    inside = cell >= 0
    x, u, p = x[cell[inside]], u[cell[inside]], fluid["pressure"][nodes[cell[inside]]]
    phi, dphi = tabulate(order_of(nodes.shape[1]), X[inside])
    G = gradient(x, u, dphi)
    velocity = np.einsum("pn,pnc->pc", phi, u)
    axisymmetric = run.case.axisymmetric
    hoop = hoop_rate(points[inside, 0], velocity[:, 0], G) if axisymmetric else 0.0
    first, second = "rz" if axisymmetric else "xy"
    values = {
        f"u_{first}": velocity[:, 0],
        f"u_{second}": velocity[:, 1],
        "p": np.einsum("pn,pn->p", phi, p),
        "vorticity": vorticity(G),
        "strain_rate": strain_rate(G, hoop),
    }
    table = pd.DataFrame({first: points[:, 0], second: points[:, 1], "where": _places(run, points, step)})
    table.loc[inside, "where"] = FLUID
    for name, known in values.items():
        table[name] = np.nan
        table.loc[inside, name] = known
    return table


def _places(run: Run, points: Array, step: int) -> list[str]:
    """The body that holds each point, or "outside"."""
    q = run.configuration(step)
    places = np.full(len(points), OUTSIDE, dtype=object)
    for name, centre, radius in zip(run.case.names, q.centres, q.radii, strict=True):
        places[np.hypot(*(points - centre).T) <= radius * (1.0 + _TOLERANCE)] = name
    return [str(place) for place in places]


def on_line(start: Sequence[float], end: Sequence[float], count: int) -> Array:
    """Evenly spaced points from start to end, (count, 2)."""
    return np.linspace(start, end, count)


def on_plane(corner: Sequence[float], opposite: Sequence[float], count: int) -> Array:
    """A grid of count x count points on the rectangle between two corners, row by row, (count^2, 2)."""
    x, y = (np.linspace(corner[k], opposite[k], count) for k in range(2))
    grid: Array = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    return grid


def read_points(path: Path) -> Array:
    """The first two columns of a CSV file, with or without a heading, (n, 2). Raises InputError."""
    try:
        frame = pd.read_csv(path, header=None, comment="#", skipinitialspace=True).iloc[:, :2]
        numbers = frame.apply(pd.to_numeric, errors="coerce").to_numpy(dtype=float)
    except (OSError, ValueError) as error:
        raise InputError(f"points = {path}: cannot be read ({error}); give a CSV file of x,y") from None
    if len(numbers) and np.isnan(numbers[0]).all():
        numbers = numbers[1:]
    if numbers.shape[1:] != (2,) or not len(numbers) or not np.isfinite(numbers).all():
        raise InputError(f"points = {path}: has lines without two numbers; give a CSV file of x,y")
    return np.asarray(numbers)


def write_values(table: pd.DataFrame, output: Path) -> None:
    """Write a table as CSV, with all digits. Raises InputError."""
    text = io.StringIO()
    table.to_csv(text, index=False)
    try:
        replace(output, text.getvalue().encode())
    except OSError as error:
        raise InputError(f"output = {output}: {error.strerror}; give another path") from None
