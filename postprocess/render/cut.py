"""Planes through a flow in space: where they lie, the spheres that they cut, a field and lines on them."""

from dataclasses import dataclass, field

import numpy as np
import pandas as pd
import pyvista as pv
from scipy.spatial import cKDTree

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.bodies.surface_gap import SurfaceGap
from fsi.case.shapes.ellipse import Ellipse
from fsi.errors import InputError
from fsi.meshes.geometry.outline import Outline
from fsi.postprocess.render.fields import DISTURBANCE, RenderedField
from fsi.postprocess.render.mean_flow import undisturbed
from fsi.postprocess.render.view import View
from fsi.postprocess.run.grids import nodes
from fsi.postprocess.run.probe import FLUID, probe_smoothly
from fsi.postprocess.run.run import Run

_X, _Y, _UP = np.eye(3)
_ACROSS = {
    "x": (_Y, _UP),
    "y": (_X, _UP),
    "z": (_X, _Y),
}  # what points right and up on planes across each axis
_POINTS = 161  # along each side of the plane: values of the elements there, linear in between
_APART = 0.06  # distance of streamlines, over half the width of the window

type Flow = tuple[pv.PolyData, pv.PolyData]  # a surface, and lines on it


@dataclass(frozen=True, slots=True)
class Cut:
    """The plane of points `centre + half (s along + t up)`.

    Attributes:
        centre: a point in space, (3,).
        half: the unit of s and t, a length.
        along: a horizontal unit vector, (3,).
        up: a unit vector across that, (3,).
    """

    centre: Array
    half: float
    along: Array
    up: Array = field(default_factory=_UP.copy)

    @property
    def across(self) -> Array:
        """The unit normal, towards who sees `along` to the right and `up` upwards."""
        normal: Array = np.cross(self.along, self.up)
        return normal

    @property
    def letters(self) -> tuple[str, str]:
        """Of the coordinates in whose directions `along` and `up` point; s and t for other directions."""
        return _letter(self.along, "s"), _letter(self.up, "t")

    def points(self, s: Array, t: Array) -> Array:
        """Points in space (..., 3)."""
        x: Array = self.centre + self.half * (s[..., None] * self.along + t[..., None] * self.up)
        return x

    def circles(self, q: Configuration) -> Configuration:
        """Where the plane cuts the bodies, as discs or ellipses with centres (s, t), in units of half."""
        if q.ellipsoids:
            return self._ellipses(q)
        apart = q.centres - self.centre
        squared = q.radii**2 - (apart @ self.across) ** 2
        cut = squared > 0.0
        centres = np.column_stack([apart @ self.along, apart @ self.up])[cut] / self.half
        return Configuration.unturned(centres, np.sqrt(squared[cut]) / self.half)

    def _ellipses(self, q: Configuration) -> Configuration:
        """The same of ellipsoids: |y| = 1 is a quadratic equation in (s, t)."""
        found: list[tuple[Array, float, Outline]] = []
        for body in q.standing:
            start = body.unstretched(self.centre)
            E = np.column_stack([body.unstretched(self.centre + e) - start for e in (self.along, self.up)])
            A, b = E.T @ E, E.T @ start
            middle = -np.linalg.solve(A, b)
            left = 1.0 - float(start @ start + b @ middle)
            if left > 0.0:
                lengths, axes = np.linalg.eigh(A)
                a, c = np.sqrt(left / lengths) / self.half
                outline = Ellipse(kind="ellipse", axes=(float(a), float(c))).outline
                turn = float(np.arctan2(axes[1, 0], axes[0, 0]))
                found.append((middle / self.half, turn, outline))
        centres = np.array([centre for centre, _, _ in found]).reshape(-1, 2)
        outlines = tuple(outline for _, _, outline in found)
        radii = np.array([outline.radius for outline in outlines])
        return Configuration(centres, np.array([turn for _, turn, _ in found]), radii, outlines)

    @property
    def name(self) -> str:
        """Where it lies."""
        for letter, normal, place in zip("xyz", np.eye(3), self.centre, strict=True):
            if abs(self.across @ normal) == 1.0:
                return f"{letter} = {place:.3g}"
        return f"at {np.degrees(np.arctan2(self.along[1], self.along[0])):.0f}° to x"


def _letter(direction: Array, other: str) -> str:
    """Of the coordinate in whose direction a unit vector points, or another one where there is none."""
    named = zip("xyz", np.eye(3), strict=True)
    return next((letter for letter, axis in named if direction @ axis == 1.0), other)


def plane_of_choice(text: str, view: View) -> Cut:
    """The plane "x=0.5", "y=0" or "z=1" in a window. Raises InputError: none of these, or not in it."""
    letter, _, number = text.replace(" ", "").partition("=")
    try:
        place = float(number)
    except ValueError:
        place = np.nan
    if letter not in _ACROSS or not np.isfinite(place):
        raise InputError(f"--plane {text}: give x=, y= or z= and a number, as in --plane x=0.5")
    centre, axis = view.centre.copy(), "xyz".index(letter)
    low, high = centre[axis] - view.half, centre[axis] + view.half
    if not low < place < high:
        raise InputError(f"--plane {text}: misses what is shown; give {letter} from {low:.3g} to {high:.3g}")
    centre[axis] = place
    return Cut(centre, view.half, *_ACROSS[letter])


def through_gap(gap: SurfaceGap, q: Configuration, view: View) -> Cut:
    """The plane that holds the line of centres; of those of a vertical line the one along x.

    Its centre is that of the view, or what lies nearest to it on the plane.
    """
    towards = (gap.middle - q.centres[gap.sides[0]]) * [1.0, 1.0, 0.0]
    length = float(np.linalg.norm(towards))
    steep = length < 1e-6 * q.radii[gap.sides[0]]
    along = _X if steep else np.copysign(1.0, towards[0]) * towards / length
    across = np.cross(along, _UP)
    return Cut(view.centre - ((view.centre - gap.middle) @ across) * across, view.half, along)


def flow_on(run: Run, step: int, cut: Cut, field: RenderedField, reach: float) -> Flow:
    """The part of the cut with |s|, |t| <= reach inside the walls, as a surface and its streamlines.

    Periods are filled with images. Points are (s, t, 0); the surface has the point data `value`. Values go
    on from the fluid into the bodies, whose pictures hide it, and from cell to cell: rates that jump there
    would have the colours of either sign where they are small.

    Raises InputError: the files have not what the field is computed from.
    """
    dimensions, side = (_POINTS, _POINTS, 1), 2.0 * reach / (_POINTS - 1)
    grid = pv.ImageData(dimensions=dimensions, spacing=(side, side, 1.0), origin=(-reach, -reach, 0.0))
    s, t, _ = np.asarray(grid.points, dtype=float).T
    x = cut.points(s, t)
    container = run.container(step)
    table = probe_smoothly(run, x, step)
    fluid = (table["where"] == FLUID).to_numpy()
    nearest = np.flatnonzero(fluid)[cKDTree(x[fluid]).query(x)[1]]
    known = _known(table.iloc[nearest], cut)
    if (flow := undisturbed(run, step)) is not None:
        known[DISTURBANCE] = known["velocity"] - flow.at(x[nearest])
    if not {*field.needs} <= {*known}:
        raise InputError(f"--field {field.name}: is not in the files of step {step}; run the case again")
    grid["value"] = field.value(known, run.case.fluid.viscosity)
    u = known[field.streamlines or "velocity"]
    grid["in plane"] = np.column_stack([u @ cut.along, u @ cut.up, np.zeros(len(x))])
    for k, distance in enumerate(container.distances(x).T):
        grid[f"wall {k}"] = distance
    surface = grid.extract_surface(algorithm="dataset_surface")
    lines = pv.PolyData()
    if field.streamlines and np.any(grid["in plane"]):
        # The first begins where the flow is fastest. Lengths of this filter are in cells.
        start = np.asarray(grid.points)[np.argmax(np.linalg.norm(grid["in plane"], axis=1))].tolist()
        apart = {"separating_distance": _APART / side, "separating_distance_ratio": 0.4}
        what = {"vectors": "in plane", "start_position": start, "compute_vorticity": False}
        lines = grid.streamlines_evenly_spaced_2D(**what, **apart)
    return _inside(surface), _inside(lines)


def _known(table: pd.DataFrame, cut: Cut) -> dict[str, Array]:
    """What is known at points, by the names of the files; of vorticity the part across the cut."""
    known = {"velocity": table[[f"u_{c}" for c in "xyz"]].to_numpy(), "pressure": table["p"].to_numpy()}
    if "vorticity_x" in table:
        known["vorticity"] = table[[f"vorticity_{c}" for c in "xyz"]].to_numpy() @ cut.across
    if "strain_rate" in table:
        known["strain_rate"] = table["strain_rate"].to_numpy()
    return known


def cut_cells(run: Run, step: int, cut: Cut) -> pv.PolyData:
    """Where the sides of the cells, as if they were flat, meet the cut: lines of points (s, t, 0)."""
    fluid = run.mesh(step)
    flat = pv.UnstructuredGrid(
        {pv.CellType.TETRA: nodes(fluid)[:, :4]}, np.asarray(fluid.points, dtype=float)
    )
    lines = flat.slice(normal=cut.across.tolist(), origin=cut.centre.tolist()).extract_all_edges()
    apart = (np.asarray(lines.points) - cut.centre) / cut.half
    lines.points = np.column_stack([apart @ cut.along, apart @ cut.up, np.zeros(len(apart))])
    return lines


def _inside(drawn: pv.PolyData) -> pv.PolyData:
    """What lies inside the walls."""
    for name in [name for name in drawn.point_data if name.startswith("wall")]:
        if drawn.n_points:
            drawn = drawn.clip_scalar(scalars=name, invert=False, value=0.0)
    return drawn
