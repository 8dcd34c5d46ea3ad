"""The pair of bodies that a calibration case samples: its geometry, and the case at any gap.

Beside a wall the body moves at unit speed, along the normal (squeeze) or along the wall (shear), or turns at
unit rate, and the resistance is the load of that motion. Two bodies feel opposite unit loads, free otherwise,
and the resistance is one over the rate at which they then move relative to each other: so neither net force
nor torque is felt far away. With the normal n, a tangent t, m = n x t, and the distance d of the centres,

    squeeze    forces n                                  rate of the gap
    shear      forces t with torques -l_i m, -l_j m      t.(u_i - u_j) - (l_i omega_i + l_j omega_j).m
    rotation   a couple, of equal bodies                 (omega_i - omega_j).m

where the arms l_i = a_i d/(a_i + a_j) meet between the surfaces. A couple on bodies of two radii makes
their surfaces slide too; no such law is calibrated. Where a body or the wall has a shape n is the normal at
the closest points, bodies move along it and do not turn, and only squeeze is calibrated. Loads, forces,
motions, masses and velocities in the case do not count.
"""

from dataclasses import dataclass, replace
from math import inf
from typing import Any

import numpy as np

from fsi.bodies.configuration import Array
from fsi.bodies.gaps import find_gaps, foot_between
from fsi.bodies.resolved_gaps import too_narrow
from fsi.calibration.sharpness import is_sharp, sharpness
from fsi.case.case import Case
from fsi.case.checks.surfaces import slip_lengths
from fsi.case.load import parse_case
from fsi.case.section import refusal, toml_text
from fsi.case.sections import Calibration
from fsi.errors import InputError
from fsi.integration.state import Results
from fsi.lubrication.expansions import LawShape
from fsi.lubrication.sliding import tangents
from fsi.meshes.geometry.feet import Foot
from fsi.meshes.geometry.placed import Placed
from fsi.meshes.geometry.wall_feet import wall_feet
from fsi.observables.truncation import is_infinite

# Sections of a case that none of its resistances has.
LEFT_OUT = frozenset({"calibration", "time", "output", "expected", "sweep", "forces"})
# Of a body, its samples have these keys.
_PLACE = ("name", "radius", "shape", "angle", "position")
# Radii are equal to this, relative.
_EQUAL = 1e-9
# Of a gap: what closest points of shapes may be off it.
_SAME_GAP = 1e-6
# Of a radius: what closest points on an axis may be off it.
_ON_AXIS = 1e-6


@dataclass(frozen=True, slots=True)
class Pair:
    """A body and a plane wall, or two bodies.

    Attributes:
        case: with its [calibration].
        first: index of the body that moves.
        second: index of the other, None for a wall.
        normal: unit vector from the other to the first, shape (d,).
        gap: between them in the case.
        shaped: whether one of them is no disc, sphere or plane.
    """

    case: Case
    first: int
    second: int | None
    normal: Array
    gap: float
    shaped: bool = False

    @property
    def plan(self) -> Calibration:
        """The section [calibration]."""
        assert self.case.calibration is not None  # by `pair_of`
        return self.case.calibration

    @property
    def shape(self) -> LawShape:
        """What the bodies are."""
        if self.shaped:
            return "shapes"
        return "discs" if self.case.geometry == "planar" else "spheres"

    @property
    def ratio(self) -> float:
        """The larger radius over the smaller, infinite beside a wall."""
        if self.second is None:
            return inf
        radii = self.case.configuration().radii
        return float(max(radii) / min(radii))

    @property
    def reduced_radius(self) -> float:
        """a_r = a b/(a + b), beside a wall a."""
        radii = self.case.configuration().radii
        return float(1.0 / np.sum(1.0 / radii))

    @property
    def confined(self) -> bool:
        """Whether there is more than the pair in a container that stands for infinity."""
        others = [wall for wall in self.case.container().walls if wall != self.plan.pair[1]]
        return len(others) > 1 or not is_infinite(self.at(self.plan.range[1]))

    def at(self, gap: float) -> Case:
        """The case at this gap, with its unit motion alone. Raises InputError: bodies have no room there."""
        data: dict[str, Any] = self.case.model_dump(exclude_none=True, exclude={*LEFT_OUT, "reduced"})
        data["bodies"] = list(data["bodies"])
        for i, body in enumerate(data["bodies"]):
            place = {key: body[key] for key in _PLACE if key in body}
            data["bodies"][i] = place | self._motion(i, gap)
        data["bodies"][self.first]["position"] = tuple(self._centre(gap).tolist())
        try:
            return parse_case(data)
        except InputError as error:
            here = f"calibration.range: at the gap {gap:g}"
            raise InputError(f"{here} the case is not sound: {error}") from None

    def _centre(self, gap: float) -> Array:
        """Of the first body at this gap, (d,)."""
        return np.asarray(self.case.configuration().centres[self.first] + (gap - self.gap) * self.normal)

    def require_resolved(self) -> None:
        """Raise InputError where the smallest gap of the range is one that is not resolved."""
        q, gap = self.case.configuration(), self.plan.range[0]
        centres = q.centres.copy()
        centres[self.first] = self._centre(gap)
        narrow = too_narrow(replace(q, centres=centres), self.case.container(), self.case.names)
        if narrow is not None:
            raise InputError(f"calibration.range.0 = {gap:g}: {narrow}; begin at a wider gap")

    def require_gap(self, gap: float) -> None:
        """Raise InputError where bodies have no room at this gap, or it is another one between shapes."""
        case = self.at(gap)
        if not self.shaped:
            return
        found = find_gaps(case.configuration(), case.container(), np.inf)
        walls = case.container().walls
        here = (
            found.pair_gaps[0]
            if self.second is not None
            else found.wall_gaps[self.first, walls.index(self.plan.pair[1])]
        )
        if abs(here - gap) > _SAME_GAP * gap:
            raise InputError(
                f"calibration.range: at the gap {gap:g} other points are closest, {here:g} apart; move the "
                "bodies so that the same points are at all gaps"
            )

    def resistance(self, gap: float, results: Results, errors: Results) -> tuple[float, float]:
        """F/U, and its error, from U and F of the case at this gap and their errors."""
        if self.second is None:
            direction = self._unit_motion()
            return float(results.F[self.first] @ direction), float(errors.F[self.first] @ np.abs(direction))
        sides = [self.first, self.second]
        unit = np.array([self._unit_loads(i, gap) for i in sides])
        speed, error = np.sum(results.U[sides] * unit), np.sum(errors.U[sides] * np.abs(unit))
        return float(1.0 / speed), float(error / speed**2)

    def _unit_loads(self, i: int, gap: float) -> Array:
        """Force and torque on body i of two, which are also the factors of its modes in the rate, (M,)."""
        n, mode, sign = self.normal, self.plan.mode, 1.0 if i == self.first else -1.0
        t = tangents(n[None])[0][0]
        m = np.ones(1) if len(n) == 2 else np.cross(n, t)
        if mode == "squeeze":
            return np.concatenate([sign * n, 0.0 * m])
        if mode == "rotation":
            return np.concatenate([0.0 * n, sign * m])
        radii = self.case.configuration().radii
        return np.concatenate([sign * t, -radii[i] * (1.0 + gap / radii.sum()) * m])

    def _motion(self, i: int, gap: float) -> dict[str, Any]:
        d = len(self.normal)
        if self.second is not None:
            loads = self._unit_loads(i, gap).tolist()
            given: dict[str, Any] = {"force": tuple(loads[:d])}
            if self.shaped:
                return given | {"angular_velocity": 0.0}
            return given if self.plan.mode == "squeeze" else given | {"torque": _turning(loads[d:])}
        motion = self._unit_motion().tolist()
        return {"velocity": tuple(motion[:d]), "angular_velocity": _turning(motion[d:])}

    def _unit_motion(self) -> Array:
        """The unit motion beside a wall, along the modes of a body."""
        d = len(self.normal)
        tangent = np.roll(self.normal, 1)  # of a normal along an axis of coordinates
        motion = np.zeros(len(self.case.modes))
        if self.plan.mode == "rotation":
            motion[d:] = 1.0 if d == 2 else np.cross(self.normal, tangent)
        else:
            motion[:d] = self.normal if self.plan.mode == "squeeze" else tangent
        return motion


def pair_of(case: Case) -> Pair:
    """The pair that a case wants calibrated. Raises InputError: [calibration] is missing or does not fit."""
    plan = case.calibration
    if plan is None:
        raise InputError("calibration: missing; give a section [calibration] with pair and range")
    for key, b in slip_lengths(case).items():
        raise refusal(key, b, "laws of gaps are those of surfaces that fluid sticks to; drop it")
    here = f"calibration.pair = {toml_text(plan.pair)}"
    if plan.pair[0] not in case.names:
        raise InputError(f"{here}: no body is named {plan.pair[0]!r}; the bodies are {toml_text(case.names)}")
    first = case.names.index(plan.pair[0])
    if plan.pair[1] in case.names and plan.pair[1] != plan.pair[0]:
        q, second = case.configuration(), case.names.index(plan.pair[1])
        apart = q.centres[first] - q.centres[second]
        distance = float(np.linalg.norm(apart))
        gap = distance - float(q.radii[first] + q.radii[second])
        pair = Pair(case, first, second, apart / distance, gap)
        if q.outlines:
            foot = _straightened(foot_between(q, first, second), q.placed[second])
            pair = _at_closest_points(pair, foot)
    elif plan.pair[1] in case.container().walls:
        pair = _beside_wall(case, first, plan.pair[1])
    else:
        others = [*(name for name in case.names if name != plan.pair[0]), *case.container().walls]
        remedy = f"use one of {toml_text(others)}"
        raise InputError(f"{here}: {plan.pair[1]!r} is no other body and no wall; {remedy}")
    if (count := len(case.bodies)) != (1 if pair.second is None else 2):
        raise InputError(f"{here}: the case has {count} bodies; drop those that are not of the pair")
    here = f"calibration.mode = {toml_text(plan.mode)}"
    if plan.mode != "squeeze" and case.axisymmetric:
        raise InputError(f'{here}: bodies on an axis of symmetry do not slide or turn; give "squeeze"')
    if plan.mode == "rotation" and pair.second is not None and pair.ratio > 1.0 + _EQUAL:
        raise InputError(f"{here}: bodies of two radii slide as a couple turns them; give equal radii")
    if plan.mode != "squeeze" and pair.shaped:
        raise InputError(f'{here}: laws of shapes are those along the normal; give "squeeze"')
    if case.axisymmetric and any(is_sharp(outline) for outline in case.configuration().outlines):
        here = f"calibration.pair = {toml_text(plan.pair)}"
        raise InputError(f"{here}: laws of bodies on an axis are those of smooth ones; drop the tip")
    if len(set(sharpness(case, plan.pair[1]))) > 1:
        here = f"calibration.pair = {toml_text(plan.pair)}"
        raise InputError(f"{here}: between a tip and what is curved there are more powers; give a plane wall")
    _check_surroundings(case)
    pair.require_resolved()
    for gap in plan.range:
        pair.require_gap(gap)
    return pair


def _at_closest_points(pair: Pair, foot: Foot) -> Pair:
    """The pair with the normal and the gap of shapes. Raises InputError: on an axis they are off it."""
    if not pair.case.axisymmetric:
        return replace(pair, normal=foot.normal, gap=foot.gap, shaped=True)
    r = abs(float(foot.x[0]))
    if r > _ON_AXIS * pair.case.configuration().radii[pair.first]:
        here = f"calibration.pair = {toml_text(pair.plan.pair)}"
        raise InputError(
            f"{here}: their closest points are at r = {r:.3g}, laws are those on the axis; turn them"
        )
    return replace(pair, normal=np.array([0.0, np.sign(foot.normal[1])]), gap=foot.gap, shaped=True)


def _straightened(foot: Foot, other: Placed) -> Foot:
    """With the normal along the way across, which the end of a tip, bent without bound, tells less well."""
    way = foot.x - other.at(other.nearest(foot.x[None])).x[0]
    length = float(np.hypot(*way))
    return replace(foot, normal=way / length) if length > _SAME_GAP * other.outline.radius else foot


def _turning(values: list[float]) -> float | tuple[float, ...]:
    """As a case has rotations and torques: a number in the plane."""
    return values[0] if len(values) == 1 else tuple(values)


def _beside_wall(case: Case, first: int, wall: str) -> Pair:
    """A body and a wall, whose normal points into the fluid. Raises InputError: the wall is not plane."""
    container, q = case.container(), case.configuration()
    k = container.walls.index(wall)
    if q.outlines and container.spheres[k] is None:
        foot = wall_feet(q.placed[first], container)[k]
        return _at_closest_points(Pair(case, first, None, foot.normal, foot.gap), foot)
    around = case.axisymmetric and container.corner_axes[k] == 0  # a cylinder about the axis
    if around or not container.plane[k]:
        raise InputError(f"calibration.pair.1 = {toml_text(wall)}: this wall is not plane; give one that is")
    distance, normal = container.to_wall(k, q.centres[first][None])
    return Pair(case, first, None, normal[0], float(distance[0] - q.radii[first]))


def _check_surroundings(case: Case) -> None:
    """Walls at rest or open, nothing else that drives a flow, and a mesh that can be made for any gap."""
    for key in ("shear", "extension", "pressure_gradient", "net_flux"):
        driven = getattr(case.domain, key, None)
        if driven:
            raise InputError(f"domain.{key} = {driven:g}: a resistance needs fluid at rest far away; drop it")
    for name, wall in case.domain.walls.items():
        if not wall.rests and wall.outside_pressure != 0.0:
            here = f"domain.walls.{name} = {toml_text(wall)}"
            raise InputError(f"{here}: a resistance needs walls at rest; drop it")
    if case.domain.mesh is not None:
        here = f"domain.mesh = {toml_text(case.domain.mesh)}"
        raise InputError(f"{here}: a mesh has one gap, a calibration many; drop it")
