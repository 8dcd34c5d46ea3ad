"""Numbers of a solved case by the names that [[expected]] rows and `fsi search` give them."""

from collections.abc import Mapping

from fsi.case.case import Case
from fsi.case.sections import APPARENT_VISCOSITY, DISSIPATION
from fsi.integration.state import Measured


def computed(case: Case, results: Measured, quantity: str) -> float:
    """The value of `disc.force.y`, by the fluid on the body, `disc.velocity.x`, `dissipation`, ..."""
    if quantity == DISSIPATION:
        return results.dissipation
    if quantity == APPARENT_VISCOSITY:
        return float("nan") if results.apparent_viscosity is None else results.apparent_viscosity
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


def stress_driven(wall_speeds: Mapping[str, float], shear_rate: float | None) -> dict[str, float]:
    """Columns of steps.csv: what a stress drives, speeds of walls and the rate of shear of a cell."""
    speeds = {f"speed_{wall}": speed for wall, speed in wall_speeds.items()}
    return speeds if shear_rate is None else {**speeds, "shear_rate": shear_rate}
