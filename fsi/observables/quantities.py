"""Numbers of a solved case by the names that [[expected]] rows and `fsi search` give them."""

from collections.abc import Sequence
from math import nan

import numpy as np
import scipy  # its modules load when they are used

from fsi.arrays import Array
from fsi.case.case import Case
from fsi.case.quantities import NUMBERS, time_at_gap
from fsi.errors import InputError
from fsi.integration.state import Measured
from fsi.observables.kinks import between_kinks

# A gap this close to that of a step, relative, is that one; steps that tell more than a straight line.
_ROUNDING, _FEWEST = 1e-12, 3
_PASSING = (
    3.0  # times the smallest gap of all steps: where those beside it are wider bodies pass in a few steps
)


def computed(case: Case, results: Measured, quantity: str) -> float:
    """The value of `disc.force.y`, by the fluid on the body, `disc.velocity.x`, `dissipation`, ...

    results: or their errors. Not a number where they have none.
    """
    if quantity in NUMBERS:
        value = NUMBERS[quantity].value(results)
        return nan if value is None else value
    body, mode = component(case, quantity)
    values = results.U if quantity.split(".")[1] in ("velocity", "angular_velocity") else -results.F
    return float(values[body, mode])


def component(case: Case, quantity: str) -> tuple[int, int]:
    """The body and its mode in a quantity like `disc.force.y`, `ball.force.z` or `disc.torque`."""
    name, kind, *axis = quantity.split(".")
    body = case.names.index(name)
    if case.dimension == 2:
        return body, {"x": 0, "r": 0, "y": 1, "z": 1}[axis[0]] if axis else 2
    turning = 3 if kind in ("angular_velocity", "torque") else 0
    return body, turning + "xyz".index(axis[0])


def stress_driven(found: Measured) -> dict[str, float]:
    """Columns of steps.csv: speeds of walls and the rate of shear by a stress, dp/dx by a flux, or a flux."""
    columns = {f"speed_{wall}": speed for wall, speed in found.wall_speeds.items()}
    others = {"shear_rate": found.shear_rate, "pressure_gradient": found.dp_dx, "flux": found.flux}
    return columns | {name: value for name, value in others.items() if value is not None}


def time_at(gap: float, t: Array, gaps: Array, kinks: Sequence[float] = ()) -> tuple[float, float]:
    """When the smallest gap first became `gap`, and an error.

    By the cubic spline of ln gap over t, (K,), from kink to kink: one of t over the gap is singular where the
    gap comes to rest. Its root is sought in the step that passes the gap. The error is the difference from a
    straight line there, or the way to the farther end of the step where kinks or contact leave that line
    alone. Raises InputError: never, or the run began with a smaller one.
    """
    _require_passed(gap, gaps)
    last = int(np.argmax(gaps <= gap))
    if np.isclose(gaps[last], gap, rtol=_ROUNDING, atol=0.0):
        return float(t[last]), 0.0
    before, after = t[last - 1], t[last]
    piece = next(one for one in between_kinks(t, kinks) if one.start < last < one.stop)
    closed = np.flatnonzero(gaps[piece] <= 0.0)
    rows = slice(piece.start, piece.start + int(closed[0])) if len(closed) else piece
    if rows.stop <= last or rows.stop - rows.start < _FEWEST:
        at = np.interp(-gap, -gaps[last - 1 : last + 1], (before, after))
        return float(at), float(max(at - before, after - at))
    y = np.log(gaps[rows] / gap)
    curve = scipy.interpolate.CubicSpline(t[rows], y)
    at = scipy.optimize.brentq(curve, before, after, xtol=_ROUNDING * (after - before))
    straight = np.interp(0.0, np.log(gap / gaps[last - 1 : last + 1]), (before, after))
    return float(at), float(abs(at - straight))


def _require_passed(gap: float, gaps: Array) -> None:
    """Raise InputError if no step ends with that gap or less, or if the run begins with less."""
    here, least = time_at_gap(gap), int(gaps.argmin())
    smallest = gaps[least]
    if gap < smallest < gaps[-1]:
        found = f"the smallest gap at its steps is {smallest:.4g}, and it opens at the end"
        # A parabola of ln gap through that step and those beside it falls below by less than it rises to
        # them, unless one step is 4.8 times as long as the other; bodies that pass in a few steps fall more.
        beside = gaps[max(least - 1, 0) : least + 2].max()
        between = gap > smallest**2 / beside or beside > _PASSING * smallest
        remedy = " or a shorter output.interval" if between else ", or bodies that come nearer"
        raise InputError(f"{here}: {found}; give a wider gap{remedy}")
    if smallest > gap:
        raise InputError(f"{here}: the smallest gap of the run is {smallest:.3g}; raise time.end")
    if gaps[0] < gap:
        raise InputError(f"{here}: the run begins at a gap of {gaps[0]:.3g}; give a smaller one")
