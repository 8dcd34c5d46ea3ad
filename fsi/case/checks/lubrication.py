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
    unknown = {
        f'model = "{case.model}" has no mesh for it; give "resolved"': case.model != "resolved",
        "it is for discs and spheres between plane or round walls; give such bodies and walls": (
            case.configuration().shaped
        ),
        "fluid sticks to all surfaces beside which laws are known; drop slip_length and surface_velocity": (
            bool(slip_lengths(case)) or any(body.swims for body in case.bodies)
        ),
        "it is for given velocities of walls and rates of shear; give these in place of a stress": (
            bool(case.wall_stress(0.0)) or stressed
        ),
        "a mesh of your own has the gaps that it has; drop domain.mesh": case.domain.mesh is not None,
        "a law is calibrated by what is resolved; drop it": case.calibration is not None,
        f"at most {WIDEST:g} of the smallest radius is known to be small; give a smaller gap": (
            below > WIDEST * radii.min(initial=float("inf"))
        ),
    }
    for remedy, refused in unknown.items():
        if refused:
            raise InputError(f"{here}: {remedy}, or drop it" if "drop" not in remedy else f"{here}: {remedy}")
