"""`fsi render`: pictures and animations of a run."""

from pathlib import Path
from typing import Annotated

import fsi.parallel as parallel
from fsi.cli.arguments import RunFolder, Step, numbers, option, output_to, tell
from fsi.errors import InputError
from fsi.postprocess.render.fields import field_names

EXAMPLE = "Example: fsi render runs/settling_disc --field dissipation --gap disc,plane -o gap.mp4"


def render(
    folder: RunFolder,
    output: Annotated[
        Path | None,
        output_to(".png: one step; .mp4 or .gif: all of them.", "flow.png in the run folder"),
    ] = None,
    field: Annotated[
        str | None, option(f"{', '.join(field_names())}; of contacts or profiles a column.", False)
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
    size: Annotated[int, option("Pixels of a panel's side.")] = 1000,
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
    ends = None
    if span is not None:
        low, high = numbers("--range", span, 2)
        if not low < high:
            raise InputError(f"--range {span}: give the lower end first")
        ends = low, high

    def draw() -> Path:
        choice = Choice(field, gap, ends, size)
        return render_run(open_run(folder), output or folder / "flow.png", choice, step, time)

    picture = parallel.on_root(draw)
    tell(f"wrote {picture}")
