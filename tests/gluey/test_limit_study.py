"""What drives the one gap of `fsi limit`: loads and weights in time; what it does not know is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from fsi.errors import InputError
from fsi.gluey.limit import Limit
from fsi.gluey.limit_study import one_gap, study
from tests.cli.test_commands import ROOT, call
from tests.gluey.test_system import case_of
from tests.ranks import needs_mpi, python_on

ALONE = {"shape": "unbounded"}
GRAVITY = {"kind": "gravity", "acceleration": [0.0, 1.0]}
ATTRACTION = {"kind": "attraction", "law": "exponential", "strength": 1.0, "length": 1.0, "cutoff": 5.0}


def pair(**more: Any) -> Any:
    """Two discs of radius 1/2, masses 1 and 4, one 0.5 above the other, which falls at 1."""
    below = {"position": [0.0, 0.0], "mass": 1.0}
    above = {"position": [0.0, 1.5], "mass": 4.0, "initial_velocity": [0.0, -1.0]}
    return case_of(below, above, **({"domain": ALONE} | more))


def test_buoyancy_drives_two_bodies_as_their_masses_differ() -> None:
    """Both are lifted by pi/4, at pi/4 and pi/16: f = -3 pi/16 apart, and q = 1/2 - t - 3 pi/32 t^2."""
    gap = one_gap(pair(forces=[GRAVITY | {"density_difference": 1.0}]))
    assert gap.f(0.3) == pytest.approx(-3.0 * np.pi / 16.0, rel=1e-14)
    a = 3.0 * np.pi / 32.0
    arrival = (-1.0 + np.sqrt(1.0 + 2.0 * a)) / (2.0 * a)
    ((begin, _),) = Limit.of(gap.q0, gap.u0, gap.f).contacts()
    assert begin == pytest.approx(arrival, rel=1e-12)


def test_what_falls_together_has_no_force_apart() -> None:
    """Gravity on masses alone is the same acceleration of both, which take their loads besides."""
    case = pair(forces=[GRAVITY])
    assert one_gap(case).f(0.3) == pytest.approx(0.0, abs=1e-15)


def test_gravity_does_not_move_what_is_held() -> None:
    """Above a held body the other one, of mass 4, has f = 1 of gravity upwards."""
    below = {"position": [0.0, 0.0], "mass": 1.0, "velocity": [0.0, 0.0]}
    case = case_of(below, {"position": [0.0, 1.5], "mass": 4.0}, forces=[GRAVITY], domain=ALONE)
    assert one_gap(case).f(0.3) == pytest.approx(1.0, rel=1e-14)


@pytest.mark.parametrize(
    ("change", "line"),
    [
        ({"forces": [GRAVITY, ATTRACTION]}, r"^forces\.1 = .*: depends on the gap, .*; drop it"),
        (
            {"gluey": {"walls": [{"name": "w", "point": [0.0, -9.0], "normal": [0.0, 1.0]}]}},
            r'^gluey\.walls\.0\.name = "w": `fsi limit` knows walls of the domain only; drop it',
        ),
        (
            {"gluey": {"gamma_min": -0.5}},
            r"^gluey\.gamma_min = -0\.5: contact becomes solid there.*; drop it",
        ),
        (
            {"gluey": {"eps": 0.1, "reference_gap": 1.0, "roughness": 0.01}},
            r"^gluey\.roughness = 0\.01: contact becomes solid there.*; drop it",
        ),
        (
            {"domain": {"lower": [-9.0, -9.0], "upper": [9.0, 9.0]}},
            r'^domain: the bodies may meet its wall "bottom", .*; give two bodies shape = "unbounded"$',
        ),
    ],
)
def test_what_the_study_does_not_know_is_refused(change: dict[str, Any], line: str) -> None:
    with pytest.raises(InputError, match=line):
        one_gap(pair(**change))


def test_the_wall_behind_the_body_is_not_reached() -> None:
    """Between walls 4 apart the disc of radius 1/2 rises at 1 from 1.5: its gap of 1 is 3 at t = 2."""
    rising = {"position": [0.0, 1.5], "mass": 1.0, "initial_velocity": [0.0, 1.0]}
    walls = {"lower": [-50.0, 0.0], "upper": [50.0, 4.0]}
    before = case_of(rising, domain=walls, time={"end": 1.99, "step": 0.1})
    assert study(before).q[-1] == pytest.approx(2.99, rel=1e-14)
    with pytest.raises(
        InputError, match=r"^time\.end = 4\.0: .* wall behind it by t = 2, .*; end before, or"
    ):
        study(case_of(rising, domain=walls, time={"end": 4.0, "step": 0.1}))


def test_both_bodies_have_a_mass() -> None:
    with pytest.raises(InputError, match="of a body with a mass and a wall, or of two such bodies"):
        one_gap(case_of({"position": [0.0, 0.0], "mass": 1.0}, {"position": [0.0, 1.5]}))


@needs_mpi
@pytest.mark.mpi
def test_two_ranks_are_refused_as_one_is() -> None:
    """One line and no wait: root alone knew of it, and the others were ended by the MPI's own words."""
    case = str(ROOT / "cases" / "settling_disc.toml")
    done = call(*python_on(2), "-m", "fsi", "limit", case, timeout=60.0)
    assert done.returncode == 2
    assert (done.stderr.count("\n"), done.stderr.startswith("error: ")) == (1, True)
