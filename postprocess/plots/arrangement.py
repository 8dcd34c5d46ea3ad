"""Draw bodies in their cell: walls thick, periodic sides dashed, their images pale, close pairs joined.

A cell given by its lattice vectors is drawn with one of each body inside, and their images around them.
"""

import itertools
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PatchCollection
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Patch, Polygon
from numpy.typing import NDArray

from fsi.arrangements.arrangement import Arrangement
from fsi.arrangements.cell import SimulationCell
from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.case.case import Case
from fsi.errors import InputError
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.curves import Sphere
from fsi.meshes.geometry.lattice import Lattice
from fsi.postprocess.plots.figure import ORANGE, saved_figure
from fsi.postprocess.run.gaps import CLOSE

_FRAME = "#222222"
_SIDES = 96  # of what stands for a body that is no disc
_LONGEST_SIDE = 8.0  # of the figure, inches


def draw_arrangement(arrangement: Arrangement, path: Path) -> None:
    """Draw into a PNG file; spheres are seen along y. Raises InputError where it cannot be written."""
    with saved_figure(path, (1.0, 1.0), font=10.0, dpi=130) as figure:
        axes = _draw_bodies(figure, arrangement)
        links = close_links(arrangement)
        axes.add_collection(LineCollection(list(links), colors=ORANGE, linewidths=1.8, zorder=3))
        axes.set_title(_title(arrangement, len(links)), loc="center", fontsize=10)
        if arrangement.cell.dimension == 3:
            _name_plane(axes)


def draw_case(figure: Figure, case: Case, q: Configuration, t: float) -> tuple[Axes, Array]:
    """Draw the bodies of a case at q and time t; gives the axes, and the centres as they are drawn.

    Raises InputError: they are neither in a box, nor in a cell, nor in a round container.
    """
    container = case.container().at(t, q.strain)
    if len(container.periods) == container.dimension:
        return _draw_lattice(figure, container, q)
    if len(container.spheres) == 1 and (around := container.spheres[0]) is not None:
        return _draw_round(figure, around, q), q.centres
    arrangement = _arrangement_of(case, q)
    return _draw_bodies(figure, arrangement), arrangement.centres


def _arrangement_of(case: Case, q: Configuration) -> Arrangement:
    """The bodies of a case at q, from the lower corner of its box. Raises InputError for other shapes."""
    box = case.domain.model_dump()
    if "lower" not in box or "upper" not in box:
        raise InputError(
            f'domain.shape = "{box["shape"]}": only bodies in a box, a cell or a round container can be drawn'
        )
    lower, sides = np.array(box["lower"]), np.subtract(box["upper"], box["lower"])
    periodic = tuple(axis in box.get("periodic", ()) for axis in "xyz"[: len(sides)])
    cell = SimulationCell(tuple(sides.tolist()), periodic)
    return Arrangement(cell, cell.wrapped(q.centres - lower), q.radii)


def _draw_bodies(figure: Figure, arrangement: Arrangement) -> Axes:
    """The bodies and their images in the frame of the cell."""
    cell = arrangement.cell
    sides = np.array([cell.sides[0], cell.sides[-1]])
    width, height = _LONGEST_SIDE * sides / sides.max()
    axes = _new_axes(figure, max(width, 2.5), max(height, 1.5))
    centres, radii = arrangement.centres[:, [0, -1]], arrangement.radii
    depth = arrangement.centres[:, 1] if cell.dimension == 3 else np.zeros(len(radii))
    order = np.argsort(-depth, kind="stable")
    rims = None if arrangement.oriented is None else arrangement.oriented.rims(_SIDES)
    _add_bodies(axes, centres[order], radii[order], rims if rims is None else rims[order])
    periods = [(-1, 0, 1) if so else (0,) for so in (cell.periodic[0], cell.periodic[-1])]
    shifts = [np.array(shift) for shift in itertools.product(*periods) if any(shift)]
    moved = np.concatenate([np.empty((0, 2)), *(centres + shift * sides for shift in shifts)])
    a = np.tile(radii, len(shifts))
    reach = a if rims is None else np.tile(np.hypot(*rims.T).max(axis=0), len(shifts))
    inside = np.all((moved > -reach[:, None]) & (moved < sides + reach[:, None]), axis=1)
    of_images = None if rims is None else np.tile(rims, (len(shifts), 1, 1))[inside]
    _add_bodies(axes, moved[inside], a[inside], of_images, image=True)
    _draw_frame(axes, cell)
    return axes


def _draw_lattice(figure: Figure, container: Container, q: Configuration) -> tuple[Axes, Array]:
    """The bodies at q (wrapped into the cell), the nearest images of all, and the cell, dashed."""
    lattice = Lattice(container.periods)
    home, (a, b) = lattice.wrapped(q.centres), container.periods
    sides = np.abs(container.periods).sum(axis=0)
    axes = _new_axes(figure, *(_LONGEST_SIDE * sides / sides.max()))
    corners = np.array([np.zeros(2), a, a + b, b])
    for e in lattice.shift(lattice.near())[::-1]:
        _add_bodies(axes, home + e, q.radii, image=bool(e.any()))
    axes.add_patch(Polygon(corners, closed=True, fill=False, ls="--", lw=0.9, ec=_FRAME, zorder=4))
    room = q.radii.max()
    (left, low), (right, high) = corners.min(axis=0) - room, corners.max(axis=0) + room
    axes.set(xlim=(left, right), ylim=(low, high))
    return axes, home


def _draw_round(figure: Figure, around: Sphere, q: Configuration) -> Axes:
    """The discs at q in their round container."""
    axes = _new_axes(figure, _LONGEST_SIDE, _LONGEST_SIDE)
    _add_bodies(axes, q.centres, q.radii)
    axes.add_patch(Circle(tuple(around.centre), around.radius, fill=False, lw=3.0, ec=_FRAME, zorder=4))
    (x, y), room = around.centre, 1.02 * around.radius
    axes.set(xlim=(x - room, x + room), ylim=(y - room, y + room))
    return axes


def _new_axes(figure: Figure, width: float, height: float) -> Axes:
    """Axes of that size in inches, with room for a title."""
    figure.set_size_inches(width + 0.3, height + 0.7)
    axes = figure.subplots()
    axes.set_aspect("equal")
    axes.set_axis_off()
    return axes


def _name_plane(axes: Axes) -> None:
    """Label the axes of a projection, and draw nothing else of them."""
    axes.set_axis_on()
    axes.spines[:].set_visible(False)
    axes.set(xlabel="x (seen along y)", ylabel="z", xticks=[], yticks=[])


def _add_bodies(
    axes: Axes, centres: Array, radii: Array, rims: Array | None = None, image: bool = False
) -> None:
    """Bodies, or images of them: discs, or what the rims (N, n, 2) around their centres say."""
    face, edge, width = ("#eaf3f9", "#a9c4d8", 0.6) if image else ("#9ecae1", "#20507a", 0.7)
    patches: list[Patch] = [Circle((x, y), a) for (x, y), a in zip(centres, radii, strict=True)]
    if rims is not None:
        patches = [Polygon(rim) for rim in centres[:, None] + rims]
    zorder = 1 if image else 2
    drawn = PatchCollection(patches, facecolors=face, edgecolors=edge, linewidths=width, zorder=zorder)
    axes.add_collection(drawn)


def close_links(arrangement: Arrangement) -> NDArray[np.float64]:
    """Segments, (P, 2, 2), between the centres of discs or spheres whose gap is below CLOSE mean radii."""
    if arrangement.oriented is not None:
        return np.empty((0, 2, 2))
    cell, radii = arrangement.cell, arrangement.radii
    close = CLOSE * float(radii.mean())
    reach = 2.0 * float(radii.max()) + close
    i, j = cell.near_pairs(arrangement.centres, reach).T
    between = cell.separation(arrangement.centres[j], arrangement.centres[i])
    near = np.linalg.norm(between, axis=1) - radii[i] - radii[j] < close
    i, j, between = i[near], j[near], between[near][:, [0, -1]]
    x = arrangement.centres[:, [0, -1]]
    # a pair across a periodic side is drawn from both of its bodies, up to the middle of the gap and beyond
    from_i = np.stack([x[i], x[i] + between], axis=1)
    across = np.linalg.norm(x[j] - x[i] - between, axis=1) > 1e-9 * max(cell.sides)
    from_j = np.stack([x[j], x[j] - between], axis=1)[across]
    return np.concatenate([from_i, from_j])


def _draw_frame(axes: Axes, cell: SimulationCell) -> None:
    width, height = cell.sides[0], cell.sides[-1]
    for k, periodic in enumerate((cell.periodic[0], cell.periodic[-1])):
        dashes, width_of_line = ("--", 0.9) if periodic else ("-", 3.0)
        for at in (0.0, (width, height)[k]):
            ends = ([at, at], [0.0, height]) if k == 0 else ([0.0, width], [at, at])
            axes.plot(*ends, color=_FRAME, zorder=4, ls=dashes, lw=width_of_line)
    margin = 0.02 * max(width, height)
    axes.set(xlim=(-margin, width + margin), ylim=(-margin, height + margin))


def _title(arrangement: Arrangement, links: int) -> str:
    text = f"N = {len(arrangement.radii)}, {arrangement.fraction_name} {arrangement.fraction():.3g}"
    gap = min(arrangement.smallest_gap(), arrangement.smallest_wall_gap())
    return f"{text}, smallest gap {gap:.3g}" + (f"; joined: gap < {CLOSE:g} a" if links else "")
