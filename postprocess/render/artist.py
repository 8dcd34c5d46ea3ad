"""What draws a run: one kind for each kind of picture."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from typing import ClassVar

from fsi.postprocess.render.canvas import Picture, require_opengl
from fsi.postprocess.render.view import Choice
from fsi.postprocess.run.gaps import SurfaceGap, parse_sides
from fsi.postprocess.run.run import Run


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

    def require(self, step: int) -> None:  # noqa: ARG002
        """Raise InputError where that step's files, or this machine, lack what it takes."""
        require_opengl()

    @abstractmethod
    def pictures(self, steps: Sequence[int]) -> Iterator[Picture]:
        """A picture of each step."""

    def title(self, step: int) -> str:
        """What is written above a picture."""
        return f"{self.run.name},  t = {self.run.times_of(self.series)[step]:.6g}"


class FlowArtist(Artist):
    """Draws a flow; a gap is chosen by its two sides."""

    def __init__(self, run: Run, choice: Choice) -> None:
        """Raises InputError: there is no such gap."""
        super().__init__(run, choice)
        self._walls = run.case.container().walls
        self.sides = None if choice.gap is None else parse_sides(choice.gap, run.case.names, self._walls)

    def gap_title(self, gap: SurfaceGap) -> str:
        """Which gap, and how wide it is."""
        names = [*self.run.case.names, *self._walls]
        between = f"gap {names[gap.sides[0]]} - {names[gap.sides[1]]}"
        return f"{'narrowest gap' if self.sides is None else between}, {gap.width:.3g}"
