"""What bodies that are no discs or spheres, and walls with a shape, can be asked for: the resolved level."""

from collections.abc import Iterator
from math import pi

import numpy as np

from fsi.bodies.gaps import find_gaps, wall_gaps
from fsi.case.case import Case
from fsi.case.checks.containers import check_container
from fsi.case.checks.walls import check_walls
from fsi.case.section import toml_text
from fsi.case.shapes.shape import AnyShape
from fsi.errors import InputError


def check_shapes(case: Case) -> None:
    """Raise InputError, which names the first shape, where what is asked for knows none."""
    check_walls(case)
    check_container(case)
    if case.domain.profiled:
        _check_walls(case)
    if _cylinders(case):
        _check_cylinder(case)
    shaped = next(((i, body.shape) for i, body in enumerate(case.bodies) if body.shape is not None), None)
    if shaped is None:
        return
    i, shape = shaped
    here, round_ = f"bodies.{i}.shape = {toml_text(shape)}", "spheres" if case.spheres else "discs"
    if case.axisymmetric:
        _check_symmetric(case)
    if case.dimension == 3:
        _check_ellipsoids(case, here)
    if not case.level.meshed:
        raise InputError(f'{here}: model = "{case.model}" knows {round_} only; give "resolved", or a radius')
    if case.domain.mesh is not None:
        raise InputError(f"{here}: a mesh of your own is for {round_}; drop domain.mesh, or give a radius")
    if case.calibration is not None and case.dimension == 3:
        raise InputError(f"{here}: laws are calibrated for {round_}; drop [calibration], or give a radius")
    if any(force.reach > 0.0 for force in case.forces):
        raise InputError(f"{here}: [[forces]] of the gap act between {round_}; drop them, or give a radius")


def _check_ellipsoids(case: Case, here: str) -> None:
    """They have no inertia and no images."""
    if len(case.container().periods):
        raise InputError(f"{here}: periodic domains in space take spheres only; give walls, or a radius")
    for i, body in enumerate(case.bodies):
        if body.mass is not None:
            mass = f"bodies.{i}.mass = {body.mass!r}"
            raise InputError(f"{mass}: there are ellipsoids, whose inertia is not known in space; drop it")


def check_gaps_without_prisms(case: Case) -> None:
    """Raise InputError where a gap beside ellipsoids, or of spheres to a cylinder, is too narrow to mesh."""
    ellipsoids = bool(case.configuration().ellipsoids)
    if not ellipsoids and not _cylinders(case):
        return
    from fsi.meshes.spatial.sizing import NARROWEST  # which other cases do without

    size = "smallest half axis" if ellipsoids else "radius"
    gaps = _gaps_of_ellipsoids(case, NARROWEST) if ellipsoids else _gaps_to_cylinders(case)
    for i, gap, other, least in gaps:
        if gap < NARROWEST * least:
            here = f"bodies.{i}.position = {toml_text(case.bodies[i].position)}"
            raise InputError(
                f"{here}: the gap of {case.names[i]!r} to {other} is {gap:.3g}, below {NARROWEST:g} of the "
                f"{size}, {least:g}; widen it"
            )


# A body, its gap, to whom, and the length that the gap is measured by.
type _Gap = tuple[int, float, str, float]


def _gaps_of_ellipsoids(case: Case, part: float) -> Iterator[_Gap]:
    """To all walls, and those between bodies up to this part of the largest of the smallest half axes."""
    q, container = case.configuration(), case.container()
    smallest = np.array([form.half_axes.min() for form in q.ellipsoids])
    gaps = find_gaps(q, container, reach=part * float(smallest.max()))
    for (i, w), gap in np.ndenumerate(gaps.wall_gaps):
        yield i, gap, f"wall {container.walls[w]!r}", float(smallest[i])
    for (i, j), gap in zip(gaps.pairs.tolist(), gaps.pair_gaps, strict=True):
        yield j, gap, repr(case.names[i]), float(smallest[[i, j]].min())


def _gaps_to_cylinders(case: Case) -> Iterator[_Gap]:
    """Of all spheres."""
    q, container = case.configuration(), case.container()
    gaps = wall_gaps(q, container)
    for w in _cylinders(case):
        for i, radius in enumerate(q.radii.tolist()):
            yield i, gaps[i, w], f"wall {container.walls[w]!r}", radius


def _cylinders(case: Case) -> list[int]:
    """Which walls are round one way only."""
    spheres = enumerate(case.container().spheres)
    return [w for w, sphere in spheres if sphere is not None and not sphere.bends_all_ways]


def _check_symmetric(case: Case) -> None:
    """A body on an axis is one of revolution."""
    for i, body in enumerate(case.bodies):
        if body.shape is not None and not body.revolved.is_symmetric:
            assert isinstance(body.angle, float)  # it is none in space
            nearest = _symmetric_turn(body.shape, body.angle)
            quarter = "" if nearest is None else f" (the nearest quarter turn at which it is: {nearest!r})"
            raise InputError(
                f"bodies.{i}.shape = {toml_text(body.shape)}: is not symmetric about the axis r = 0 at the "
                f"angle {body.angle!r}; give a shape that is, or an angle to all digits{quarter}"
            )


def _symmetric_turn(shape: AnyShape, angle: float) -> float | None:
    """The quarter turn next to an angle at which the shape is symmetric about r = 0; None where none is."""
    quarter = 0.5 * pi
    last = round(angle / quarter)
    turns = sorted((quarter * k for k in range(last - 2, last + 3)), key=lambda turn: abs(turn - angle))
    return next((turn for turn in turns if shape.revolved(turn).is_symmetric), None)


def _check_walls(case: Case) -> None:
    """Of walls with a shape."""
    here = "domain.profiles"
    if not case.level.meshed:
        raise InputError(
            f'{here}: model = "{case.model}" knows straight walls only; give "resolved", or drop it'
        )
    if any(force.reach > 0.0 for force in case.forces):
        raise InputError(f"{here}: [[forces]] of the gap act beside straight walls; drop them, or it")


def _check_cylinder(case: Case) -> None:
    """Of a wall that is round one way only: laws, and slip, know planes and spheres."""
    here = f"domain.shape = {toml_text(case.domain.shape)}"
    if not case.level.meshed:
        raise InputError(
            f'{here}: model = "{case.model}" knows no law beside a cylinder; give "resolved", or a box'
        )
    if case.calibration is not None:
        raise InputError(f"{here}: no law beside a cylinder is calibrated; drop [calibration], or give a box")
    for name, sphere in zip(case.domain.walls, case.container().spheres, strict=True):
        wall = case.domain.walls[name]
        if sphere is not None and wall.slip:
            key = f"domain.walls.{name}.slip_length = {wall.slip!r}"
            raise InputError(f"{key}: fluid sticks to the {name} of a {case.domain.shape}; drop it")
    for i, body in enumerate(case.bodies):
        if body.shape is not None:
            raise InputError(
                f"bodies.{i}.shape = {toml_text(body.shape)}: a {case.domain.shape} takes spheres only; give "
                "a box, or a radius"
            )
