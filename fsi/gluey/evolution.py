"""A gluey run: its steps in a run folder, its contacts as a table and as lines for ParaView."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fsi.bodies.configuration import Array, Configuration
from fsi.evolution import Moment, Table
from fsi.gluey.contacts import find_contacts
from fsi.gluey.setup import GlueyCase
from fsi.gluey.step import Checks, Touching, advance
from fsi.gluey.system import GlueyState
from fsi.integration.schedule import Schedule
from fsi.integration.stepper import State
from fsi.run_folder.folder import StepRecord
from fsi.run_folder.vtu import write_lines, write_points

CONTACTS = "contacts.csv"
CONTACT_COLUMNS = ("step", "t", "side", "body", "gap", "gamma", "impulse", "solid_impulse")


class GlueyEvolution:
    """Steps a gluey case; an `fsi.evolution.Evolution`."""

    def __init__(self, case: GlueyCase) -> None:
        self.case = case
        self.system = case.system()
        self.names = case.names
        self.schedule = Schedule(case.time.end, (), case.output.interval)
        self._sides = (*case.names, *(f"wall {name}" for name in wall_names(case)))
        self._key = np.empty(0, dtype=np.int64)
        self._gamma = np.empty(0)

    def start(self) -> Moment:
        """The moment at time 0: nothing has touched."""
        begin = self.case.state()
        contacts = find_contacts(begin.centres, self.system.radii, self.system.room, 0.0)
        nothing = np.zeros(len(contacts))
        touching = Touching(contacts, nothing, nothing, nothing)
        return self._moment(0.0, 0, 0.0, begin, touching, Checks(0.0, 0.0, 0.0, 0, 0))

    def advance(self, state: State) -> Moment:
        """One step. Raises SolveError."""
        t_end = self.schedule.landing(state.t, self.case.time.step)
        h = t_end - state.t
        d = self.system.dimension
        angles = state.q.angles.reshape(len(state.q), -1)
        now = GlueyState(state.q.centres, angles, state.U, self._key, self._gamma)
        new, touching, checks = advance(self.system, now, state.t, h)
        assert new.U.shape[1] == state.U.shape[1] == d + angles.shape[1]
        return self._moment(t_end, state.step + 1, h, new, touching, checks)

    def memory(self) -> dict[str, NDArray[Any]]:
        """The pairs that remember, and what."""
        return {"key": self._key, "gamma": self._gamma}

    def restore(self, memory: Mapping[str, NDArray[Any]]) -> None:
        """Take back what `memory` gave."""
        self._key, self._gamma = memory["key"], memory["gamma"]

    def _moment(
        self, t: float, step: int, h: float, new: GlueyState, touching: Touching, checks: Checks
    ) -> Moment:
        self._key, self._gamma = new.key, new.gamma
        angles = new.angles[:, 0] if self.system.dimension == 2 else new.angles
        q = Configuration(new.centres, angles, self.system.radii)
        load = self.system.impulse(t - h, t) / h if h > 0.0 else np.zeros_like(new.U)
        kinetic = 0.5 * float((self.system.mass * new.U**2).sum())
        columns = {
            "contacts": int((touching.p > 0.0).sum()),
            "solid_contacts": int((touching.solid > 0.0).sum()),
            "smallest_gamma": float(new.gamma.min(initial=0.0)),
            "kinetic_energy": kinetic,
            "kkt": checks.kkt,
            "momentum_defect": checks.momentum,
            "overlap": checks.overlap,
            "iterations": checks.iterations,
            "newton_steps": checks.newton,
        }
        record = StepRecord(step, t, h, self._smallest_gap(new), 0, q, new.U, load, columns)
        fields = partial(self._write, step=step, new=new, touching=touching)
        tables = partial(self._tables, step, t, touching)
        return Moment(State(t, step, q, new.U, self.case.time.step), record, fields, tables)

    def _smallest_gap(self, state: GlueyState) -> float:
        film = self.system.film(1.0)
        if film is not None and len(state.gamma):
            return float(film.gap(state.gamma).min())
        reach = 2.0 * float(self.system.radii.max())
        gaps = find_contacts(state.centres, self.system.radii, self.system.room, reach).D
        return float(gaps.min(initial=np.inf))

    def _tables(self, step: int, t: float, touching: Touching) -> dict[str, Table]:
        """Contacts that carry an impulse or remember; the gap is that at the beginning of the step."""
        c = touching.contacts
        rows = [
            [
                step,
                t,
                self._sides[c.i[k]],
                self._sides[c.j[k]],
                *map(float, (c.D[k], touching.gamma[k])),
                float(touching.p[k]),
                float(touching.solid[k]),
            ]
            for k in np.flatnonzero((touching.p > 0.0) | (touching.gamma < 0.0))
        ]
        return {CONTACTS: (CONTACT_COLUMNS, rows)}

    def _write(
        self, folder: Path, step: int, new: GlueyState, touching: Touching
    ) -> dict[str, Sequence[str]]:
        """Bodies as points with radius and velocity, contacts as lines from centre (or wall) to centre."""
        d = self.system.dimension
        bodies, lines = f"bodies_{step:06d}.vtu", f"contacts_{step:06d}.vtu"
        write_points(
            folder / bodies, new.centres, {"radius": self.system.radii, "velocity": _in_space(new.U[:, :d])}
        )
        c, radii = touching.contacts, self.system.radii
        shown = (touching.p > 0.0) | (touching.gamma < 0.0)
        j, n = c.j[shown], c.n[shown]
        reach = radii[j] + np.append(radii, 0.0)[np.minimum(c.i[shown], len(radii))]
        ends = new.centres[j], new.centres[j] - reach[:, None] * n
        values = {
            "gamma": touching.gamma[shown],
            "impulse": touching.p[shown],
            "solid": touching.solid[shown],
        }
        write_lines(folder / lines, *ends, values)
        return {"bodies": [bodies], "contacts": [lines]}


def wall_names(case: GlueyCase) -> tuple[str, ...]:
    """Names of the walls in the order of the room."""
    sides: list[str] = []
    for axis, letter in enumerate("xyz"[: case.dimension]):
        if case.cell is not None and letter not in case.cell.periodic:
            sides += [("left", "right"), ("bottom", "top"), ("back", "front")][axis]
    return (*sides, *(wall.name for wall in case.walls))


def _in_space(vectors: Array) -> Array:
    """Vectors (n, d) with three components."""
    return np.pad(vectors, ((0, 0), (0, 3 - vectors.shape[1])))
