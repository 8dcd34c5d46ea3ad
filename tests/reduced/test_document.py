"""What docs/reduced.md says that `fsi compare` prints is what it prints."""

from __future__ import annotations

import re
from pathlib import Path

from tests.test_manual_output import call, require_printed

TEXT = (Path(__file__).parents[2] / "docs" / "reduced.md").read_text(encoding="utf-8")


def test_the_table_of_levels(tmp_path: Path) -> None:
    """All but the seconds, in the last column."""
    command, table = re.findall(r"`(fsi compare [^`]*)`[^\n]*\n(?:[^\n]+\n)*\n((?:    [^\n]+\n)+)", TEXT)[0]
    rows = [line.rsplit(maxsplit=1)[0] for line in table.splitlines()[1:]]
    assert [row.split()[0] for row in rows] == ["resolved", "pores", "reduced"]
    require_printed(rows, call(" ".join(command.split()), tmp_path))
