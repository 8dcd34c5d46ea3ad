"""`fsi cases`, `fsi check`, `fsi keys`: the cases to begin with, what a case holds, and what it may."""

import shlex
import shutil
import tempfile
from pathlib import Path
from typing import Annotated

import typer

import fsi.parallel as parallel
from fsi.cli.arguments import CaseFile, Overrides, load, tell
from fsi.errors import InputError
from fsi.report.console import standard_output

EXAMPLE = "Example: fsi cases, then fsi run cases/settling_disc.toml"
CHECK_EXAMPLE = "Example: fsi check cases/two_discs.toml --set 'bodies.0.position=[-1.5, 0.0]'"
KEYS_EXAMPLE = "Example: fsi keys gluey"

_CASES = Path(__file__).parents[1] / "cases"


def shipped_cases() -> Path:
    """The folder of the cases. Raises InputError."""
    if (_CASES / "validation").is_dir():
        return _CASES
    raise InputError(f"{_CASES.parent}: the program has come without its cases; install it anew")


def write_cases(folder: Path) -> int:
    """Copy them into a new folder, all or none; gives the number of case files.

    Raises InputError: it is there already; OSError, with its name: the disk refuses.
    """
    if folder.exists():
        raise InputError(f"folder = {folder}: is there already; give the name of a new one")
    source = shipped_cases()
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=".cases-", dir=folder.parent) as beside:
            copied = Path(beside) / "cases"
            _copy(source, copied)
            copied.rename(folder)
    except OSError as error:
        raise OSError(error.errno, error.strerror, str(folder)) from None
    return len(list(folder.rglob("*.toml")))


def _copy(source: Path, target: Path) -> None:
    """Copy a folder. Raises OSError at the first refusal: that of shutil.copytree has no number."""
    target.mkdir()
    for path in source.iterdir():
        if path.is_dir():
            _copy(path, target / path.name)
        else:
            shutil.copy2(path, target / path.name)


def cases(
    folder: Annotated[Path, typer.Argument(metavar="FOLDER", help="A new folder.")] = Path("cases"),
) -> None:
    """Write the cases that come with the program into a folder: examples, validation, calibration."""
    count = parallel.on_root(lambda: write_cases(folder))
    first = shlex.join(["fsi", "run", str(folder / "settling_disc.toml")])
    tell(f"wrote {count} cases to {folder}; begin with: {first}")


def check(case_file: CaseFile, overrides: Overrides = None) -> None:
    """Read a case and say what it holds: bodies, gaps, what is free or held, walls. Nothing is computed."""
    runs = Path("runs")  # where `fsi run` and `fsi calibrate` write if no folder is given
    case = load(case_file, overrides, runs)
    from fsi.case.checks.expected import check_expected
    from fsi.case.checks.own_mesh import check_mesh_file
    from fsi.case.checks.work import require_room_for_samples

    if not case.level.viscous:
        _ = case.timing  # all that such a case is for: it has no instant
    check_expected(case)
    parallel.on_root(lambda: require_room_for_samples(case, runs))
    parallel.on_root(lambda: check_mesh_file(case))
    if case.model == "reduced":
        from fsi.reduced.gap_laws import require_laws

        parallel.on_root(lambda: require_laws(case))
    if parallel.is_root():
        from fsi.report.case import print_case

        print_case(standard_output(), case)


def keys(
    section: Annotated[
        str | None,
        typer.Argument(metavar="SECTION", help="time, gluey, macroscopic.blocks ...", show_default="all"),
    ] = None,
    markdown: Annotated[
        bool, typer.Option("--markdown", help="Print the page of the documentation.")
    ] = False,
) -> None:
    """Print the keys of the case file with their meaning and what holds if they are not given."""
    from rich.table import Table

    from fsi.case.reference import as_markdown, sections_of_case

    sections = [each for each in sections_of_case() if section is None or f"[{section}]" in each.title]
    if not sections:
        raise InputError(f"SECTION {section}: there is no such section; `fsi keys` without one prints all")
    if not parallel.is_root():
        return
    if markdown:
        typer.echo(as_markdown(sections))
        return
    for each in sections:
        title = each.title.replace("`", "") or "above all sections"
        table = Table("key", "meaning", "if not given", title=title, title_justify="left")
        for key in each.keys:
            table.add_row(key.name, key.meaning, key.default)
        standard_output().print(table, highlight=False)
