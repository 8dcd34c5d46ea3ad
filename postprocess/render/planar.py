"""Pictures of the flow in the plane, or around an axis: all bodies, and a close-up of a gap."""

from collections.abc import Iterator, Sequence
from functools import lru_cache

import numpy as np
from matplotlib.cm import ScalarMappable

from fsi.bodies.surface_gap import SurfaceGap
from fsi.errors import InputError
from fsi.postprocess.render.canvas import INK, Panel, Picture, new_panel
from fsi.postprocess.render.curved_cells import edges, rims
from fsi.postprocess.render.fields import (
    DISTURBANCE,
    RenderedField,
    field_names,
    rendered_field,
)
from fsi.postprocess.render.mean_flow import is_sheared, sliding_walls
from fsi.postprocess.render.network import NECKS
from fsi.postprocess.render.picture import FlowArtist, Framed, compose
from fsi.postprocess.render.scenes import RIBBON, Scene, gap_at, in_window, scene, window_on
from fsi.postprocess.render.suspended import MOTION
from fsi.postprocess.render.view import Choice, View
from fsi.postprocess.render.walls import draw_open_walls
from fsi.postprocess.run.run import Run

_STREAMLINES = 24


class PlanarArtist(FlowArtist):
    """Draws the flow of a run in the plane."""

    def __init__(self, run: Run, choice: Choice) -> None:
        """Raises InputError: there is no such field or gap."""
        super().__init__(run, choice)
        near, sheared = "mesh" if run.case.level.meshed else "dissipation", is_sheared(run)
        flow = DISTURBANCE if sheared else "speed"
        panels = [(flow, False), (near, True)]
        if choice.gap is not None:
            panels = [(choice.field or near, True)]
        elif choice.field is not None or not run.case.bodies:
            panels = [(choice.field or flow, False)]
        if choice.field == DISTURBANCE and not sheared:
            raise InputError(f"--field {DISTURBANCE}: bodies disturb no sheared flow in this run; give speed")
        for name, _ in panels:
            _require_shown(run, name, sheared)
        self.panels = [(rendered_field(name), close) for name, close in panels]
        # The last of each is kept: its colours are wanted before its picture.
        self._mesh = lru_cache(maxsize=1)(run.mesh)
        self._scenes = lru_cache(maxsize=1)(self._read)

    def require(self, step: int) -> None:
        """Older runs have not written all that can be drawn."""
        needed = {name for field, _ in self.panels if not field.on_bodies for name in field.needs}
        needed -= {DISTURBANCE}
        if needed - {*self._mesh(step).point_data}:
            what = f"--field {self.choice.field}: is not in the files of step {step}"
            if "pressure" in needed and not self.run.case.level.pressure:
                only = "where no neck is narrow, with modes enough, of at most 500 bodies"
                remedy = "raise pores.modes, or give another field"
                raise InputError(f"{what}; between pores there is a pressure only {only}; {remedy}")
            raise InputError(f"{what}; run the case again")
        super().require(step)

    def pictures(self, steps: Sequence[int]) -> Iterator[Picture]:
        """A picture of each step."""
        window = window_on(self.run, steps, self._mesh(steps[0]))
        if len(self.panels) > 1:
            gaps = (gap_at(self.run, step, None, window) for step in steps)
            self.panels = self.panels if any(map(window.is_narrow, gaps)) else self.panels[:1]
        shades = self._shades(steps, window)
        return (self._picture(step, window, shades) for step in steps)

    def _shades(self, steps: Sequence[int], window: View) -> list[ScalarMappable]:
        """What the colours of each panel mean, over all those steps."""
        scenes = (self._scenes(step, window) for step in steps)
        each = [[field.scale.seen(*seen.samples(field)) for field, seen, _ in at] for at in scenes]
        return [
            field.shades(of, self.choice.span)
            for (field, _), of in zip(self.panels, zip(*each, strict=True), strict=True)
        ]

    def _read(self, step: int, window: View) -> list[tuple[RenderedField, Scene, SurfaceGap | None]]:
        """What the panels show of a step. Raises InputError: its files have not all of it, as in a film."""
        self.require(step)
        tractions = any(field.on_bodies for field, _ in self.panels) and bool(self.run.case.bodies)
        shown = []
        for field, close in self.panels:
            gap = gap_at(self.run, step, self.sides, window) if close else None
            view = window if gap is None else window.close_up(gap)
            shown.append((field, scene(self.run, step, self._mesh(step), view, tractions), gap))
        return shown

    def _picture(self, step: int, window: View, each: Sequence[ScalarMappable]) -> Picture:
        scenes, framed = self._scenes(step, window), []
        for (field, seen, gap), shades in zip(scenes, each, strict=True):
            panel = new_panel(seen.view, self.choice.size, self.choice.theme)
            draw_open_walls(panel, self.run)
            _draw(panel, seen, field, shades)
            panel.bodies(seen.q, turning=not seen.axisymmetric, rims=field.scale.rims)
            if gap is None:
                panel.sliding(sliding_walls(self.run, step))
            if gap is None and len(scenes) > 1:
                panel.frame(scenes[1][1].view)
            title = field.title if gap is None else f"{self.gap_title(step, gap, seen.view)}: {field.title}"
            cut = field.scale.cut if self.choice.span is None else "both"
            framed.append(Framed(panel.image(), title, seen.view.half, field.label, shades, cut))
        return compose(self.title(step), framed, self.choice.theme)


def _draw(panel: Panel, seen: Scene, field: RenderedField, shades: ScalarMappable) -> None:
    """A field, in the fluid or in ribbons inside the bodies along their surfaces, and the lines on it.

    Streamlines are level lines of the stream function: the closer, the faster.
    """
    if field.on_bodies:
        panel.fill(seen.bare_surface(panel.size), "white")
        if seen.bodies is not None:
            seen.bodies["value"] = field.value(seen.bodies.point_data, seen.viscosity)
            panel.colour(rims(seen.bodies, RIBBON).translate((0.0, 0.0, 3e-3)), shades)
        return
    surface = seen.surface(field, panel.size)
    panel.colour(surface, shades)
    if field.streamlines:
        psi = surface["psi"][in_window(surface.points, seen.view)]
        levels = np.linspace(float(psi.min()), float(psi.max()), _STREAMLINES + 2)[1:-1]
        panel.lines(surface.contour(levels, scalars="psi"), "white", width=3, opacity=0.8)
    if field.edges:
        panel.lines(edges(seen.fluid), INK, width=3)


def _require_shown(run: Run, name: str, sheared: bool) -> None:
    """Raise InputError where no field has that name, or it needs a mesh that the run has not."""
    if name in field_names() and (run.case.level.meshed or not rendered_field(name).of_mesh):
        return
    why = f'model = "{run.case.model}" has no mesh; ' if name in field_names() else ""
    raise InputError(f"--field {name}: {why}give one of {', '.join(_shown(run, sheared))}")


def _shown(run: Run, sheared: bool) -> list[str]:
    """The fields that the last step with a flow can show, and what is drawn without it."""
    meshed, case, has = run.case.level.meshed, run.case, {*run.mesh().point_data}
    has |= {DISTURBANCE} if sheared else set[str]()
    has |= {"traction"} if meshed and case.bodies else set[str]()
    fields = (rendered_field(name) for name in field_names())
    shown = [field.name for field in fields if has >= {*field.needs} and (meshed or not field.of_mesh)]
    necks = [NECKS] if run.has(NECKS) else []
    return shown + necks + ([MOTION] if case.geometry == "planar" and case.bodies else [])
