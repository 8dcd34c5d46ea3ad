"""When two surfaces meet: the time of contact from how a gap has closed, by the law of its last decades.

Where lubrication alone resists, a gap under a constant force closes as

    q' = -K q^m,        q^p = p K (t_c - t),    p = 1 - m,

with m = 3/2 of two smooth surfaces in the plane, 1 of spheres, and m = 3 alpha / (1 + alpha) of a tip of
profile |x|^(1 + alpha) in the plane. Three gaps of a run give p, and for p > 0 the time of contact

    t_c = t_2 + (t_2 - t_1) q_2^p / (q_1^p - q_2^p);

for p <= 0 there is none in finite time (Gerard-Varet and Hillairet 2010, Arch. Rational Mech. Anal. 195).
The gaps are wide apart, so that steps do not matter. What p and t_c change by where all three gaps are
APART times as wide gives their errors.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy  # its modules load when they are used

from fsi.arrays import Array

APART = 3.0  # ratio of the gaps that the law is taken from
STEEPEST = 4.0  # |p| at most
SAFETY = 2.0  # of the error: corrections fall like a power of the gap below 1


@dataclass(frozen=True, slots=True)
class ContactTime:
    """How the narrowest gap of a run closes.

    Attributes:
        since: the time from which on gaps were taken.
        gap: the smallest that it came to.
        exponent: m of q' ~ -q^m there.
        exponent_error: of m, estimated.
        time: t_c; infinite where m >= 1.
        error: of t_c, estimated; infinite where it is not known whether m < 1.
    """

    since: float
    gap: float
    exponent: float
    exponent_error: float
    time: float
    error: float


def contact_time(t: Array, gap: Array) -> ContactTime | None:
    """From the times and smallest gaps of the steps of a run, (n,) each.

    None where the gap has not closed all the time by APART^3, so that there is nothing to extrapolate.
    """
    places = _places(gap)
    if places is None:
        return None
    (p, time), (before, earlier) = (_law(t[some], gap[some]) for some in (places[1:], places[:-1]))
    off = SAFETY * abs(p - before)
    sure = p - off > 0.0
    error = SAFETY * abs(time - earlier) if sure and np.isfinite(earlier) else np.inf
    return ContactTime(float(t[places[0]]), float(gap[-1]), 1.0 - p, off, time, error if p > 0.0 else 0.0)


def _places(gap: Array) -> list[int] | None:
    """The last step, and before it those at which the gap was APART, APART^2 and APART^3 as wide."""
    found = [len(gap) - 1]
    for _ in range(3):
        wide = np.flatnonzero(gap[: found[0]] >= APART * gap[found[0]])
        if len(wide) == 0 or np.any(np.diff(gap[wide[-1] :]) >= 0.0):
            return None
        found.insert(0, int(wide[-1]))
    return found


def _law(t: Array, gap: Array) -> tuple[float, float]:
    """p, and the time of contact, infinite for p <= 0, of three steps."""
    logs, steps = np.log(gap / gap[-1]), np.diff(t)

    def off(p: float) -> float:
        powers = np.expm1(p * logs) / p if p else logs  # (q^p - q_2^p) / p
        return float(-np.diff(powers) @ [steps[1], -steps[0]])

    if off(-STEEPEST) * off(STEEPEST) > 0.0:
        return -np.inf, np.inf
    p = float(scipy.optimize.brentq(off, -STEEPEST, STEEPEST, xtol=1e-12))
    if p <= 0.0:
        return p, np.inf
    return p, float(t[-1] + steps[1] / np.expm1(p * logs[1]))
