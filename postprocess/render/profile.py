"""Pictures of macroscopic runs, which have no bodies: the profiles of a step."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from fsi.errors import InputError
from fsi.postprocess.plots.profiles import LABELS, profile_figure
from fsi.postprocess.render.artist import Artist
from fsi.postprocess.render.canvas import Picture
from fsi.postprocess.render.picture import pixels
from fsi.postprocess.render.view import Choice
from fsi.postprocess.run.run import Run


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
        ends = {name: self.choice.span or _ends([of[name] for of in profiles]) for name in self.names}
        ends["x"] = _ends([of["x"] for of in profiles])
        for step, profile in zip(steps, profiles, strict=True):
            yield pixels(profile_figure(self.title(step), profile, ends, self.choice.size))[..., :3]

    def _read(self, step: int) -> dict[str, np.ndarray]:
        """The profiles of a step at the middles x of its parcels."""
        grid = self.run.mesh(step, self.series)
        return {"x": np.asarray(grid.points)[:, 0]} | {name: np.asarray(grid[name]) for name in self.names}


def _ends(values: Sequence[np.ndarray]) -> tuple[float, float]:
    """Of an axis that shows all values, and a little more."""
    low, high = float(np.min(np.concatenate(values))), float(np.max(np.concatenate(values)))
    room = 0.05 * (high - low) or 0.5
    return low - room, high + room
