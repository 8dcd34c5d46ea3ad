"""Pictures and animations of a run of any model."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from math import isfinite
from pathlib import Path

from fsi.errors import InputError
from fsi.files import require_suffix
from fsi.postprocess.render.canvas import Picture
from fsi.postprocess.render.meridian import MeridianArtist
from fsi.postprocess.render.network import NECKS, NeckArtist, NetworkArtist
from fsi.postprocess.render.picture import MOVIES, STILLS, Artist, write_pictures
from fsi.postprocess.render.planar import PlanarArtist
from fsi.postprocess.render.profile import ProfileArtist
from fsi.postprocess.render.revolved import RevolvedArtist
from fsi.postprocess.render.spatial import SpatialArtist
from fsi.postprocess.render.suspended import MOTION, MotionArtist
from fsi.postprocess.render.view import Choice
from fsi.postprocess.run.run import Run
from fsi.report.progress import counting


def artist(run: Run, choice: Choice) -> Artist:
    """Who draws this run. Raises InputError: it has not what is chosen."""
    if choice.field == NECKS and run.has(NECKS):
        return NeckArtist(run, replace(choice, field=None))
    require_sense(run, choice)
    if choice.field == MOTION:
        return MotionArtist(run, choice)
    if choice.revolved:
        return RevolvedArtist(run, choice)
    if run.series != "fluid":
        return NetworkArtist(run, choice) if run.series == "bodies" else ProfileArtist(run, choice)
    flow = {"planar": PlanarArtist, "axisymmetric": MeridianArtist, "spatial": SpatialArtist}
    return flow[run.case.geometry](run, choice)


def require_sense(run: Run, choice: Choice) -> None:
    """Raise InputError where a choice is for other runs."""
    if choice.plane is not None and (run.series != "fluid" or run.case.geometry != "spatial"):
        raise InputError(f"--plane {choice.plane}: is for flows in space; this run has none")
    if choice.revolved and not (run.series == "fluid" and run.case.axisymmetric):
        raise InputError("--revolved: is for axisymmetric flows; this run has none")


def render_run(
    run: Run, output: Path, choice: Choice, step: int | None = None, time: float | None = None
) -> Path:
    """Draw a step (default: the last) into a PNG file, or all steps into an MP4 or GIF file.

    The step is given by its number, or as the one nearest to a time.

    Raises InputError: no such field, gap or step, no fields in the run, no OpenGL here, or the disk refuses.
    """
    require_suffix(output, *STILLS, *MOVIES)
    if choice.size < 100:
        raise InputError(f"--size {choice.size}: give at least 100 pixels")
    if time is not None and not isfinite(time):
        raise InputError(f"--time {time:g}: give a finite number")
    painter = artist(run, choice)
    animated = output.suffix in MOVIES
    if time is not None:
        painter.step(None)
        step = int((painter.times - time).abs().idxmin())
    if animated and step is not None:
        raise InputError(f"output = {output}: shows all steps; give a .png file for one step")
    last = painter.step(step)
    steps = painter.film if animated else [last]
    painter.require(steps[0])
    pictures = painter.pictures(steps)
    if animated:
        with counting("pictures") as show:
            write_pictures(_counted(pictures, lambda n: show(n, len(steps))), output)
    else:
        write_pictures(pictures, output)
    return output


def _counted(pictures: Iterable[Picture], show: Callable[[int], None]) -> Iterator[Picture]:
    """The pictures, after each of which `show` is told how many there are."""
    for n, picture in enumerate(pictures, 1):
        show(n)
        yield picture
