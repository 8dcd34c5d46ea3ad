"""A small program of this package: `python -m postprocess.NAME RUN` prints a table and draws a plot."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

from rich.table import Table

from fsi.errors import FsiError
from fsi.report.console import standard_output


def program(usage: str | None, work: Callable[..., None], arguments: list[str], most: int = 1) -> int:
    """Call `work` with a folder and further arguments, up to `most` in all; the exit code.

    Without arguments, or with too many, it prints the usage; a mistake of the user is one line.
    """
    if not 1 <= len(arguments) <= most or arguments[0] in ("-h", "--help"):
        print(usage, file=sys.stderr)  # noqa: T201  (this is a program)
        return 2
    try:
        work(Path(arguments[0]), *arguments[1:])
    except FsiError as error:
        print(f"error: {error}", file=sys.stderr)  # noqa: T201
        return error.exit_code
    return 0


def say(table: Table, *lines: str) -> None:
    """Print a table and lines below it."""
    console = standard_output()
    console.print(table)
    for line in lines:
        console.print(line, highlight=False, soft_wrap=True)
