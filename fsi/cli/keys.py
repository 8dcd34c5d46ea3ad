"""`fsi keys`: every key of the case file."""

from typing import Annotated

import typer

import fsi.parallel as parallel
from fsi.errors import InputError
from fsi.report.console import standard_output

EXAMPLE = "Example: fsi keys gluey"


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
        standard_output().print(table, highlight=False, markup=False)
