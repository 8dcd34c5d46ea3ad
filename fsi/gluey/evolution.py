"""A gluey run: its steps in a run folder, its contacts as a table and as lines for ParaView."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.bodies.gaps import without_rounding
from fsi.case.case import Case
from fsi.errors import SolveError
from fsi.gluey.contacts import Contacts, Room, find_contacts, smallest_gap
from fsi.gluey.step import Checks, Touching, advance
from fsi.gluey.system import GlueyState, gluey_state, gluey_system, wall_names
from fsi.integration.evolution import CsvTable, Moment
from fsi.integration.state import Schedule, State, StepRecord
from fsi.meshes.geometry.lattice import Lattice
from fsi.parallel import on_root
from fsi.run_folder.paraview import in_space, write_lines, write_points
from fsi.run_folder.rows import CONTACT_COLUMNS

CONTACTS = "contacts.csv"


@dataclass(frozen=True, slots=True)
class Stepped:
    """What a step came to.

    Attributes:
        t, step, h: its end, number and length.
        state: all that the next one depends on.
        touching: its contacts.
        checks: how good it is.
        load: the external loads over it, (N, modes).
    """

    t: float
    step: int
    h: float
    state: GlueyState
    touching: Touching
    checks: Checks
    load: Array


class GlueyEvolution:
    """Steps a gluey case, as an `fsi.integration.evolution.Evolution`."""

    def __init__(self, case: Case) -> None:
        """A case with [time]. Raises InputError."""
        self.case = case
        self.system = gluey_system(case)
        self.schedule = Schedule(case.timing.end, (), case.output.interval)
        self._sides = (*case.names, *(f"wall {name}" for name in wall_names(case)))
        container = case.container()
        self._far = [container.walls.index(name) for name in container.far_walls]
        self._key = np.empty(0, dtype=np.int64)
        self._gamma = np.empty(0)
        self._step = case.timing.step or case.timing.end

    def start(self) -> Moment:
        """The moment at time 0: nothing has touched."""
        begin = gluey_state(self.case)
        contacts = find_contacts(begin.centres, self.system.radii, self.system.room, 0.0)
        nothing = np.zeros(len(contacts))
        touching = Touching(contacts, nothing, nothing, nothing)
        checks = Checks(0.0, 0.0, 0.0, 0, 0)
        return self._moment(Stepped(0.0, 0, 0.0, begin, touching, checks, np.zeros_like(begin.U)))

    def advance(self, state: State) -> Moment:
        """One step. Raises SolveError."""
        t_end = self.schedule.landing(state.t, self._step)
        h = t_end - state.t
        angles = state.q.angles.reshape(len(state.q), -1)
        now = GlueyState(state.q.centres, angles, state.U, self._key, self._gamma)
        new, touching, checks = advance(self.system, now, state.t, h)
        self._require_room(new, t_end)
        load = self.system.load(now.centres, state.t, t_end) / h
        return self._moment(Stepped(t_end, state.step + 1, h, new, touching, checks, load))

    def memory(self) -> dict[str, NDArray[Any]]:
        """The pairs that remember, and what."""
        return {"key": self._key, "gamma": self._gamma}

    def restore(self, memory: Mapping[str, NDArray[Any]]) -> None:
        """Take back what `memory` gave."""
        self._key, self._gamma = memory["key"], memory["gamma"]

    def _require_room(self, new: GlueyState, t: float) -> None:
        """What stands for infinity in other models is no wall here, and nothing may come so far."""
        if not self._far:
            return
        away = self.case.container().distances(new.centres)[:, self._far].min(axis=1) - self.system.radii
        i = int(away.argmin())
        if away[i] <= 0.0:
            raise SolveError(
                f"domain.radius: body {self.case.names[i]} has come to the far end of the domain at t = "
                f"{t:.9g}, which stands for infinity; enlarge it, or give a box"
            )

    def _moment(self, now: Stepped) -> Moment:
        new, touching, checks = now.state, now.touching, now.checks
        self._key, self._gamma = new.key, new.gamma
        angles = new.angles[:, 0] if self.system.dimension == 2 else new.angles
        q = Configuration(new.centres, angles, self.system.radii)
        columns = {
            "contacts": int((touching.p > 0.0).sum()),
            "solid_contacts": int((touching.solid > 0.0).sum()),
            "smallest_gamma": float(new.gamma.min(initial=0.0)),
            "kinetic_energy": 0.5 * float((self.system.mass * new.U**2).sum()),
            "kkt": checks.kkt,
            "momentum_defect": checks.momentum,
            "overlap": checks.overlap,
            "iterations": checks.iterations,
            "newton_steps": checks.newton,
        }
        record = StepRecord(now.step, now.t, now.h, self._smallest_gap(new), 0, q, new.U, now.load, columns)
        names = self.case.names if self.schedule.is_output(now.t) else ()
        state = State(now.t, now.step, q, new.U, self._step)

        def write(folder: Path) -> dict[str, Sequence[str]]:
            return on_root(lambda: self._write(now, folder))

        return Moment(state, record, names, write, partial(self._tables, now))

    def _smallest_gap(self, state: GlueyState) -> float:
        film = self.system.film(1.0)
        if film is not None and len(state.gamma):
            return float(film.gap(state.gamma).min())
        if len(state.key):  # gamma < 0, and q gamma = 0 in the limit
            return 0.0
        radii = self.system.radii
        gap = smallest_gap(state.centres, radii, self.system.room)
        return float(without_rounding(np.array(gap), float(radii.min())))

    def _tables(self, now: Stepped) -> dict[str, CsvTable]:
        """Contacts that carry an impulse or remember; the gap is that at the beginning of the step."""
        touching = now.touching
        c = touching.contacts
        gaps = without_rounding(c.D, float(self.system.radii.min()))
        numbers = np.column_stack([gaps, touching.gamma, touching.p, touching.solid]).tolist()
        rows = [
            [now.step, now.t, self._sides[c.i[k]], self._sides[c.j[k]], *numbers[k]]
            for k in np.flatnonzero(_tells(touching))
        ]
        return {CONTACTS: (CONTACT_COLUMNS, rows)}

    def _write(self, now: Stepped, folder: Path) -> dict[str, Sequence[str]]:
        """Bodies as points with radius and velocity, contacts as lines from centre (or wall) to centre.

        Both where they are at the end of the step.
        """
        new, touching, step = now.state, now.touching, now.step
        d = self.system.dimension
        bodies, lines = f"bodies_{step:06d}.vtu", f"contacts_{step:06d}.vtu"
        c, radii = touching.contacts, self.system.radii
        write_points(folder / bodies, new.centres, {"radius": radii, "velocity": in_space(new.U[:, :d])})
        shown = np.flatnonzero(_tells(touching))
        ends = _ends(c[shown], new.centres, radii, self.system.room)
        values = {"gamma": touching.gamma, "impulse": touching.p, "solid": touching.solid}
        write_lines(folder / lines, *ends, {name: value[shown] for name, value in values.items()})
        return {"bodies": [bodies], "contacts": [lines]}


def _tells(touching: Touching) -> NDArray[np.bool_]:
    """Contacts that carry an impulse or remember, (C,): what lets go of a cone pulls, p < 0."""
    tells: NDArray[np.bool_] = (touching.p != 0.0) | (touching.gamma < 0.0)
    return tells


def _ends(contacts: Contacts, centres: Array, radii: Array, room: Room) -> tuple[Array, Array]:
    """The ends of contacts when centres have moved, (C, d): that of j, and the image of i or foot on a wall.

    Of the images of i it is the one that lies where the normal says.
    """
    N, j = len(centres), centres[contacts.j]
    pair = np.flatnonzero(contacts.i < N)
    wall = np.flatnonzero(contacts.i >= N)
    other = np.empty_like(j)
    i = contacts.i[pair]
    reach = contacts.D[pair] + radii[i] + radii[contacts.j[pair]]
    away = j[pair] - reach[:, None] * contacts.n[pair] - centres[i]
    lattice = Lattice(room.container.periods)
    other[pair] = centres[i] + lattice.shift(lattice.nearest(away))
    n, points = contacts.n[wall], room.points[contacts.i[wall] - N]
    other[wall] = j[wall] - np.sum((j[wall] - points) * n, axis=1)[:, None] * n
    return j, other
