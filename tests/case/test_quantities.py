"""Quantities by name: one more is one function, and cases that lack one are told what to do."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from fsi.case.case import Case
from fsi.case.checks.expected import check_expected
from fsi.case.load import parse_case
from fsi.case.quantities import NUMBERS, flow_number
from fsi.case.reference import as_markdown, sections_of_case
from fsi.errors import InputError
from fsi.integration.state import Measured
from fsi.studies.evaluate import at_instant, of_motion, require_quantity

CHANNEL = {"lower": [0.0, 0.0], "upper": [7.0, 6.0], "periodic": ["x"]}
CELL = {"shape": "cell", "vectors": [[6.0, 0.0], [0.0, 6.0]]}
DISC = {"name": "a", "radius": 1.0, "position": [3.0, 3.0]}


def case_in(domain: dict[str, Any], **more: Any) -> Case:
    """A disc there."""
    data = {"name": "a case", "model": "pores", "fluid": {"viscosity": 1.0}, "bodies": [DISC]}
    return parse_case(data | {"domain": domain} | more)


def pushed(**more: Any) -> Case:
    """A disc that is pushed towards a plane, by its film alone."""
    push = {"radius": 1.0, "position": [0.0, 1.1], "force": [0.0, -2.0]}
    reduced = {"law": "exact", "drag": 5.0}
    domain = {"shape": "half-plane", "radius": 1000.0}
    return case_in(domain, model="reduced", reduced=reduced, bodies=[{"name": "a"} | push], **more)


@pytest.fixture
def loss() -> Iterator[str]:
    """A number that the package does not know, of cases with a body at most."""

    def many(case: Case) -> str:
        return "" if len(case.bodies) < 2 else "is that of one body; drop the others"

    @flow_number("power loss", "of one body", lacking=many)
    def power_loss(found: Measured) -> float:
        return 1e-3 * found.dissipation

    yield "power loss"
    del NUMBERS["power loss"]


def test_one_from_outside_is_known_wherever_quantities_are(loss: str, tmp_path: Path) -> None:
    """A push F dissipates -F V: that of 2 a thousandth of 2 times the speed."""
    row = {"quantity": loss, "value": 0.0, "rtol": 1.0, "source": "by hand"}
    case = pushed(expected=[row], time={"end": 0.01})
    check_expected(case)
    found = at_instant(case, [loss, "a.velocity.y"])
    assert found[loss].value == pytest.approx(-2e-3 * found["a.velocity.y"].value, rel=1e-12)
    with pytest.raises(
        InputError, match=r'no such number; give "dissipation", .*"power loss" \(of one body\)'
    ):
        require_quantity(case, "power")
    assert '"power loss" (of one body)' in as_markdown(sections_of_case())
    two = case_in(CHANNEL, bodies=[DISC, DISC | {"name": "b", "radius": 0.5, "position": [3.0, 0.9]}])
    with pytest.raises(InputError, match=f"--quantity {loss}: is that of one body; drop the others"):
        require_quantity(two, loss)
    with pytest.raises(InputError, match=f"--quantity {loss}: runs of this model have none; take another"):
        of_motion(case, tmp_path / "run", [loss])[loss]


def test_a_name_that_is_taken_is_refused(loss: str) -> None:
    with pytest.raises(ValueError, match=r'^"flux": is the name of fsi\.case\.quantities\._flux already'):
        flow_number("flux")(NUMBERS[loss].value)


@pytest.mark.parametrize(
    ("quantity", "case", "words"),
    [
        ("flux", case_in(CHANNEL | {"net_flux": 1.0}), "is given, as domain.net_flux; take the pressure"),
        ("flux", case_in(CELL), "is that of a periodic channel; give another"),
        ("flux", pushed(), "is that of a periodic channel; give another"),
        ("pressure gradient", case_in(CHANNEL), "whose flux is given; give domain.net_flux"),
        ("pressure gradient", case_in(CELL), "whose flux is given; give domain.net_flux"),
        ("wall speed", case_in(CHANNEL), "give domain.walls.top"),
        ("shear rate", case_in(CELL), "give domain.stress"),
        ("apparent viscosity", pushed(), "is that of a periodic domain; give another"),
    ],
)
def test_what_a_case_has_not_is_refused_with_a_remedy(quantity: str, case: Case, words: str) -> None:
    with pytest.raises(InputError, match=f"^--quantity {quantity}: .*{words}"):
        require_quantity(case, quantity)


def test_what_a_case_has_is_taken() -> None:
    require_quantity(case_in(CHANNEL), "flux")
    require_quantity(case_in(CHANNEL | {"net_flux": 1.0}), "pressure gradient")


@pytest.mark.parametrize("quantity", ["time at gap -", "time at gap e", "time at gap 0.1.2", "Flux", "a.b.x"])
def test_what_is_no_name_is_refused(quantity: str) -> None:
    """The time at a gap that is no number ended in a traceback."""
    with pytest.raises(InputError, match="no such number; give"):
        require_quantity(pushed(time={"end": 1.0}), quantity, moving=True)
