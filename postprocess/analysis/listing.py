"""Tables of analyses on a terminal."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rich.table import Table


def listed(title: str, headings: Sequence[str], rows: Iterable[Sequence[str]], words: str = "") -> Table:
    """A table of cells, numbers to the right, the column of that heading to the left."""
    table = Table(title=title)
    for heading in headings:
        table.add_column(heading, justify="left" if heading == words else "right")
    for row in rows:
        table.add_row(*row)
    return table
