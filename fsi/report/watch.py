"""`fsi watch`: the steps of a run as lines, while another process makes it."""

import time
from collections.abc import Iterator, Mapping
from math import inf, nan
from pathlib import Path
from zlib import crc32

from rich.console import Console

from fsi.case.arguments import told_as
from fsi.errors import InputError
from fsi.files import content
from fsi.run_folder.checkpoint import read_checkpoint
from fsi.run_folder.kept import REMEDY, STATE, STEPS, disk, require_as_begun, require_commit_of
from fsi.run_folder.tables import STEP_COLUMNS

PAUSE = 1.0  # seconds between two looks


def follow(console: Console, folder: Path, end: float, contact_gap: float | None, *, once: bool) -> None:
    """Print a line for each step up to the end of time, or to contact; once: for those that are there.

    Raises InputError as `complete_rows`, and where someone has changed the case.
    """
    spent = 0.0
    with told_as("run"):
        require_as_begun(folder)
        for rows in arrivals(folder, end, contact_gap, once=once):
            for row in rows:
                spent += row.get("cpu_step", nan)
                console.print(line(row, end, spent), highlight=False)


def arrivals(
    folder: Path, end: float, contact_gap: float | None, *, once: bool = False
) -> Iterator[list[dict[str, float]]]:
    """The new rows of steps.csv, look by look, at least one each; the last with the end of the run.

    Raises InputError as `complete_rows`.
    """
    seen = 0
    while True:
        new = complete_rows(folder)[seen:]
        seen += len(new)
        if new:
            yield new
        over = (row["t"] >= end or row["smallest_gap"] <= (contact_gap or -inf) for row in new)
        if once or any(over):
            return
        time.sleep(PAUSE)


def complete_rows(folder: Path) -> list[dict[str, float]]:
    """The rows of steps.csv up to its last line end: what comes after is being written.

    Raises InputError: they are fewer than the run has committed, not as it has written them, or of another
    run.
    """
    table = folder / STEPS
    with disk(folder, InputError, REMEDY):
        # The state first: the run commits what the table has already.
        least, checksum = _committed(folder)
        text = content(table, REMEDY) if least or table.is_file() else b""
        if len(text) < least:
            raise ValueError(f"{STEPS}: {least - len(text)} bytes are missing at its end")
        try:
            rows = _rows(text[: text.rfind(b"\n") + 1].decode())
        except ValueError as error:
            raise ValueError(f"{STEPS}: {error}") from None
        if checksum not in (None, crc32(text[:least])):
            raise ValueError(f"{STEPS}: its rows are others than were written")
        return rows


def _committed(folder: Path) -> tuple[int, int | None]:
    """How many bytes of steps.csv a run has committed, and their CRC-32, which older runs do not keep.

    Raises InputError, ValueError: the commit is of another run, or damaged.
    """
    if not (folder / STATE).is_file():
        return 0, None
    checkpoint = read_checkpoint(folder / STATE)
    require_commit_of(folder, checkpoint)
    return checkpoint.lengths.get(STEPS, 0), checkpoint.sums.get(STEPS)


def _rows(text: str) -> list[dict[str, float]]:
    """The rows of a table of steps. Raises ValueError: its header is another, or not all are numbers."""
    header, *rows = [each.split(",") for each in text.splitlines()] or [list(STEP_COLUMNS)]
    if tuple(header[: len(STEP_COLUMNS)]) != STEP_COLUMNS:
        raise ValueError(f"does not begin with the columns {', '.join(STEP_COLUMNS)}")
    if any(len(row) != len(header) for row in rows):
        raise ValueError("rows are not of one width")
    return [dict(zip(header, map(float, row), strict=True)) for row in rows]


def line(row: Mapping[str, float], end: float, spent: float) -> str:
    """A step, the part of the time that it has reached, and the CPU seconds that the rest may take."""
    t = row["t"]
    parts = [f"step {row['step']:.0f}", f"t = {t:.4g} of {end:g}", f"smallest gap {row['smallest_gap']:.3e}"]
    if "apparent_viscosity" in row:
        parts.append(f"apparent viscosity {row['apparent_viscosity']:.5g}")
    if 0.0 < t < end:
        parts.append(f"some {spent * (end - t) / t:.0f} CPU s left")
    return "  ".join(parts)
