"""Where the commands print their tables, and what these have in common."""

import os
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, override

from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, RenderableType, RenderResult
from rich.style import StyleType
from rich.table import Column, Table
from rich.text import Text

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
    """Standard output, as wide as the terminal or as COLUMNS says; without either, wide enough.

    What is printed is no markup and has no emoji: names may have brackets and colons.
    """
    known = sys.stdout.isatty() or "COLUMNS" in os.environ
    return _Lasting(width=None if known else WIDTH, markup=False, emoji=False)


def standard_error() -> Console:
    """Standard error, silent on all ranks but root."""
    return _Lasting(stderr=True, quiet=not parallel.is_root(), markup=False, emoji=False)


class FittingTable(Table):
    """A table that breaks no number and no word: what is too wide goes on below, led by the same columns.

    led_by: how many columns lead each part; fewer where they leave no room for a number.
    """

    led_by = 1

    @override
    def add_row(
        self, *cells: RenderableType | None, style: StyleType | None = None, end_section: bool = False
    ) -> None:
        """Words as they are: brackets in the name of a body are no markup."""
        plain = (Text(cell) if isinstance(cell, str) else cell for cell in cells)
        super().add_row(*plain, style=style, end_section=end_section)

    @override
    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        narrow, wide = zip(*map(_widths, self.columns), strict=True)
        leading = self.led_by
        while leading and _total((*narrow[:leading], max(narrow[leading:]))) > options.max_width:
            leading -= 1
        parts: list[list[int]] = [[]]
        for k in range(leading, len(self.columns)):
            if (
                parts[-1]
                and _total([narrow[j] for j in (*range(leading), *parts[-1], k)]) > options.max_width
            ):
                parts.append([])
            parts[-1].append(k)
        for part in parts:
            chosen = [*range(leading), *part]
            free = max(options.max_width - _total([narrow[k] for k in chosen]), 0)
            widths = {}
            for k in chosen:
                widths[k] = min(wide[k], narrow[k] + free)
                free -= widths[k] - narrow[k]
            shown = Table(box=self.box, padding=self.padding, title_justify=self.title_justify)
            shown.title = self.title if part is parts[0] else None
            shown.caption = self.caption if part is parts[-1] else None
            shown.columns = [
                replace(self.columns[k], _index=i, width=widths[k], overflow="fold")
                for i, k in enumerate(chosen)
            ]
            shown.rows = self.rows
            yield from Table.__rich_console__(shown, console, options)


def _widths(column: Column) -> tuple[int, int]:
    """The longest word and the longest line of a column, whose numbers are words.

    Rich would measure each cell once more where it is not told: two thirds of the time of a long table.
    """
    lines = [line for cell in (column.header, *column.cells) for line in str(cell).splitlines()]
    words = {word for line in lines for word in line.split()}
    return max(map(cell_len, words), default=0), max(map(cell_len, lines), default=0)


def _total(widths: Sequence[int]) -> int:
    """With a margin on both sides of each column, and lines around."""
    return sum(widths) + 3 * len(widths) + 1


def table(
    words: Sequence[str], numbers: Sequence[str], rows: Iterable[Sequence[str]] = (), **style: Any
) -> FittingTable:
    """A table of columns of words, then of columns of numbers, which stand to the right; style: of rich."""
    with_rows = FittingTable(*words, **style)
    with_rows.led_by = max(len(words), 1) if numbers else 1
    for heading in numbers:
        with_rows.add_column(heading, justify="right", no_wrap=True)
    for row in rows:
        with_rows.add_row(*row)
    return with_rows


def checks_table(heading: str, checks: Mapping[str, float]) -> Table:
    """Relative numbers that should be small."""
    return table((heading,), ("value",), ((name, f"{value:.1e}") for name, value in checks.items()))


def print_mesh_instead(console: Console, size: str) -> None:
    """Say which size was taken where those of the case gave no valid mesh; nothing where they did, ""."""
    if size:
        console.print(f"the sizes of the case gave no valid mesh; taken: {size}", soft_wrap=True)
