"""The command `fsi compare`: a case run with both models, into one folder."""

from __future__ import annotations

import json
from pathlib import Path

from rich.console import Console
from rich.table import Table

from fsi import parallel
from fsi.case.case import Case, load_case, parse_case
from fsi.comparison import LIMITS, PART, Comparison, History, compare, comparison_json
from fsi.errors import InputError
from fsi.models import make_model
from fsi.run import Progress, no_progress, resume_run, run_case
from fsi.run_folder.checkpoint import replace


def compare_models(
    case: Case, law: str, folder: Path, progress: Progress = no_progress
) -> tuple[Comparison, dict[str, object]]:
    """Run both models, or go on with what is in the folder, and compare them; collective.

    Writes the run folders `resolved` and `reduced`, and `comparison.json` and `.png`.

    Returns:
        the comparison, and it as a JSON object.

    Raises:
        InputError: the case is not one for both models, or the folder holds another one; nothing is written.
        SolveError: a run cannot go on.
    """
    data = case.model_dump(exclude_none=True)
    given = data["reduced"] | {"law": law}
    cases = {
        "resolved": parse_case(data | {"model": "resolved", "reduced": given}),
        "reduced": parse_case(data | {"model": "reduced", "reduced": given}),
    }
    for name, each in cases.items():
        parallel.on_root(lambda name=name, each=each: _require_same(folder / name, each))  # type: ignore[misc]
    parallel.on_root(lambda: folder.mkdir(parents=True, exist_ok=True))
    for name, each in cases.items():
        if (folder / name).exists():
            resume_run(folder / name, make_model, progress)
        else:
            run_case(each, folder / name, make_model(each), progress)
    return parallel.on_root(lambda: _compare_folders(cases["reduced"], folder))


def _require_same(folder: Path, case: Case) -> None:
    """A run that is there already must be one of this case."""
    if folder.exists() and load_case(folder / "case.toml") != case:
        raise InputError(f"output = {folder}: holds the run of another case; give a new folder")


def _compare_folders(case: Case, folder: Path) -> tuple[Comparison, dict[str, object]]:
    from fsi.postprocess.plots.comparison import plot_comparison
    from fsi.postprocess.run.run import open_run

    resolved, reduced = (
        History.of_table(case, open_run(folder / name).columns("bodies")) for name in ("resolved", "reduced")
    )
    found = compare(case, resolved, reduced)
    data = comparison_json(case.names, case.reduced.law, found)
    replace(folder / "comparison.json", (json.dumps(data) + "\n").encode())
    plot_comparison(case.names, found, folder / "comparison.png")
    return found, data


def print_comparison(console: Console, case: Case, found: Comparison) -> None:
    """The table of the bodies, and from which gap on the reduced model may be trusted."""
    table = Table("body", title=f"{case.name}: reduced against resolved", title_justify="left")
    for heading in ("largest dV / V", "dV / V at the end", "gap at the end", "reduced", "largest dD / D"):
        table.add_column(heading, justify="right")
    for name, row in zip(case.names, found.bodies(), strict=True):
        table.add_row(
            name,
            f"{row['velocity_difference']:.2g}",
            f"{row['final_velocity_difference']:.2g}",
            f"{row['final_gap']:.4g}",
            f"{row['final_reduced_gap']:.4g}",
            f"{row['gap_difference']:.2g}",
        )
    console.print(table)
    for limit in LIMITS:
        gap = found.good_below(limit)
        where = "at no sampled gap" if gap is None else f"for gaps up to {gap:.3g}"
        console.print(
            f"rate of the gap within {limit:.0%} {where} ({PART:.0%} of the samples)", highlight=False
        )
