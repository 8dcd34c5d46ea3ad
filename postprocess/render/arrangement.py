"""Draw bodies in their cell: walls thick, periodic sides dashed, their images pale, close pairs joined."""

from __future__ import annotations

import itertools
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PatchCollection
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from numpy.typing import NDArray

from fsi.arrangements.arrangement import Arrangement, Array, SimulationCell
from fsi.bodies.configuration import Configuration
from fsi.case.case import Case
from fsi.errors import InputError

CLOSE = 0.1  # gaps below this many mean radii are joined by a line
BODY, EDGE, LINK, FRAME = "#9ecae1", "#20507a", "#d55e00", "#222222"
IMAGE, IMAGE_EDGE = "#eaf3f9", "#a9c4d8"
_LONGEST_SIDE = 8.0  # of the figure, inches


def draw_arrangement(arrangement: Arrangement, path: Path) -> None:
    """Draw into a PNG file; spheres are seen along y. Raises InputError where it cannot be written."""
    with mpl.rc_context({"font.size": 10}):
        figure = Figure(figsize=figure_size(arrangement.cell), layout="constrained")
        axes = figure.subplots()
        draw_bodies(axes, arrangement)
        links = close_links(arrangement)
        axes.add_collection(LineCollection(list(links), colors=LINK, linewidths=1.8, zorder=3))
        axes.set_title(_title(arrangement, len(links)), fontsize=10)
        try:
            figure.savefig(path, dpi=130)
        except (OSError, ValueError) as error:
            raise InputError(f"picture = {path}: {error}; give a .png that can be written") from None


def figure_size(cell: SimulationCell) -> tuple[float, float]:
    """Inches, with room for a title."""
    width, height = cell.sides[0], cell.sides[-1]
    scale = _LONGEST_SIDE / max(width, height)
    return max(scale * width, 2.5) + 0.3, max(scale * height, 1.5) + 0.7


def arrangement_of(case: Case, q: Configuration) -> Arrangement:
    """The bodies of a case at q, from the lower corner of its box. Raises InputError for other shapes."""
    given = case.domain.model_dump()
    if "lower" not in given or "upper" not in given:
        raise InputError(f'domain.shape = "{given["shape"]}": only bodies in a box can be drawn')
    lower, sides = np.array(given["lower"]), np.subtract(given["upper"], given["lower"])
    cell = SimulationCell(
        tuple(sides.tolist()), tuple(axis in given.get("periodic", ()) for axis in "xyz"[: len(sides)])
    )
    return Arrangement(cell, cell.wrapped(q.centres - lower), q.radii)


def draw_bodies(axes: Axes, arrangement: Arrangement) -> None:
    """The bodies and their images in the frame of the cell."""
    cell = arrangement.cell
    centres, radii = arrangement.centres[:, [0, -1]], arrangement.radii
    depth = arrangement.centres[:, 1] if cell.dimension == 3 else np.zeros(len(radii))
    order = np.argsort(-depth, kind="stable")
    here = [Circle((x, y), a) for (x, y), a in zip(centres[order], radii[order], strict=True)]
    bodies = PatchCollection(here, facecolors=BODY, edgecolors=EDGE, linewidths=0.7, zorder=2)
    axes.add_collection(bodies)
    images = PatchCollection(
        list(_images(cell, centres, radii)),
        facecolors=IMAGE,
        edgecolors=IMAGE_EDGE,
        linewidths=0.6,
        zorder=1,
    )
    axes.add_collection(images)
    _draw_frame(axes, cell)


def close_links(arrangement: Arrangement, close: float = CLOSE) -> NDArray[np.float64]:
    """Segments, shape (P, 2, 2), between the centres of pairs whose gap is below `close` mean radii."""
    cell, radii = arrangement.cell, arrangement.radii
    reach = 2.0 * float(radii.max()) + close * float(radii.mean())
    i, j = cell.near_pairs(arrangement.centres, reach).T
    between = cell.separation(arrangement.centres[j], arrangement.centres[i])
    near = np.linalg.norm(between, axis=1) - radii[i] - radii[j] < close * float(radii.mean())
    i, j, between = i[near], j[near], between[near][:, [0, -1]]
    x = arrangement.centres[:, [0, -1]]
    # a pair across a periodic side is drawn from both of its bodies, up to the middle of the gap and beyond
    from_i = np.stack([x[i], x[i] + between], axis=1)
    across = np.linalg.norm(x[j] - x[i] - between, axis=1) > 1e-9 * max(cell.sides)
    from_j = np.stack([x[j], x[j] - between], axis=1)[across]
    return np.concatenate([from_i, from_j])


def _images(cell: SimulationCell, centres: Array, radii: Array) -> list[Circle]:
    """Images that reach into the cell."""
    sides = np.array([cell.sides[0], cell.sides[-1]])
    shifts = [(-1, 0, 1) if so else (0,) for so in (cell.periodic[0], cell.periodic[-1])]
    found = []
    for shift in itertools.product(*shifts):
        if any(shift):
            moved = centres + np.array(shift) * sides
            inside = np.all((moved > -radii[:, None]) & (moved < sides + radii[:, None]), axis=1)
            found += [Circle((x, y), a) for (x, y), a in zip(moved[inside], radii[inside], strict=True)]
    return found


def _draw_frame(axes: Axes, cell: SimulationCell) -> None:
    width, height = cell.sides[0], cell.sides[-1]
    for k, periodic in enumerate((cell.periodic[0], cell.periodic[-1])):
        style = {"ls": "--", "lw": 0.9} if periodic else {"ls": "-", "lw": 3.0}
        for at in (0.0, (width, height)[k]):
            ends = ([at, at], [0.0, height]) if k == 0 else ([0.0, width], [at, at])
            axes.plot(*ends, color=FRAME, zorder=4, **style)  # type: ignore[arg-type]
    margin = 0.02 * max(width, height)
    axes.set_xlim(-margin, width + margin)
    axes.set_ylim(-margin, height + margin)
    axes.set_aspect("equal")
    axes.set_xticks([])
    axes.set_yticks([])
    for spine in axes.spines.values():
        spine.set_visible(False)


def _title(arrangement: Arrangement, links: int) -> str:
    text = f"N = {len(arrangement.radii)}, area fraction {arrangement.fraction():.3g}"
    gap = min(arrangement.smallest_gap(), arrangement.smallest_wall_gap())
    return f"{text}, smallest gap {gap:.3g}" + (f"; joined: gap < {CLOSE:g} a" if links else "")
