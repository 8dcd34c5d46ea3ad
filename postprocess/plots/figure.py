"""What all figures share: their style, their colours, names and labels, and how they are saved."""

import textwrap
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, override

import matplotlib as mpl
import numpy as np
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import Formatter, LogLocator, MaxNLocator, NullFormatter

from fsi.errors import InputError
from fsi.files import appearing, require_suffix

# Okabe and Ito: told apart by every eye.
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")
BLUE, ORANGE, GREEN = COLOURS[:3]
GREY = "#999999"  # of exact curves, which lie broad below the others
STYLE: dict[Any, Any] = {
    "font.size": 11, "axes.titlesize": 12, "axes.titlelocation": "left", "legend.frameon": False,
    "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True, "grid.alpha": 0.3,
    "axes.formatter.useoffset": False,
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Theme:
    """The colours of a page: the page itself, ink, walls and other solids, discs, and spheres in space."""

    page: str
    ink: str
    solid: str
    disc: str
    sphere: str

    @property
    def style(self) -> dict[Any, Any]:
        """What matplotlib draws with."""
        inked = ("text.color", "axes.edgecolor", "axes.labelcolor", "xtick.color", "ytick.color")
        return (
            STYLE
            | dict.fromkeys(inked, self.ink)
            | {"figure.facecolor": self.page, "axes.facecolor": self.page}
        )


LIGHT = Theme("white", "#000000", "#c9c9c9", "#f3efe6", "#e8dfcf")
DARK = Theme("#16181c", "#e6e6e6", "#4a4d52", "#b9b4a9", "#c8c0b2")
SUFFIXES = (".png", ".svg", ".pdf")
_LABEL, _TITLE, _LINES = 30, 40, 3  # letters of a line: side by side they fit a figure; lines of a title
_FEWEST_DIGITS, _MOST_DIGITS = 6, 16  # of a label
_OFF = 1e-3  # how far a label may be off, over the distance of the next
_SHORT = 100.0  # ratio of the ends of an axis up to which steps in between have labels
_SHORTEST = 3.0  # the same up to which they are even: hardly any of the numbers 1, 2, 3, 5 lies between


@contextmanager
def saved_figure(
    path: Path, size: tuple[float, float], font: float = 11.0, dpi: int = 160, theme: Theme = LIGHT
) -> Iterator[Figure]:
    """A figure, size in inches, that is written to the path when all has been drawn.

    A file that was there before stays until the new one is complete. Raises InputError.
    """
    with mpl.rc_context(theme.style | {"font.size": font}):
        figure, kind = Figure(figsize=size, layout="constrained"), path.suffix.removeprefix(".")
        if kind not in figure.canvas.get_supported_filetypes():
            raise InputError(f"output = {path}: this suffix is of no picture; choose another path")
        yield figure
        try:
            with appearing(path) as partial:
                figure.savefig(partial, dpi=dpi, format=kind)
        except OSError as error:
            raise InputError(f"output = {path}: {error.strerror or error}; choose another path") from None


def plain(text: str) -> str:
    """A name that users give as matplotlib draws it letter by letter.

    What stands between two $ would be a formula, and legends leave out labels that begin with _.
    """
    return ("\u200b" if text.startswith("_") else "") + text.replace("$", r"\$")


def plain_title(text: str) -> str:
    """The same of a title in lines that end before a legend beside it; of a very long one the beginning."""
    return plain("\n".join(textwrap.wrap(text, _TITLE, max_lines=_LINES, placeholder=" …")))


def plain_labels(texts: Sequence[str]) -> list[str]:
    """The same of all labels of a legend: of long lines the middle is left out, and equal ones are numbered.

    Axes would have no room beside a legend as wide as such names. What is "run: curve" is two lines then.
    """
    brief = [_brief(text) for text in texts]
    numbers = [brief[: k + 1].count(label) for k, label in enumerate(brief)]
    return [
        plain(f"{label} ({number})" if brief.count(label) > 1 else label)
        for label, number in zip(brief, numbers, strict=True)
    ]


def _brief(text: str) -> str:
    """A label in lines that are not long."""
    broken = (line.replace(": ", ":\n", 1) if len(line) > _LABEL else line for line in text.split("\n"))
    return "\n".join(_without_middle(line) for lines in broken for line in lines.split("\n"))


def _without_middle(line: str) -> str:
    """A line, of a long one as much of its beginning as of its end."""
    kept = (_LABEL - 1) // 2
    return line if len(line) <= _LABEL else f"{line[:kept].rstrip()}…{line[-kept:].lstrip()}"


def require_figure(path: Path) -> None:
    """Raise InputError unless the path is that of a figure in a folder that exists."""
    require_suffix(path, *SUFFIXES)


class PlainNumbers(Formatter):
    """Labels with six digits, or as many as tell them apart, no common offset, and no hyphens for signs."""

    @override
    def __call__(self, x: float, pos: int | None = None) -> str:
        return self.fix_minus(f"{x:.6g}")

    @override
    def format_ticks(self, values: Sequence[float]) -> list[str]:
        apart = min(np.diff(np.sort(values)), default=np.abs(values).max(initial=0.0))
        for digits in range(_FEWEST_DIGITS, _MOST_DIGITS + 1):
            labels = [f"{value:.{digits}g}" for value in values]
            if np.all(np.abs(np.array(labels, dtype=float) - values) <= _OFF * apart):
                break
        return [self.fix_minus(label) for label in labels]


def label_short(axis: Axis) -> None:
    """Label a logarithmic axis, whose ends are set, with plain numbers if shorter than two decades.

    Labels are then 0.2, 0.5, 1, not 2 x 10^-1.
    """
    least, most = axis.get_view_interval()
    if most < _SHORT * least:
        subs = (1.0, 2.0, 3.0, 5.0) if most < 10.0 * least else (1.0, 2.0, 5.0)
        axis.set_major_locator(MaxNLocator(4) if most < _SHORTEST * least else LogLocator(subs=subs))
        axis.set_major_formatter(PlainNumbers())
        axis.set_minor_formatter(NullFormatter())
