"""What a case must satisfy whose fluid slides along surfaces, or whose bodies swim."""

import numpy as np

from fsi.case.case import Case
from fsi.case.section import refusal
from fsi.errors import InputError

# Of the largest radius or, without bodies, of the container: shorter slips are none to nine digits.
SHORTEST = 1e-9
# Sine of the angle between an axis and that of a swimmer on it: pi need not have all of its digits.
STRAIGHT = 1e-4


def check_surfaces(case: Case) -> None:
    """Raise InputError, one line with key, value and remedy, for the first thing that cannot be."""
    sliding = slip_lengths(case)
    swimming = {
        f"bodies.{i}.surface_velocity": body.surface_velocity
        for i, body in enumerate(case.bodies)
        if body.surface_velocity is not None
    }
    if sliding and case.dimension == 3 and len(case.container().periods):
        key, b = next(iter(sliding.items()))
        raise refusal(key, b, "fluid sticks to all surfaces of periodic domains in space; drop it")
    if not case.level.meshed:
        for key, value in (sliding | swimming).items():
            raise refusal(key, value, f'model = "{case.model}" does not know it; drop it or give "resolved"')
    for i, body in enumerate(case.bodies):
        if body.surface_velocity is not None and body.shape is not None:
            key = f"bodies.{i}.surface_velocity"
            raise refusal(key, body.surface_velocity, "its modes are those of discs and spheres; drop it")
        if body.swims and case.axisymmetric and abs(np.sin(body.angle)) > STRAIGHT:
            turned = "a swimmer goes along the axis; give 0.0 or 3.14159265"
            raise refusal(f"bodies.{i}.angle", body.angle, turned)
    if not sliding:
        return
    key, b = next(iter(sliding.items()))
    here = f"{key} = {b!r}"
    for option, word in (("formulation", "multiplier"), ("solver", "iterative")):
        if getattr(case.discretisation, option) == word:
            raise InputError(f'{here}: discretisation.{option} = "{word}" does not know it; drop that')
    size = max((body.radius for body in case.bodies), default=case.container().size())
    for key, b in sliding.items():
        if b < SHORTEST * size:
            raise refusal(key, b, f"is not resolved below {SHORTEST:g} of {size:g}; give 0, or drop it")
    for name in case.container().far_walls:
        if case.domain.walls[name].slip:
            here = f"domain.walls.{name}.slip_length = {case.domain.walls[name].slip!r}"
            raise InputError(f"{here}: this wall stands for infinity; drop it")


def slip_lengths(case: Case) -> dict[str, float]:
    """The slip lengths above zero, by their keys."""
    found = {f"bodies.{i}.slip_length": body.slip_length or 0.0 for i, body in enumerate(case.bodies)}
    found |= {f"domain.walls.{name}.slip_length": wall.slip for name, wall in case.domain.walls.items()}
    return {key: b for key, b in found.items() if b}
