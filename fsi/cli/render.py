"""`fsi render`: pictures of fields and bodies."""

from pathlib import Path
from typing import Annotated

import fsi.parallel as parallel
from fsi.cli.arguments import RunFolder, Step, numbers, option, output_to, tell
from fsi.errors import InputError
from fsi.machine.resources import require_memory
from fsi.postprocess.render.fields import field_names

_LARGEST = 1e30  # end of colours, and one over their least span: those of VTK are single numbers
_PIXEL_BYTES = 400.0  # of a pixel of a panel: two panels, drawn at a multiple of their size, and copies
EXAMPLE = "Example: fsi render runs/settling_disc --field dissipation --gap disc,plane -o gap.mp4"


def render(
    folder: RunFolder,
    output: Annotated[
        Path | None,
        output_to(".png: one step; .mp4 or .gif: all of them.", "flow.png in the run folder"),
    ] = None,
    field: Annotated[
        str | None,
        option(f"{', '.join(field_names())}; motion, necks; of contacts or profiles a column.", False),
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
    size: Annotated[int, option("Pixels of a panel's width.", min=100)] = 1000,
    plane: Annotated[
        str | None,
        option(
            "In space, on which plane a field of the fluid is shown.",
            "y = that of the bodies",
            metavar="x=X|y=Y|z=Z",
        ),
    ] = None,
    revolved: Annotated[
        bool, option("Show an axisymmetric flow in space, turned half around its axis.")
    ] = False,
    dark: Annotated[bool, option("Draw on a dark page.")] = False,
) -> None:
    """Draw a run: speed, streamlines, and the mesh in the narrowest gap, or the field of your choice.

    In a sheared flow that is the velocity less the mean flow, with its streamlines. Axisymmetric flows are
    mirrored at their axis. Of flows in space the spheres are shown with their traction, and a field on a
    plane, for a gap the one that holds the line of centres. Reduced and gluey runs show their contacts,
    macroscopic ones their profiles.
    """
    from fsi.postprocess.render.render import render_run
    from fsi.postprocess.render.view import Choice
    from fsi.postprocess.run.run import open_run

    if time is not None and step is not None:
        raise InputError("render: give --time or --step, not both")
    require_memory(
        f"--size {size}: {float(size) ** 2:.3g} pixels", _PIXEL_BYTES * float(size) ** 2, "give fewer"
    )
    ends = None if span is None else _ends(span)

    def draw() -> Path:
        choice = Choice(field, gap, ends, size, plane, revolved, dark)
        return render_run(open_run(folder), output or folder / "flow.png", choice, step, time)

    picture = parallel.on_root(draw)
    tell(f"wrote {picture}")


def _ends(span: str) -> tuple[float, float]:
    """The ends of the colours, of the text that the option was given. Raises InputError."""
    low, high = numbers("--range", span, 2)
    if not low < high:
        raise InputError(f"--range {span}: give the lower end first")
    if max(-low, high) > _LARGEST:
        raise InputError(f"--range {span}: colours end at {_LARGEST:g}; give smaller numbers")
    if high - low < 1.0 / _LARGEST:
        raise InputError(
            f"--range {span}: colours span {1.0 / _LARGEST:g} or more; give ends that are farther apart"
        )
    return low, high
