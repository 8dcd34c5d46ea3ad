"""Pictures and animations of a run: the flow around the bodies, and a close-up of a gap."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from fsi.errors import InputError
from postprocess.animation import MOVIES, Picture, require_suffix, write_pictures
from postprocess.drawings import DRAWINGS, Span
from postprocess.figure import Framed, compose
from postprocess.opengl import require_opengl
from postprocess.panel import new_panel
from postprocess.run import Run
from postprocess.scenes import Scene, gap_at, read_scene, window_on
from postprocess.view import Gap, View, parse_sides

FROM = {"vorticity": "vorticity", "dissipation": "strain_rate"}  # what older runs have not written


@dataclass(frozen=True, slots=True)
class Choice:
    """What the user wants to see; without field and gap: the speed, and the mesh in the narrowest gap.

    field: a key of DRAWINGS; gap: two sides, "3,7" or "disc,bottom"; span: of the colours; size: pixels of a
    panel.
    """

    field: str | None = None
    gap: str | None = None
    span: Span | None = None
    size: int = 1000


def render_run(run: Run, output: Path, choice: Choice, step: int | None = None) -> Path:
    """Draw a step (default: the last) into a PNG file, or all steps into an MP4 or GIF file.

    Raises:
        InputError: no such field, gap or step, no fields in the run, no OpenGL here, or the disk refuses.
    """
    require_suffix(output)
    run.require_plane("render")
    artist = Artist(run, choice)
    animated = output.suffix in MOVIES
    if animated and step is not None:
        raise InputError(f"output = {output}: shows all steps; give a .png file for one step")
    steps = [int(n) for n in run.times.index] if animated else [run.step(step)]
    if not steps:
        run.step()  # says that there are no fields
    missing = {FROM.get(name, "velocity") for name, _ in artist.panels} - {*run.mesh(steps[0]).point_data}
    if missing:
        raise InputError(f"--field {choice.field}: is not in the files of this run; run the case again")
    require_opengl()
    write_pictures(artist.pictures(steps), output)
    return output


class Artist:
    """Draws pictures of a run in one manner: the same windows, and the same colours for the same values."""

    def __init__(self, run: Run, choice: Choice) -> None:
        """Raises InputError: there is no such field or gap."""
        if choice.field is not None and choice.field not in DRAWINGS:
            raise InputError(f"--field {choice.field}: give one of {', '.join(DRAWINGS)}")
        if choice.size < 100:
            raise InputError(f"--size {choice.size}: give at least 100 pixels")
        self.run, self.choice, walls = run, choice, run.case.container().walls
        self.sides = None if choice.gap is None else parse_sides(choice.gap, run.case.names, walls)
        if choice.gap is not None:
            self.panels = [(choice.field or "mesh", True)]
        elif choice.field is not None or not run.case.bodies:
            self.panels = [(choice.field or "speed", False)]
        else:
            self.panels = [("speed", False), ("mesh", True)]

    def pictures(self, steps: Sequence[int]) -> Iterator[Picture]:
        """A picture of each step."""
        around = window_on(self.run, steps)
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
        """What the panels show of a step."""
        tractions = any(name == "traction" for name, _ in self.panels) and bool(self.run.case.bodies)
        found = []
        for _, close in self.panels:
            gap = gap_at(self.run, step, self.sides, around) if close else None
            view = around if gap is None else gap.close_up(around)
            found.append((read_scene(self.run, step, view, tractions), gap))
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
            framed.append(Framed(panel.image(), title, seen.view.half, drawing.label, drawing.colours, norm))
        t = self.run.times[step]
        return compose(f"{self.run.case.name},  t = {t:.6g}", framed)

    def _title(self, gap: Gap) -> str:
        """Which gap, and how wide it is."""
        names = [*self.run.case.names, *self.run.case.container().walls]
        which = (
            "narrowest gap" if self.sides is None else f"gap {names[gap.sides[0]]} - {names[gap.sides[1]]}"
        )
        return f"{which}, {gap.width:.3g}"
