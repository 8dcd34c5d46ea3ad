"""One configuration at several levels: how far viscosity, velocities, spins and rates of gaps are off.

All levels that give velocities at an instant are asked at time 0, and compared with the first of them. With
velocities u, rotations omega, the linear flow u_inf that walls drive without bodies (else 0), and the rates
D' of gaps,

    viscosity    mu_app / mu_app of the first - 1
    velocities   |u - u of the first| / |u of the first - u_inf|
    spins        |omega - omega of the first| / |omega of the first|
    gap rates    |D' - D' of the first| / |D' of the first|, of the N narrowest gaps of N bodies

with the root of the sum of squares over the bodies, or gaps. Velocities and rates of images are those of
their bodies with the lattice's. What symmetry makes zero is so in no solve, and has no relative error: what
is below a thousandth of the speeds |u - u_inf| and |omega| a of the first.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from time import process_time
from typing import Any

import numpy as np

from fsi.bodies.configuration import Array
from fsi.case.case import Case
from fsi.errors import InputError
from fsi.models import make_model
from fsi.reduced.enclosure import Enclosure, make_enclosure, with_flow
from fsi.reduced.network import gradient
from fsi.reduced.pairs import find_pairs

# Of the speeds of the first level, what is zero to the accuracy of solves: that is some 1e-5 by default.
ZERO = 1e-3


@dataclass(frozen=True, slots=True)
class LevelAtInstant:
    """What one level gives, and its errors; None is where the first level has nothing to compare with.

    Attributes:
        apparent_viscosity: over that of the fluid.
        viscosity, velocities, spins, gap_rates: relative errors, the first with its sign.
        seconds: of CPU.
    """

    apparent_viscosity: float | None
    viscosity: float | None
    velocities: float | None
    spins: float | None
    gap_rates: float | None
    seconds: float


def compare_instants(cases: Mapping[str, Case]) -> dict[str, LevelAtInstant]:
    """The levels of a case that have an instant, none if only one has; collective.

    Raises InputError or SolveError where one of them fails.
    """
    found: dict[str, LevelAtInstant] = {}
    first: tuple[Array, Array] | None = None
    asked = {level: case for level, case in cases.items() if case.level.viscous}
    for level, case in asked.items() if len(asked) > 1 else ():
        began = process_time()
        instant = make_model(case)(case.configuration(), 0.0)
        spent = process_time() - began
        U, rates, mu = instant.U, _narrowest_rates(case, instant.U), instant.record.get("apparent_viscosity")
        if first is None:
            first, of_first = (U, rates), mu
        found[level] = replace(_errors(case, first, (U, rates)), seconds=spent)
        if mu is not None and of_first is not None and np.isfinite([mu, of_first]).all():
            both = {"apparent_viscosity": float(mu), "viscosity": float(mu / of_first - 1.0)}
            found[level] = replace(found[level], **both)
    return found


def _errors(case: Case, first: tuple[Array, Array], here: tuple[Array, Array]) -> LevelAtInstant:
    """Without viscosity."""
    d, q = case.dimension, case.configuration()
    (U, rates), mean = first, _surroundings(case).background(q.centres)
    relative, turning = U[:, :d] - mean[:, :d], q.radii[:, None] * U[:, d:]
    least = ZERO * max(float(np.linalg.norm(part)) for part in (relative, turning))
    return LevelAtInstant(
        apparent_viscosity=None,
        viscosity=None,
        velocities=_ratio(here[0][:, :d] - U[:, :d], relative, least),
        spins=_ratio(here[0][:, d:] - U[:, d:], U[:, d:], least / float(q.radii.max(initial=1.0))),
        gap_rates=_ratio(here[1] - rates, rates, least),
        seconds=0.0,
    )


def _ratio(off: Array, first: Array, least: float) -> float | None:
    """|off| / |first|; None where the latter is no more than `least`."""
    size = float(np.linalg.norm(first))
    return float(np.linalg.norm(off)) / size if size > least else None


def _narrowest_rates(case: Case, U: Array) -> Array:
    """D' of the N narrowest gaps, at most; the same ones at all levels."""
    q, around = case.configuration(), _surroundings(case)
    if not len(q):
        return np.empty(0)
    pairs = find_pairs(q, around, min(2.0 * float(q.radii.max()), around.container.image_reach))
    rates = gradient(pairs, len(q)) @ U[:, : q.dimension].ravel() - pairs.b
    narrowest: Array = rates[np.argsort(pairs.gap, kind="stable")[: len(q)]]
    return narrowest


def _surroundings(case: Case) -> Enclosure:
    """Walls, periods and u_inf, which is 0 where walls or pressures drive no linear flow."""
    try:
        return make_enclosure(case, 0.0)
    except InputError:
        container = case.container()
        return with_flow(case, 0.0, np.zeros(container.dimension), container.mean_gradient)


def instants_json(found: Mapping[str, LevelAtInstant]) -> dict[str, Any]:
    """What `fsi compare --json` prints of the instant: a row for each level."""
    return {"instant": {level: asdict(row) for level, row in found.items()}}
