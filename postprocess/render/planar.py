"""Pictures of the flow in the plane, or around an axis: all bodies, and a close-up of a gap."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import pyvista as pv

from fsi.errors import InputError
from fsi.postprocess.choice import Choice, Span
from fsi.postprocess.render.animation import Picture
from fsi.postprocess.render.fields_shown import DRAWINGS
from fsi.postprocess.render.figure import Framed, compose
from fsi.postprocess.render.panel import new_panel
from fsi.postprocess.render.scenes import Scene, gap_at, scene, window_on
from fsi.postprocess.render.view import Gap, View, parse_sides
from fsi.postprocess.run.run import Run

FROM = {"vorticity": "vorticity", "dissipation": "strain_rate"}  # what older runs have not written


class FlowArtist:
    """Draws the flow of a run in the plane: the same windows, and the same colours for the same values."""

    series = "fluid"

    def __init__(self, run: Run, choice: Choice) -> None:
        """Raises InputError: there is no such field or gap."""
        if choice.field is not None and choice.field not in DRAWINGS:
            raise InputError(f"--field {choice.field}: give one of {', '.join(DRAWINGS)}")
        self.run, self.choice, walls = run, choice, run.case.container().walls
        self.sides = None if choice.gap is None else parse_sides(choice.gap, run.case.names, walls)
        self._fluid: tuple[int, pv.UnstructuredGrid] | None = None
        self._kept: tuple[int, list[tuple[Scene, Gap | None]]] | None = None
        if choice.gap is not None:
            self.panels = [(choice.field or "mesh", True)]
        elif choice.field is not None or not run.case.bodies:
            self.panels = [(choice.field or "speed", False)]
        else:
            self.panels = [("speed", False), ("mesh", True)]

    def require_fields(self, step: int) -> None:
        """Raise InputError where older runs have not written what is to be drawn."""
        missing = {FROM.get(name, "velocity") for name, _ in self.panels} - {*self._mesh(step).point_data}
        if missing:
            raise InputError(
                f"--field {self.choice.field}: is not in the files of this run; run the case again"
            )

    def pictures(self, steps: Sequence[int]) -> Iterator[Picture]:
        """A picture of each step."""
        around, self._kept = window_on(self.run, steps, self._mesh(steps[0])), None
        spans = self._spans(steps, around)
        for step in steps:
            yield self._picture(step, around, spans)

    def _spans(self, steps: Sequence[int], around: View) -> list[Span]:
        """The range of colours of each panel, over all those steps."""
        if self.choice.span is not None:
            return [self.choice.span] * len(self.panels)
        each = [
            [
                DRAWINGS[name].span(seen)
                for (name, _), (seen, _) in zip(self.panels, self._scenes(step, around), strict=True)
            ]
            for step in steps
        ]
        return [(min(s[0] for s in own), max(s[1] for s in own)) for own in zip(*each, strict=True)]

    def _scenes(self, step: int, around: View) -> list[tuple[Scene, Gap | None]]:
        """What the panels show of a step; the last is kept, as its colours are wanted before its picture."""
        if self._kept is None or self._kept[0] != step:
            self._kept = step, self._read(step, around)
        return self._kept[1]

    def _mesh(self, step: int) -> pv.UnstructuredGrid:
        """The flow of a step; the last is kept, as it is asked for again."""
        if self._fluid is None or self._fluid[0] != step:
            self._fluid = step, self.run.mesh(step)
        return self._fluid[1]

    def _read(self, step: int, around: View) -> list[tuple[Scene, Gap | None]]:
        """The same from its files."""
        tractions = any(name == "traction" for name, _ in self.panels) and bool(self.run.case.bodies)
        found, fluid = [], self._mesh(step)
        for _, close in self.panels:
            gap = gap_at(self.run, step, self.sides, around) if close else None
            view = around if gap is None else gap.close_up(around)
            found.append((scene(self.run, step, fluid, view, tractions), gap))
        return found

    def _picture(self, step: int, around: View, spans: Sequence[Span]) -> Picture:
        """One picture."""
        scenes = self._scenes(step, around)
        framed = []
        for (name, _), (seen, gap), span in zip(self.panels, scenes, spans, strict=True):
            drawing = DRAWINGS[name]
            norm = drawing.norm(span)
            panel = new_panel(seen.view, self.choice.size)
            drawing.draw(panel, seen, norm)
            panel.bodies(seen.q, turning=not seen.axisymmetric)
            if gap is None and len(scenes) > 1:
                panel.frame(scenes[1][0].view)
            title = drawing.title if gap is None else f"{self._title(gap)}: {drawing.title}"
            cut = self.choice.span is not None or name != "mesh"
            framed.append(
                Framed(panel.image(), title, seen.view.half, drawing.label, drawing.colours, norm, cut)
            )
        t = self.run.times[step]
        return compose(f"{self.run.case.name},  t = {t:.6g}", framed)

    def _title(self, gap: Gap) -> str:
        """Which gap, and how wide it is."""
        names = [*self.run.case.names, *self.run.case.container().walls]
        which = (
            "narrowest gap" if self.sides is None else f"gap {names[gap.sides[0]]} - {names[gap.sides[1]]}"
        )
        return f"{which}, {gap.width:.3g}"
