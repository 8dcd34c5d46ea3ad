"""What every case must satisfy beyond the types of its keys: names, room, loads; then what its level wants.

All checks concern the start; what happens later is the stepper's to watch.
"""

from pathlib import Path

import numpy as np

from fsi.bodies.configuration import Configuration
from fsi.bodies.gaps import find_gaps, gap_to_image, wall_gaps
from fsi.case.case import Case
from fsi.case.checks.determined import (
    check_determined,
    check_flux,
    check_periodic_walls,
    check_round_sides,
    check_stress,
)
from fsi.case.checks.gluey import check_gluey
from fsi.case.checks.lubrication import check_lubrication
from fsi.case.checks.macroscopic import check_macroscopic
from fsi.case.checks.pores import check_pores
from fsi.case.checks.reduced import check_reduced
from fsi.case.checks.shapes import check_gaps_without_prisms, check_shapes
from fsi.case.checks.surfaces import check_surfaces
from fsi.case.checks.time import check_time
from fsi.case.section import refusal, toml_text
from fsi.case.sections import HIGHEST_DEGREE
from fsi.case.series import Component, is_zero
from fsi.errors import InputError
from fsi.meshes.geometry.container import Container, lengths
from fsi.meshes.geometry.lattice import Lattice, positive

# A gap is touching when it is no larger than what rounding makes of coordinates of this size.
_ROUNDING = 8.0 * float(np.finfo(float).eps)
# Over a radius: a gap that does not touch, whatever coordinates say.
_WIDE = 1e-6
# Times the size of a periodic domain: a body so far away has its image to nine digits.
_FARTHEST = 1e6
_TAKEN = {"fluid": "fluid", "outside": "space outside the domain"}


def check_case(case: Case) -> None:
    """Raise InputError, one line with key, value and remedy, for the first thing that cannot be."""
    case.domain.require_shapes()
    _check_names(case)
    if case.axisymmetric:
        _check_axis(case)
    _check_loads(case)
    _check_inertia(case)
    _check_forces(case)
    _check_files(case)
    check_stress(case)
    check_shapes(case)
    check_surfaces(case)
    check_lubrication(case)
    if case.level.viscous:
        _check_fluid(case)
    if case.model in _OF_LEVEL:
        _OF_LEVEL[case.model](case)
    check_time(case)


# What else a level wants.
_OF_LEVEL = {
    "pores": check_pores,
    "reduced": check_reduced,
    "gluey": check_gluey,
    "macroscopic": check_macroscopic,
}


def _check_fluid(case: Case) -> None:
    """What holds wherever a viscous fluid moves the bodies."""
    if "fluid" not in case.model_fields_set:
        raise InputError("fluid: missing; give a section [fluid] with its viscosity")
    if case.level.flow or np.isfinite(case.container().size()):  # drag and gaps alone need no container
        case.domain.require_fluid()
    _check_discretisation(case)
    _check_room(case)
    check_gaps_without_prisms(case)
    check_periodic_walls(case)
    check_round_sides(case)
    check_flux(case)
    check_determined(case)


def _check_names(case: Case) -> None:
    walls = case.container().boundary_names
    first: dict[str, int] = {}
    for i, name in enumerate(case.names):
        here = f"bodies.{i}.name = {toml_text(name)}"
        if first.setdefault(name, i) != i:
            raise InputError(f"{here}: bodies.{first[name]} has the same name; give each body its own")
        if name in walls:
            raise InputError(f"{here}: a wall has this name; give the body another one")
        if name in _TAKEN:
            raise InputError(f"{here}: meshes and `fsi probe` call the {_TAKEN[name]} so; give another one")


def _check_discretisation(case: Case) -> None:
    """Degrees that there are, the iterative solver for eliminated systems in space, sparse planes."""
    given, highest = case.discretisation, HIGHEST_DEGREE[case.dimension]
    if given.degree > highest:
        raise InputError(f"discretisation.degree = {given.degree}: is at most {highest} in space; lower it")
    if given.interior == "sparse" and case.dimension == 3:
        raise InputError('discretisation.interior = "sparse": is for the plane; drop it or give "graded"')
    if given.solver == "iterative" and (case.dimension == 2 or given.formulation == "multiplier"):
        raise InputError(
            'discretisation.solver = "iterative": is for geometry = "spatial" and formulation = '
            '"eliminated"; drop it or give "direct"'
        )


def _check_room(case: Case) -> None:
    """No body touches a wall or another body."""
    q, container = case.configuration(), case.container()
    _check_sizes(case, q, container)
    touching = _ROUNDING * _largest_coordinate(q, container)
    to_walls = wall_gaps(q, container)
    for i, w in np.argwhere(to_walls <= touching)[:1]:
        here = f"bodies.{i}.position = {toml_text(case.bodies[i].position)}: body {case.names[i]!r}"
        other = f"wall {container.walls[w]!r} (gap {to_walls[i, w]:.6g})"
        _require_known(f"{here} and {other}", to_walls[i, w] / q.radii[i], touching)
        raise InputError(f"{here} touches or crosses {other}; move or shrink it")
    _check_near(case, container)
    _check_periods(case, q, container)
    gaps = find_gaps(q, container, reach=touching)
    for (i, j), gap in zip(gaps.pairs[:1], gaps.pair_gaps[:1], strict=True):
        other = repr(case.names[j]) if i != j else "its image"
        here = f"bodies.{j}.position = {toml_text(case.bodies[j].position)}: bodies {case.names[i]!r}"
        _require_known(f"{here} and {other} (gap {gap:.6g})", gap / q.radii[j], touching)
        raise InputError(f"{here} and {other} overlap or touch (gap {gap:.6g}); move them apart")


def _require_known(sides: str, gap: float, touching: float) -> None:
    """Raise InputError where the rounding of large coordinates hides a gap, over a radius, that is wide."""
    if gap > _WIDE:
        raise InputError(
            f"{sides}: coordinates as large as those here are rounded to gaps of {touching:.2g}; give a "
            "smaller domain, nearer to the origin, or a wider gap"
        )


def _check_sizes(case: Case, q: Configuration, container: Container) -> None:
    """No body is larger than the domain: along its outline waves of a wall would be followed without end."""
    size = np.inf if len(container.periods) else container.size()
    for i in np.flatnonzero(q.radii > size)[:1]:
        body = case.bodies[i]
        key, value = ("radius", body.radius) if body.shape is None else ("shape", body.shape)
        raise InputError(
            f"bodies.{i}.{key} = {toml_text(value)}: body {body.name!r} is larger than the domain (of the "
            f"size {size:.6g}); shrink it"
        )


def _check_periods(case: Case, q: Configuration, container: Container) -> None:
    """No body overlaps the images next to it: of one that is wide images without end would be listed."""
    if len(q) == 0 or len(container.periods) == 0:
        return
    lattice = Lattice(container.periods)
    near = lattice.near()
    away = lattice.shift(near[positive(near)])
    for i in np.flatnonzero(2.0 * q.radii >= lengths(away).min()):
        gaps = (gap_to_image(q, int(i), apart) for apart in away)
        for gap in (gap for gap in gaps if gap <= 0.0):
            raise InputError(
                f"bodies.{i}.position = {toml_text(case.bodies[i].position)}: bodies {case.names[i]!r} and "
                f"its image overlap or touch (gap {gap:.6g}); move them apart"
            )


def _largest_coordinate(q: Configuration, container: Container) -> float:
    """The size of the container or, without one, of what there is."""
    if np.isfinite(size := container.size()):
        return size
    return float((np.linalg.norm(q.centres, axis=1) + q.radii).max(initial=0.0))


def _check_near(case: Case, container: Container) -> None:
    """Bodies of a periodic domain are given by images so near that rounding leaves their gaps alone."""
    farthest = _FARTHEST * container.size() if len(container.periods) else np.inf
    for i, body in enumerate(case.bodies):
        if np.linalg.norm(body.position) > farthest:
            raise InputError(
                f"bodies.{i}.position = {toml_text(body.position)}: rounding hides where its image in "
                "the periodic domain lies; give the position of an image near the origin"
            )


def _check_axis(case: Case) -> None:
    """Spheres and walls respect the axis: nothing pushes or moves them off it."""
    case.domain.require_axis()
    for i, body in enumerate(case.bodies):
        off_axis = {
            "position": body.position if body.position[0] != 0.0 else None,
            "velocity": body.velocity if not _nothing(body.velocity[0]) else None,
            "angular_velocity": body.angular_velocity if not _nothing(body.motion[2]) else None,
            "force": body.force if not _nothing(body.force[0]) else None,
            "torque": body.torque if not _nothing(body.loads[2]) else None,
            "moment_of_inertia": body.moment_of_inertia,
        }
        for key, value in off_axis.items():
            if value is not None:
                raise InputError(
                    f"bodies.{i}.{key} = {toml_text(value)}: a body on the axis moves only along z;"
                    " give [0.0, z] for pairs and drop what turns it"
                )
    for name, wall in case.domain.walls.items():
        if not wall.suits_axis(along=name == "right"):
            raise refusal(f"domain.walls.{name}", wall, "is not symmetric about the axis; give [0.0, u_z]")


def _nothing(component: Component) -> bool:
    """Free, or at rest."""
    return component == "free" or is_zero(component)


def _check_loads(case: Case) -> None:
    for i, body in enumerate(case.bodies):
        for held, load, key in zip(body.motion, body.loads, body.keys, strict=True):
            if held != "free" and not is_zero(load):
                raise InputError(
                    f"bodies.{i}.{key} = {toml_text(load)}: body {body.name!r} holds this component, "
                    'so its load is a result; drop the load or make the velocity "free"'
                )


def _check_inertia(case: Case) -> None:
    """Mass and moment of inertia come together, and only what has one of them begins with a velocity."""
    for i, body in enumerate(case.bodies):
        _check_beginning(case, i)
        if case.model == "gluey" and body.moment_of_inertia is None:
            continue  # that of a uniform body
        if body.shape is not None and body.mass is not None:
            continue  # the same
        if not case.axisymmetric and (body.mass is None) != (body.moment_of_inertia is None):
            given, other = ("mass", "moment_of_inertia")[:: 1 if body.mass is not None else -1]
            raise InputError(
                f"bodies.{i}.{given} = {getattr(body, given)!r}: without {other}; give both or neither "
                "(a uniform disc has moment_of_inertia = mass radius^2 / 2, a sphere 2/5 of it)"
            )


def _check_beginning(case: Case, i: int) -> None:
    """Only a free component of a body with inertia begins with a velocity of its own."""
    body = case.bodies[i]
    for key in ("initial_velocity", "initial_angular_velocity"):
        velocity = getattr(body, key)
        if velocity is not None and body.mass is None and case.level.viscous:
            raise InputError(
                f"bodies.{i}.{key} = {toml_text(velocity)}: without a mass the velocity is a result; drop it "
                "or give mass and moment_of_inertia"
            )
    for held, begin in zip(body.motion, body.initial_motion, strict=True):
        if held != "free" and begin != 0.0:
            raise InputError(
                f"bodies.{i}.initial_velocity = {toml_text(body.initial_motion)}: body {body.name!r} holds "
                'this component; drop it there or make the velocity "free"'
            )


def _check_forces(case: Case) -> None:
    """Each law suits the case: its dimension, what there is to act on, how far it reaches."""
    heavy = case.model == "gluey" or any(body.mass is not None for body in case.bodies)
    for k, force in enumerate(case.forces):
        force.require_fit(f"forces.{k}", case.container(), heavy=heavy)
        force.require_reach(f"forces.{k}", case.container())


def _check_files(case: Case) -> None:
    mesh = case.domain.mesh
    if mesh is not None and not Path(mesh).is_file():
        what = "is a folder" if Path(mesh).is_dir() else "no such file"
        raise refusal("domain.mesh", mesh, f"{what}; give the path of a mesh file")
