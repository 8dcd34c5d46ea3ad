"""What a case must satisfy to be run with the reduced model."""

from __future__ import annotations

from fsi.case.background_flow import background
from fsi.case.case import Case
from fsi.case.domain import MeanDrive
from fsi.errors import InputError


def check_reduced(case: Case) -> None:
    """Raise InputError, one line with key, value and remedy, for the first thing that cannot be."""
    if case.drag == 0.0 and case.masses() is None:
        raise InputError(
            "reduced.drag = 0: only lubrication would resist bodies without mass; give them drag or mass"
        )
    if case.output.error_estimates:
        raise InputError(
            "output.error_estimates = true: a reduced model has no mesh to estimate the error of; drop it"
        )
    _check_periodic(case)
    _check_background(case)
    laws = {case.reduced.law, case.reduced.wall_law or case.reduced.law}
    literal = case.time is not None and case.time.scheme == "backward-euler"
    if literal and (laws != {"slides"} or case.reduced.cutoff is not None):
        raise InputError(
            f'reduced.law = "{case.reduced.law}": scheme "backward-euler" is for "slides" without a cutoff; '
            'use time.scheme = "distance"'
        )


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
