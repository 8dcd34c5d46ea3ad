"""The decoupled distance scheme of the slides for `M u' + zeta (u - u_inf) + A u = Phi`: pairs store gaps.

Each step h
  1. advances the distance of each pair by itself, `D'' = -g kappa(D) D' + f`, in x = ln D, which does not
     underflow where D does; f holds the other pairs, drag and `G'.u` at the beginning of the step, and the
     loads. So stored gaps are positive. Beside bodies held in some directions g turns, too;
  2. takes A with kappa(D^{n+1}) and G at q^n, and solves `(M + h Z + h A) u^{n+1} = M u^n + h Phi`;
  3. moves the bodies, `q += h u^{n+1}`; held modes have their mean velocity in the step, so that they are
     where its integral takes them, and what they push keeps up with them.
The energy inequality `1/2 |u^{n+1}|^2_M + h A u.u + ... <= 1/2 |u^n|^2_M + h Phi.u^{n+1}` holds at each
step. Stored gaps drift away from those of the bodies, at first order in h; the drift is recorded.

Where bodies would overlap, as their own gap is smaller than the stored one, the pair is stopped: 2. and 3.
are repeated with kappa = inf there, so that its gap stays as it is. Any kappa >= 0 leaves A symmetric and
nonnegative, so that the energy inequality holds as before; a shorter step would keep it too, but the drift
of pressed contacts is O(h) however short h is. How many are stopped is recorded.
Source: A. Lefebvre and B. Maury, Direct simulation of dense suspensions (2008).
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from time import process_time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration, Inertia, Motion
from fsi.bodies.gaps import ROUNDING, row_numbers
from fsi.case.case import Case
from fsi.errors import SolveError
from fsi.integration.state import State
from fsi.reduced.enclosure import Enclosure
from fsi.reduced.first_integral import FirstIntegral, Some, backward_euler_step
from fsi.reduced.model import ReducedInstant, ReducedModel
from fsi.reduced.network import gradient, own_mobility
from fsi.reduced.pairs import Pairs, find_pairs, gaps_at, of_keys, own_speed, turning
from fsi.reduced.stress import lubrication_stress, stresslets
from fsi.reduced.system import SolvedSystem, Surroundings, identities, require, solve_system


@dataclass(frozen=True, slots=True)
class PairMemory:
    """What is stored of P pairs.

    Attributes:
        key: see `Pairs`, in order, (P, 2 + k).
        x: ln D, (P,).
        w: the first integral `D' + g K(D)`, with "backward-euler" D' itself, (P,).
        force: lambda at the end of the last step, (P,).
    """

    key: NDArray[np.int64]
    x: Array
    w: Array
    force: Array

    def positions(self, keys: NDArray[np.int64]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Where the rows that both have stand in `keys` and in the memory, both in order and each once."""
        rows, stored = row_numbers(keys, self.key)
        there = np.searchsorted(stored, rows)
        here = np.flatnonzero(np.append(stored, -1)[there] == rows)
        return here, there[here]


@dataclass(frozen=True, slots=True)
class Met:
    """What a step ends with and the next one begins with: bodies, what is around them, and their pairs."""

    q: Configuration
    ambient: Surroundings
    pairs: Pairs

    def within(self, enclosure: Enclosure) -> Pairs:
        """The pairs as they are in what encloses them during the next step: walls and lattices move."""
        if enclosure.container != self.ambient.enclosure.container:
            return of_keys(self.q, enclosure, self.pairs.key)
        b = own_speed(self.pairs, len(self.q), enclosure)
        return self.pairs if np.array_equal(b, self.pairs.b) else replace(self.pairs, b=b)


def merged(
    key: NDArray[np.int64], *parts: tuple[NDArray[np.intp], NDArray[np.intp], PairMemory]
) -> PairMemory:
    """The memory of the pairs with these keys, of parts (rows of the result, rows of the memory, memory)."""
    x, w, force = (np.empty(len(key)) for _ in range(3))
    for rows, where, memory in parts:
        x[rows], w[rows], force[rows] = memory.x[where], memory.w[where], memory.force[where]
    return PairMemory(key, x, w, force)


class DistanceModel(ReducedModel):
    """The reduced model with inertia and a memory of its gaps; `begin` and then `march` make the steps."""

    def __init__(self, case: Case) -> None:
        """A model of a case whose free bodies have masses, without memory yet. Raises InputError."""
        super().__init__(case)
        masses = case.masses()
        self.masses = np.zeros_like(self.zeta) if masses is None else masses
        self.literal = case.timing.scheme == "backward-euler"
        self._memory: PairMemory | None = None
        self._last: Met | None = None

    def state(self) -> dict[str, NDArray[Any]]:
        """The memory."""
        return {} if self._memory is None else asdict(self._memory)

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Take the memory back."""
        self._memory = PairMemory(**state) if state else None

    def begin(self, q: Configuration) -> ReducedInstant:
        """The instant at time 0 with the velocities of the case; the memory begins. Raises SolveError."""
        began, U = process_time(), self.case.initial_velocity()
        ambient = self.surroundings(q, 0.0)
        pairs = find_pairs(q, ambient.enclosure, self.reach)
        self._memory, self._last = self._fresh(pairs, ambient, U), Met(q, ambient, pairs)
        held = Motion(np.ones_like(ambient.motion.held), U, np.zeros_like(U))
        kappa = self.laws.kappa(self._memory.x, pairs.films)
        solved = solve_system(replace(ambient, motion=held), pairs, kappa, None, stored=True)
        checks = {} if self.literal else {"invariant": 0.0}
        checks |= identities(solved.network, q, U, solved.alone, solved.force) | solved.balances()
        require(checks, 0.0)
        record = {"pairs": len(pairs), "dissipation": solved.dissipation, **checks, "energy": 0.0}
        instant = self._instant(U, record | {"stopped": 0, "drift": 0.0})
        return replace(instant, record={**instant.record, "cpu_solve": process_time() - began})

    def march(self, state: State, t_end: float) -> tuple[Configuration, ReducedInstant]:
        """One step: its end, the instant there. Raises SolveError: new pairs overlap, an identity fails."""
        began = process_time()
        h, before = t_end - state.t, self._met(state)
        ambient = self._during(state.q, state.t, t_end)
        pairs = before.within(ambient.enclosure)
        memory, checks = self._advance_distances(state, pairs, ambient, h)
        kappa = self.laws.kappa(memory.x, pairs.films)
        solved, q, gap, stopped = self._without_overlap(state, ambient, pairs, kappa, h)
        checks |= identities(solved.network, state.q, solved.U, solved.alone, solved.force)
        checks |= solved.balances() | {"energy": solved.energy(self.masses, state.U, h)}
        require(checks, t_end, remedy="shorten time.step")
        record = {"pairs": len(pairs), "dissipation": solved.dissipation, **checks, "stopped": stopped}
        w = memory.w if self.literal else memory.w + self._turned(memory.x, pairs, q, ambient)
        memory = replace(memory, w=w, force=solved.force)
        drift = self._meet(q, solved.U, memory, gap, t_end)
        instant = self._instant(solved.U, {**record, "drift": drift})
        return q, replace(instant, record={**instant.record, "cpu_solve": process_time() - began})

    @property
    def _surely_found(self) -> float:
        """The search finds all pairs of bodies whose gap is smaller, however that rounds."""
        return 0.999 * min(self.reach, self.case.container().size())

    def _met(self, state: State) -> Met:
        """The end of the last step, found again where a run is resumed."""
        if self._last is None or self._last.q is not state.q:
            assert self._memory is not None
            ambient = self.surroundings(state.q, state.t)
            self._last = Met(state.q, ambient, of_keys(state.q, ambient.enclosure, self._memory.key))
        return self._last

    def _without_overlap(
        self, state: State, ambient: Surroundings, pairs: Pairs, kappa: Array, h: float
    ) -> tuple[SolvedSystem, Configuration, Array, int]:
        """Steps 2 and 3: velocities, the bodies and the gaps there, and how many had to be stopped."""
        inertia, stopped = Inertia(self.masses / h, state.U), np.zeros(len(pairs), dtype=bool)
        while True:
            rigid = np.where(stopped, np.inf, kappa)
            solved = solve_system(ambient, pairs, rigid, inertia, stored=True)
            moved = state.q.moved(h * solved.U)
            gap = gaps_at(moved, ambient.enclosure, pairs)
            if np.any(np.isinf(rigid) & (gap < -ROUNDING * state.q.radii.min())):
                raise SolveError(
                    f"time.step = {h:g}: bodies overlap after it by {-gap.min():.3g}, and stopping "
                    "their gaps does not part them; shorten it"
                )
            closed = (gap <= 0.0) & ~np.isinf(rigid)
            if not closed.any():
                return solved, moved, gap, int(stopped.sum())
            stopped |= closed

    def _during(self, q: Configuration, t: float, t_end: float) -> Surroundings:
        """Walls at the end of the step, held velocities and loads of its middle.

        Steps land on the kinks of both: as they are linear in between, these are their means over the step.
        """
        return replace(self.surroundings(q, t_end), motion=self.motion(q, 0.5 * (t + t_end)))

    def _advance_distances(
        self, state: State, pairs: Pairs, ambient: Surroundings, h: float
    ) -> tuple[PairMemory, dict[str, float]]:
        """Step 1: the memory with the gaps of the end of the step, and the defect of the first integral."""
        old = self._memory
        assert old is not None
        f, g = self._rates_of_change(state, pairs, ambient, h)
        if self.literal:
            x, V = backward_euler_step(old.x, old.w, f, h, g * self.case.fluid.viscosity)
            return replace(old, x=x, w=V), {}

        def integral(x: Array, part: Some) -> tuple[Array, Array]:
            return self.laws.integral(x, pairs.films.of(part))

        w = old.w + h * f
        step = FirstIntegral(old.x, w, h, g, integral)
        x = step.solve()
        return replace(old, x=x, w=w), {"invariant": step.defect(x)}

    def _turned(self, x: Array, pairs: Pairs, q: Configuration, ambient: Surroundings) -> Array:
        """By how much w changes with the directions as bodies move to q, `(g then - g) K`, (P,).

        g turns with them beside bodies that are held in some directions only.
        """
        change, N, d = np.zeros(len(x)), len(ambient.motion.held), pairs.n.shape[1]
        held = ambient.motion.held[:, :d].sum(axis=1)
        partly = (held > 0) & (held < d)
        here = np.flatnonzero(partly[pairs.i] | partly[np.where(pairs.is_wall, pairs.i, pairs.j)])
        if len(here):
            M_inverse = self._inverse_masses(ambient, d)
            then = of_keys(q, ambient.enclosure, pairs.key[here])
            g = own_mobility(gradient(pairs, N)[here], M_inverse)
            K, _ = self.laws.integral(x[here], pairs.films.of(here))
            change[here] = (own_mobility(gradient(then, N), M_inverse) - g) * K
        return change

    def _rates_of_change(
        self, state: State, pairs: Pairs, ambient: Surroundings, h: float
    ) -> tuple[Array, Array]:
        """f, all that changes D' but the pair's own lubrication, and `g = G.M^-1 G`; (P,)."""
        assert self._memory is not None
        d, force, motion = pairs.n.shape[1], self._memory.force, ambient.motion
        U, before = state.U, self._met(state).ambient
        G, M_inverse = gradient(pairs, len(U)), self._inverse_masses(ambient, d)
        load = (motion.F - before.zeta * (U - before.background))[:, :d] - (G.T @ force).reshape(-1, d)
        prescribed = (motion.U - U)[:, :d] / h
        a = np.where(motion.held[:, :d], prescribed, M_inverse * load)
        g = own_mobility(G, M_inverse)
        b_before = own_speed(pairs, len(U), before.enclosure)
        f = G @ a.ravel() + g * force + turning(pairs, U[:, :d]) - (pairs.b - b_before) / h
        return f, g

    def _inverse_masses(self, ambient: Surroundings, d: int) -> Array:
        """M^-1 of the translations, 0 where held, (N, d)."""
        free = ~ambient.motion.held[:, :d]  # what is held may be without mass
        return np.divide(1.0, self.masses[:, :d], out=np.zeros(free.shape), where=free)

    def _meet(self, q: Configuration, U: Array, memory: PairMemory, gap: Array, t: float) -> float:
        """Carry the memory of pairs, with gaps at q, to those near now, and in contact by their stored gaps.

        Returns:
            the drift, by how much stored gaps are off at most.
        """
        ambient = self.surroundings(q, t)
        of_wall = memory.key[:, 1] >= len(q)  # which may stop to count beside an edge
        in_contact = (np.exp(memory.x) < self.reach) & (of_wall | ~(gap < self._surely_found))
        pairs = find_pairs(q, ambient.enclosure, self.reach, memory.key[in_contact])
        known, stored = memory.positions(pairs.key)
        new = np.setdiff1d(np.arange(len(pairs)), known, assume_unique=True)
        fresh = self._fresh(of_keys(q, ambient.enclosure, pairs.key[new]), ambient, U)
        self._memory = merged(pairs.key, (known, stored, memory), (new, np.arange(len(new)), fresh))
        self._last = Met(q, ambient, pairs)
        return float(np.abs(np.exp(memory.x[stored]) - pairs.gap[known]).max(initial=0.0))

    def _fresh(self, pairs: Pairs, ambient: Surroundings, U: Array) -> PairMemory:
        """The memory of pairs that have just come near: their stored gap is the one they have."""
        if np.any(pairs.gap <= 0.0):
            raise SolveError(
                f"time.step = {self.case.timing.step:g}: bodies came near and overlapped within one step "
                f"(gap {pairs.gap.min():.3g}); shorten it or give a larger reduced.cutoff"
            )
        d, x = pairs.n.shape[1], np.log(pairs.gap)
        G = gradient(pairs, len(U))
        rates = G @ U[:, :d].ravel() - pairs.b
        force = self.laws.kappa(x, pairs.films) * rates
        if self.literal:
            return PairMemory(pairs.key, x, rates, force)
        K, _ = self.laws.integral(x, pairs.films)
        return PairMemory(pairs.key, x, rates + own_mobility(G, self._inverse_masses(ambient, d)) * K, force)

    def _instant(self, U: Array, record: Mapping[str, float]) -> ReducedInstant:
        """What is known at the end of a step."""
        last, memory = self._last, self._memory
        assert last is not None
        assert memory is not None
        q, ambient, pairs = last.q, last.ambient, last.pairs
        d = pairs.n.shape[1]
        G = gradient(pairs, len(U))
        g = own_mobility(G, self._inverse_masses(ambient, d))
        F = ambient.zeta * (U - ambient.background)
        F[:, :d] += (G.T @ memory.force).reshape(-1, d)
        stored = {"log10_stored_gap": float(memory.x.min(initial=np.inf) / np.log(10.0))}
        stress = lubrication_stress(
            ambient.enclosure, stresslets(pairs, memory.force, q.radii), self.case.fluid.viscosity
        )
        columns = {**record, **({} if stress is None else stress.record), **stored}
        rates = G @ U[:, :d].ravel() - pairs.b
        return ReducedInstant(q, U, F, pairs, memory.x, rates, memory.force, self.laws, g, columns, stress)
