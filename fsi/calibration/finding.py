"""The pair that a case wants calibrated, by the names of its two sides, and what it must satisfy."""

from dataclasses import replace

import numpy as np

from fsi.bodies.gaps import foot_between
from fsi.calibration.film import film_length
from fsi.calibration.pair import SAME_GAP, Pair, planned_gaps
from fsi.calibration.sharpness import is_sharp, sharpness
from fsi.case.case import Case
from fsi.case.checks.surfaces import slip_lengths
from fsi.case.section import refusal, toml_text
from fsi.case.sections import Calibration
from fsi.errors import InputError
from fsi.lubrication.expansions import pair_series
from fsi.lubrication.fitting import FREE
from fsi.meshes.geometry.feet import Foot
from fsi.meshes.geometry.placed import Placed
from fsi.meshes.geometry.wall_feet import wall_feet

# Radii are equal to this, relative.
_EQUAL = 1e-9
# Of a radius: what closest points on an axis may be off it.
_ON_AXIS = 1e-6


def pair_of(case: Case) -> Pair:
    """The pair that a case wants calibrated. Raises InputError: [calibration] is missing or does not fit."""
    plan = case.calibration
    if plan is None:
        raise InputError("calibration: missing; give a section [calibration] with pair and range")
    for key, b in slip_lengths(case).items():
        raise refusal(key, b, "laws of gaps are those of surfaces that fluid sticks to; drop it")
    pair = _named(case, plan)
    _check_alone(pair)
    _check_mode(pair)
    _check_tips(pair)
    _check_surroundings(case)
    pair.require_resolved()
    for gap in plan.range:
        pair.require_gap(gap)
    _check_reach(pair)
    return pair


def _refusal(plan: Calibration, what: str) -> InputError:
    return refusal("calibration.pair", plan.pair, what)


def _named(case: Case, plan: Calibration) -> Pair:
    """The two sides of the names, however they fit. Raises InputError: there are none."""
    one, other = plan.pair
    if one not in case.names:
        raise _refusal(plan, f"no body is named {one!r}; the bodies are {toml_text(case.names)}")
    first = case.names.index(one)
    if other in case.names and other != one:
        return _two_bodies(case, first, case.names.index(other))
    if other in case.container().walls:
        return _beside_wall(case, first, other)
    raise _refusal(plan, f"{other!r} is no other body and no wall; {_remedy(case, one)}")


def _remedy(case: Case, one: str) -> str:
    """What to give as the other side: another body, or beside a lone one a wall that may be."""
    walls = case.container().walls if len(case.bodies) == 1 else ()
    others = [name for name in case.names if name != one]
    others += [wall for k, wall in enumerate(walls) if _is_plane(case, k)]
    return (
        f"use one of {toml_text(others)}" if others else "give a second body, or a domain with a plane wall"
    )


def _two_bodies(case: Case, first: int, second: int) -> Pair:
    """Two bodies. Raises InputError: on an axis their closest points are off it."""
    q = case.configuration()
    apart = q.centres[first] - q.centres[second]
    distance = float(np.linalg.norm(apart))
    gap = distance - float(q.radii[first] + q.radii[second])
    pair = Pair(case, first, second, apart / distance, gap)
    if not q.outlines:
        return pair
    return _at_closest_points(pair, _straightened(foot_between(q, first, second), q.placed[second]))


def _at_closest_points(pair: Pair, foot: Foot) -> Pair:
    """The pair with the normal and the gap of shapes. Raises InputError: on an axis they are off it."""
    if not pair.case.axisymmetric:
        return replace(pair, normal=foot.normal, gap=foot.gap, shaped=True)
    r = abs(float(foot.x[0]))
    if r > _ON_AXIS * pair.case.configuration().radii[pair.first]:
        what = f"their closest points are at r = {r:.3g}, laws are those on the axis; turn them"
        raise _refusal(pair.plan, what)
    return replace(pair, normal=np.array([0.0, np.sign(foot.normal[1])]), gap=foot.gap, shaped=True)


def _straightened(foot: Foot, other: Placed) -> Foot:
    """With the normal along the way across, which the end of a tip, bent without bound, tells less well."""
    way = foot.x - other.at(other.nearest(foot.x[None])).x[0]
    length = float(np.hypot(*way))
    return replace(foot, normal=way / length) if length > SAME_GAP * other.outline.radius else foot


def _beside_wall(case: Case, first: int, wall: str) -> Pair:
    """A body and a wall, whose normal points into the fluid. Raises InputError: the wall is not plane."""
    container, q = case.container(), case.configuration()
    k = container.walls.index(wall)
    if not _is_plane(case, k):
        what = f"this wall is not plane; {_remedy(case, case.names[first])}"
        raise refusal("calibration.pair.1", wall, what)
    if q.outlines:
        foot = wall_feet(q.placed[first], container)[k]
        return _at_closest_points(Pair(case, first, None, foot.normal, foot.gap), foot)
    distance, normal = container.to_wall(k, q.centres[first][None])
    return Pair(case, first, None, normal[0], float(distance[0] - q.radii[first]))


def _is_plane(case: Case, k: int) -> bool:
    """Whether a wall is plane, or beside shapes any that is no circle."""
    container = case.container()
    if case.axisymmetric and container.corner_axes[k] == 0:  # a cylinder about the axis
        return False
    return container.plane[k] or (bool(case.configuration().outlines) and container.spheres[k] is None)


def _check_alone(pair: Pair) -> None:
    """There are no other bodies."""
    if (count := len(pair.case.bodies)) != (1 if pair.second is None else 2):
        raise _refusal(pair.plan, f"the case has {count} bodies; drop those that are not of the pair")


def _check_mode(pair: Pair) -> None:
    """The sides can move by the mode, and a law of it is known."""
    mode, wrong = pair.plan.mode, None
    if mode != "squeeze" and pair.case.axisymmetric:
        wrong = 'bodies on an axis of symmetry do not slide or turn; give "squeeze"'
    elif mode == "rotation" and pair.second is not None and pair.ratio > 1.0 + _EQUAL:
        wrong = "bodies of two radii slide as a couple turns them; give equal radii"
    elif mode != "squeeze" and pair.shaped:
        wrong = 'laws of shapes are those along the normal; give "squeeze"'
    if wrong is not None:
        raise refusal("calibration.mode", mode, wrong)


def _check_tips(pair: Pair) -> None:
    """The powers of the gap are known."""
    case, plan = pair.case, pair.plan
    if case.axisymmetric and any(is_sharp(outline) for outline in case.configuration().outlines):
        raise _refusal(plan, "laws of bodies on an axis are those of smooth ones; drop the tip")
    if len(set(sharpness(case, plan.pair[1]))) > 1:
        raise _refusal(plan, "between a tip and what is curved there are more powers; give a plane wall")


def _check_reach(pair: Pair) -> None:
    """A series has samples where it converges; the table has them anywhere."""
    plan = pair.plan
    if plan.form == "table":
        return
    fewest, what = FREE + 1, "the smaller diameter"
    if pair.shape == "shapes":
        fewest, what = FREE + 2, "the length to which both shapes go on as they do where they are nearest"
        reach = film_length(pair)
        if reach == 0.0:
            flat = "the shapes are flat where they are nearest, of no power law of the gap"
            raise _refusal(plan, f'{flat}; turn them, or give calibration.form = "table"')
    else:
        reach = pair.reduced_radius * pair_series(pair.shape, plan.mode, pair.ratio).reach
    if sum(gap < reach for gap, held_out in planned_gaps(pair) if not held_out) < fewest:
        where = f"a series takes {fewest} samples at least at gaps below {what}, {reach:.4g}"
        raise refusal("calibration.range", plan.range, f'{where}; give them, or calibration.form = "table"')


def _check_surroundings(case: Case) -> None:
    """Walls at rest or open, nothing else that drives a flow, and a mesh that can be made for any gap."""
    # Zero net flux is a given one too: then the fluid rests far away, but its pressure drops.
    at_rest = "a resistance needs fluid at rest far away and no pressure drop, not a given flux"
    case.domain.require_undriven(at_rest)
    for name, wall in case.domain.walls.items():
        if not wall.rests and wall.outside_pressure != 0.0:
            raise refusal(f"domain.walls.{name}", wall, "a resistance needs walls at rest; drop it")
    if case.domain.mesh is not None:
        raise refusal("domain.mesh", case.domain.mesh, "a mesh has one gap, a calibration many; drop it")
