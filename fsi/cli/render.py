"""`fsi render` and `fsi plot`: pictures of fields and bodies, and curves over time."""

from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer

import fsi.parallel as parallel
from fsi.cli.arguments import RunFolder, Step, numbers, option, output_to, tell
from fsi.errors import InputError
from fsi.machine import require_memory
from fsi.postprocess.render.fields import field_names

_LARGEST = 1e30  # end of colours: those of VTK are single numbers
_PIXEL_BYTES = 400.0  # of a pixel of a panel: two panels, drawn at a multiple of their size, and copies
EXAMPLE = "Example: fsi render runs/settling_disc --field dissipation --gap disc,plane -o gap.mp4"
PLOT_EXAMPLE = "Example: fsi plot runs/settling_disc runs/settling_discs -o gaps.pdf"


def render(
    folder: RunFolder,
    output: Annotated[
        Path | None,
        output_to(".png: one step; .mp4 or .gif: all of them.", "flow.png in the run folder"),
    ] = None,
    field: Annotated[
        str | None, option(f"{', '.join(field_names())}; necks; of contacts or profiles a column.", False)
    ] = None,
    gap: Annotated[
        str | None,
        option(
            "Zoom into the gap between two bodies, or a body and a wall, by name or number from 0.",
            False,
            metavar="A,B",
        ),
    ] = None,
    time: Annotated[float | None, option("Draw the step nearest to this time.", False)] = None,
    step: Step = None,
    span: Annotated[
        str | None, option("What the colours span.", False, "--range", metavar="LOW,HIGH")
    ] = None,
    size: Annotated[int, option("Pixels of a panel's side.", min=50)] = 1000,
) -> None:
    """Draw a run: speed, streamlines, and the mesh in the narrowest gap, or the field of your choice.

    Axisymmetric flows are mirrored at their axis. Flows in space are shown on a vertical plane, gaps on
    the one that holds the line of centres. Reduced and gluey runs show their contacts, macroscopic ones their
    profiles.
    """
    from fsi.postprocess.render.render import render_run
    from fsi.postprocess.render.view import Choice
    from fsi.postprocess.run.run import open_run

    if time is not None and step is not None:
        raise InputError("render: give --time or --step, not both")
    require_memory(
        f"--size {size}: {float(size) ** 2:.3g} pixels", _PIXEL_BYTES * float(size) ** 2, "give fewer"
    )
    ends = None
    if span is not None:
        low, high = numbers("--range", span, 2)
        if not low < high:
            raise InputError(f"--range {span}: give the lower end first")
        if max(-low, high) > _LARGEST:
            raise InputError(f"--range {span}: colours end at {_LARGEST:g}; give smaller numbers")
        ends = low, high

    def draw() -> Path:
        choice = Choice(field, gap, ends, size)
        return render_run(open_run(folder), output or folder / "flow.png", choice, step, time)

    picture = parallel.on_root(draw)
    tell(f"wrote {picture}")


def plot(
    folders: Annotated[
        list[Path],
        typer.Argument(
            metavar="RUN...",
            help="Folders made by fsi run or fsi calibrate, or one file.",
            show_default=False,
        ),
    ],
    output: Annotated[
        Path | None,
        output_to("A .png, .svg or .pdf file.", "history.png in the first run folder, or beside the file"),
    ] = None,
    gap: Annotated[
        str | None,
        option(
            "The gap between two bodies, or a body and a wall, by name or number from 0.",
            "the smallest gap of each body",
            metavar="A,B",
        ),
    ] = None,
) -> None:
    """Draw gap, speed, load and apparent viscosity against time, or strain, several runs over each other.

    The folder of a calibration gives resistance against gap: samples, law and, where known, the exact curve.
    A single body that settles onto a plane comes with its exact law and that law's asymptote. The file that a
    benchmark writes with --json gives its CPU seconds against N.
    """
    from fsi.calibration.calibrate import SUMMARY
    from fsi.files import require_suffix
    from fsi.postprocess.plots.calibration import plot_calibration
    from fsi.postprocess.plots.figure import SUFFIXES
    from fsi.postprocess.plots.histories import plot_runs
    from fsi.postprocess.plots.scaling import plot_scaling
    from fsi.postprocess.run.run import open_run

    calibrated = parallel.on_root(lambda: len(folders) == 1 and (folders[0] / SUMMARY).is_file())
    draw: Callable[[Path, Path], None] | None = None
    if len(folders) == 1 and folders[0].suffix == ".json":
        path, draw = folders[0].with_suffix(".png"), plot_scaling
    elif calibrated:
        path, draw = folders[0] / "calibration.png", plot_calibration
    else:
        path = folders[0] / "history.png"
    path = output or path
    parallel.on_root(lambda: require_suffix(path, *SUFFIXES))
    if draw is not None:
        parallel.on_root(lambda: draw(folders[0], path))
    else:
        parallel.on_root(lambda: plot_runs([open_run(folder) for folder in folders], path, gap))
    tell(f"wrote {path}")
