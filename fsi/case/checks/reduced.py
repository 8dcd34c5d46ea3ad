"""What a case must satisfy to be run with the reduced model."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fsi.case.background_flow import background
from fsi.case.domain import MeanDrive
from fsi.errors import InputError

if TYPE_CHECKING:
    from fsi.case.case import Case


def check_reduced(case: Case) -> None:
    """Raise InputError, one line with key, value and remedy, for the first thing that cannot be."""
    reduced = case.reduced
    if case.drag == 0.0 and reduced.scheme == "adaptive" and case.masses() is None:
        raise InputError(
            "reduced.drag = 0: only lubrication would resist bodies without mass; give them drag or mass"
        )
    if case.output.error_estimates:
        raise InputError(
            "output.error_estimates = true: a reduced model has no mesh to estimate the error of; drop it"
        )
    _check_periodic(case)
    _check_background(case)
    if reduced.scheme == "adaptive":
        if reduced.step is not None:
            raise InputError(
                f'reduced.step = {reduced.step:g}: scheme "adaptive" chooses its steps; drop it or give '
                'reduced.scheme = "distance"'
            )
        return
    _check_distance_scheme(case)


def _check_periodic(case: Case) -> None:
    """Images end at the cutoff."""
    if case.reduced.cutoff is None and len(case.container().periods):
        raise InputError(
            "reduced.cutoff: missing; a body of a periodic domain has images without end; give the gap from "
            "which on they do not feel each other"
        )


def _check_background(case: Case) -> None:
    """Walls drive a flow that is known at any time, and no pressure drives one."""
    drive = case.domain.mean_drive()
    if drive != MeanDrive(0.0, None):
        key = "pressure_gradient" if drive.net_flux is None else "net_flux"
        raise InputError(
            f"domain.{key} = {getattr(drive, key):g}: the reduced model knows only flow between moving "
            "walls; drop it"
        )
    pressures = case.wall_pressure()
    if len(set(pressures.values())) > 1:
        name = max(pressures, key=lambda name: abs(pressures[name]))
        raise InputError(
            f"domain.walls.{name} = {{pressure = {pressures[name]:g}}}: the reduced model knows no flow that "
            "pressure drives; give all open walls the same"
        )
    for t in case.knots() or (0.0,):
        background(case.container(), case.wall_velocity(t))


def _check_distance_scheme(case: Case) -> None:
    reduced = case.reduced
    if reduced.step is None:
        raise InputError(f'reduced.step: missing; scheme "{reduced.scheme}" needs the length of its steps')
    for i, body in enumerate(case.bodies):
        if body.mass is None:
            raise InputError(
                f'bodies.{i}.mass: missing; scheme "{reduced.scheme}" is for bodies with inertia: give each '
                'a mass, or use reduced.scheme = "adaptive"'
            )
    laws = {reduced.law, reduced.wall_law or reduced.law}
    if reduced.scheme == "backward-euler" and (laws != {"slides"} or reduced.cutoff is not None):
        raise InputError(
            f'reduced.law = "{reduced.law}": scheme "backward-euler" is for "slides" without a cutoff; '
            'use reduced.scheme = "distance"'
        )
