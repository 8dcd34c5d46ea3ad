"""Laws of force from outside: taken by each level, or refused like those that are here."""

from __future__ import annotations

from typing import Any, Literal, override

import numpy as np
import pytest
from pydantic import Field

from fsi.arrays import Array
from fsi.bodies.forces import Bulk
from fsi.case.case import Case
from fsi.case.force_laws.law import ForceSection, register_force
from fsi.case.load import parse_case
from fsi.errors import InputError, SolveError
from fsi.gluey.limit_study import one_gap
from fsi.gluey.system import gluey_system


class Ramp(ForceSection):
    """Pulls each body by itself to the right, as heavy as it may be."""

    law: Literal["ramp-of-tests"]
    start: float = Field(default=0.0, description="the force at time 0, a number")
    rate: float = Field(default=0.0, description="by which it grows in time, a number")

    @override
    def on_bodies(self, bulk: Bulk, t: float) -> Array:
        return np.outer(np.ones(len(bulk.masses)), [self.start + self.rate * t, 0.0])


class Logarithm(ForceSection):
    """Draws bodies by ln d, which is minus infinity where they touch, up to a gap."""

    law: Literal["logarithm-of-tests"]
    end: float = Field(description="the gap beyond which there is no force, a number")

    @property
    @override
    def reach(self) -> float:
        return self.end

    @override
    def repulsion(self, d: Array) -> Array:
        with np.errstate(divide="ignore"):
            return np.log(d)


class Shaped(ForceSection):
    """Gives whatever it is told to."""

    law: Literal["shaped-of-tests"]
    given: Any = Field(default=None, description="anything")

    @override
    def on_bodies(self, bulk: Bulk, t: float) -> Array:
        return self.given  # type: ignore[no-any-return]


@pytest.fixture(autouse=True)
def registered(monkeypatch: pytest.MonkeyPatch) -> None:
    """Registered for one test only: messages list all laws."""
    monkeypatch.setattr(ForceSection.registry, "sections", [*ForceSection.registry.all()])
    register_force(Ramp)
    register_force(Logarithm)


def gluey_discs(*forces: dict[str, Any], **more: Any) -> Case:
    """Two of radius 1 that touch, the first of them held in x, neither with a weight."""
    bodies = [
        {"name": "held", "radius": 1.0, "position": [0.0, 0.0], "mass": 2.0, "velocity": [0.0, "free"]},
        {"name": "pulled", "radius": 1.0, "position": [2.0, 0.0], "mass": 2.0},
    ]
    data = {
        "name": "gluey", "model": "gluey", "domain": {"lower": [-9.0, -9.0], "upper": [9.0, 9.0]},
        "bodies": bodies, "forces": forces, "time": {"end": 1.0, "step": 0.1},
    }  # fmt: skip
    return parse_case(data | more)


@pytest.mark.parametrize(("force", "impulse"), [({"start": 3.0}, 1.2), ({"rate": 3.0}, 0.48)])
def test_a_gluey_step_takes_the_force_on_each_body(force: dict[str, float], impulse: float) -> None:
    """From 0.2 to 0.6 the integral of 3 is 1.2 and that of 3 t is 0.48; none on what is held."""
    case = gluey_discs({"law": "ramp-of-tests"} | force)
    load = gluey_system(case).load(case.configuration().centres, 0.2, 0.6)
    np.testing.assert_allclose(load, [[0.0, 0.0, 0.0], [impulse, 0.0, 0.0]], rtol=1e-14)


def test_the_limit_of_one_gap_refuses_what_is_no_table() -> None:
    with pytest.raises(InputError, match=r"^forces\.0 = .*ramp.*: no weight, .*; give bodies their force"):
        one_gap(gluey_discs({"law": "ramp-of-tests", "start": 3.0}))


def test_a_law_that_reaches_beyond_the_images_is_refused() -> None:
    """In a square cell of side 8 images are looked for up to sqrt(2) 8 = 11.3137; others were left out."""
    cell = {"shape": "cell", "vectors": [[8.0, 0.0], [0.0, 8.0]]}
    gluey_discs({"law": "logarithm-of-tests", "end": 11.31}, domain=cell)
    refusal = r"^forces\.0\.reach = 11\.32: reaches farther .*; end it at a gap of 11\.3137 or less$"
    with pytest.raises(InputError, match=refusal):
        gluey_discs({"law": "logarithm-of-tests", "end": 11.32}, domain=cell)


def test_a_force_that_is_no_number_is_that_of_its_law() -> None:
    """The second of two: ln 0 where discs touch, when a step begins; an infinite pull, in its middle."""
    line = r"^forces\.1: gives a force that is no finite number at t = "
    case = gluey_discs({"law": "ramp-of-tests", "rate": 1.0}, {"law": "logarithm-of-tests", "end": 1.0})
    infinite = Ramp.model_construct(law="ramp-of-tests", start=np.inf)
    pulled = case.model_copy(update={"forces": (case.forces[0], infinite)})
    for wrong, t in ((case, r"0\.2;"), (pulled, r"0\.4;")):
        with pytest.raises(SolveError, match=line + t):
            gluey_system(wrong).load(case.configuration().centres, 0.2, 0.6)
        with pytest.raises(SolveError, match=line + r"0\.2;"):
            wrong.motion_at(case.configuration(), 0.2)


@pytest.mark.parametrize(
    ("given", "told"),
    [
        (np.array([2.0, 5.0]), r"float64 of shape \(2,\)"),
        (np.zeros(2), r"float64 of shape \(2,\)"),
        (np.ones((2, 1)), r"float64 of shape \(2, 1\)"),
        (np.ones((1, 2)), r"float64 of shape \(1, 2\)"),
        (np.ones((2, 2), dtype=bool), r"bool of shape \(2, 2\)"),
        (3.0, "a float"),
        (None, "a NoneType"),
        ([[1.0, 0.0], [1.0, 0.0]], "a list"),
    ],
)
def test_a_force_has_a_row_for_each_body(given: Any, told: str) -> None:
    """N = d = 2: the pulls 2 and 5 along x were the force (2, 5) on both bodies."""
    case = gluey_discs({"law": "ramp-of-tests"})

    def with_force(F: Any) -> Case:
        return case.model_copy(update={"forces": (Shaped.model_construct(given=F),)})

    refusal = (
        rf"^forces\.0: Shaped\.on_bodies gives {told}; give an array of numbers of shape \(2, 2\), .* or 0$"
    )
    with pytest.raises(InputError, match=refusal):
        with_force(given).motion_at(case.configuration(), 0.2)
    with pytest.raises(InputError, match=refusal):
        gluey_system(with_force(given)).load(case.configuration().centres, 0.2, 0.6)
    for none in (0, 0.0):
        F = with_force(none).motion_at(case.configuration(), 0.2).F
        np.testing.assert_array_equal(F, np.zeros((2, 3)))
