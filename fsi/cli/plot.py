"""`fsi plot`: curves over time, trajectories, and what benchmarks and calibrations have found."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import fsi.parallel as parallel
from fsi.cli.arguments import option, output_to, tell
from fsi.errors import InputError

if TYPE_CHECKING:
    from fsi.postprocess.plots.figure import Theme

EXAMPLE = "Example: fsi plot runs/settling_disc runs/settling_discs -o gaps.pdf"


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
        output_to(
            "A .png, .svg or .pdf file.", "history.png in the first run folder, or beside the file; paths.png"
        ),
    ] = None,
    gap: Annotated[
        str | None,
        option(
            "The gap between two bodies, or a body and a wall, by name or number from 0.",
            "the smallest gap of each body",
            metavar="A,B",
        ),
    ] = None,
    curves: Annotated[
        str | None,
        option(
            "What is drawn: some of gap, speed, load, x, y, z, angle (in space angle_x, ...), ...",
            "what the run has",
            metavar="NAMES",
        ),
    ] = None,
    paths: Annotated[bool, option("Draw the trajectories, with the bodies at both ends.", False)] = False,
    relative: Annotated[
        str | None,
        option("Draw the trajectory of body A as B sees it.", False, metavar="A,B"),
    ] = None,
    follow: Annotated[
        bool, option("Draw again after new steps, of a run that another process makes, until it ends.", False)
    ] = False,
    dark: Annotated[bool, option("Draw on a dark page.", False)] = False,
) -> None:
    """Draw gap, speed, load and apparent viscosity against time, or strain, several runs over each other.

    Of bodies that are no discs or spheres come the angles, where they turn.
    The folder of a calibration gives resistance against gap: samples, law and, where known, the exact curve.
    A single body that settles onto a plane comes with its exact law and that law's asymptote. A macroscopic
    run gives density, velocity and memory over x and t. The file that a benchmark writes with --json gives
    its CPU seconds against N.
    """
    from fsi.postprocess.plots.figure import DARK, LIGHT

    parallel.on_root(lambda: _require_sense(folders, gap, curves, paths=paths or relative is not None))
    theme = DARK if dark else LIGHT

    def draw() -> Path:
        if paths or relative is not None:
            return _paths(folders[0], output, relative, theme)
        return _of_file(folders, output, theme) or _histories(folders, output, gap, curves, theme)

    for _ in _looks(folders) if follow else range(1):
        tell(f"wrote {parallel.on_root(draw)}")


def _looks(folders: list[Path]) -> Iterator[None]:
    """Once when a run has begun, and after new steps, up to its end. Raises InputError: it is not one run."""
    from fsi.case.load import load_case
    from fsi.report.watch import arrivals
    from fsi.run_folder.kept import CASE, require_run

    if len(folders) > 1 or parallel.size() > 1:
        raise InputError("plot: --follow draws one run, in one process; drop it, or the others")
    require_run(folders[0])
    time = load_case(folders[0] / CASE).timing
    return (None for _ in arrivals(folders[0], time.end, time.contact_gap))


def _require_sense(folders: list[Path], gap: str | None, curves: str | None, *, paths: bool) -> None:
    """Raise InputError where options do not go together."""
    if paths and (gap is not None or curves is not None or len(folders) > 1):
        raise InputError("plot: --paths and --relative draw one run, without --gap and --curves")


def _paths(folder: Path, output: Path | None, relative: str | None, theme: "Theme") -> Path:
    """Trajectories; gives the file."""
    from fsi.postprocess.plots.trajectories import plot_paths
    from fsi.postprocess.run.run import open_run

    path = _output(output, folder / "paths.png")
    plot_paths(open_run(folder), path, relative, theme)
    return path


def _of_file(folders: list[Path], output: Path | None, theme: "Theme") -> Path | None:
    """What is not of runs: a calibration, or a benchmark; gives the file, None where there are runs."""
    from fsi.calibration.calibrate import SUMMARY
    from fsi.postprocess.plots.calibration import plot_calibration
    from fsi.postprocess.plots.scaling import plot_scaling

    if len(folders) > 1:
        return None
    if folders[0].suffix == ".json":
        path = _output(output, folders[0].with_suffix(".png"))
        plot_scaling(folders[0], path, theme)
        return path
    if (folders[0] / SUMMARY).is_file():
        path = _output(output, folders[0] / "calibration.png")
        plot_calibration(folders[0], path, theme)
        return path
    return None


def _histories(
    folders: list[Path], output: Path | None, gap: str | None, curves: str | None, theme: "Theme"
) -> Path:
    """Curves over time, or of a macroscopic run its profiles over x and t; gives the file."""
    from fsi.postprocess.plots.histories import plot_runs
    from fsi.postprocess.plots.trajectories import plot_space_time
    from fsi.postprocess.run.run import open_run

    path = _output(output, folders[0] / "history.png")
    runs = [open_run(folder) for folder in folders]
    if len(runs) == 1 and runs[0].series == "profile" and gap is None and curves is None:
        plot_space_time(runs[0], path, theme)
    else:
        plot_runs(runs, path, gap, curves, theme)
    return path


def _output(output: Path | None, beside: Path) -> Path:
    """Where a figure goes: beside what it is of if no path is given. Raises InputError: it is no figure's."""
    from fsi.postprocess.plots.figure import require_figure

    if output is not None:
        require_figure(output)
    return output or beside
