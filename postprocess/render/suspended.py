"""Bodies of a run in the plane, coloured by how they move, from its tables alone: no field files are needed.

A body's colour is the size of its velocity, in a sheared flow less that of the mean flow at its centre. Of
thousands of bodies, each a few pixels wide, that shows which of them move together.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import NamedTuple, override

import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.errors import InputError
from fsi.postprocess.render.canvas import Picture, new_panel
from fsi.postprocess.render.mean_flow import sliding_walls, undisturbed
from fsi.postprocess.render.picture import Artist, Cut, Framed, compose
from fsi.postprocess.render.scales import FromZero, Shown, shaded
from fsi.postprocess.render.scenes import images
from fsi.postprocess.render.view import Choice, View, around_all, around_period
from fsi.postprocess.render.walls import draw_open_walls, inside_walls
from fsi.postprocess.run.run import Run

MOTION = "motion"
_SPEED, _DISTURBED = "$|U|$", r"$|U - u_\infty|$"
_MAP = "magma_r"  # pale where bodies move with the flow
_EQUAL = 1e-9  # of the interval: a time is one of its multiples but for rounding


class MovingBodies(NamedTuple):
    """The bodies of one step.

    Attributes:
        q: where they are.
        speed: |U - u_inf|, (N,).
    """

    q: Configuration
    speed: Array


class MotionArtist(Artist):
    """Draws bodies in the plane, with the same colours for the same speeds."""

    def __init__(self, run: Run, choice: Choice) -> None:
        """Raises InputError: the run has no bodies in the plane, or a gap is asked for."""
        super().__init__(run, choice)
        if choice.gap is not None:
            raise InputError(f"--gap {choice.gap}: --field {MOTION} shows all bodies; drop one of the two")
        if not run.drawn_by_tables:
            raise InputError(f"--field {MOTION}: is for bodies in a viscous fluid in the plane; drop it")
        self._moving = lru_cache(maxsize=1)(self._read)

    @property
    @override
    def times(self) -> pd.Series[float]:
        return self.run.steps.set_index("step")["t"].astype(float)

    @property
    @override
    def film(self) -> list[int]:
        """All steps; where the case has an `output.interval`, those at its multiples."""
        interval, times = self.run.case.output.interval, self.times
        if interval is not None:
            parts = times / interval
            times = times[(parts - parts.round()).abs() <= _EQUAL * parts.clip(lower=1.0)]
        return [int(step) for step in times.index]

    @override
    def step(self, step: int | None) -> int:
        """That step, or the last. Raises InputError."""
        known = self.run.steps["step"]
        if step is not None and step not in known.to_numpy():
            raise InputError(f"--step {step}: give one from 0 to {known.iloc[-1]}")
        return int(known.iloc[-1] if step is None else step)

    def pictures(self, steps: Sequence[int]) -> Iterator[Picture]:
        """A picture of each step."""
        view = self._window(steps)
        seen = self._seen(steps)
        shades = shaded(FromZero(), seen._replace(span=self.choice.span or seen.span), colormaps[_MAP])
        return (self._picture(step, view, shades) for step in steps)

    def _window(self, steps: Sequence[int]) -> View:
        """On one period, or on all bodies at all steps."""
        container = self.run.container(steps[0])
        if len(container.periods):
            return around_period(container)
        q = [self._moving(step).q for step in steps]
        return around_all(np.stack([at.centres for at in q]), q[0].radii)

    def _seen(self, steps: Sequence[int]) -> Shown:
        """Speeds from zero to what hardly any body exceeds in those steps."""
        speeds = np.concatenate([self._moving(step).speed for step in steps])
        return FromZero().seen(speeds, np.ones(len(speeds)))

    def _read(self, step: int) -> MovingBodies:
        q, table = self.run.configuration(step), self.run.bodies
        U = table.loc[table["step"] == step, ["V_x", "V_y"]].to_numpy()
        if (flow := undisturbed(self.run, step)) is not None:
            U = U - flow.at(q.centres)[:, :2]
        return MovingBodies(q, np.hypot(U[:, 0], U[:, 1]))

    def _picture(self, step: int, view: View, shades: ScalarMappable) -> Picture:
        container, bodies = self.run.container(step), self._moving(step)
        q, speed = bodies
        if len(container.periods):
            q, which = images(q, container, view)
            speed = speed[which]
        panel = new_panel(view, self.choice.size, self.choice.theme)
        if (inside := inside_walls(self.run, view)).n_points:
            panel.fill(inside, self.choice.theme.page)
        draw_open_walls(panel, self.run)
        panel.coloured_bodies(q, speed, shades)
        panel.sliding(sliding_walls(self.run, step))
        sheared = undisturbed(self.run, step) is not None
        label, title = (_DISTURBED, "bodies, velocity less the mean flow") if sheared else (_SPEED, "bodies")
        cut: Cut = "max" if self.choice.span is None else "both"
        return compose(
            self.title(step),
            [Framed(panel.image(), title, view.half, label, shades, cut)],
            self.choice.theme,
        )
