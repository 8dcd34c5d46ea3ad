"""The walls of a case enclose an incompressible fluid: what flows in must flow out."""

from __future__ import annotations

from fsi.case.case import Case
from fsi.case.section import toml_text
from fsi.errors import InputError


def check_flux(case: Case) -> None:
    """An incompressible fluid that is enclosed all round cannot take a net flux, at any time."""
    if case.wall_pressure() or not case.domain.walls:
        return
    fluxes = dict(zip(case.domain.walls, case.container().wall_fluxes(), strict=True))
    for t in case.knots() or (0.0,):
        outward = {
            name: float(fluxes[name][:-1] @ wall.velocity + fluxes[name][-1] * wall.shear)
            for name, wall in case.wall_velocity(t).items()
        }
        worst = max(outward, key=lambda name: abs(outward[name]))
        net = sum(outward.values())
        if abs(net) > 1e-12 * abs(outward[worst]):
            raise InputError(
                f"domain.walls.{worst} = {toml_text(case.domain.walls[worst])}: the net flux out of the "
                f'closed domain is {net:.6g} at t = {t:g}; balance the wall velocities or make a wall "open"'
            )
