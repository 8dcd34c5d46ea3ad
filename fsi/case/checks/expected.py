"""What the rows [[expected]] of a case must satisfy: bodies and components that it has, fitting results."""

from typing import TYPE_CHECKING

import numpy as np

from fsi.case.case import Case
from fsi.case.quantities import NUMBERS, is_time
from fsi.case.section import nearest_word, toml_text
from fsi.case.sections import Expected
from fsi.errors import InputError

if TYPE_CHECKING:  # exact results take long to load
    from fsi.lubrication.exact_results import Fitting

# Of vectors and of what turns; in the plane a torque is a number and has none.
_COMPONENTS = {"planar": ("xy", ""), "axisymmetric": ("z", ""), "spatial": ("xyz", "xyz")}

# Of the smallest radius and the largest velocity: what is off a place, a radius or a velocity by less is not.
_SAME = 1e-9


def check_expected(case: Case) -> None:
    """Raise InputError for the first row that the case cannot give.

    For `fsi check` and `fsi validate`: whoever solves a case with a change, `--set bodies=[]`, needs no rows.
    """
    for i, row in enumerate(case.expected):
        try:
            check_quantity(case, row.quantity, f"expected.{i}.quantity = {toml_text(row.quantity)}")
        except InputError as error:
            raise InputError(f"{error}, or drop expected.{i} as a whole") from None
        if row.exact is not None:
            from fsi.lubrication.exact_results import EXACT

            _check_exact(case, row, EXACT[row.exact].fitting, f"expected.{i}.exact = {toml_text(row.exact)}")


def check_quantity(case: Case, quantity: str, here: str) -> None:
    """Raise InputError if the case cannot give that quantity; here: the key and value of the user."""
    if quantity in NUMBERS:
        if lacking := NUMBERS[quantity].lacking(case):
            raise InputError(f"{here}: {lacking}")
    elif not is_time(quantity):
        _check_component(case, quantity, here)


def _check_component(case: Case, quantity: str, here: str) -> None:
    body, kind, *axis = quantity.split(".")
    if body not in case.names:
        nearest = f"the nearest is {nearest_word(body, case.names)!r}" if case.names else "there are none"
        raise InputError(f"{here}: there is no such body; {nearest}")
    turning = kind in ("angular_velocity", "torque")
    letters = _COMPONENTS[case.geometry][turning]
    if case.axisymmetric and turning:
        raise InputError(f"{here}: a sphere on the axis does not turn; give another")
    if "".join(axis) not in (letters or ("",)) or bool(axis) != bool(letters):
        choices = ", ".join(f"{body}.{kind}.{letter}" for letter in letters) or f"{body}.{kind}"
        raise InputError(f'{here}: geometry = "{case.geometry}" has no such component; give {choices}')


def _check_exact(case: Case, row: Expected, fitting: "Fitting", here: str) -> None:
    kind = (case.geometry, case.domain.shape, len(case.bodies))
    if kind != (fitting.geometry, fitting.shape, fitting.bodies):
        raise InputError(
            f'{here}: is for geometry = "{fitting.geometry}", domain.shape = "{fitting.shape}" and '
            f"{fitting.bodies} of [[bodies]]; give such a case, or a value"
        )
    if fitting.gives != _kind(row.quantity):
        raise InputError(f"{here}: gives a {fitting.gives}, not {row.quantity}; change the quantity")
    far = case.wall_velocity(0.0).get("far")
    if fitting.sheared and (far is None or far.shear == 0.0):
        raise InputError(f"{here}: needs a shear flow; give domain.walls.far = {{ shear = 1.0 }}")
    _check_place(case, row, fitting, here)


def _check_place(case: Case, row: Expected, fitting: "Fitting", here: str) -> None:
    """Raise InputError where the bodies of a fitting case look or stand as the formula does not know them."""
    for i, body in enumerate(case.bodies):
        if body.shape is not None and not fitting.shaped:
            raise InputError(f"{here}: is for round bodies; give bodies.{i}.radius and no shape, or a value")
        if body.swims and np.any(body.angle):
            raise InputError(
                f"{here}: is for swimmers that are not turned; drop bodies.{i}.angle, or give a value"
            )
    centres, radii = case.configuration().centres, case.configuration().radii
    if fitting.place == "centre" and np.abs(centres).max() > _SAME * radii.min():
        centre = toml_text((0.0,) * case.dimension)
        raise InputError(
            f"{here}: is for a body at the centre of its container; give bodies.0.position = {centre}, or "
            "a value"
        )
    if fitting.place == "line":
        _check_approach(case, row.quantity, here)


def _check_approach(case: Case, quantity: str, here: str) -> None:
    """Raise InputError unless two equal bodies meet along the axis of the quantity.

    Otherwise a net force acts on both, which depends on the container however large it is.
    """
    axis = "xy".find(quantity[-1])
    q, motion = case.configuration(), case.motion(0.0)
    near = _SAME * q.radii.min()
    if axis < 0 or np.abs(np.delete(q.centres[1] - q.centres[0], axis)).max() > near:
        raise InputError(
            f"{here}: is for the force along a line of centres that is an axis of coordinates; change "
            "bodies.1.position or the quantity, or give a value"
        )
    if abs(q.radii[1] - q.radii[0]) > near:
        radius = toml_text(case.bodies[0].radius)
        raise InputError(f"{here}: is for equal discs; give bodies.1.radius = {radius}, or a value")
    U, held = motion.U[:, axis], motion.held[:, axis]
    if not held.all() or abs(U.sum()) > _SAME * np.abs(U).max():
        raise InputError(
            f"{here}: is for opposite velocities; give bodies.1.velocity.{axis} so that it is the opposite "
            "of that of bodies.0, or a value"
        )


def _kind(quantity: str) -> str:
    """`force`, `velocity` or `time`, a torque being a force here and a rotation a velocity; else its name."""
    if quantity in NUMBERS:
        return quantity
    if is_time(quantity):
        return "time"
    kind = quantity.split(".")[1]
    return {"torque": "force", "angular_velocity": "velocity"}.get(kind, kind)
