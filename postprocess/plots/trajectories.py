"""Paths of bodies in the plane, or of one as another sees it; and of matter on a line over time."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from fsi.arrays import Array
from fsi.errors import InputError
from fsi.meshes.geometry.lattice import Lattice
from fsi.postprocess.plots.figure import COLOURS, GREY, LIGHT, Theme, plain_labels, plain_title, saved_figure
from fsi.postprocess.run.run import Run

_SINGLY = len(COLOURS)  # of more bodies all paths have one colour
_ACROSS = {2: ("x", "y"), 3: ("x", "z")}
_ROUNDING = 1e-9  # of the scale of a profile
RARE = 0.05  # of the largest density: less is vacuum, where nothing moves or remembers
# Columns of profiles.csv, what they are, and their colours: perceptual, on both sides of zero for u.
PROFILES = {
    "rho": (r"density $\rho$", "viridis"),
    "u": ("velocity u", "PuOr_r"),
    "gamma": (r"memory $\gamma$", "cividis"),
}


def paths(run: Run) -> Array:
    """Where the bodies were at all steps, (steps, N, 2): x and y, in space x and z. Raises InputError."""
    case = run.case
    if not case.names:
        what = f"{run.path}: the run has no bodies, and so no trajectories"
        raise InputError(f"{what}; drop --paths or --relative")
    if case.axisymmetric:
        raise InputError(f"{run.path}: bodies stay on the axis; give --curves y")
    columns = list(_ACROSS[case.dimension])
    return np.asarray(run.bodies[columns], dtype=float).reshape(-1, len(case.names), 2)


def relative_path(run: Run, pair: str) -> Array:
    """The path of one body as seen from another, "second,first", (steps, 2).

    Across the ends of a period the body is followed, not its nearest image. Raises InputError.
    """
    found = [word.strip() for word in pair.split(",")]
    if len(found) != 2 or not {*found} <= {*run.case.names} or found[0] == found[1]:
        raise InputError(f"--relative {pair}: give the names of two bodies of {', '.join(run.case.names)}")
    i, j = (run.case.names.index(name) for name in found)
    x = paths(run)
    apart = x[:, i] - x[:, j]
    periods = run.case.container().periods
    if run.case.dimension == 2 and len(periods):
        lattice = Lattice(periods)
        apart = apart - lattice.shift(lattice.nearest(apart[:1]))
    return np.asarray(apart)


def plot_paths(run: Run, output: Path, relative: str | None = None, theme: Theme = LIGHT) -> None:
    """Draw the paths, with the bodies where they began and ended. Raises InputError."""
    names, radii = run.case.names, run.case.configuration().radii
    if any(body.shape is not None for body in run.case.bodies):
        raise InputError("bodies: have shapes, but paths are drawn with discs; draw them by `fsi render`")
    with saved_figure(output, (7.0, 6.0), theme=theme) as figure:
        axes = figure.add_subplot(aspect="equal", adjustable="datalim", title=plain_title(run.case.name))
        if relative is not None:
            x = relative_path(run, relative)
            seen, centre = (word.strip() for word in relative.split(","))
            axes.add_patch(Circle((0.0, 0.0), float(radii[names.index(centre)]), color=GREY, alpha=0.5, lw=0))
            axes.plot(*x.T, color=COLOURS[0], label=",\nseen from ".join(plain_labels([seen, centre])))
            axes.plot(*x[0], "o", color=COLOURS[0], mfc="none")
            axes.legend()
        else:
            _draw_paths(axes, names, paths(run), radii)
        horizontal, vertical = _ACROSS[run.case.dimension]
        axes.set(xlabel=horizontal, ylabel=vertical)


def _draw_paths(axes: Axes, names: tuple[str, ...], x: Array, radii: Array) -> None:
    """Of all bodies: few have colours and names; outlines are pale at the start."""
    few = len(names) <= _SINGLY
    labels = plain_labels(names) if few else [None] * len(names)
    for k, label in enumerate(labels):
        colour = COLOURS[k] if few else COLOURS[0]
        axes.plot(*x[:, k].T, color=colour, lw=1.5 if few else 0.7, label=label)
        for at, alpha in ((0, 0.25), (-1, 0.8)):
            style = {"fill": False, "color": colour, "lw": 1.0, "alpha": alpha}
            axes.add_patch(Circle((float(x[at, k, 0]), float(x[at, k, 1])), float(radii[k]), **style))
    if few:
        axes.legend()
    axes.autoscale_view()


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
    there = grids["rho"] > RARE * grids["rho"].max()
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
