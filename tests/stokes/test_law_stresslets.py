"""Stresslets of flows with laws below a gap: what pressures in gaps do to them, and what laws leave open."""

from typing import Any

import numpy as np
from numpy.testing import assert_allclose

from fsi.observables.bulk_stress import BulkStress
from tests.stokes.law_flows import solved

CHANNEL = {"lower": [0.0, 0.0], "upper": [6.0, 6.0], "periodic": ["x"]}


def disc(name: str, radius: float, at: list[float], V: float = 0.0, omega: float = 0.0) -> dict[str, Any]:
    motion = {"velocity": [0.0, V], "angular_velocity": omega}
    return {"name": name, "radius": radius, "position": at} | motion


def stress_of(bodies: list[dict[str, Any]], below: float | None) -> BulkStress:
    bulk = solved(bodies, below, domain=CHANNEL, discretisation={"degree": 3}).bulk
    assert bulk is not None
    return bulk


def test_stresslets_of_discs_that_roll_have_the_pressure_between_them() -> None:
    """Held, without a couple on both; shared as radii are -26 and -16 in place of 65 and -106."""
    pair = [disc("a", 1.0, [2.0, 2.5], omega=1.0), disc("b", 0.6, [3.602, 2.5], omega=-1.0 / 0.6)]
    found, resolved = (stress_of(pair, below).stresslets[:, 0, 1] for below in (0.02, None))
    assert_allclose(found, resolved, rtol=0.02)
    assert resolved[0] * resolved[1] < 0.0


def test_what_laws_leave_open_of_stresslets_is_known() -> None:
    """A disc is squeezed towards a wall, another is far: what the spread of the load misses of either.

    2 d F is missed of the normal stresslet of the one, and as p has no mean over the fluid 2 d F over it of a
    pressure on both: of the other nothing was known, of 29 in 31.
    """
    bodies = [disc("a", 1.0, [2.0, 1.002], V=-1.0), disc("b", 0.6, [4.0, 4.0])]
    found, resolved = (stress_of(bodies, below) for below in (0.02, None))
    assert found.in_gaps is not None
    off, largest = found.stresslets - resolved.stresslets, np.abs(found.in_gaps).max(axis=(1, 2))
    assert np.all(np.abs(off - found.in_gaps) < 0.01 * largest[:, None, None])
