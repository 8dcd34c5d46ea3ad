"""What a case must satisfy to be run with the model of pores: discs, closed in by walls that move rigidly."""

from fsi.case.case import Case
from fsi.case.section import refusal, toml_text
from fsi.case.sections import EDGE_MODES
from fsi.errors import InputError

_RESOLVED = 'or give model = "resolved"'
# How many straight walls, round ones and periods close the fluid in: a cell, a channel, a box, a circle.
_CLOSED = {(0, 0, 2), (2, 0, 1), (4, 0, 0), (0, 1, 0)}


def check_pores(case: Case) -> None:
    """Raise InputError, one line with key, value and remedy, for the first thing that cannot be."""
    if case.geometry != "planar":
        raise InputError(f'geometry = "{case.geometry}": pores lie between discs; give "planar", {_RESOLVED}')
    if not case.bodies:
        raise InputError(f"bodies: missing; pores lie between discs: add [[bodies]], {_RESOLVED}")
    if case.domain.mesh is not None:
        raise refusal("domain.mesh", case.domain.mesh, "pores are no mesh; drop it")
    _check_modes(case)
    _check_closed(case)
    _check_walls(case)


def _check_modes(case: Case) -> None:
    """A tolerance begins with modes whose error more of them tell."""
    if case.pores.tolerance is not None and case.pores.modes == EDGE_MODES[-1]:
        raise InputError(
            f"pores.modes = {case.pores.modes}: a tolerance takes {EDGE_MODES[-2]} at most, whose error "
            "these tell; drop one of them"
        )


def _check_closed(case: Case) -> None:
    """Pores fill what walls and periods close in on all sides; nothing in them stands for infinity."""
    container = case.container()
    round_walls = sum(sphere is not None for sphere in container.spheres)
    found = (len(container.walls) - round_walls, round_walls, len(container.periods))
    if found not in _CLOSED or container.far_walls:
        raise InputError(
            f'domain.shape = "{case.domain.shape}": pores are closed in by walls or periods; give "box", '
            f'"round" or "cell", {_RESOLVED}'
        )


def _check_walls(case: Case) -> None:
    """Walls are solid, and slide along themselves as rigid bodies do, none against another at a corner."""
    container = case.container()
    meeting = {wall for pair in container.meetings() for wall in pair}
    for k, (name, wall) in enumerate(case.domain.walls.items()):
        here = f"domain.walls.{name}"
        if wall.outside_pressure is not None:
            raise refusal(here, wall, f"pores have no open walls; drop it, {_RESOLVED}")
        if wall.rests or wall.shear_stress(0.0) is not None:  # that moves a wall of a channel along itself
            continue
        if k in meeting or container.spheres[k] is not None:
            raise refusal(here, wall, f"only walls of a channel slide; drop it, {_RESOLVED}")
        normal = container.normals(container.middle[None])[0, k]
        for t in wall.kinks() or {0.0}:
            velocity = wall.velocity_at(t, case.dimension)
            assert velocity is not None  # it is solid
            if velocity.gradient.any() or velocity.velocity @ normal != 0.0:
                remedy = "walls slide along themselves; give [u_x, 0.0]"
                raise InputError(f"{here} = {toml_text(wall)}: {remedy}, {_RESOLVED}")
