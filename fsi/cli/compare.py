"""`fsi compare` and `fsi limit`: one case at several levels, and one gap as the viscosity vanishes."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import fsi.parallel as parallel
from fsi.cli.arguments import AsJson, CaseFile, Overrides, load, option, output_to, require_writable
from fsi.report.console import standard_output

if TYPE_CHECKING:
    from fsi.case.case import Case
    from fsi.comparison.instants import LevelAtInstant

EXAMPLE = "Example: fsi compare cases/levels.toml --levels resolved,reduced,gluey,macroscopic"
LIMIT_EXAMPLE = "Example: fsi limit cases/gluey/pushed_then_pulled.toml --output limit.png"


def compare(
    case_file: CaseFile,
    levels: Annotated[
        str, option("Levels, with commas between them; the first is what the others are compared with.")
    ] = "resolved,reduced",
    law: Annotated[
        str | None, option("The law of the reduced model: a name, or a law file.", "that of the case")
    ] = None,
    output: Annotated[Path | None, output_to("The folder.", "runs/<case file>_compared")] = None,
    as_json: AsJson = False,
    overrides: Overrides = None,
) -> None:
    """Run a case at several levels, and say how far they differ.

    First at time 0, of all levels that give velocities at an instant: apparent viscosity, velocities less
    the mean flow, spins, and rates of the narrowest gaps; a case without [time] is compared there alone.
    Then over time: smallest gaps, and apparent viscosities where two levels have them, in one picture.
    What is in the folder already is not run again; levels without a flow write all their steps, whatever
    output.interval is. Of the reduced level against the resolved one alone the rates of the gaps are compared
    too, at the same configurations; the picture then shows these and the smallest gap of each body.
    """
    from fsi.comparison.instants import compare_instants
    from fsi.comparison.levels import case_at_levels, require_motion, run_levels
    from fsi.files import json_text, require_folder
    from fsi.report.progress import ProgressBar

    case = load(case_file, overrides)
    folder = output or Path("runs") / f"{case_file.stem}_compared"
    path = str(Path(law).resolve()) if law is not None and Path(law).is_file() else law
    cases = parallel.on_root(lambda: case_at_levels(case, levels.split(","), path))
    parallel.on_root(lambda: require_motion(cases))
    parallel.on_root(lambda: require_folder(folder))
    at_once = compare_instants(cases)
    if case.time is not None:
        with ProgressBar() as bar:
            bar.begin(case.timing.end)
            run_levels(cases, folder, bar.show)
    data = parallel.on_root(lambda: _compare(cases, folder, at_once, quiet=as_json))
    if parallel.is_root() and as_json:
        typer.echo(json_text(data))
    elif parallel.is_root():
        typer.echo(f"wrote {folder}/comparison.json" + (" and .png" if case.time is not None else ""))


def _compare(
    cases: "dict[str, Case]", folder: Path, at_once: "dict[str, LevelAtInstant]", *, quiet: bool
) -> dict[str, Any]:
    """The instants, and the runs in a folder, on root: printed unless it is quiet, and kept as JSON."""
    from fsi.comparison.instants import instants_json
    from fsi.files import json_text, replace
    from fsi.report.studies import print_instants

    case, data = next(iter(cases.values())), instants_json(at_once)
    if at_once and not quiet:
        print_instants(standard_output(), case, at_once)
    if case.time is not None:
        data |= _compare_runs(cases, folder, quiet=quiet)
    folder.mkdir(parents=True, exist_ok=True)
    replace(folder / "comparison.json", (json_text(data) + "\n").encode())
    return data


def _compare_runs(cases: "dict[str, Case]", folder: Path, *, quiet: bool) -> dict[str, Any]:
    """The runs in a folder: what is printed unless it is quiet, and drawn."""
    from fsi.comparison.motion import History, compare_rates, comparison_json, rates_json, trajectories
    from fsi.comparison.viscosity import viscosities_json, viscosity_histories
    from fsi.postprocess.plots.studies import plot_comparison, plot_levels
    from fsi.postprocess.run.run import open_run
    from fsi.report.studies import print_rates, print_trajectories, print_viscosities

    runs = {level: open_run(folder / level) for level in cases}
    histories = {
        level: History.of_tables(case, runs[level].columns("bodies"), runs[level].columns("steps"))
        for level, case in cases.items()
    }
    paths = trajectories(cases, histories)
    data, picture = comparison_json(paths), folder / "comparison.png"
    viscosities = viscosity_histories({level: run.columns("steps") for level, run in runs.items()})
    if viscosities is not None:
        data |= viscosities_json(viscosities)
        if not quiet:
            print_viscosities(standard_output(), next(iter(cases.values())), viscosities)
    if set(cases) == {"resolved", "reduced"}:
        reduced = cases["reduced"]
        rates = compare_rates(reduced, histories["resolved"], histories["reduced"])
        data |= rates_json(reduced.names, reduced.reduced.law, rates)
        plot_comparison(reduced.names, rates, picture)
        if not quiet:
            print_rates(standard_output(), reduced, rates)
    else:
        plot_levels(runs, paths, viscosities, picture)
        if not quiet:
            print_trajectories(standard_output(), next(iter(cases.values())), paths)
    return data


def limit(
    case_file: CaseFile,
    output: Annotated[Path | None, output_to("A .png, .svg or .pdf file.", "none")] = None,
    overrides: Overrides = None,
) -> None:
    """Solve q'' = -eps q'/q + f, of one gap of a case, for ever smaller eps, and compare with the limit.

    Prints when the body sticks and is released, the errors for each eps, and the order of the slides' scheme.
    """
    from fsi.gluey.limit_study import study
    from fsi.postprocess.plots.figure import require_figure
    from fsi.postprocess.plots.studies import plot_limit
    from fsi.report.studies import print_study

    case = load(case_file, overrides)

    def work() -> None:
        if output is not None:
            require_figure(output)
            require_writable(output)
        found = study(case)
        print_study(standard_output(), found)
        if output is not None:
            plot_limit(case.name, found, output)
            typer.echo(f"{output}: written")

    parallel.on_root(work)
