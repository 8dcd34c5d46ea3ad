"""Whether the motion of a case is determined and its fluid incompressible, by walls and by what is held."""

from collections.abc import Iterator

import numpy as np

from fsi.arrays import Array
from fsi.bodies.configuration import rigid_motion
from fsi.case.case import Case
from fsi.case.section import refusal, toml_text
from fsi.errors import InputError


def require_determined_at_rest(case: Case) -> None:
    """Raise InputError where masses alone determine the motion: an instant is solved without them."""
    if case.masses() is None or case.wall_velocity(0.0):
        return
    if _rank(case, _stopped_modes(case, inertia=False)) < case.modes.sum():
        raise InputError(
            "bodies.0.mass: one instant is solved without inertia, and only the masses determine this "
            "motion; use `fsi run`, or give a wall a velocity or hold a body"
        )


def require_still(case: Case) -> None:
    """Raise InputError where F = R U is not all: a mean flow, or a pressure gradient that is a result too."""
    container = case.container()
    if len(container.periods) == container.dimension:
        raise InputError(
            'domain.shape = "cell": without walls bodies alone do not determine the flow, so it has no '
            'resistance matrix; give a box with periodic = ["x"]'
        )
    if (net_flux := case.domain.mean_drive().net_flux) is not None:
        why = "a resistance matrix is that at a mean pressure gradient of zero"
        raise InputError(f"domain.net_flux = {net_flux!r}: {why}; drop it")


def _rank(case: Case, stopped: Iterator[Array]) -> int:
    forms = np.array(list(stopped)).reshape(-1, len(case.modes))[:, case.modes]
    return int(np.linalg.matrix_rank(forms)) if forms.size else 0


def check_determined(case: Case) -> None:
    """Some wall, held component or mass must stop every rigid motion of fluid and bodies together.

    Without a container the fluid is at rest far away.
    """
    if case.wall_velocity(0.0) or not np.isfinite(case.container().size()):
        return
    if not case.container().walls:
        _check_cell(case)
        return
    rank = _rank(case, _stopped_modes(case))
    if rank < case.modes.sum():
        free = "what is held leaves a rigid motion of all together free" if rank else "everything is free"
        raise InputError(
            f"domain.walls = {toml_text(case.domain.walls)}: no wall has a velocity and {free}, so the "
            "motion is not determined; give a wall a velocity or hold a body"
        )


def _check_cell(case: Case) -> None:
    """A cell without walls has bodies, and its mean flow alone fixes their common translation."""
    if not case.bodies:
        raise InputError(
            f"domain.shape = {case.domain.shape!r}: a cell without bodies is not solved; add [[bodies]]"
        )
    for i, body in enumerate(case.bodies):
        if body.mass is not None:
            both = "" if body.moment_of_inertia is None else f" and bodies.{i}.moment_of_inertia"
            why = "in a cell without walls bodies have no inertia"
            raise InputError(f"bodies.{i}.mass = {body.mass!r}: {why}; drop it{both}")


def _stopped_modes(case: Case, inertia: bool = True) -> Iterator[Array]:
    """The linear forms of a global rigid motion, (M,), that held or, with inertia, heavy components fix."""
    for body in case.bodies:
        of_body = rigid_motion(np.array(body.position))
        for held, form in zip(body.motion, of_body, strict=True):
            if held != "free" or (inertia and body.mass is not None):
                yield form


def check_stress(case: Case) -> None:
    """A stress moves one wall of a channel along itself, and the other has a velocity; or a cell."""
    stressed = case.wall_stress(0.0)
    container, mean = case.container(), case.domain.mean_drive().mean_stress
    keys = [(f"domain.walls.{name}", toml_text(case.domain.walls[name]), "a velocity") for name in stressed]
    keys += [] if mean is None else [("domain.stress", toml_text(mean), "domain.shear")]
    for key, value, instead in keys:
        here = f"{key} = {value}"
        if not case.level.flow:
            raise InputError(
                f'{here}: model = "{case.model}" is not moved by a stress; give {instead}, or add '
                "--set model=resolved or pores"
            )
        if stressed and (len(container.periods), len(container.walls)) != (container.dimension - 1, 2):
            raise InputError(f"{here}: a stress moves only walls of channels; give a velocity")
        if len(stressed) > 1:
            raise InputError(
                f"{here}: so has the other wall, but one of them must be given a velocity; give it one"
            )


def check_strayed_lattice(case: Case) -> None:
    """Raise InputError where bars of positions are wanted in a lattice that moves as a result says."""
    mean = case.domain.mean_drive().mean_stress
    if mean is not None and case.output.error_estimates:
        raise InputError(
            f"output.error_estimates = true: a run under domain.stress = {mean!r} does not tell how far the "
            "strain of its cell is from the exact one; drop it, `fsi solve` has the bars of an instant"
        )


def check_periodic_walls(case: Case) -> None:
    """The velocity of a wall has the periods of the domain."""
    periods = case.container().periods
    for t in (case.kinks() or (0.0,)) if len(periods) else ():
        for name, wall in case.wall_velocity(t).items():
            if np.any(wall.gradient @ periods.T):
                here = f"domain.walls.{name}"
                raise refusal(here, case.domain.walls[name], "its flow is not periodic; give a velocity")


def check_round_sides(case: Case) -> None:
    """Raise InputError where fluid would go through the side of a tube, at any time."""
    container, times = case.container(), case.kinks() or (0.0,)
    sides = zip(container.walls, container.spheres, strict=True)
    for name in (wall for wall, side in sides if side is not None and not side.bends_all_ways):
        for t in times:
            moved = case.wall_velocity(t).get(name)
            if moved is not None and (moved.velocity[:2].any() or moved.gradient[:2].any()):
                along = 'fluid would go through it; let it move along its axis, [0.0, 0.0, v], or be "open"'
                raise refusal(f"domain.walls.{name}", case.domain.walls[name], along)


def check_flux(case: Case) -> None:
    """An incompressible fluid that is enclosed all round cannot take a net flux, at any time."""
    if case.wall_pressure() or not case.domain.walls:
        return
    fluxes = dict(zip(case.domain.walls, case.container().wall_fluxes(), strict=True))
    for t in case.kinks() or (0.0,):
        outward = {
            name: float(np.sum(fluxes[name] * np.column_stack([wall.velocity, wall.gradient])))
            for name, wall in case.wall_velocity(t).items()
        }
        worst = max(outward, key=lambda name: abs(outward[name]))
        net = sum(outward.values())
        if abs(net) > 1e-12 * abs(outward[worst]):
            raise InputError(
                f"domain.walls.{worst} = {toml_text(case.domain.walls[worst])}: the net flux out of the "
                f'closed domain is {net:.6g} at t = {t:g}; balance the wall velocities or make a wall "open"'
            )
