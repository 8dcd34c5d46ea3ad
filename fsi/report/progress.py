"""Progress on a terminal: of a run its time, smallest gap and time left; of other things their number."""

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Self, override

import numpy as np
from rich.console import Console
from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeRemainingColumn
from rich.table import Column

import fsi.parallel as parallel
from fsi.integration.state import StepRecord

# A short bar of 6, "100 %", "0:00:00" and blanks between: the text of a run fits into 80 with them.
_BESIDE = 21


@contextmanager
def counting(what: str) -> Iterator[Callable[[int, int], None]]:
    """Yields `show(there, all)`, which shows how many there are of what is counted."""
    with _new_bar() as bar:
        task = bar.add_task(what, total=None)
        described = f"{{}} of {{}} {what}".format
        yield lambda n, total: bar.update(task, completed=n, total=total, description=described(n, total))


def _new_bar(*, quiet: bool = False) -> Progress:
    """A bar that is silent on all ranks but root, and where stderr is neither a terminal nor a notebook's."""
    console = Console(stderr=True)
    terminal = sys.stderr is not None and sys.stderr.isatty()  # it is None where nobody reads
    shown = not quiet and parallel.is_root() and (terminal or console.is_jupyter)
    part = TextColumn("{task.percentage:.0f} %")
    columns = (_Description(console), BarColumn(), part, TimeRemainingColumn())
    return Progress(*columns, console=console, disable=not shown)


class _Description(TextColumn):
    """What is done, cut off where a narrow terminal has no room for it beside the bar."""

    def __init__(self, console: Console) -> None:
        super().__init__("{task.description}")
        self._console = console

    @override
    def get_table_column(self) -> Column:
        return Column(no_wrap=True, max_width=max(self._console.width - _BESIDE, 1))


class ProgressBar:
    """A context in which `show` follows a run; silent on all ranks but root and where stderr is no terminal.

    elapsed: wall-clock seconds.
    """

    def __init__(self, *, quiet: bool = False) -> None:
        self._began = time.monotonic()
        self._bar = _new_bar(quiet=quiet)
        self._task: TaskID = self._bar.add_task("first mesh", total=None)

    @property
    def elapsed(self) -> float:
        """Wall-clock seconds since the beginning."""
        return time.monotonic() - self._began

    def begin(self, end: float | None) -> None:
        """Take the end of time."""
        self._bar.update(self._task, total=end)

    def show(self, record: StepRecord) -> None:
        """Show an accepted step."""
        d = record.q.dimension
        fastest = float(np.linalg.norm(record.U[:, :d], axis=1).max(initial=0.0))
        text = f"step {record.step}  t = {record.t:.4g}  smallest gap {record.smallest_gap:.3e}"
        text += f"  fastest {fastest:.3g}"
        self._bar.update(self._task, completed=record.t, description=text)

    def __enter__(self) -> Self:
        self._bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._bar.stop()
