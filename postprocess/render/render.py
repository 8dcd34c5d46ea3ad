"""Pictures and animations of a run of any model."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Protocol

from fsi.errors import InputError
from fsi.postprocess.choice import Choice
from fsi.postprocess.render.animation import MOVIES, Picture, require_suffix, write_pictures
from fsi.postprocess.render.network import CONTACTS, NetworkArtist
from fsi.postprocess.render.opengl import require_opengl
from fsi.postprocess.render.planar import FlowArtist
from fsi.postprocess.render.spatial import SpatialArtist
from fsi.postprocess.run.run import Run


class Artist(Protocol):
    """Draws pictures of a run in one manner: the same windows, and the same colours for the same values."""

    series: str

    def require_fields(self, step: int) -> None:
        """Raise InputError where that step's files lack what is to be drawn."""

    def pictures(self, steps: Sequence[int]) -> Iterator[Picture]:
        """A picture of each step."""


def artist(run: Run, choice: Choice) -> Artist:
    """Who draws this run. Raises InputError: it has not what is chosen."""
    if run.model == "macroscopic":
        raise InputError(f'{run.path}: model = "macroscopic" has no bodies to draw; use fsi plot')
    if run.times.empty and (run.model != "resolved" or not run.times_of(CONTACTS).empty):
        return NetworkArtist(run, choice)
    return SpatialArtist(run, choice) if run.case.geometry == "spatial" else FlowArtist(run, choice)


def render_run(
    run: Run, output: Path, choice: Choice, step: int | None = None, time: float | None = None
) -> Path:
    """Draw a step (default: the last) into a PNG file, or all steps into an MP4 or GIF file.

    The step is given by its number, or as the one nearest to a time.

    Raises:
        InputError: no such field, gap or step, no fields in the run, no OpenGL here, or the disk refuses.
    """
    require_suffix(output)
    if choice.size < 100:
        raise InputError(f"--size {choice.size}: give at least 100 pixels")
    own = artist(run, choice)
    animated = output.suffix in MOVIES
    step = step if time is None else run.nearest(time, own.series)
    if animated and step is not None:
        raise InputError(f"output = {output}: shows all steps; give a .png file for one step")
    last = run.step(step, own.series)
    steps = [int(n) for n in run.times_of(own.series).index] if animated else [last]
    own.require_fields(steps[0])
    require_opengl()
    write_pictures(own.pictures(steps), output)
    return output
