"""The reference of an expected row: the value that it gives, or an exact result of its case."""

from __future__ import annotations

from decimal import Decimal

from fsi.case.case import Case
from fsi.case.sections import TIME_AT_GAP, Expected, gap_of
from fsi.lubrication.exact_results import EXACT, ExactProblem

EXACT_DIGITS = 1e-13  # relative error of the functions in `fsi.lubrication`


def reference(case: Case, row: Expected) -> tuple[float, float]:
    """The reference of a row, and its relative error: half a unit of the last digit given."""
    if row.exact is not None:
        return exact_value(case, row.exact, row.quantity), EXACT_DIGITS
    assert row.value is not None  # by the schema
    exponent = Decimal(repr(row.value)).as_tuple().exponent
    return row.value, 0.5 * 10.0 ** int(exponent) / (abs(row.value) or 1.0)


def exact_value(case: Case, name: str, quantity: str) -> float:
    """What an exact result gives for a quantity of the case at time 0."""
    q = case.configuration()
    motion, far = case.motion_at(q, 0.0), case.wall_velocity(0.0).get("far")
    body, mode, gap = 0, 0, 0.0
    if quantity.startswith(TIME_AT_GAP):
        gap = gap_of(quantity)
    else:
        body, mode = component(case, quantity)
    problem = ExactProblem(
        case.fluid.viscosity, q.centres, q.radii, motion.U, motion.F, case.container().size(),
        0.0 if far is None else far.shear, body, mode, gap,
    )  # fmt: skip
    return EXACT[name].value(problem)


def component(case: Case, quantity: str) -> tuple[int, int]:
    """The body and its mode in a quantity like `disc.force.y`, `ball.force.z` or `disc.torque`."""
    name, kind, *axis = quantity.split(".")
    body = case.names.index(name)
    if case.dimension == 2:
        return body, {"x": 0, "r": 0, "y": 1, "z": 1}[axis[0]] if axis else 2
    turning = 3 if kind in ("angular_velocity", "torque") else 0
    return body, turning + "xyz".index(axis[0])
