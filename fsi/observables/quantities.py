"""Numbers of a solved case by the names that [[expected]] rows and `fsi search` give them."""

import numpy as np
import scipy  # its modules load when they are used

from fsi.arrays import Array
from fsi.case.case import Case
from fsi.case.sections import APPARENT_VISCOSITY, DISSIPATION, SHEAR_RATE, TIME_AT_GAP, WALL_SPEED
from fsi.errors import InputError
from fsi.integration.state import Measured


def computed(case: Case, results: Measured, quantity: str) -> float:
    """The value of `disc.force.y`, by the fluid on the body, `disc.velocity.x`, `dissipation`, ..."""
    if quantity == DISSIPATION:
        return results.dissipation
    if quantity == APPARENT_VISCOSITY:
        return float("nan") if results.apparent_viscosity is None else results.apparent_viscosity
    if quantity in (SHEAR_RATE, WALL_SPEED):
        # Only what a stress moves has these, and the case was checked for that.
        return stress_driven(results)[stress_column(case, quantity)]
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


def stress_column(case: Case, quantity: str) -> str:
    """That of the rate of shear or of the wall in steps.csv."""
    return "shear_rate" if quantity == SHEAR_RATE else f"speed_{next(iter(case.wall_stress(0.0)))}"


def time_at(gap: float, t: Array, gaps: Array) -> float:
    """When the smallest gap first became `gap`, by a spline of t over ln gap.

    Raises InputError: never, or the run began with a smaller one.
    """
    if (smallest := gaps.min()) > gap:
        here = f"{TIME_AT_GAP}{gap:g}: the smallest gap of the run"
        raise InputError(f"{here} is {smallest:.3g}; raise time.end")
    if gaps[0] < gap:
        raise InputError(
            f"{TIME_AT_GAP}{gap:g}: the run begins at a gap of {gaps[0]:.3g}; give a smaller one"
        )
    if gaps[0] == gap:
        return float(t[0])
    last = int(np.argmax(gaps <= gap))
    rises = np.flatnonzero(np.diff(gaps[: last + 1]) >= 0.0)
    first = int(rises[-1]) + 1 if len(rises) else 0
    later = np.flatnonzero(np.diff(gaps[last:]) >= 0.0)
    end = last + int(later[0]) + 1 if len(later) else len(gaps)
    y, s = np.log(gaps[first:end][::-1]), t[first:end][::-1]
    return float(scipy.interpolate.CubicSpline(y, s)(np.log(gap)))
