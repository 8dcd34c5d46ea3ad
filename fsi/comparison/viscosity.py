"""The apparent viscosity over time at several levels, and until when they agree."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.interpolate import make_interp_spline

from fsi.arrays import Array
from fsi.comparison.motion import TIMES

AGREE = 0.02  # relative


@dataclass(frozen=True, slots=True)
class ViscosityHistories:
    """Apparent viscosities of runs at the same times.

    Attributes:
        t: the times, (T,).
        mu: of each level that has one, (T,); the first level is what others are compared with.
    """

    t: Array
    mu: Mapping[str, Array]

    @property
    def differences(self) -> dict[str, Array]:
        """Relative, from the first level, (T,)."""
        first = next(iter(self.mu.values()))
        return {level: np.asarray(mu / first - 1.0) for level, mu in self.mu.items()}

    @property
    def agree_until(self) -> dict[str, float]:
        """The time up to which each level is within AGREE of the first; curves part with trajectories."""
        off = {level: np.abs(difference) > AGREE for level, difference in self.differences.items()}
        last = {level: int(np.argmax(far)) - 1 if far.any() else len(far) - 1 for level, far in off.items()}
        return {level: float(self.t[max(k, 0)]) for level, k in last.items()}


def viscosity_histories(steps: Mapping[str, Mapping[str, Array]]) -> ViscosityHistories | None:
    """From the columns of steps.csv of each level; None where fewer than two have a viscosity."""
    curves = {}
    for level, table in steps.items():
        mu = table.get("apparent_viscosity", np.empty(0))
        known = np.isfinite(mu)
        if known.sum() > 1:
            curves[level] = table["t"][known], mu[known]
    if len(curves) < 2:
        return None
    t = np.linspace(max(t[0] for t, _ in curves.values()), min(t[-1] for t, _ in curves.values()), TIMES)
    splines = {
        level: make_interp_spline(*curve, k=min(3, len(curve[0]) - 1)) for level, curve in curves.items()
    }
    return ViscosityHistories(t, {level: np.asarray(spline(t)) for level, spline in splines.items()})


def viscosities_json(found: ViscosityHistories) -> dict[str, Any]:
    """What `fsi compare --json` adds where at least two levels have an apparent viscosity."""
    return {
        "apparent_viscosity": {
            "times": found.t.tolist(),
            "levels": {level: mu.tolist() for level, mu in found.mu.items()},
            "largest_difference": {
                level: float(np.abs(difference).max()) for level, difference in found.differences.items()
            },
            "within": AGREE,
            "agree_until": found.agree_until,
        }
    }
