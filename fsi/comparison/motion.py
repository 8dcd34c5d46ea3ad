"""One case at several levels: the trajectories that they give, and how good the reduced model's rates are.

The trajectories of all levels are compared with those of the first. Of the reduced model against the resolved
one more is known. At each step of the resolved run the reduced model is asked for its velocities at the same
configuration under the same loads on the fluid, inertia in them, so that what the two laws of motion say can
be told apart from where earlier errors have carried the bodies. The relative error of a gap is that of its
rate D', `|D'_reduced - D'_resolved| / |D'_resolved|`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline, make_interp_spline

from fsi.arrays import Array
from fsi.bodies.configuration import LOADS, MODES, PLACES, Configuration
from fsi.bodies.gaps import smallest_of_each, without_rounding
from fsi.case.case import Case
from fsi.reduced.model import ReducedModel
from fsi.reduced.network import gradient
from fsi.reduced.pairs import find_pairs

# Of a table and a plot.
TIMES = 601
LIMITS = (0.1, 0.01)
# A gap at which the two models move it in opposite directions has no small relative error; so that one
# turning point does not decide, a model is called good below a gap if this part of the samples is.
PART = 0.9


@dataclass(frozen=True, slots=True)
class History:
    """The bodies at T times: t (T,), centres (T, N, d), U and the loads on the fluid F (T, N, M).

    Of a cell that a stress shears `strain` tells by how much it has at any times (t,).
    """

    t: Array
    centres: Array
    U: Array
    F: Array
    strain: Callable[[Array], Array] = np.zeros_like

    @classmethod
    def of_tables(cls, case: Case, table: Mapping[str, Array], steps: Mapping[str, Array]) -> History:
        """From the columns of bodies.csv and steps.csv."""
        N, d = len(case.bodies), case.dimension
        x = np.stack([table[name].reshape(-1, N) for name in PLACES[d][:d]], axis=2)
        U = np.stack([table[name].reshape(-1, N) for name in MODES[d]], axis=2)
        F = np.stack([table[name].reshape(-1, N) for name in LOADS[d]], axis=2)
        t = table["t"].reshape(-1, N)[:, 0]
        if "strain" not in steps:
            return cls(t, x, U, F)
        return cls(t, x, U, F, CubicHermiteSpline(steps["t"], steps["strain"], steps["shear_rate"]))

    def at(self, t: Array) -> Array:
        """The centres at other times, by cubic interpolation, (t, N, d)."""
        d = self.centres.shape[2]
        centres: Array = CubicHermiteSpline(self.t, self.centres, self.U[:, :, :d])(t)
        return centres

    def between(self, t: Array) -> Array:
        """The centres at other times, (t, N, d), linear between steps: for velocities that jump."""
        centres: Array = make_interp_spline(self.t, self.centres, k=1)(t)
        return centres


@dataclass(frozen=True, slots=True)
class Trajectories:
    """The smallest gap of each body at all levels.

    Attributes:
        t: times, equally far from each other, shape (T,).
        gap: of each level, shape (T, N); the first level is what others are compared with.
    """

    t: Array
    gap: Mapping[str, Array]

    @property
    def smallest(self) -> dict[str, Array]:
        """The smallest gap of all over time, (T,), of each level."""
        return {level: gap.min(axis=1, initial=np.inf) for level, gap in self.gap.items()}

    @property
    def differences(self) -> dict[str, float]:
        """sup over time and bodies of the difference from the first level."""
        first = next(iter(self.gap.values()))
        return {level: float(np.abs(gap - first).max(initial=0.0)) for level, gap in self.gap.items()}


@dataclass(frozen=True, slots=True)
class RateComparison:
    """The reduced model at the configurations of a resolved run.

    Attributes:
        t: times of its steps, shape (T,).
        gap, reduced_gap: smallest gap of each body along the two trajectories, shape (T, N); NaN after the
            end of the reduced run.
        velocity: resolved, shape (T, N, d).
        reduced_velocity: of the reduced model at the resolved configurations, shape (T, N, d).
        sample_gap, rate, reduced_rate: of S samples (time and pair), shape (S,).
    """

    t: Array
    gap: Array
    reduced_gap: Array
    velocity: Array
    reduced_velocity: Array
    sample_gap: Array
    rate: Array
    reduced_rate: Array

    @property
    def rate_error(self) -> Array:
        """Relative error of each sample, (S,)."""
        error: Array = np.abs(self.reduced_rate - self.rate) / np.abs(self.rate)
        return error

    def good_below(self, limit: float) -> float | None:
        """The largest sampled gap up to which `PART` of the samples have rates within `limit`; or None."""
        order = np.argsort(self.sample_gap)
        good = np.cumsum(self.rate_error[order] <= limit) >= PART * np.arange(1, len(order) + 1)
        return float(self.sample_gap[order][good][-1]) if np.any(good) else None

    @property
    def common(self) -> NDArray[np.bool_]:
        """Which times both runs have, (T,)."""
        known: NDArray[np.bool_] = ~np.isnan(self.reduced_gap).any(axis=1)
        return known

    def bodies(self) -> list[dict[str, float]]:
        """Of each body the largest differences over time, of velocities over its largest resolved speed.

        Gaps are compared as long as both runs go on. One that is held at rest moves alike in both, which is a
        difference of 0; so are the gaps of one that meets nothing, which are infinite.
        """
        speed = np.linalg.norm(self.velocity, axis=2).max(axis=0)
        speed = np.where(speed > 0.0, speed, 1.0)
        off = np.linalg.norm(self.reduced_velocity - self.velocity, axis=2)
        gap, reduced_gap = self.gap[self.common], self.reduced_gap[self.common]
        with np.errstate(invalid="ignore"):
            gaps = np.nan_to_num(np.abs(reduced_gap / gap - 1.0))
        return [
            {
                "velocity_difference": float(off[:, i].max() / speed[i]),
                "final_velocity_difference": float(off[-1, i] / speed[i]),
                "final_gap": float(gap[-1, i]),
                "final_reduced_gap": float(reduced_gap[-1, i]),
                "gap_difference": float(gaps[:, i].max()),
            }
            for i in range(len(speed))
        ]


def trajectories(cases: Mapping[str, Case], histories: Mapping[str, History]) -> Trajectories:
    """The gaps of all levels at the same times."""
    end = min(history.t[-1] for history in histories.values())
    t = np.linspace(0.0, end, TIMES)
    gaps = {}
    for level, history in histories.items():
        # Where a model takes steps of given length its velocities jump, on contact for instance.
        centres = history.at(t) if cases[level].level.viscous else history.between(t)
        gaps[level] = _gaps_over_time(cases[level], t, centres, history.strain(t))
    return Trajectories(t, gaps)


def compare_rates(case: Case, resolved: History, reduced: History) -> RateComparison:
    """Compare the reduced run of a case with its resolved one; `case` is the reduced one.

    Raises SolveError if the reduced model fails at a configuration of the resolved run.
    """
    model, d = ReducedModel(case), case.dimension
    radii = case.configuration().radii
    reach = 2.0 * float(radii.max()) if case.reduced.cutoff is None else case.reduced.cutoff
    velocities, samples = [], []
    for t, x, U, F in zip(resolved.t, resolved.centres, resolved.U, resolved.F, strict=True):
        q = Configuration.unturned(x, radii)
        around = model.surroundings(q, float(t))
        motion = replace(around.motion, F=np.where(around.motion.held, 0.0, F))
        ours = model.under(replace(around, motion=motion), q, float(t)).U
        velocities.append(ours[:, :d])
        pairs = find_pairs(q, around.enclosure, reach)
        G = gradient(pairs, len(q))
        rates = [G @ u[:, :d].ravel() - pairs.b for u in (U, ours)]
        samples.append(np.column_stack([pairs.gap, *rates]))
    table = np.vstack(samples)
    table = table[table[:, 1] != 0.0]
    both = resolved.t <= reduced.t[-1]
    reduced_gap = np.full(resolved.centres.shape[:2], np.nan)
    t, at_rest = resolved.t, np.zeros_like(resolved.t)
    reduced_gap[both] = _gaps_over_time(case, t[both], reduced.at(t[both]), at_rest[both])
    return RateComparison(
        t,
        _gaps_over_time(case, t, resolved.centres, at_rest),
        reduced_gap,
        resolved.U[:, :, :d],
        np.array(velocities),
        *table.T,
    )


def _gaps_over_time(case: Case, t: Array, centres: Array, strain: Array) -> Array:
    """The smallest gap of each body for centres (T, N, d) at times t, (T, N); 0 in contact.

    strain: by which a stress has sheared the lattice, (T,).
    """
    radii, container = case.configuration().radii, case.container()
    gaps = np.array(
        [
            smallest_of_each(Configuration.unturned(x, radii), container.at(at, by))
            for at, x, by in zip(t.tolist(), centres, strain.tolist(), strict=True)
        ]
    )
    return without_rounding(gaps, float(radii.min(initial=np.inf)))


def comparison_json(paths: Trajectories) -> dict[str, Any]:
    """What `fsi compare --json` prints of the levels."""
    return {
        "levels": list(paths.gap),
        "times": paths.t.tolist(),
        "gaps": {level: gap.tolist() for level, gap in paths.gap.items()},
        "smallest_gaps": {level: float(gap.min()) for level, gap in paths.smallest.items()},
        "differences": paths.differences,
    }


def rates_json(names: Sequence[str], law: str, found: RateComparison) -> dict[str, Any]:
    """What `fsi compare --json` adds for the reduced level against the resolved one."""
    return {
        "law": law,
        "bodies": [{"name": name, **row} for name, row in zip(names, found.bodies(), strict=True)],
        "good_below_gap": {f"{limit:g}": found.good_below(limit) for limit in LIMITS},
        "part_of_samples": PART,
        "samples": len(found.rate),
        "smallest_gap": float(found.sample_gap.min(initial=np.inf)),
        "t": found.t.tolist(),
        "gap": found.gap.tolist(),
        "reduced_gap": found.reduced_gap.tolist(),
        "sample_gap": found.sample_gap.tolist(),
        "gap_rate": found.rate.tolist(),
        "reduced_gap_rate": found.reduced_rate.tolist(),
    }
