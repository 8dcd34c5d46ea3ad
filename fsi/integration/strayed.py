"""How far the bodies of a run have strayed from the exact motion: the bars of positions, gaps and times.

The velocities of a run miss by delta, and the loads of bodies with mass by phi, both of the elements. Each
step ends at distances eps in place and eta in velocity of its own from where the motion leads. To first order
the distances e and d of the exact places and velocities from those of the run obey

    e' = d,    m d' = -(dF/dq e + dF/dU d) - phi,       e -> e + eps,  d -> d + eta  at the end of a step,

with the load F(q, U) that a motion takes, and without mass d = J e + delta, J = dU/dq; in space, where places
turned by e beyond those of the run go on to turn with omega, e' = d + omega x e. They do so for each of
the two causes. Places are stepped by the trapezoidal rule with a predictor, velocities by implicit Euler,
which is one solve of each cause: near places, with `Inertia` of near velocities; its difference from the
velocities of the run is d. So errors decay where bodies approach a wall and grow where they part, and what
moves together strays together. delta and phi have the sign of the estimate. eps is that of the member of
lower order; eta is how far the change of the velocity is from that of the trapezoidal rule, whose own error
is twice that of the scheme. Both take in each component the sign that lengthens e, at first that of eps. As
the two causes may have any signs to each other, the bar of a position is the sum of both |e|.

Where a body with a shape turns, the estimate of a step changes sign twice in each half turn and is then far
too small: eps is not below that of the step before times (h / h_before)^3, and longer by the turn.

Where a body without mass relaxes to a balance of loads, its distance to there goes as exp(z) in a step,
z < 0, and with the scheme as R(z). For the pair 3(2) the estimate is z^3 (1 + z) / 48 of that distance, which
is zero at z = -1, but exp(z) - R(z) at most z^2 / 19 of h dU, with the change dU of the velocity. So another
solve finds w = h J h dU, the ratio of w to h dU is z, and eps is not below STEP_SAFETY |z w| / 30. Near
places are those to which e decays with exp(z), and what decays is summed as an exponential, as the rules
above are unstable below z = -1. There what steps have missed stays on its side, what relaxes by exp(z).

The solves say too how the loads change on the way to near places and velocities, dF, and the dissipation D,
of which dD = 2 F . d + grad D . e. With mass the bars of both have this, each component by itself.

Of gaps, and of the times at which the run has them, see `fsi.integration.strayed_gaps`.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from math import inf
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.bodies.configuration import LOADS, MODES, PLACES, Configuration, Inertia, Motion
from fsi.bodies.surface_gap import SurfaceGap, narrowest_gap
from fsi.integration.errors import ErrorEstimate, StepErrors
from fsi.integration.relaxing import cancelled, kept, left, mean, relaxing, shrunk
from fsi.integration.state import Model, State, Step
from fsi.integration.strayed_angles import in_columns, places_of, turn_since, turned_along
from fsi.integration.strayed_bars import HIDDEN, bars, bars_of_places
from fsi.integration.strayed_gaps import gap_bar, gap_gradient, gap_rate, way_of_gaps
from fsi.meshes.geometry.container import Container

# Of the smallest gap or radius, by which velocities are differenced: far above what a new mesh changes.
SMALL = 0.02
# At the loosest tolerance, 1e-2, a step of a disc beside a plane erred by up to 2.2 times the estimate.
STEP_SAFETY = 2.5
# With a turn by t in a step of a body with a shape more, by the factor 1 + TURN_SAFETY t^2.
TURN_SAFETY = 20.0
# The velocity of a body with mass erred by up to six times the estimate, at first steps.
VELOCITY_SAFETY = 8.0
OF_CAUSES = np.array([1.0, VELOCITY_SAFETY])[:, None, None]


def _none() -> Array:
    return np.zeros((2, 0, 0))


class _Change(NamedTuple):
    """What near places and velocities change.

    Attributes:
        U: of the velocities, (N, M).
        F: of the loads, (N, M).
        D: of the dissipation at the same velocities, as 2 F . dU is taken off.
    """

    U: Array
    F: Array
    D: float = 0.0


@dataclass(slots=True)
class Strayed:
    """The distances by their cause, elements and steps, and what the next step needs; zero at the start.

    Attributes:
        masses: m or I of each mode, 0 without inertia, (N, M); None where no body has any.
        motion_at: what holds and drives the bodies.
        e: of the exact places from those of the run, (2, N, M).
        d: of the exact velocities from those of the run, (2, N, M).
        run: velocities and accelerations of the run at the last step, of modes without mass 0, (2, N, M).
        last: the estimate of that step over h^3, and where it ended, (2, N, M).
        widest: the larger |d| of its two ends, at the second without cancellation; not for the next step.
        loads: |dF| of its end, without cancellation, (2, N, M); not for the next step.
        lost: |grad D . e| there; not for the next step.
        part: the bar of the smallest gap over that gap.
        farthest: how far places have strayed, but for what relaxes, (2, N, M); 0 with mass.
    """

    masses: Array | None
    motion_at: Callable[[Configuration, float], Motion]
    e: Array = field(default_factory=_none)
    d: Array = field(default_factory=_none)
    run: Array = field(default_factory=_none)
    last: Array = field(default_factory=_none)
    widest: Array = field(default_factory=_none)
    loads: Array = field(default_factory=_none)
    lost: float = 0.0
    part: float = 0.0
    farthest: Array = field(default_factory=_none)

    def follow(self, step: Step, errors: StepErrors, model: Model, container: Container) -> None:
        """Take a step, at whose end velocities and loads miss by `errors`; collective.

        Three solves: with mass, what steps have missed in place and in velocity may cancel in d; without, one
        finds how fast bodies relax.
        """
        h, (delta, phi) = step.h, errors.signed
        run = self._run(step)
        if h == 0.0:
            self.e, self.d, self.run = np.zeros((2, *delta.shape)), _of_elements(delta), run
            self.widest, self.loads, self.lost = np.abs(self.d), np.zeros_like(self.e), 0.0
            self.last = np.stack([self._at_first(step), places_of(step.state.q)])
            self.farthest = np.zeros_like(self.e)
            return
        none, carried = np.zeros_like(delta), partial(self._carried, step, model=model, container=container)
        z = least = change = none
        if self.masses is None:
            change = h * (run[0] - self.run[0])
            z, least = relaxing(step.state.q.arms, change, h * carried(change, none).U)
        eps, eta = self._missed(step, run, least)
        turn = turn_since(self.last[1], step.state.q)
        self.run, self.last = run, np.stack([_per_cube(step), places_of(step.state.q)])
        e, d_before = (turned_along(distances, turn) for distances in (self.e, self.d))
        near = e + shrunk(z) * h * d_before + eps
        pushed = self.d + eta - _of_elements(h * self._accelerated(phi))
        by_elements = carried(near[0], pushed[0])
        by_places, by_speeds = carried(near[1], none), carried(none, pushed[1])
        of_elements, of_steps = by_elements.U + delta, np.stack([by_places.U, by_speeds.U])
        loads = np.abs([by_elements.F, np.abs(by_places.F) + np.abs(by_speeds.F)])
        self.loads = np.where(self._found(step), loads, 0.0)
        self.lost = abs(by_elements.D) + abs(by_places.D)
        d = np.stack([of_elements, of_steps.sum(axis=0)])
        # d is that of places that have eps, which comes at the end of the step.
        later = e + h * mean(d_before, d - z / h * eps)
        along = step.state.q.arms * change
        self.e = np.stack([later[0], kept(z, along, e[1], later[1])]) + eps
        if self.masses is None:
            self.farthest = np.maximum(np.abs(self.e), left(z, along) * self.farthest)
            self.farthest[0] += h * cancelled(d_before[0], d[0])
        widest = np.stack([np.abs(of_elements), np.abs(of_steps).sum(axis=0)])
        self.d, self.widest = d, np.maximum(np.abs(self.d), widest)
        self._follow_gap(step, HIDDEN * (h * self.widest[0] + np.abs(eps[1])), container)

    def _follow_gap(self, step: Step, hidden: Array, container: Container) -> None:
        """Take a step in whose displacement `hidden`, (N, M), may have any sign."""
        q = step.state.q
        gap = narrowest_gap(q, container.at(step.state.t))
        if gap is not None and gap.width > 0.0:
            self.part = self._gap_bar(q, gap, hidden) / gap.width

    def _gap_bar(self, q: Configuration, gap: SurfaceGap, hidden: Array | float = 0.0) -> float:
        """The bar of the smallest gap, to which `hidden` may add by any sign."""
        gradient, of_places = gap_gradient(q, gap), bars_of_places(q, self.e, self.farthest)
        least = self.part * gap.width + float(np.abs(gradient * hidden).sum())
        return gap_bar(gradient, self.e, of_places, inf if gap.away is None else least)

    def _run(self, step: Step) -> Array:
        """What `run` shall be at the end of a step."""
        motion = self.motion_at(step.state.q, step.state.t)
        a = self._accelerated(np.where(motion.held, 0.0, motion.F - step.instant.F))
        return np.stack([step.state.U, a])

    def _accelerated(self, load: Array) -> Array:
        """The acceleration by a load, 0 without mass."""
        if self.masses is None:
            return np.zeros_like(load)
        return np.divide(load, self.masses, out=np.zeros_like(load), where=self.masses > 0.0)

    def _found(self, step: Step) -> NDArray[np.bool_]:
        """Where loads are results, (N, M); all others are given."""
        held = self.motion_at(step.state.q, step.state.t).held
        return held if self.masses is None else held | (self.masses > 0.0)

    def _missed(self, step: Step, run: Array, least: Array) -> tuple[Array, Array]:
        """eps, before STEP_SAFETY at least `least`, and eta of a step, by cause, (2, N, M) each."""
        (U, a), (U_end, a_end) = self.run, run
        eta = U_end - U - 0.5 * step.h * (a + a_end)
        massive = np.zeros_like(U) if self.masses is None else self.masses
        missed = np.stack([self._erred(step, least), eta * (massive > 0.0)])
        signs = np.where(self.e[1] == 0.0, missed[0], self.e[1])
        eps, eta = STEP_SAFETY * np.copysign(missed, signs)
        return _of_steps(eps), _of_steps(eta)

    def _at_first(self, step: Step) -> Array:
        """What stands for an estimate over h^3 before the first step: |omega|^3 of free shapes, (N, M)."""
        q, U = step.state.q, step.state.U
        free = ~self.motion_at(q, step.state.t).held
        free[:, : q.dimension] = False
        rates: Array = np.abs(U) ** 3 * free * q.shaped
        return rates

    def _erred(self, step: Step, least: Array) -> Array:
        """The error of a step in place, at least `least`; of shapes at least what the step before foretells.

        All (N, M).
        """
        estimate = np.zeros_like(step.state.U) if step.error is None else step.error
        error: Array = np.copysign(np.maximum(np.abs(estimate), least), estimate)
        q, (usual, places) = step.state.q, self.last
        if not q.shaped:
            return error
        more = 1.0 + TURN_SAFETY * (turn_since(places, q) ** 2).sum(axis=1, keepdims=True)
        erred: Array = np.copysign(more * np.maximum(np.abs(error), usual * step.h**3), error)
        return erred

    def _carried(self, step: Step, e: Array, d: Array, model: Model, container: Container) -> _Change:
        """What the distances d become over a step that ends at the distances e, U, and what goes with it."""
        q, t, U = step.state.q, step.state.t, step.state.U
        scale = SMALL * way_of_gaps(q, e, container.at(t))
        if scale == 0.0:  # only d counts, of which the velocities are a linear function
            if not d.any():
                return _Change(np.zeros_like(e), np.zeros_like(e))
            scale = 1.0
        inertia = None
        if self.masses is not None:
            inertia = Inertia(self.masses / step.h, U - step.h * self.run[1] + scale * d)
        near, F = model(q.moved(scale * e), t, inertia), step.instant.F
        dU, dF = near.U - U, near.F - F
        dD = near.dissipation - step.instant.dissipation - 2.0 * float((F * dU).sum())
        return _Change(dU / scale, dF / scale, dD / scale)

    def columns(self, state: State, container: Container) -> Mapping[str, float]:
        """Of steps.csv: how far the smallest gap has strayed, and the time at which the run has it."""
        q, now = state.q, container.at(state.t)
        gap = narrowest_gap(q, now)
        error = self._gap_bar(q, gap) if gap else 0.0
        rate = abs(gap_rate(q, state.U, now, lambda after: container.at(state.t + after)))
        return {"err_smallest_gap": error, "err_t": error / rate if rate > 0.0 else inf}

    def body_columns(self, q: Configuration, errors: ErrorEstimate) -> Mapping[str, Array]:
        """Of bodies.csv: the errors of positions and angles, absolute, (N,) each.

        With mass those of velocities and loads too, which carry on what was missed before; without, they are
        those of the flow where the run has the bodies, and `errors` has what they miss there.
        """
        of_places = bars_of_places(q, in_columns(q, self.e), self.farthest)
        found = {f"err_{name}": e for name, e in zip(PLACES[q.dimension], of_places.T, strict=True)}
        if self.masses is None:
            return found
        of_velocities = np.maximum(errors.U, self._of_velocities(q))
        of_loads = errors.F + bars(1.0 / q.arms, self.loads * OF_CAUSES)
        found |= {f"err_{name}": error for name, error in zip(LOADS[q.dimension], of_loads.T, strict=True)}
        return found | {f"err_{name}": d for name, d in zip(MODES[q.dimension], of_velocities.T, strict=True)}

    def dissipation_column(self, step: Step, errors: ErrorEstimate) -> Mapping[str, float]:
        """Of steps.csv, with mass: the error of the dissipation, absolute."""
        if self.masses is None:
            return {}
        by_velocities = 2.0 * float((np.abs(step.instant.F) * self._of_velocities(step.state.q)).sum())
        return {"err_dissipation": errors.dissipation + by_velocities + self.lost}

    def _of_velocities(self, q: Configuration) -> Array:
        """How far velocities have strayed at most, (N, M)."""
        return bars(q.arms, self.widest * OF_CAUSES)

    def memory(self) -> dict[str, NDArray[Any]]:
        """What must be restored, by name."""
        of_bodies = np.stack([self.e, self.d, self.run, self.last])
        return {"strayed": of_bodies, "strayed_gap": np.array(self.part), "farthest": self.farthest}

    def restore(self, memory: Mapping[str, NDArray[Any]]) -> None:
        """Take back what `memory` gave."""
        self.e, self.d, self.run, self.last = memory["strayed"]
        self.part = float(memory["strayed_gap"])
        # Runs of older versions have kept none, or that of steps alone.
        self.farthest = np.broadcast_to(memory.get("farthest", np.abs(self.e)), self.e.shape)


def _per_cube(step: Step) -> Array:
    """The estimated error of a step in place over h^3, (N, M)."""
    return np.zeros_like(step.state.U) if step.error is None else np.abs(step.error) / step.h**3


def _of_elements(values: Array) -> Array:
    """By cause: that of the elements alone."""
    return np.stack([values, np.zeros_like(values)])


def _of_steps(values: Array) -> Array:
    """By cause: that of the steps alone."""
    return np.stack([np.zeros_like(values), values])
