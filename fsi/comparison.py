"""The reduced model against the resolved one: gap rates at the same configurations, and the two trajectories.

At each step of the resolved run the reduced model is asked for its velocities at the same configuration under
the same loads on the fluid, inertia in them, so that what the two laws of motion say can be told apart from
where earlier errors have carried the bodies. The relative error of a gap is that of its rate D',
`|D'_reduced - D'_resolved| / |D'_resolved|`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline

from fsi.bodies.configuration import LOADS, MODES, PLACES, Array, Configuration
from fsi.bodies.gaps import find_gaps
from fsi.case.case import Case
from fsi.meshes.geometry.containers import Container
from fsi.reduced.model import ReducedModel
from fsi.reduced.network import gradient
from fsi.reduced.pairs import find_pairs

LIMITS = (0.1, 0.01)
# A gap at which the two models move it in opposite directions has no small relative error; so that one
# turning point does not decide, a model is called good below a gap if this part of the samples is.
PART = 0.9


@dataclass(frozen=True, slots=True)
class History:
    """The bodies at T times: t (T,), centres (T, N, d), U and the loads on the fluid F (T, N, M)."""

    t: Array
    centres: Array
    U: Array
    F: Array

    @classmethod
    def of_table(cls, case: Case, table: Mapping[str, Array]) -> History:
        """From the columns of bodies.csv."""
        N, d = len(case.bodies), case.dimension
        x = np.stack([table[name].reshape(-1, N) for name in PLACES[d][:d]], axis=2)
        U = np.stack([table[name].reshape(-1, N) for name in MODES[d]], axis=2)
        F = np.stack([table[name].reshape(-1, N) for name in LOADS[d]], axis=2)
        return cls(table["t"].reshape(-1, N)[:, 0], x, U, F)

    def at(self, t: Array) -> Array:
        """The centres at other times, by cubic interpolation, (t, N, d)."""
        d = self.centres.shape[2]
        centres: Array = CubicHermiteSpline(self.t, self.centres, self.U[:, :, :d])(t)
        return centres


@dataclass(frozen=True, slots=True)
class Comparison:
    """What came of it.

    t (T,); gap, reduced_gap: smallest gap of each body along the two trajectories, (T, N); velocity:
    resolved, and reduced_velocity: of the reduced model at the resolved configurations, (T, N, d); of S
    samples (time and pair): sample_gap, rate, reduced_rate, (S,).
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

    def bodies(self) -> list[dict[str, float]]:
        """Of each body the largest differences over time, of velocities over its largest resolved speed.

        One that is held at rest moves alike in both, which is a difference of 0.
        """
        speed = np.linalg.norm(self.velocity, axis=2).max(axis=0)
        speed = np.where(speed > 0.0, speed, 1.0)
        off = np.linalg.norm(self.reduced_velocity - self.velocity, axis=2)
        gaps = np.abs(self.reduced_gap - self.gap) / self.gap
        return [
            {
                "velocity_difference": float(off[:, i].max() / speed[i]),
                "final_velocity_difference": float(off[-1, i] / speed[i]),
                "final_gap": float(self.gap[-1, i]),
                "final_reduced_gap": float(self.reduced_gap[-1, i]),
                "gap_difference": float(gaps[:, i].max()),
            }
            for i in range(len(speed))
        ]


def compare(case: Case, resolved: History, reduced: History) -> Comparison:
    """Compare two runs of a case; `case` is the reduced one.

    Raises:
        SolveError: the reduced model fails at a configuration of the resolved run.
    """
    model, d = ReducedModel(case), case.dimension
    radii, container = case.configuration().radii, case.container()
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

    def gaps(centres: Array) -> Array:
        return np.array(
            [
                _gaps_of_each(Configuration.unturned(x, radii), container.at(float(t)))
                for t, x in zip(resolved.t, centres, strict=True)
            ]
        )

    return Comparison(
        resolved.t,
        gaps(resolved.centres),
        gaps(reduced.at(resolved.t)),
        resolved.U[:, :, :d],
        np.array(velocities),
        *table.T,
    )


def _gaps_of_each(q: Configuration, container: Container) -> NDArray[np.float64]:
    return find_gaps(q, container, reach=container.size()).smallest_of_each()


def comparison_json(names: Sequence[str], law: str, found: Comparison) -> dict[str, Any]:
    """The object that `fsi compare --json` prints."""
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
