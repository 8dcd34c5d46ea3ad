"""A picture of one or more panels: images with titles, colour bars and scale bars around them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Colormap, LogNorm, Normalize
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

from fsi.postprocess.render.ticks import label_short

_INCHES = 5.0  # a panel
_BAR, _ABOVE, _BELOW, _GAP = 0.2, 0.14, 0.08, 0.03  # room around a panel, in panels
_FITS = 56  # letters of the usual size above a panel
_SCALE = 0.25  # longest scale bar, in panels


@dataclass(frozen=True)
class Framed:
    """A panel that has been drawn: its image, title, half its width, and what its colours mean.

    cut: whether values beyond both ends have the colours of the ends.
    """

    image: NDArray[np.uint8]
    title: str
    half: float
    label: str
    colours: Colormap
    norm: Normalize
    cut: bool = False


def compose(title: str, panels: Sequence[Framed]) -> NDArray[np.uint8]:
    """The panels side by side under a title, as pixels (height, width, 3)."""
    size = panels[0].image.shape[0]
    wide, high = len(panels) * (1.0 + _BAR) + _GAP, 1.0 + _ABOVE + _BELOW
    with mpl.rc_context({"font.size": 11, "axes.linewidth": 0.8, "mathtext.fontset": "dejavusans"}):
        figure = Figure(figsize=(_INCHES * wide, _INCHES * high), dpi=size / _INCHES, facecolor="none")
        figure.text(_GAP / wide, 1.0 - 0.045 / high, title, fontsize=13, va="center")
        for k, panel in enumerate(panels):
            left = k * (1.0 + _BAR) + _GAP
            axes = figure.add_axes((left / wide, _BELOW / high, 1.0 / wide, 1.0 / high))
            _frame(axes, panel)
            bar = figure.add_axes(((left + 1.015) / wide, _BELOW / high, 0.03 / wide, 1.0 / high))
            colours = ScalarMappable(panel.norm, panel.colours)
            figure.colorbar(colours, cax=bar, extend="both" if panel.cut else "neither", extendfrac=0.025)
            if isinstance(panel.norm, LogNorm):
                label_short(bar.yaxis)
            bar.set_title(panel.label, fontsize=11, pad=7, loc="left")
        canvas: Any = FigureCanvasAgg(figure)
        canvas.draw()
    drawn = Image.fromarray(np.asarray(canvas.buffer_rgba()))
    picture = Image.new("RGBA", drawn.size, "white")
    for k, panel in enumerate(panels):
        corner = round(size * (k * (1.0 + _BAR) + _GAP)), round(size * _ABOVE)
        picture.paste(Image.fromarray(panel.image), corner)
    picture.alpha_composite(drawn)
    return np.asarray(picture.convert("RGB"))


def _frame(axes: Axes, panel: Framed) -> None:
    """Room for the image under its title, and below it a bar of a round length."""
    axes.patch.set_visible(False)
    axes.set_title(panel.title, fontsize=11.0 * min(1.0, _FITS / len(panel.title)), loc="left", pad=7)
    axes.set_xticks([])
    axes.set_yticks([])
    length = round_length(_SCALE * 2.0 * panel.half)
    end = length / (2.0 * panel.half)
    axes.plot([0.0, end], [-0.04, -0.04], color="black", lw=2.5, clip_on=False, solid_capstyle="butt")
    axes.text(end + 0.015, -0.04, f"{length:g}", va="center")
    axes.set_xlim(0.0, 1.0)
    axes.set_ylim(0.0, 1.0)


def round_length(most: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is at most so long."""
    power = 10.0 ** np.floor(np.log10(most))
    return float(max(f * power for f in (1.0, 2.0, 5.0) if f * power <= most * (1.0 + 1e-9)))
