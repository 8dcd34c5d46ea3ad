"""Values of the flow at any point, exact: those of the finite element itself, not read off a drawing.

The field files hold the nodes of the element and its values there, so that its polynomials are known; in a
curved cell the point is found by Newton's method (`fsi.meshes.cells.lagrange`). Vorticity and strain rate
jump from cell to cell; at a point they are those of the cell that holds it.
"""

import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd
import pyvista as pv
from numpy.typing import NDArray

from fsi.bodies.configuration import Array
from fsi.errors import InputError
from fsi.files import data_of, write_whole
from fsi.meshes.cells.lagrange import gradient, locate, order_of, tabulate
from fsi.observables.bulk_stress import hoop_rate, strain_rate, vorticity
from fsi.postprocess.run.run import Run, nodes

FLUID = "fluid"
OUTSIDE = "outside"
# Curved sides follow circles to 1e-5 radii or better: a point that is on a body to rounding counts as fluid.
_TOLERANCE = 1e-4


def probe(run: Run, points: Array, step: int | None = None) -> pd.DataFrame:
    """Velocity, pressure, vorticity and strain rate at points (n, d), a row for each, at a step.

    Columns x, y (with an axis r, z; in space x, y, z), `where` ("fluid", the name of the body that holds the
    point, or "outside"), u_x, u_y ..., p (in a model with pressure), vorticity (in space vorticity_x ...),
    strain_rate; NaN where there is no fluid. For their signs see `fsi.observables.bulk_stress`. A point up to
    1e-4 of a cell beyond the fluid's boundary counts as on it.

    Raises InputError: the run has no fields of that step.
    """
    letters = "rz" if run.case.axisymmetric else "xyz"[: run.case.dimension]
    step = run.step(step)
    points = np.asarray(points, dtype=float)
    inside, values = _values(run, run.mesh(step), points, letters)
    places = {"where": _places(run, points, step)}
    table = pd.DataFrame(dict(zip(letters, points.T, strict=True)) | places)
    table.loc[inside, "where"] = FLUID
    for name, known in values.items():
        table[name] = np.nan
        table.loc[inside, name] = known
    return table


def _values(
    run: Run, fluid: pv.UnstructuredGrid, points: Array, letters: str
) -> tuple[NDArray[np.bool_], dict[str, Array]]:
    """Which points lie in the fluid, (n,), and what is found at those, by name."""
    d, cells = len(letters), nodes(fluid)
    x, u = fluid.points[cells][..., :d], fluid["velocity"][cells][..., :d]
    cell, X = locate(x, points, _TOLERANCE)
    inside = cell >= 0
    x, u, at = x[cell[inside]], u[cell[inside]], cells[cell[inside]]
    phi, dphi = tabulate(order_of(cells.shape[1], d), X[inside])
    G = gradient(x, u, dphi)
    velocity = np.einsum("pn,pnc->pc", phi, u)
    hoop = hoop_rate(points[inside, 0], velocity[:, 0], G) if run.case.axisymmetric else 0.0
    curl = vorticity(G)
    curls = {"vorticity": curl} if d == 2 else {f"vorticity_{c}": curl[:, k] for k, c in enumerate(letters)}
    values = {f"u_{c}": velocity[:, k] for k, c in enumerate(letters)}
    if "pressure" in fluid.point_data:
        values["p"] = np.sum(phi * fluid["pressure"][at], axis=1)
    return inside, values | curls | {"strain_rate": strain_rate(G, hoop)}


def _places(run: Run, points: Array, step: int) -> list[str]:
    """The body that holds each point, or "outside"."""
    q = run.meshed(step)
    places = np.full(len(points), OUTSIDE, dtype=object)
    for name, body in zip(run.case.names, q.placed, strict=False):
        places[body.signed_distance(points)[0] <= _TOLERANCE * body.outline.radius] = name
    for name, form in zip(run.case.names, q.standing, strict=False):
        places[form.off(points) <= _TOLERANCE * form.form.radius] = name
    if q.shaped:
        return [str(place) for place in places]
    for name, centre, radius in zip(run.case.names, q.centres, (1.0 + _TOLERANCE) * q.radii, strict=True):
        near = np.flatnonzero(np.abs(points - centre).max(axis=1) <= radius)  # squares of others may overflow
        places[near[np.linalg.norm(points[near] - centre, axis=1) <= radius]] = name
    return [str(place) for place in places]


def on_plane(corner: Sequence[float], opposite: Sequence[float], count: int) -> Array:
    """A grid of count x count points on the rectangle between two corners, row by row, (count^2, d).

    Raises InputError: in space it does not lie across one of the axes.
    """
    d = len(corner)
    sides = [k for k in range(d) if d == 2 or corner[k] != opposite[k]]
    if len(sides) != 2:
        ends = ",".join(f"{c:g}" for c in (*corner, *opposite))
        raise InputError(f"--plane {ends}: give corners that share exactly one coordinate")
    x, y = (np.linspace(corner[k], opposite[k], count) for k in sides)
    points = np.tile(np.asarray(corner, dtype=float), (count * count, 1))
    points[:, sides] = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    return points


def read_points(path: Path, dimension: int = 2) -> Array:
    """The first columns of a CSV file, with or without a heading, (n, dimension). Raises InputError."""
    wanted = "x,y" if dimension == 2 else "x,y,z"
    remedy = f"give a CSV file of {wanted}"
    try:
        text = io.StringIO(data_of(path, "CSV", str, remedy))
        frame = pd.read_csv(text, header=None, comment="#", skipinitialspace=True).iloc[:, :dimension]
        numbers = frame.apply(pd.to_numeric, errors="coerce").to_numpy(dtype=float)
    except ValueError as error:
        raise InputError(f"points = {path}: cannot be read ({error}); {remedy}") from None
    if len(numbers) and np.isnan(numbers[0]).all():
        numbers = numbers[1:]
    if numbers.shape[1:] != (dimension,) or not len(numbers) or not np.isfinite(numbers).all():
        what = f"points = {path}: has lines without {dimension} numbers"
        raise InputError(f"{what}; give a CSV file of {wanted}")
    return np.asarray(numbers)


def write_values(table: pd.DataFrame, output: Path) -> None:
    """Write a table as CSV, with all digits. Raises InputError."""
    write_whole(output, table.to_csv(index=False))
