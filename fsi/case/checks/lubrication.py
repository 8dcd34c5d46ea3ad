"""What a case must satisfy in which laws take over from the mesh below a gap."""

from fsi.case.case import Case
from fsi.case.checks.surfaces import slip_lengths
from fsi.errors import InputError

# Of the smallest radius: bodies are meshed so far apart at most.
WIDEST = 0.1


def check_lubrication(case: Case) -> None:
    """Raise InputError, one line with key, value and remedy, for the first thing that cannot be."""
    if (below := case.lubrication.below) is None:
        return
    here, radii = f"lubrication.below = {below!r}", case.configuration().radii
    stressed = case.domain.mean_drive().mean_stress is not None
    swims = any(body.swims for body in case.bodies)
    refused = [
        (not case.level.meshed, f'model = "{case.model}" has no mesh for it; give "resolved", or drop it'),
        (
            case.configuration().shaped,
            "it is for discs and spheres between plane or round walls; give such ones, or drop it",
        ),
        (
            swims or bool(slip_lengths(case)),
            "fluid sticks to all surfaces beside which laws are known; drop slip_length and surface_velocity",
        ),
        (
            stressed or bool(case.wall_stress(0.0)),
            "it is for given velocities of walls and rates of shear; give these, and no stress, or drop it",
        ),
        (case.domain.mesh is not None, "a mesh of your own has the gaps that it has; drop domain.mesh"),
        (case.calibration is not None, "a law is calibrated by what is resolved; drop it"),
        (
            below > WIDEST * radii.min(initial=float("inf")),
            f"at most {WIDEST:g} of the smallest radius is known to be small; give a smaller gap, or drop it",
        ),
    ]
    for is_so, what in refused:
        if is_so:
            raise InputError(f"{here}: {what}")
