"""Where the commands print their tables, and what these have in common."""

import os
import sys
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, override

from rich.console import Console
from rich.table import Table

import fsi.parallel as parallel

# Of the widest table: without a terminal rich would cut numbers to fit 80 columns.
WIDTH = 140


class _Lasting(Console):
    """A console that falls silent where its reader has gone, as `head` does; the command goes on."""

    @override
    def on_broken_pipe(self) -> None:
        self.quiet = True
        with Path(os.devnull).open("wb") as nowhere:  # takes what is still to be written
            os.dup2(nowhere.fileno(), self.file.fileno())


def standard_output() -> Console:
    """Standard output, as wide as the terminal or as COLUMNS says; without either, wide enough."""
    known = sys.stdout.isatty() or "COLUMNS" in os.environ
    return _Lasting(width=None if known else WIDTH)


def standard_error() -> Console:
    """Standard error, silent on all ranks but root."""
    return _Lasting(stderr=True, quiet=not parallel.is_root())


def table(
    words: Sequence[str], numbers: Sequence[str], rows: Iterable[Sequence[str]] = (), **style: Any
) -> Table:
    """A table of columns of words, then of columns of numbers, which stand to the right; style: of rich."""
    with_rows = Table(*words, **style)
    for heading in numbers:
        with_rows.add_column(heading, justify="right", overflow="fold")
    for row in rows:
        with_rows.add_row(*row)
    return with_rows


def checks_table(heading: str, checks: Mapping[str, float]) -> Table:
    """Relative numbers that should be small."""
    return table((heading,), ("value",), ((name, f"{value:.1e}") for name, value in checks.items()))
