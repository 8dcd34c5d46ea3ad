"""Values of the flow at any point, exact: those of the finite element itself, not read off a drawing.

The field files hold the nodes of the element and its values there, so that its polynomials are known; in a
curved cell the point is found by Newton's method (`fsi.meshes.cells.lagrange`). Vorticity and strain rate
jump from cell to cell; at a point they are those of the cell that holds it. Pictures take the means at nodes
that the files have of them, which go on from cell to cell.
"""

import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
import pyvista as pv
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.case.arguments import require_type
from fsi.errors import InputError
from fsi.files import data_of, write_whole
from fsi.meshes.cells.lagrange import gradient, locate, order_of, tabulate
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.lattice import Lattice, positive
from fsi.observables.kinematics import hoop_rate, strain_rate, vorticity
from fsi.postprocess.run.grids import nodes
from fsi.postprocess.run.run import Run

FLUID = "fluid"
OUTSIDE = "outside"
# Curved sides follow circles to 1e-5 radii or better: a point that is on a body to rounding counts as fluid.
_TOLERANCE = 1e-4
_BRIEF = 80  # letters of a heading that is told
_RATES = ("vorticity", "strain_rate")  # what jumps from cell to cell
_SAME_PLACE = 1e-12  # of the size of the domain: a mesh has images to rounding, and neighbours in narrow gaps


def probe(run: Run, points: ArrayLike, step: int | None = None) -> pd.DataFrame:
    """Velocity, pressure, vorticity and strain rate at points (n, d), a row for each, at a step.

    Columns x, y (with an axis r, z; in space x, y, z), `where` ("fluid", the name of the body that holds the
    point, or "outside"), u_x, u_y ..., p (where there is one), vorticity (in space vorticity_x ...),
    strain_rate; NaN where there is no fluid. For their signs see `fsi.observables.kinematics`. A point up to
    1e-4 of a cell beyond the fluid's boundary counts as on it. Periodic flows have values at all images, as
    `fsi.Solution.evaluate`.

    Raises InputError: that is no run, it has no fields of that step, or those are no points.
    """
    require_type("run", run, "give fsi.open_run(PATH)", right=isinstance(run, Run))
    step = run.step(step)
    return _probed(run, given_points(points, run.case.dimension), step, means=False)


def probe_smoothly(run: Run, points: Array, step: int) -> pd.DataFrame:
    """The same at points (n, d), but vorticity and strain rate by the means at nodes that the files have.

    Where the files have none, as those of old runs, these columns are left out. Raises InputError as `probe`.
    """
    return _probed(run, points, step, means=True)


def _probed(run: Run, points: Array, step: int, *, means: bool) -> pd.DataFrame:
    """The table of both."""
    letters = letters_of(run)
    fluid, container = run.mesh(step), run.container(step)
    table = pd.DataFrame(dict(zip(letters, points.T, strict=True)) | {"where": FLUID})
    with np.errstate(over="ignore", invalid="ignore"):  # no integer tells which image is far out
        found = _located(fluid, Lattice(container.periods), points)
        inside = found.cell >= 0
        table.loc[~inside, "where"] = _places(run, points[~inside], step)
    values = _values(fluid, found.those(inside), container, letters)
    if means:
        values = {name: known for name, known in values.items() if not name.startswith(_RATES)}
        values |= _nodal_rates(fluid, found.those(inside), letters)
    for name, known in values.items():
        table[name] = np.nan
        table.loc[inside, name] = known
    return table


def letters_of(run: Run) -> str:
    """Of the coordinates of a run."""
    return "rz" if run.case.axisymmetric else "xyz"[: run.case.dimension]


def given_points(points: ArrayLike, d: int) -> Array:
    """What a user gives as points, (n, d): also one point, or none. Raises InputError."""
    try:
        x = np.asarray(points)
    except ValueError:  # rows of different lengths
        x = np.empty(0, dtype=object)
    if x.dtype.kind not in "iuf":
        raise InputError(f"points: are no numbers, or not as many of each point; give (n, {d}) numbers")
    if not x.size:
        return np.empty((0, d))
    x = np.ma.filled(np.ma.asarray(points, dtype=float), np.nan)
    if x.ndim not in (1, 2):
        raise InputError(f"points: an array of {x.ndim} dimensions; give (n, {d}) numbers")
    if x.shape[-1] != d:
        raise InputError(f"points have {x.shape[-1]} components where this geometry has {d}; give (n, {d})")
    if not np.isfinite(x).all():
        raise InputError(f"points: not all are finite; give (n, {d}) finite numbers")
    return np.atleast_2d(x)


@dataclass(frozen=True, slots=True)
class _Found:
    """Where points lie in the mesh.

    Attributes:
        cell: that holds an image of the point, -1 where none does, (n,).
        X: where in it, (n, d).
        away: the lattice vector from that image to the point, (n, d).
    """

    cell: NDArray[np.int64]
    X: Array
    away: Array

    def those(self, which: NDArray[np.bool_]) -> "_Found":
        """Some of them."""
        return _Found(self.cell[which], self.X[which], self.away[which])


def _located(fluid: pv.UnstructuredGrid, lattice: Lattice, points: Array) -> _Found:
    """Where images of points (n, d) lie in the mesh, opened along a cut that winds around bodies."""
    x = fluid.points[nodes(fluid)][..., : points.shape[1]]
    low, high = x.min(axis=(0, 1)), x.max(axis=(0, 1))
    nearest = lattice.nearest(points - 0.5 * (low + high))
    found = _Found(np.full(len(points), -1), np.full(points.shape, np.nan), np.zeros(points.shape))
    for m in lattice.near(float(np.linalg.norm(high - low))):
        missing = np.flatnonzero(found.cell < 0)
        away = lattice.shift(nearest[missing] + m)
        found.cell[missing], found.X[missing] = locate(x, points[missing] - away, _TOLERANCE)
        found.away[missing] = away
    return found


def _values(
    fluid: pv.UnstructuredGrid, found: _Found, container: Container, letters: str
) -> dict[str, Array]:
    """What is known at points in the fluid, by name.

    u(x + e) = u(x) + E e,    p(x + e) = p(x) + G.e
    """
    d, at = len(letters), nodes(fluid)[found.cell]
    x, u = fluid.points[at][..., :d], fluid["velocity"][at][..., :d]
    phi, dphi = tabulate(order_of(at.shape[1], d), found.X)
    G = gradient(x, u, dphi)
    velocity = np.einsum("pn,pnc->pc", phi, u) + container.mean_velocity(found.away)
    hoop: Array | float = 0.0
    if letters == "rz":
        hoop = hoop_rate(np.einsum("pn,pn->p", phi, x[..., 0]), velocity[:, 0], G)
    curl = vorticity(G)
    curls = {"vorticity": curl} if d == 2 else {f"vorticity_{c}": curl[:, k] for k, c in enumerate(letters)}
    values = {f"u_{c}": velocity[:, k] for k, c in enumerate(letters)}
    if "pressure" in fluid.point_data:
        rises = found.away @ mean_pressure_gradient(fluid, Lattice(container.periods))
        values["p"] = np.sum(phi * fluid["pressure"][at], axis=1) + rises
    return values | curls | {"strain_rate": strain_rate(G, hoop)}


def _nodal_rates(fluid: pv.UnstructuredGrid, found: _Found, letters: str) -> dict[str, Array]:
    """Vorticity and strain rate at points in the fluid by their values at nodes, where those are known."""
    at = nodes(fluid)[found.cell]
    phi, _ = tabulate(order_of(at.shape[1], len(letters)), found.X)
    values: dict[str, Array] = {}
    for name in (name for name in _RATES if name in fluid.point_data):
        table = np.asarray(fluid[name]).reshape(fluid.n_points, -1)
        columns = [name] if table.shape[1] == 1 else [f"{name}_{c}" for c in letters]
        values |= zip(columns, np.einsum("pn,pnc->cp", phi, table[at]), strict=True)
    return values


def mean_pressure_gradient(fluid: pv.UnstructuredGrid, lattice: Lattice) -> Array:
    """G along the periods, (d,), by the pressures on both sides of the cut; no other G is a part of G.e."""
    d = lattice.vectors.shape[1]
    if "dp_dx" in fluid.cell_data:  # between pores, where p jumps a little from pore to pore
        return np.array([fluid.cell_data["dp_dx"][0], fluid.cell_data["dp_dy"][0]])
    vertices = np.unique(nodes(fluid)[:, : d + 1])
    x, p = np.asarray(fluid.points)[vertices, :d], np.asarray(fluid["pressure"])[vertices]
    tree, every = cKDTree(x), lattice.near(fluid.length)
    shifts = lattice.shift(every[positive(every)])
    steps, rises = [np.zeros((0, d))], [np.zeros(0)]
    for e in shifts:
        distance, image = tree.query(x + e, distance_upper_bound=_SAME_PLACE * fluid.length)
        there = np.isfinite(distance)
        steps.append(np.tile(e, (int(there.sum()), 1)))
        rises.append(p[image[there]] - p[there])
    return np.asarray(np.linalg.lstsq(np.concatenate(steps), np.concatenate(rises))[0])


def _places(run: Run, points: Array, step: int) -> list[str]:
    """The body that holds each point, or "outside"."""
    q, lattice = run.meshed(step), Lattice(run.container(step).periods)
    places = [OUTSIDE] * len(points)
    home, centres, reach = lattice.wrapped(points), lattice.wrapped(q.centres), (1.0 + _TOLERANCE) * q.radii
    tree = cKDTree(home)
    for e in lattice.shift(lattice.near(float(reach.max(initial=0.0)))):
        # In squares: of far points those of distances overflow.
        for i, near in enumerate(tree.query_ball_point(centres + e, reach, p=np.inf)):
            if near:
                for k in np.array(near)[_holds(q, i, home[near] - centres[i] - e)]:
                    places[k] = run.case.names[i]
    return places


def _holds(q: Configuration, i: int, r: Array) -> NDArray[np.bool_]:
    """Which points, r from its centre, (n, d), body i holds."""
    if q.placed:
        off = q.placed[i].signed_distance(q.centres[i] + r)[0]
    elif q.standing:
        off = q.standing[i].off(q.centres[i] + r)
    else:
        off = np.linalg.norm(r, axis=1) - q.radii[i]
    return np.asarray(off <= _TOLERANCE * q.radii[i])


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


def read_points(path: Path, letters: str = "xy") -> Array:
    """Points of a CSV file, (n, d): its columns of these letters, or the first ones if it has no heading.

    Raises InputError.
    """
    remedy = f"give a CSV file of {','.join(letters)}"
    try:
        text = io.StringIO(data_of(path, "CSV", str, remedy))
        words = pd.read_csv(text, header=None, comment="#", skipinitialspace=True, dtype=str)
    except ValueError as error:
        raise InputError(f"points = {path}: cannot be read ({error}); {remedy}") from None
    numbers = words.apply(pd.to_numeric, errors="coerce").to_numpy(dtype=float)
    columns: Sequence[int] = range(len(letters))
    if len(numbers) and np.isnan(numbers[0]).all():
        heading = [str(word).strip() for word in words.iloc[0]]
        if not set(letters) <= set(heading):
            wanted, has = ",".join(letters), ",".join(heading)[:_BRIEF]
            raise InputError(f"points = {path}: the heading {has} has not all of {wanted}; {remedy}")
        columns, numbers = [heading.index(letter) for letter in letters], numbers[1:]
    numbers = numbers[:, columns] if numbers.shape[1] >= len(letters) else np.full((1, 1), np.nan)
    if not len(numbers) or not np.isfinite(numbers).all():
        raise InputError(f"points = {path}: has lines without {len(letters)} numbers; {remedy}")
    return np.asarray(numbers)


def write_values(table: pd.DataFrame, output: Path) -> None:
    """Write a table as CSV, with all digits. Raises InputError."""
    write_whole(output, table.to_csv(index=False))
