"""A macroscopic run: its steps in a run folder, its profiles as a table and as lines for ParaView."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fsi.bodies.configuration import Configuration
from fsi.case.case import Case
from fsi.integration.evolution import CsvTable, Moment
from fsi.integration.schedule import Schedule
from fsi.integration.state import State, StepRecord
from fsi.macroscopic.model import Parcels
from fsi.macroscopic.setup import matter
from fsi.parallel import on_root
from fsi.run_folder.vtu import write_polyline

PROFILES = "profiles.csv"
PROFILE_COLUMNS = ("step", "t", "m", "x", "rho", "u", "gamma")
NO_BODIES = Configuration.unturned(np.empty((0, 2)), np.empty(0))


class MacroscopicEvolution:
    """Steps a macroscopic case, as an `fsi.integration.evolution.Evolution`: the parcels are its memory."""

    def __init__(self, case: Case) -> None:
        """A case with [time]. Raises InputError."""
        self.case = case
        self.line = matter(case)
        self.parcels = self.line.parcels
        self.schedule = Schedule(case.timing.end, (), case.output.interval)
        self._step = case.timing.step or case.timing.end

    def start(self) -> Moment:
        """The moment at time 0."""
        return self._moment(0.0, 0, 0.0)

    def advance(self, state: State) -> Moment:
        """One step."""
        t_end = self.schedule.landing(state.t, self._step)
        h = t_end - state.t
        self.parcels = self.parcels.advance(self.line.force, state.t, h)
        return self._moment(t_end, state.step + 1, h)

    def memory(self) -> dict[str, NDArray[Any]]:
        """The parcels."""
        return {"X": self.parcels.X, "u": self.parcels.u, "w": self.parcels.w}

    def restore(self, memory: Mapping[str, NDArray[Any]]) -> None:
        """Take back what `memory` gave."""
        X, u, w = memory["X"], memory["u"], memory["w"]
        self.parcels = Parcels(self.parcels.m, self.parcels.dm, X, u, w)

    def _moment(self, t: float, step: int, h: float) -> Moment:
        parcels = self.parcels
        columns = {
            "largest_density": float(parcels.density.max()),
            "smallest_gamma": float(parcels.gamma.min()),
            "momentum": float(parcels.u.sum() * parcels.dm),
            "kinetic_energy": 0.5 * float((parcels.u**2).sum() * parcels.dm),
        }
        bodies = self.line.bodies
        if bodies is None:
            q, U, F = NO_BODIES, np.empty((0, 3)), np.empty((0, 3))
            gap = float(np.diff(parcels.X).min() - parcels.dm)
        else:
            q, gap, F = bodies.at(parcels.X), bodies.smallest_gap(parcels), bodies.load(t)
            U = np.zeros_like(F)
            U[:, bodies.axis] = bodies.mean(parcels.u)
        record = StepRecord(step, t, h, gap, 0, q, U, F, columns)
        state = State(t, step, q, U, self._step)
        write, tables = partial(_write, step, parcels), partial(_tables, step, t, parcels)
        return Moment(state, record, self.case.names, write, tables)


def profile(parcels: Parcels) -> dict[str, NDArray[np.float64]]:
    """Density, velocity and gamma at the middles of parcels, shapes (n,).

    rho: dm over half the distance to both neighbours; at free ends to the one there is.
    """
    widths = np.diff(parcels.X)
    room = 0.5 * (np.append(widths[0], widths) + np.append(widths, widths[-1]))
    gamma = 0.5 * (parcels.gamma[1:] + parcels.gamma[:-1])
    return {"rho": parcels.dm / room, "u": parcels.u, "gamma": gamma}


def _tables(step: int, t: float, parcels: Parcels) -> dict[str, CsvTable]:
    numbers = np.column_stack([parcels.m, parcels.X, *profile(parcels).values()])
    return {PROFILES: (PROFILE_COLUMNS, [[step, t, *row] for row in numbers.tolist()])}


def _write(step: int, parcels: Parcels, folder: Path) -> dict[str, Sequence[str]]:
    name = f"profile_{step:06d}.vtu"
    on_root(lambda: write_polyline(folder / name, parcels.X[:, None], profile(parcels)))
    return {"profile": [name]}
