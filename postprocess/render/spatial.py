"""Pictures of the flow in space: spheres, and a vertical plane through them that shows a field; or a gap.

On the plane there are a field and the lines along the velocity in it.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
import pyvista as pv
from matplotlib.cm import ScalarMappable
from scipy.spatial import cKDTree

from fsi.bodies.configuration import Array, Configuration
from fsi.postprocess.render.canvas import Picture, new_panel, new_spatial_panel
from fsi.postprocess.render.fields import RenderedField, rendered_field
from fsi.postprocess.render.picture import FlowArtist, Framed, compose
from fsi.postprocess.render.view import Choice, View, around_all
from fsi.postprocess.run.gaps import SurfaceGap, gap_between
from fsi.postprocess.run.probe import FLUID, probe
from fsi.postprocess.run.run import Run

_WIDE = 2.2  # of the window over that which just holds the bodies
_MARGIN = 1.08  # of a window around the whole domain
_REACH = 1.35  # of the plane over the window, half its width
_X, _UP = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
_POINTS = 161  # along each side of the plane: exact values there, linear in between
_APART = 0.06  # distance of streamlines, over half the width of the window

type Flow = tuple[pv.PolyData, pv.PolyData]  # a surface, and lines on it


@dataclass(frozen=True, slots=True)
class Cut:
    """The plane of points `centre + half (s along + t e_z)`.

    Attributes:
        centre: a point in space, (3,).
        half: the unit of s and t, a length.
        along: a horizontal unit vector, (3,).
    """

    centre: Array
    half: float
    along: Array

    def points(self, s: Array, t: Array) -> Array:
        """Points in space (..., 3)."""
        x: Array = self.centre + self.half * (s[..., None] * self.along + t[..., None] * _UP)
        return x

    def circles(self, q: Configuration) -> Configuration:
        """Where the plane cuts the spheres, as discs with centres (s, t), in units of half."""
        across = np.cross(self.along, _UP)
        apart = q.centres - self.centre
        squared = q.radii**2 - (apart @ across) ** 2
        cut = squared > 0.0
        centres = np.column_stack([apart @ self.along, apart @ _UP])[cut] / self.half
        return Configuration.unturned(centres, np.sqrt(squared[cut]) / self.half)

    @property
    def name(self) -> str:
        """Where it lies."""
        if abs(self.along[0]) == 1.0:
            return f"y = {self.centre[1]:.3g}"
        return f"at {np.degrees(np.arctan2(self.along[1], self.along[0])):.0f}° to x"


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

    Points are (s, t, 0); the surface has the point data `value`. Values go on from the fluid into the bodies,
    whose pictures hide it.
    """
    dimensions, side = (_POINTS, _POINTS, 1), 2.0 * reach / (_POINTS - 1)
    grid = pv.ImageData(dimensions=dimensions, spacing=(side, side, 1.0), origin=(-reach, -reach, 0.0))
    s, t, _ = np.asarray(grid.points, dtype=float).T
    x = cut.points(s, t)
    table = probe(run, x, step)
    fluid = (table["where"] == FLUID).to_numpy()
    nearest = np.flatnonzero(fluid)[cKDTree(x[fluid]).query(x)[1]]
    known = _known(table.iloc[nearest])
    grid["value"] = field.value(known, run.case.fluid.viscosity)
    u = known["velocity"]
    grid["in plane"] = np.column_stack([u @ cut.along, u @ _UP, np.zeros(len(x))])
    for k, distance in enumerate(run.container(step).distances(x).T):
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


def _known(table: pd.DataFrame) -> dict[str, Array]:
    """What `fsi probe` says of points, by the names of the field files."""
    columns = {"velocity": [f"u_{c}" for c in "xyz"], "vorticity": [f"vorticity_{c}" for c in "xyz"]}
    vectors = {name: table[names].to_numpy() for name, names in columns.items()}
    scalars = {"pressure": table["p"].to_numpy(), "strain_rate": table["strain_rate"].to_numpy()}
    return vectors | scalars


def _inside(drawn: pv.PolyData) -> pv.PolyData:
    """What lies inside the walls."""
    for name in [name for name in drawn.point_data if name.startswith("wall")]:
        if drawn.n_points:
            drawn = drawn.clip_scalar(scalars=name, invert=False, value=0.0)
    return drawn


class SpatialArtist(FlowArtist):
    """Draws a run in space."""

    def __init__(self, run: Run, choice: Choice) -> None:
        """Raises InputError: there is no such field or gap."""
        super().__init__(run, choice)
        name = choice.field or ("speed" if self.sides is None else "pressure")
        self.field = rendered_field(name, in_space=True)

    def pictures(self, steps: Sequence[int]) -> Iterator[Picture]:
        """A picture of each step."""
        q = [self.run.configuration(step) for step in steps]
        window = self._window(steps[0], np.stack([at.centres for at in q]), q[0].radii)
        seen = [self._cut(step, at, window) for step, at in zip(steps, q, strict=True)]
        reach = _REACH if self.sides is None else 1.0
        cuts = zip(steps, (cut for cut, _ in seen), strict=True)
        flows = [flow_on(self.run, step, cut, self.field, reach) for step, cut in cuts]
        values = np.concatenate([plane["value"] for plane, _ in flows])
        span = self.choice.span or self.field.scale.span_on_plane(values)
        shades = ScalarMappable(self.field.scale.norm(span), self.field.colour_map)
        draw = self._space if self.sides is None else self._close_up
        for step, at, (cut, title), flow in zip(steps, q, seen, flows, strict=True):
            image = draw(flow, cut, at, shades)
            framed = Framed(image, title, cut.half, self.field.label, shades, cut=True)
            yield compose(self.title(step), [framed])

    def _window(self, step: int, centres: Array, radii: Array) -> View:
        """A cube around the bodies at all steps, or around the domain where that is smaller."""
        near = around_all(centres, radii)
        low, high = np.array(self.run.mesh(step).bounds).reshape(3, 2).T
        whole = _MARGIN * 0.5 * float(np.max(high - low))
        if whole > _WIDE * near.half:
            return View(near.centre, _WIDE * near.half)
        middle = 0.5 * (low + high)
        return View(np.array([middle[0], near.centre[1], middle[2]]), whole)

    def _cut(self, step: int, q: Configuration, window: View) -> tuple[Cut, str]:
        """The plane that is shown at a step, and what is said of it."""
        if self.sides is None:
            cut = Cut(window.centre, window.half, _X)
            what = f"{self.field.name}, streamlines" if self.field.streamlines else self.field.name
            return cut, f"{what} on the plane {cut.name}"
        gap = gap_between(q, self.run.container(step), self.sides)
        cut = through_gap(gap, q, window.close_up(gap))
        return cut, f"{self.gap_title(gap)}: {self.field.name}, plane {cut.name}"

    def _space(self, flow: Flow, cut: Cut, q: Configuration, shades: ScalarMappable) -> Picture:
        """The spheres, and the plane behind and in front of them."""
        space = new_spatial_panel(View(cut.centre, cut.half), self.choice.size)
        plane, lines = (_upright(part) for part in flow)
        space.colour(plane, shades)
        space.lines(lines)
        space.bodies(q)
        if "plane" in self.run.case.container().walls:
            space.floor(0.0)
        return space.image()

    def _close_up(self, flow: Flow, cut: Cut, q: Configuration, shades: ScalarMappable) -> Picture:
        """The plane alone, and where it cuts the spheres."""
        panel = new_panel(View(np.zeros(2), 1.0), self.choice.size)
        plane, lines = flow
        panel.colour(plane, shades)
        panel.lines(lines, "white", width=3, opacity=0.8, layer=0.5)
        panel.bodies(cut.circles(q), turning=False)
        return panel.image()


def _upright(flat: pv.PolyData) -> pv.PolyData:
    """(s, t, 0) to (s, 0, t), in the window's coordinates in space."""
    upright = flat.copy()
    if upright.n_points:
        upright.points = np.asarray(flat.points)[:, [0, 2, 1]]
    return upright
