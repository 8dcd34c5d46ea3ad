"""One configuration at several levels: how far viscosity, velocities, spins and rates of gaps are off.

All levels that give velocities at an instant are asked at time 0, and compared with the first of them. With
velocities u, rotations omega, the linear flow u_inf that walls drive without bodies (else 0), and the rates
D' of gaps,

    viscosity    mu_app / mu_app of the first - 1
    velocities   |u - u of the first| / |u of the first - u_inf|
    spins        |omega - omega of the first| / |omega of the first|
    gap rates    |D' - D' of the first| / |D' of the first|, of the N narrowest gaps of N bodies

with the root of the sum of squares over the bodies, or gaps. Velocities and rates of images are those of
their bodies with the lattice's. Where a stress drives the mean flow each level has the one that it finds.
What symmetry makes zero is so in no solve, and has no relative error: what is below a thousandth of the
speeds |u - u_inf| and |omega| a of the first.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from time import process_time
from typing import Any

import numpy as np

from fsi.arrays import Array
from fsi.case.case import Case
from fsi.case.load import parse_case
from fsi.errors import InputError
from fsi.models import make_model
from fsi.reduced.enclosure import Enclosure, make_enclosure, with_flow
from fsi.reduced.network import gradient
from fsi.reduced.pairs import find_pairs

# Of the speeds of the first level, what is zero to the accuracy of solves: that is some 1e-5 by default.
ZERO = 1e-3


@dataclass(frozen=True, slots=True)
class LevelAtInstant:
    """What one level gives, and its errors; None where it, or the first level, has nothing to compare.

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
    asked = {level: case for level, case in cases.items() if _has_instant(case)}
    if len(asked) < 2:
        return {}
    found = {level: _found(case) for level, case in asked.items()}
    first = next(iter(found.values()))
    return {level: _against(first, here) for level, here in found.items()}


def _has_instant(case: Case) -> bool:
    """Whether loads have velocities: of networks all that resists any motion is drag, and inertia in runs."""
    return case.level.viscous and (case.level.flow or case.drag > 0.0 or bool(case.held().all()))


@dataclass(frozen=True, slots=True)
class _Found:
    """What a level gives: its mean flow, in the case; velocities, rates of gaps; a viscosity or None."""

    case: Case
    U: Array
    rates: Array
    mu: float | None
    seconds: float


def _found(case: Case) -> _Found:
    began = process_time()
    instant = make_model(case)(case.configuration(), 0.0)
    spent = process_time() - began
    driven, mu = _at_found_rates(case, instant.record), instant.record.get("apparent_viscosity", np.nan)
    known = float(mu) if np.isfinite(mu) else None
    return _Found(driven, instant.U, _narrowest_rates(driven, instant.U), known, spent)


def _against(first: _Found, here: _Found) -> LevelAtInstant:
    d, q = first.case.dimension, first.case.configuration()
    mean = _surroundings(first.case).background(q.centres)
    relative, turning = first.U[:, :d] - mean[:, :d], q.radii[:, None] * first.U[:, d:]
    least = ZERO * max(float(np.linalg.norm(part)) for part in (relative, turning))
    off = here.U - first.U
    return LevelAtInstant(
        apparent_viscosity=here.mu,
        viscosity=None if here.mu is None or first.mu is None else here.mu / first.mu - 1.0,
        velocities=_ratio(off[:, :d], relative, least),
        spins=_ratio(off[:, d:], first.U[:, d:], least / float(q.radii.max(initial=1.0))),
        gap_rates=_ratio(here.rates - first.rates, first.rates, least),
        seconds=here.seconds,
    )


def _ratio(off: Array, first: Array, least: float) -> float | None:
    """|off| / |first|; None where the latter is no more than `least`."""
    size = float(np.linalg.norm(first))
    return float(np.linalg.norm(off)) / size if size > least else None


def _at_found_rates(case: Case, record: Mapping[str, float]) -> Case:
    """The case with the rate of shear, or the velocity of a wall, that its stress drives at a level."""
    data = case.as_data()
    domain, still = data["domain"], [0.0] * (case.dimension - 1)
    if "shear_rate" in record:
        del domain["stress"]
        domain["shear"] = float(record["shear_rate"])
    for wall in case.wall_stress(0.0):
        domain["walls"][wall] = [float(record[f"speed_{wall}"]), *still]
    return parse_case(data)


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
