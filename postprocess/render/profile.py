"""Pictures of macroscopic runs, which have no bodies: the profiles of a step."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from fsi.bodies.configuration import Array
from fsi.errors import InputError
from fsi.postprocess.plots.profiles import LABELS, profile_figure
from fsi.postprocess.render.artist import Artist
from fsi.postprocess.render.canvas import Picture
from fsi.postprocess.render.picture import pixels
from fsi.postprocess.render.view import Choice
from fsi.postprocess.run.run import Run

_ROUNDING = 1e-9  # of the largest number in a profile


class ProfileArtist(Artist):
    """Draws density, velocity and memory over x, or the one that is chosen."""

    series = "profile"

    def __init__(self, run: Run, choice: Choice) -> None:
        """Raises InputError: there is no such profile, or a gap is asked for."""
        super().__init__(run, choice)
        if choice.gap is not None:
            raise InputError(f"--gap {choice.gap}: there are no bodies in this run; drop it")
        if choice.field not in (None, *LABELS):
            raise InputError(f"--field {choice.field}: give one of {', '.join(LABELS)}")
        self.names = [choice.field] if choice.field else [*LABELS]

    def require(self, step: int) -> None:
        """Figures need no OpenGL."""

    def pictures(self, steps: Sequence[int]) -> Iterator[Picture]:
        """A picture of each step."""
        profiles = [self._read(step) for step in steps]
        columns = {name: np.concatenate([of[name] for of in profiles]) for name in profiles[0]}
        least = _ROUNDING * max(float(np.abs(values).max()) for values in columns.values())
        ends = {name: _ends(values, least) for name, values in columns.items()}
        if self.choice.span is not None:
            ends |= dict.fromkeys(self.names, self.choice.span)
        for step, profile in zip(steps, profiles, strict=True):
            yield pixels(profile_figure(self.title(step), profile, ends, self.choice.size))[..., :3]

    def _read(self, step: int) -> dict[str, Array]:
        """The profiles of a step at the middles x of its parcels."""
        grid = self.run.mesh(step, self.series)
        return {"x": np.asarray(grid.points)[:, 0]} | {name: np.asarray(grid[name]) for name in self.names}


def _ends(values: Array, least: float) -> tuple[float, float]:
    """Of an axis that shows all values, and a little more; what differs by less is constant."""
    low, high = float(values.min()), float(values.max())
    room = 0.05 * (high - low) if high - low > least else 0.5
    return low - room, high + room
