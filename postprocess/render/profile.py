"""Pictures of macroscopic runs, which have no bodies: density, velocity and memory over x at a step."""

from collections.abc import Iterator, Mapping, Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from fsi.arrays import Array
from fsi.errors import InputError
from fsi.postprocess.plots.figure import BLUE
from fsi.postprocess.plots.trajectories import PROFILES, profile_ends, profile_scales, vacuum
from fsi.postprocess.render.canvas import Picture
from fsi.postprocess.render.picture import Artist, pixels
from fsi.postprocess.render.scales import Span
from fsi.postprocess.render.view import Choice
from fsi.postprocess.run.run import Run

_LABELS = {name: label for name, (label, _) in PROFILES.items()}
_MARGIN = 0.05  # of an axis, beyond the values


class ProfileArtist(Artist):
    """Draws all profiles below each other, or the one that is chosen."""

    series = "profile"

    def __init__(self, run: Run, choice: Choice) -> None:
        """Raises InputError: there is no such profile, or a gap is asked for."""
        super().__init__(run, choice)
        if choice.gap is not None:
            raise InputError(f"--gap {choice.gap}: there are no bodies in this run; drop it")
        if choice.field not in (None, *_LABELS):
            raise InputError(f"--field {choice.field}: give one of {', '.join(_LABELS)}")
        self.names = [choice.field] if choice.field else [*_LABELS]

    def require(self, step: int) -> None:
        """Figures need no OpenGL."""

    def pictures(self, steps: Sequence[int]) -> Iterator[Picture]:
        """A picture of each step."""
        profiles = [self._read(step) for step in steps]
        columns = {name: np.concatenate([of[name] for of in profiles]) for name in profiles[0]}
        scales = profile_scales(self.run)
        ends = {name: profile_ends(values, scales[name], _MARGIN) for name, values in columns.items()}
        if self.choice.span is not None:
            ends |= dict.fromkeys(self.names, self.choice.span)
        for step, profile in zip(steps, profiles, strict=True):
            yield pixels(profile_figure(self.title(step), profile, ends, self.choice))[..., :3]

    def _read(self, step: int) -> dict[str, Array]:
        """At the middles x of the parcels, (n,) each."""
        grid = self.run.mesh(step, self.series)
        return {"x": np.asarray(grid.points)[:, 0]} | {name: np.asarray(grid[name]) for name in self.names}


def profile_figure(
    title: str, profile: Mapping[str, Array], ends: Mapping[str, Span], choice: Choice
) -> Figure:
    """Draw all columns (n,) of a profile against its column x, below each other, in vacuum rho alone.

    ends: of the axis of each column; choice: its size is about as many pixels high and wide.
    """
    names = [name for name in _LABELS if name in profile]
    with mpl.rc_context(choice.theme.style):
        figure = Figure(figsize=(6.0, 1.2 + 1.7 * len(names)), dpi=choice.size / 6.0, layout="constrained")
        figure.suptitle(title, x=0.02, ha="left", fontsize=13)
        axes = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
        for name, panel in zip(names, axes, strict=True):
            line = np.array([profile["x"], profile[name]])
            panel.plot(*(line if name == "rho" else _parted(line)), ".-", color=BLUE, ms=2, lw=1.0)
            panel.set(ylabel=_LABELS[name], xlim=ends["x"], ylim=ends[name])
        axes[-1].set_xlabel("x")
    return figure


def _parted(line: Array) -> Array:
    """A line through parcels (2, n) with a point that is no number wherever vacuum parts neighbours."""
    return np.insert(line, np.flatnonzero(vacuum(line[0])) + 1, np.nan, axis=1)
