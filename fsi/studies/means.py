"""Means over time of what a run has at its steps."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from scipy.interpolate import PchipInterpolator

from fsi.arrays import Array
from fsi.errors import SolveError

# Times from kink to kink that tell a square, and steps there that tell it well.
_FEWEST, _PARTS = 3, 8


def mean_over_time(t: Array, values: Array, kinks: Sequence[float] = ()) -> tuple[float, float | None]:
    """Of what has these values at times t, (K,): by monotone cubics (Fritsch & Carlson 1980), kink to kink.

    Steps are as long as gaps allow, so straight lines may be far off where what drives the flow changes, and
    splines without bound where a gap closes. The error, the second number, is the difference from straight
    lines; None of one value or of infinite ones.
    """
    if len(t) == 1 or not np.isfinite(values).all():
        return float(values.mean()), None
    whole = sum(
        PchipInterpolator(t[k], values[k]).integrate(t[k][0], t[k][-1]) for k in _between(t, kinks)
    ) / (t[-1] - t[0])
    straight = np.trapezoid(values, t) / (t[-1] - t[0])
    return float(whole), abs(float(whole - straight))


def _between(t: Array, kinks: Sequence[float]) -> list[slice]:
    """The pieces of times t from kink to kink, both ends in each."""
    ends = sorted({0, len(t) - 1, *(k for k in np.searchsorted(t, kinks).tolist() if k < len(t))})
    return [slice(first, last + 1) for first, last in pairwise(ends)]


def require_enough(t: Array, kinks: Sequence[float], quantity: str) -> None:
    """Raise SolveError where two times alone have what goes with the square of what changes between them."""
    for piece in _between(t, kinks) if kinks else []:
        if len(t[piece]) < _FEWEST:
            a, b = t[piece][[0, -1]]
            raise SolveError(
                f"--quantity {quantity}: goes with the square of what is given, and the run has no step "
                f"between t = {a:g} and {b:g}; give output.interval = {(b - a) / _PARTS:.3g}"
            )
