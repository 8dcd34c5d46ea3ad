"""Pictures of the flow in space: spheres with their traction in their box, a field on a plane, a gap."""

from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np
import pyvista as pv
from matplotlib.cm import ScalarMappable

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.bodies.surface_gap import gap_between
from fsi.errors import InputError
from fsi.postprocess.render.canvas import ASLANT, INK, Picture, new_panel, new_spatial_panel
from fsi.postprocess.render.cut import Cut, Flow, cut_cells, flow_on, plane_of_choice, through_gap
from fsi.postprocess.render.fields import DISTURBANCE, RenderedField, rendered_field
from fsi.postprocess.render.mean_flow import is_sheared
from fsi.postprocess.render.periodic_box import PeriodicBox
from fsi.postprocess.render.picture import FlowArtist, Framed, compose
from fsi.postprocess.render.scales import Shown, exceeded
from fsi.postprocess.render.view import Choice, View, around_all
from fsi.postprocess.render.walls import draw_open_walls
from fsi.postprocess.run.run import Run

_WIDE = 2.2  # of the window over that which just holds the bodies
_MARGIN = 1.08  # of a window around the whole domain
_FILMS = 0.01  # of the surfaces: films, which hold the largest values, have one colour
_DECADE = 0.1  # at least so far down: differences of some percent are those of the elements
_CURVED = 3  # times that the cells of a sphere are divided


class SpatialArtist(FlowArtist):
    """Draws a run in space: what bodies carry on the spheres, other fields on a plane seen face on."""

    def __init__(self, run: Run, choice: Choice) -> None:
        """Raises InputError: there is no such field, gap or plane."""
        super().__init__(run, choice)
        sheared = is_sheared(run)
        flow = DISTURBANCE if sheared else "speed"
        names = [choice.field or "pressure"] if self.sides is not None else [choice.field]
        if names == [None]:
            names = ["traction", flow] if run.has("surface") else [flow]
        self.fields = [rendered_field(name) for name in names if name is not None]
        if DISTURBANCE in names and not sheared:
            raise InputError(f"--field {DISTURBANCE}: bodies disturb no sheared flow in this run; give speed")
        if choice.plane is not None and self.sides is not None:
            raise InputError(
                "render: give --gap or --plane, not both; a gap has the plane of its line of centres"
            )
        if choice.plane is not None and all(field.on_bodies for field in self.fields):
            raise InputError(f"--plane {choice.plane}: {names[0]} is seen on whole bodies; drop it")
        if len(run.case.container().periods):
            if self.sides is not None:
                raise InputError(f"--gap {choice.gap}: gaps across periods in space are not drawn; drop it")
            if self.fields[0].edges:
                raise InputError(f"--field {names[0]}: cells of periods in space are not drawn; give speed")
        if self.fields[0].on_bodies and (self.sides is not None or not run.has("surface")):
            raise InputError(f"--field {names[0]}: is seen on whole spheres of runs with fields; drop --gap")

    def pictures(self, steps: Sequence[int]) -> Iterator[Picture]:
        """A picture of each step."""
        q = [self.run.meshed(step) for step in steps]
        window = self._window(steps, np.stack([at.centres for at in q]), q[0].radii)
        cuts = [self._cut(step, at, window) for step, at in zip(steps, q, strict=True)]
        drawn = [self._drawn(field, steps, cuts, window.centre) for field in self.fields]
        shades = [self._shades(field, parts) for field, parts in zip(self.fields, drawn, strict=True)]
        for k, (step, at, (cut, where)) in enumerate(zip(steps, q, cuts, strict=True)):
            framed = []
            for field, parts, colours in zip(self.fields, drawn, shades, strict=True):
                if field.on_bodies:
                    half = ASLANT * cut.half
                    image, title = self._space(parts[k][0], (step, cut, window.centre), colours), field.title
                else:
                    half, title = cut.half, f"{where}: {field.title}"
                    image = self._plane(field, parts[k], (step, cut, at), colours)
                ends = field.scale.cut if self.choice.span is None else "both"
                label = field.along(*cut.letters).label
                framed.append(Framed(image, title, half, label, colours, ends))
            yield compose(self.title(step), framed, self.choice.theme)

    def _drawn(
        self, field: RenderedField, steps: Sequence[int], cuts: Sequence[tuple[Cut, str]], middle: Array
    ) -> list[Flow]:
        """At each step the surface with the data `value` that is coloured, and the lines on it.

        middle: of the box that shows a period.
        """
        if not field.on_bodies:
            return [
                flow_on(self.run, step, cut, field, 1.0) for step, (cut, _) in zip(steps, cuts, strict=True)
            ]
        spheres = []
        for step in steps:
            grid = self.run.mesh(step, "surface")
            if (period := self._period(step, middle)) is not None:
                grid = period.whole(grid, self.run.meshed(step))
            skin = grid.extract_surface(algorithm="dataset_surface", nonlinear_subdivision=_CURVED)
            skin["value"] = field.value(skin.point_data, self.run.case.fluid.viscosity)
            spheres.append((skin, pv.PolyData()))
        return spheres

    def _shades(self, field: RenderedField, parts: Sequence[Flow]) -> ScalarMappable:
        """The same colours for the same values at all steps."""
        if field.on_bodies:
            sized = [surface.compute_cell_sizes(length=False, volume=False) for surface, _ in parts]
            values = np.concatenate([each.point_data_to_cell_data()["value"] for each in sized])
            areas = np.concatenate([each["Area"] for each in sized])
            (low, high), typical = field.scale.seen(
                np.minimum(values, exceeded(values, areas, _FILMS)), areas
            )
            seen = Shown((min(low, _DECADE * high), high), typical)
        else:
            values = np.concatenate([np.asarray(surface["value"]) for surface, _ in parts])
            seen = field.scale.seen_on_plane(values)
        return field.shades([seen], self.choice.span)

    def _period(self, step: int, middle: Array | None = None) -> PeriodicBox | None:
        """The box of one period, if the domain has any."""
        container = self.run.container(step)
        return PeriodicBox.of(container, middle) if len(container.periods) else None

    def _window(self, steps: Sequence[int], centres: Array, radii: Array) -> View:
        """A cube around the bodies at all steps, or around the domain where that is smaller; or a period."""
        step = steps[0]
        if (period := self._period(step)) is not None:
            views = [PeriodicBox.of(self.run.container(at), period.middle).view() for at in steps]
            return max(views, key=lambda view: view.half)
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
            cut = plane_of_choice(self.choice.plane or f"y={float(window.centre[1])!r}", window)
            return cut, f"plane {cut.name}"
        gap = gap_between(q, self.run.container(step), self.sides)
        view = window.close_up(gap)
        cut = through_gap(gap, q, view)
        return cut, f"{self.gap_title(step, gap, view)}, plane {cut.name}"

    def _space(self, spheres: pv.PolyData, where: tuple[int, Cut, Array], shades: ScalarMappable) -> Picture:
        """The spheres in their box, and the outline of the plane where a panel shows that."""
        step, cut, middle = where
        view = View(cut.centre, ASLANT * cut.half)
        space = new_spatial_panel(view, self.choice.size, self.choice.theme)
        local = spheres.copy()
        local.points = view.local(np.asarray(spheres.points, dtype=float))
        space.colour(local, shades, lit=True)
        faces = self.run.case.container().faces
        if (period := self._period(step, middle)) is not None:
            space.outline(view.local(period.edges), space.theme.ink)
        elif len(faces) == 6:
            ends = np.array([sorted(at for axis, at in faces.values() if axis == k) for k in range(3)])
            space.outline(view.local(_edges(ends)), space.theme.ink)
        elif "plane" in self.run.case.container().walls:
            space.floor(0.0)
        elif len(edges := self.run.case.container().edges):
            space.outline(view.local(edges), space.theme.ink)
        if not all(field.on_bodies for field in self.fields):
            corners = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]])
            around = view.local(cut.points(*corners.T))
            space.outline(np.stack([around[:-1], around[1:]], axis=1), "#d55e00")
        return space.image()

    def _plane(
        self, field: RenderedField, flow: Flow, where: tuple[int, Cut, Configuration], shades: ScalarMappable
    ) -> Picture:
        """The plane face on, and where it cuts the spheres."""
        panel = new_panel(View(np.zeros(2), 1.0), self.choice.size, self.choice.theme)
        (plane, lines), (step, cut, q) = flow, where
        draw_open_walls(panel, self.run, lambda local: cut.points(*local.T))
        panel.colour(plane, shades)
        panel.lines(lines, "white", width=3, opacity=0.8, layer=0.5)
        if field.edges:
            panel.lines(cut_cells(self.run, step, cut), INK, width=2, layer=0.5)
        period = self._period(step)
        shown = q if period is None else period.bodies(q, View(cut.centre, cut.half))
        panel.bodies(cut.circles(shown), turning=False, rims=field.scale.rims)
        return panel.image()


def _edges(ends: Array) -> Array:
    """The edges of a box with those ends along each axis, (3, 2): (12, 2, 3)."""
    found = []
    for axis in range(3):
        for one, other in product((0, 1), repeat=2):
            corner = np.empty((2, 3))
            corner[:, axis] = ends[axis]
            first, second = (k for k in range(3) if k != axis)
            corner[:, first], corner[:, second] = ends[first, one], ends[second, other]
            found.append(corner)
    return np.array(found)
