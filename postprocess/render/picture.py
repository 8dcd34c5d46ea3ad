"""Pictures: who draws a run, panels under a title with colour bars and scale bars, and how they become files.

One picture is written as PNG, many as MP4 or GIF, each to a temporary name that is then renamed.
"""

from __future__ import annotations

import subprocess
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any, ClassVar, Literal

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colorbar import Colorbar
from matplotlib.colors import LogNorm, SymLogNorm
from matplotlib.figure import Figure
from PIL import Image

from fsi.bodies.surface_gap import SurfaceGap, gap_between
from fsi.errors import InputError
from fsi.files import unfinished
from fsi.postprocess.plots.figure import LIGHT, PlainNumbers, Theme, label_short, plain
from fsi.postprocess.render.canvas import Picture, require_opengl
from fsi.postprocess.render.view import Choice, View
from fsi.postprocess.run.gaps import parse_sides
from fsi.postprocess.run.run import Run

type Cut = Literal["neither", "both", "min", "max"]

STILLS, MOVIES = (".png",), (".mp4", ".gif")
_PER_SECOND = 8
_QUALITY = "10"  # of H.264, 0 without losses to 51

_INCHES = 5.0  # a panel
_BAR, _ABOVE, _BELOW, _GAP = 0.2, 0.14, 0.08, 0.03  # room around a panel, in panels
_FITS = 56  # letters of the usual size above a panel
_BESIDE = 6  # letters of the usual size beside a colour bar
_OPENED = 1e-6  # a gap that is wider by so much in the mesh is opened there
_ROOM = 0.045  # of a label beside a colour bar, in panels
_SCALE = 0.25  # longest scale bar, in panels


class Artist(ABC):
    """Draws pictures of a run in one manner: the same windows, and the same colours for the same values.

    Attributes:
        series: the files that it draws.
        run: the run.
        choice: what is to be seen.
    """

    series: ClassVar[str] = "fluid"

    def __init__(self, run: Run, choice: Choice) -> None:
        """Raises InputError: there is not what is chosen."""
        self.run, self.choice = run, choice

    @property
    def times(self) -> pd.Series[float]:
        """Of the steps that it can draw, by their numbers."""
        return self.run.times_of(self.series)

    def step(self, step: int | None) -> int:
        """That step, or the last one, if it can be drawn. Raises InputError."""
        return self.run.step(step, self.series)

    @property
    def film(self) -> list[int]:
        """The steps that an animation shows."""
        return [int(step) for step in self.times.index]

    def require(self, step: int) -> None:  # noqa: ARG002
        """Raise InputError where that step's files, or this machine, lack what it takes."""
        require_opengl()

    @abstractmethod
    def pictures(self, steps: Sequence[int]) -> Iterator[Picture]:
        """A picture of each step."""

    def title(self, step: int) -> str:
        """What is written above a picture."""
        return f"{plain(self.run.case.name)},  t = {self.times[step]:.6g}"


class FlowArtist(Artist):
    """Draws a flow; a gap is chosen by its two sides."""

    def __init__(self, run: Run, choice: Choice) -> None:
        """Raises InputError: there is no such gap."""
        super().__init__(run, choice)
        self._walls = run.case.container().walls
        self.sides = None if choice.gap is None else parse_sides(choice.gap, run.case.names, self._walls)

    def gap_title(self, step: int, gap: SurfaceGap, view: View) -> str:
        """Which gap, how wide it is, in the mesh too where laws stand for it, and how far it is turned."""
        names = [*self.run.case.names, *self._walls]
        between = f"gap {names[gap.sides[0]]} - {names[gap.sides[1]]}"
        turned = f", turned by {view.turned:.0f}°" if abs(view.turned) >= 0.5 else ""
        width = gap_between(self.run.configuration(step), self.run.container(step), gap.sides, gap.away).width
        meshed = f", meshed as {gap.width:.3g}" if gap.width > (1.0 + _OPENED) * width else ""
        return f"{'narrowest gap' if self.sides is None else between}, {width:.3g}{meshed}{turned}"


@dataclass(frozen=True)
class Framed:
    """A panel that has been drawn.

    Attributes:
        image: its pixels.
        title: what is written above it.
        half: half its width, a length.
        label: what its colour bar says.
        shades: what its colours mean; None where nothing has one, and there is no colour bar.
        cut: at which ends of the colours values lie beyond, as a colour bar of matplotlib has it.
    """

    image: Picture
    title: str
    half: float
    label: str
    shades: ScalarMappable | None
    cut: Cut = "neither"

    @property
    def aspect(self) -> float:
        """Its height over its width."""
        return float(self.image.shape[0] / self.image.shape[1])


def compose(title: str, panels: Sequence[Framed], theme: Theme = LIGHT) -> Picture:
    """The panels side by side under a title, as pixels (height, width, 3)."""
    size, tallest = panels[0].image.shape[1], max(panel.aspect for panel in panels)
    wide, high = len(panels) * (1.0 + _BAR) + _GAP, tallest + _ABOVE + _BELOW
    style = {"font.size": 11, "axes.linewidth": 0.8, "mathtext.fontset": "dejavusans", "axes.grid": False}
    with mpl.rc_context(theme.style | style | {"axes.spines.top": True, "axes.spines.right": True}):
        figure = Figure(figsize=(_INCHES * wide, _INCHES * high), dpi=size / _INCHES, facecolor="none")
        figure.text(_GAP / wide, 1.0 - 0.045 / high, title, fontsize=13, va="center")
        for k, panel in enumerate(panels):
            left, low = k * (1.0 + _BAR) + _GAP, _BELOW + 0.5 * (tallest - panel.aspect)
            axes = figure.add_axes((left / wide, low / high, 1.0 / wide, panel.aspect / high))
            _frame(axes, panel)
            if panel.shades is None:
                continue
            bar = figure.add_axes(((left + 1.015) / wide, low / high, 0.03 / wide, panel.aspect / high))
            constant = panel.shades.cmap.N == 1
            ends = "neither" if constant else panel.cut
            shown = figure.colorbar(panel.shades, cax=bar, extend=ends, extendfrac=0.025)
            if isinstance(panel.shades.norm, LogNorm):
                label_short(bar.yaxis)
            if isinstance(panel.shades.norm, LogNorm | SymLogNorm):
                _label_ends(shown, _ROOM / panel.aspect)
            elif constant:
                shown.set_ticks([np.mean(panel.shades.get_clim())])
            _label_beside(bar.yaxis)
            bar.set_title(panel.label, fontsize=11, pad=7, loc="left")
        drawn = Image.fromarray(pixels(figure))
    picture = Image.new("RGBA", drawn.size, theme.page)
    for k, panel in enumerate(panels):
        down = _ABOVE + 0.5 * (tallest - panel.aspect)
        corner = round(size * (k * (1.0 + _BAR) + _GAP)), round(size * down)
        picture.paste(Image.fromarray(panel.image), corner)
    picture.alpha_composite(drawn)
    return np.asarray(picture.convert("RGB"))


def _label_beside(axis: Axis) -> None:
    """Make room for the labels of a colour bar: smaller where they are long, and no offset above."""
    low, high = sorted(axis.get_view_interval())
    ticks = [t for t in axis.get_majorticklocs() if low <= t <= high]
    labels = axis.get_major_formatter().format_ticks(ticks)
    if axis.get_major_formatter().get_offset():
        axis.set_major_formatter(PlainNumbers())
        labels = axis.get_major_formatter().format_ticks(ticks)
    longest = max((len(label) for label in labels if "$" not in label), default=1)
    axis.set_tick_params(labelsize=11.0 * min(1.0, _BESIDE / longest))


def _label_ends(bar: Colorbar, room: float) -> None:
    """Label the ends of a logarithmic colour bar too, and leave out what is nearer to another than the room.

    Ticks beyond its ends would stretch it past the colours; in a linear part they lie upon each other.
    """
    formatter, place = bar.ax.yaxis.get_major_formatter(), bar.norm
    low, high = bar.mappable.get_clim()
    taken, inner = [0.0, 1.0], list[float]()
    for tick in sorted((tick for tick in bar.get_ticks() if low < tick < high), key=abs):
        if min(abs(float(place(tick)) - other) for other in taken) > room:
            inner.append(tick)
            taken.append(float(place(tick)))
    ends = PlainNumbers().format_ticks([_rounded(low, high), _rounded(high, low)])
    bar.set_ticks([*inner, low, high], labels=formatter.format_ticks(inner) + ends)


def _rounded(end: float, other: float) -> float:
    """One end of a range with three digits of its own, and of the range."""
    least = min(abs(end), abs(other - end)) or 1.0
    return round(end, 2 - int(np.floor(np.log10(least))))


def _frame(axes: Axes, panel: Framed) -> None:
    """Room for the image under its title, and below it a bar of a round length."""
    axes.patch.set_visible(False)
    axes.set_title(panel.title, fontsize=11.0 * min(1.0, _FITS / len(panel.title)), loc="left", pad=7)
    axes.set(xticks=[], yticks=[])
    length = round_length(_SCALE * 2.0 * panel.half)
    end = length / (2.0 * panel.half)
    below = -0.04 / panel.aspect
    style = {"color": mpl.rcParams["text.color"], "solid_capstyle": "butt", "clip_on": False}
    axes.plot([0.0, end], [below, below], lw=2.5, **style)
    axes.text(end + 0.015, below, f"{length:g}", va="center")
    axes.set(xlim=(0.0, 1.0), ylim=(0.0, 1.0))


def pixels(figure: Figure) -> Picture:
    """A figure as it looks, (height, width, 4)."""
    canvas: Any = FigureCanvasAgg(figure)
    canvas.draw()
    return np.array(canvas.buffer_rgba())


def round_length(most: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is at most so long."""
    power = 10.0 ** np.floor(np.log10(most))
    return float(max(f * power for f in (1.0, 2.0, 5.0) if f * power <= most * (1.0 + 1e-9)))


def write_pictures(pictures: Iterable[Picture], output: Path) -> None:
    """Write pictures of one size, (height, width, 3) each, as they come. Raises InputError."""
    temporary = unfinished(output)
    try:
        temporary.touch()  # ffmpeg would complain itself, in its own words
        {".png": _write_png, ".mp4": _write_mp4, ".gif": _write_gif}[output.suffix](pictures, temporary)
        temporary.replace(output)
    except OSError as error:
        raise InputError(f"output = {output}: {error.strerror or error}; choose another path") from None
    finally:
        temporary.unlink(missing_ok=True)


def _write_png(pictures: Iterable[Picture], path: Path) -> None:
    for picture in pictures:
        Image.fromarray(picture).save(path, format="PNG", compress_level=3)


def _write_mp4(pictures: Iterable[Picture], path: Path) -> None:
    """H.264, which browsers and slides show; it wants even sizes. Raises OSError with ffmpeg's last words."""
    import imageio_ffmpeg

    frames = (np.ascontiguousarray(f[: len(f) // 2 * 2, : f.shape[1] // 2 * 2]) for f in pictures)
    first = next(frames)
    size, rate = f"{first.shape[1]}x{first.shape[0]}", str(_PER_SECOND)
    raw = ("-f", "rawvideo", "-pix_fmt", "rgb24", "-s", size, "-r", rate, "-i", "-")
    coded = ("-an", "-vcodec", "libx264", "-pix_fmt", "yuv420p", "-crf", _QUALITY, "-v", "error", "-xerror")
    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-y", *raw, *coded, str(path)]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE
    ) as ffmpeg:
        assert ffmpeg.stdin is not None
        assert ffmpeg.stderr is not None
        with suppress(BrokenPipeError), ffmpeg.stdin as pipe:
            for picture in chain((first,), frames):
                pipe.write(picture.data)
        said = [line for line in ffmpeg.stderr.read().decode(errors="replace").splitlines() if line.strip()]
    if ffmpeg.returncode:
        said = said or ["ffmpeg could not write all of it, perhaps for want of room"]
        raise OSError(said[-1].rpartition("] ")[2])


def _write_gif(pictures: Iterable[Picture], path: Path) -> None:
    first, *others = (Image.fromarray(picture).quantize(256) for picture in pictures)
    duration = 1000 // _PER_SECOND
    first.save(path, format="GIF", save_all=True, append_images=others, duration=duration, loop=0)
