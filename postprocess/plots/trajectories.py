"""Paths of bodies in the plane, or of one as another sees it; and of matter on a line over time."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.errors import InputError
from fsi.meshes.geometry.lattice import Lattice
from fsi.postprocess.plots.figure import COLOURS, GREY, LIGHT, Theme, plain_labels, plain_title, saved_figure
from fsi.postprocess.run.run import Run

_SINGLY = len(COLOURS)  # of more bodies all paths have one colour
_ACROSS = {2: ("x", "y"), 3: ("x", "z")}
_POINTS = 200  # of an outline
_PALE, _DARK = 0.25, 0.8  # opacity of outlines where a path begins, and where it ends
_ROUNDING = 1e-9  # of the scale of a profile
_APART = 2.0  # times as far as both have their other neighbours: what two parcels leave is vacuum
# Columns of profiles.csv, what they are, and their colours: perceptual, on both sides of zero for u.
PROFILES = {
    "rho": (r"density $\rho$", "viridis"),
    "u": ("velocity u", "PuOr_r"),
    "gamma": (r"memory $\gamma$", "cividis"),
}


def paths(run: Run) -> Array:
    """Where the bodies were at all steps, (steps, N, 2): x and y, in space x and z. Raises InputError."""
    return _places(run)[..., [0, -1]]


def _places(run: Run) -> Array:
    """The same in all d components, (steps, N, d)."""
    case = run.case
    if not case.names:
        what = f"{run.path}: the run has no bodies, and so no trajectories"
        raise InputError(f"{what}; drop --paths or --relative")
    if case.axisymmetric:
        raise InputError(f"{run.path}: bodies stay on the axis; give --curves y")
    d = case.dimension
    return np.asarray(run.bodies[list("xyz"[:d])], dtype=float).reshape(-1, len(case.names), d)


def relative_path(run: Run, pair: str) -> Array:
    """The path of one body as seen from another, "second,first", (steps, 2).

    Of its images the one is followed that is nearest at first, as the lattice carries it. Raises InputError.
    """
    found = [word.strip() for word in pair.split(",")]
    if len(found) != 2 or not {*found} <= {*run.case.names} or found[0] == found[1]:
        raise InputError(f"--relative {pair}: give the names of two bodies of {', '.join(run.case.names)}")
    i, j = (run.case.names.index(name) for name in found)
    x, container = _places(run), run.case.container()
    apart = x[:, i] - x[:, j]
    if len(container.periods):
        lattice = Lattice(container.periods)
        away = lattice.shift(lattice.nearest(apart[:1]))
        moments = [(run.time(step), run.strain(step)) for step in run.steps["step"]]
        apart = apart - np.concatenate([container.carried(away, t, strain) for t, strain in moments])
    return apart[:, [0, -1]]


def plot_paths(run: Run, output: Path, relative: str | None = None, theme: Theme = LIGHT) -> None:
    """Draw the paths, with the bodies where they began and ended. Raises InputError."""
    names, x = run.case.names, paths(run)
    ends = [_outlines(run.configuration(int(run.steps["step"].iloc[k]))) for k in (0, -1)]
    with saved_figure(output, (7.0, 6.0), theme=theme) as figure:
        axes = figure.add_subplot(aspect="equal", adjustable="datalim", title=plain_title(run.case.name))
        if relative is not None:
            apart = relative_path(run, relative)
            seen, centre = (word.strip() for word in relative.split(","))
            axes.plot(*apart.T, color=COLOURS[0], label=",\nseen from ".join(plain_labels([seen, centre])))
            axes.plot(*apart[0], "o", color=COLOURS[0], mfc="none")
            _draw_ends(axes, apart, [outlines[names.index(seen)] for outlines in ends], COLOURS[0])
            _draw_ends(axes, 0.0 * apart, [outlines[names.index(centre)] for outlines in ends], GREY)
            axes.legend()
        else:
            _draw_paths(axes, names, x, ends)
        axes.autoscale_view()
        horizontal, vertical = _ACROSS[run.case.dimension]
        axes.set(xlabel=horizontal, ylabel=vertical)


def _outlines(q: Configuration) -> list[Array]:
    """Of each body around its centre, as it is seen, (n, 2)."""
    turn = np.linspace(0.0, 2.0 * np.pi, _POINTS, endpoint=False)
    circle = np.column_stack([np.cos(turn), np.sin(turn)])
    if q.outlines:
        return [body.drawn(_POINTS) - body.centre for body in q.placed]
    if q.ellipsoids:  # seen along y
        across = [body.axes[[0, 2]] for body in q.standing]
        return [circle @ np.linalg.cholesky(M @ M.T).T for M in across]
    return [radius * circle for radius in q.radii]


def _draw_ends(axes: Axes, x: Array, outlines: Sequence[Array], colour: str) -> None:
    """The outlines of a body where its path x (steps, 2) begins, pale, and where it ends."""
    for at, outline, alpha in zip((x[0], x[-1]), outlines, (_PALE, _DARK), strict=True):
        axes.add_patch(Polygon(at + outline, fill=False, color=colour, lw=1.0, alpha=alpha))


def _draw_paths(axes: Axes, names: tuple[str, ...], x: Array, ends: Sequence[Sequence[Array]]) -> None:
    """Of all bodies (steps, N, 2), with their outlines at both ends: few have colours and names."""
    few = len(names) <= _SINGLY
    labels = plain_labels(names) if few else [None] * len(names)
    for k, label in enumerate(labels):
        colour = COLOURS[k] if few else COLOURS[0]
        axes.plot(*x[:, k].T, color=colour, lw=1.5 if few else 0.7, label=label)
        _draw_ends(axes, x[:, k], [outlines[k] for outlines in ends], colour)
    if few:
        axes.legend()


def plot_space_time(run: Run, output: Path, theme: Theme = LIGHT) -> None:
    """Draw density, velocity and memory of a macroscopic run over x and t, none in vacuum.

    Raises InputError.
    """
    with saved_figure(output, (3.1 * len(PROFILES), 3.4), theme=theme) as figure:
        space_time_figure(run, figure)


def space_time_figure(run: Run, figure: Figure) -> Figure:
    """The figure with a panel for each. Raises InputError."""
    grids = _over_space_and_time(run)
    x, t, scales = grids["x"], grids["t"], profile_scales(run)
    empty = np.array([vacuum(row) for row in x])
    there = ~(np.pad(empty, ((0, 0), (1, 0))) | np.pad(empty, ((0, 0), (0, 1))))
    period = (t.min(), t.max()) if len(t) > 1 else None  # cells around the first and last reach further
    panels = figure.subplots(1, len(PROFILES), sharex=True, sharey=True)
    for axes, (name, (label, colours)) in zip(panels, PROFILES.items(), strict=True):
        values = np.where(there, grids[name], np.nan)
        largest = float(np.nanmax(np.abs(values))) or 1.0
        about_zero = {"rho": (0.0, largest), "u": (-largest, largest)}
        low, high = about_zero.get(name) or profile_ends(values, scales[name])
        style = {"cmap": colours, "vmin": low, "vmax": high, "shading": "nearest", "rasterized": True}
        drawn = axes.pcolormesh(x, t, values, **style)
        axes.grid(visible=False)
        axes.set(xlabel="x", title=label, ylim=period)
        figure.colorbar(drawn, ax=axes)
    panels[0].set_ylabel("t")
    return figure


def vacuum(x: Array) -> NDArray[np.bool_]:
    """Between which neighbours of parcels at x (n,) there is no matter, (n - 1,).

    Where matter is rare all neighbours are far apart, on either side of vacuum these two alone are: they have
    half their mass in it, and their density tells of its width, not of matter in it.
    """
    apart = np.diff(x)
    around = np.pad(apart, 1, mode="edge")  # two alone are matter
    empty: NDArray[np.bool_] = apart > _APART * np.maximum(around[:-2], around[2:])
    return empty


def profile_scales(run: Run) -> dict[str, float]:
    """Of each column the largest number in the run, for the memory at least the mass times that of u."""
    table = run.table("profiles")
    largest = {name: float(table[name].abs().max()) for name in ("m", "x", *PROFILES)}
    return largest | {"gamma": max(largest["gamma"], largest["m"] * largest["u"])}


def profile_ends(values: Array, scale: float, margin: float = 0.0) -> tuple[float, float]:
    """Of an axis or of colours for values, some NaN, with a margin; what differs by rounding is constant."""
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    room = margin * (high - low) if high - low > _ROUNDING * scale else 0.5 * (scale or 1.0)
    return low - room, high + room


def _over_space_and_time(run: Run) -> dict[str, Array]:
    """x, t and the profiles, a row for each step. Raises InputError: the rows are no such grid."""
    table = run.table("profiles")
    steps = table["step"].nunique()
    values = {name: table[name].to_numpy(dtype=float) for name in ("t", "x", *PROFILES)}
    if len(table) % steps == 0:
        grids = {name: column.reshape(steps, -1) for name, column in values.items()}
        if (np.diff(grids["x"], axis=1) > 0.0).all() and (np.diff(grids["t"], axis=0) > 0.0).all():
            return grids
    raise InputError(
        f"{run.path / 'profiles.csv'}: x and t do not ascend in it; it was changed: run the case again"
    )
