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

from fsi.arrays import Array
from fsi.bodies.gaps import find_gaps
from fsi.bodies.resolved_gaps import too_narrow
from fsi.case.case import Case
from fsi.case.load import parse_case
from fsi.case.sections import Calibration
from fsi.errors import InputError
from fsi.integration.state import Results
from fsi.lubrication.expansions import LawShape
from fsi.lubrication.sliding import tangents
from fsi.observables.truncation import is_infinite

# Sections of a case that none of its resistances has.
LEFT_OUT = frozenset({"calibration", "time", "output", "expected", "sweep", "forces"})
# Of a body, its samples have these keys.
_PLACE = ("name", "radius", "shape", "angle", "position")
# Of a gap: what closest points of shapes may be off it.
SAME_GAP = 1e-6
_DIGITS = 8  # of a gap over a radius


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
        assert self.case.calibration is not None  # by `fsi.calibration.finding`
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
        if abs(here - gap) > SAME_GAP * gap:
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


def _turning(values: list[float]) -> float | tuple[float, ...]:
    """As a case has rotations and torques: a number in the plane."""
    return values[0] if len(values) == 1 else tuple(values)


def planned_gaps(pair: Pair) -> list[tuple[float, bool]]:
    """(gap, held out) of all samples: the range in equal ratios, and middles of intervals spread over it.

    Those inside the range are rounded over the largest radius, so that they are the same in all units.
    """
    plan, unit = pair.plan, float(pair.case.configuration().radii.max())
    gaps = np.geomspace(*plan.range, plan.samples)
    middles = np.sqrt(gaps[1:] * gaps[:-1])
    chosen = middles[np.unique(np.linspace(0, len(middles) - 1, plan.held_out).round().astype(int))]
    gaps[1:-1], chosen = (
        [unit * float(f"{gap / unit:.{_DIGITS}g}") for gap in inner] for inner in (gaps[1:-1], chosen)
    )
    return [(gap, False) for gap in gaps.tolist()] + [(gap, True) for gap in chosen]
