"""Means over time of what a run has at its steps."""

from collections.abc import Sequence

import numpy as np
from scipy.interpolate import PchipInterpolator

from fsi.arrays import Array
from fsi.errors import SolveError
from fsi.observables.kinks import between_kinks

# Times from kink to kink that tell a square, and steps there that tell it well.
_FEWEST, _PARTS = 3, 8


def mean_over_time(t: Array, values: Array, kinks: Sequence[float] = ()) -> tuple[float, float | None]:
    """Of what has these values at times t, (K,): by monotone cubics (Fritsch & Carlson 1980), kink to kink.

    Steps are as long as gaps allow, so straight lines may be far off where what drives the flow changes, and
    splines without bound where a gap closes. The error, the second number, is the difference from straight
    lines, added up without signs, which cancel by chance over a run; None of one value or of infinite ones.
    """
    if len(t) == 1 or not np.isfinite(values).all():
        return float(values.mean()), None
    curved = np.concatenate([_integrals(t[k], values[k]) for k in between_kinks(t, kinks)])
    straight = 0.5 * (values[1:] + values[:-1]) * np.diff(t)
    T = t[-1] - t[0]
    return float(curved.sum() / T), float(np.abs(curved - straight).sum() / T)


def _integrals(t: Array, values: Array) -> Array:
    """Of monotone cubics, over each step, (K - 1,)."""
    return np.diff(PchipInterpolator(t, values).antiderivative()(t))


def mean_dissipation(
    t: Array, values: Array, kinks: Sequence[float], relaxed: tuple[float, float] = (0.0, np.inf)
) -> tuple[float, float | None]:
    """The same of the dissipation, where bodies have mass and dissipate `energy_relaxed` as they begin.

    The first value is at the velocities that they begin with. A narrow film may stop them in a small part of
    the first step: a line through that value has then energy that there never was, and the step gets that of
    its end and what is relaxed instead; the error is that, and by how much the next step lets it change.
    Where the line has less, the step follows them in part, and the error grows by that part of the line.
    """
    if len(t) == 1:
        return mean_over_time(t, values)
    T, h, (energy, most) = t[-1] - t[0], t[1] - t[0], relaxed
    line = abs(values[0] - values[1]) * h / 2.0
    sudden = line > most
    mean, error = mean_over_time(t, np.append(values[1], values[1:]) if sudden else values, kinks)
    if error is None or line == 0.0:
        return mean, error
    if not sudden:
        return mean, float(error + line**2 / most / T)
    later = abs(values[2] - values[1]) * h / (t[2] - t[1]) * h / 2.0 if len(t) > 2 else line
    return float(mean + energy / T), float(error + (most + later) / T)


def energy_relaxed(masses: Array, before: Array, after: Array) -> tuple[float, float]:
    """What bodies with mass dissipate beyond the rate at the velocities to which they relax, and its error.

    Of m w' = -R w and D = (V + w).R (V + w), with w = U - V, all (N, M): 1/2 w.m w + 2 V.m w. The second term
    is that of V past the fluid, which is not known: it is in the error, with the first.
    """
    w = before - after
    known = 0.5 * float((masses * w**2).sum())
    return known, known + 2.0 * float((masses * np.abs(w * after)).sum())


def require_enough(t: Array, kinks: Sequence[float], quantity: str) -> None:
    """Raise SolveError where two times alone have what goes with the square of what changes between them."""
    for piece in between_kinks(t, kinks) if kinks else []:
        if len(t[piece]) < _FEWEST:
            a, b = t[piece][[0, -1]]
            raise SolveError(
                f"--quantity {quantity}: goes with the square of what is given, and the run has no step "
                f"between t = {a:g} and {b:g}; give output.interval = {(b - a) / _PARTS:.3g}"
            )
