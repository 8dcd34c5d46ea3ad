"""What `fsi keys` says of a key that is not given is what happens then."""

from __future__ import annotations

from typing import Any

import pytest

from fsi.case.load import parse_case
from fsi.case.reference import Key, sections_of_case
from fsi.errors import InputError

DISC = {"name": "disc", "radius": 1.0, "position": [0.0, 0.0], "force": [1.0, 0.0]}
DATA = {"name": "x", "domain": {"shape": "round", "radius": 5.0}, "bodies": [DISC]}
VISCOUS = DATA | {"fluid": {"viscosity": 1.0}}


def keys(title: str) -> dict[str, Key]:
    """Those of a section, by name; of those that stand above all with an empty title."""
    (section,) = (each for each in sections_of_case() if each.title == title)
    return {key.name: key for key in section.keys}


def test_what_must_be_given_above_all_sections_is_what_no_case_can_lack() -> None:
    needed = {name for name, key in keys("").items() if key.default == "must be given"}
    assert needed == {"name", "domain"}
    parse_case(VISCOUS)  # without [discretisation] too
    for name in sorted(needed):
        with pytest.raises(InputError, match=f"^{name}: missing"):
            parse_case({key: value for key, value in VISCOUS.items() if key != name})


def test_only_a_viscous_fluid_must_be_given() -> None:
    assert "others need it" in keys("")["fluid"].meaning
    wall = {"shape": "half-plane", "radius": 50.0}
    above = DATA | {"domain": wall, "bodies": [DISC | {"position": [0.0, 2.0]}]}
    assert parse_case(above | {"model": "gluey"}).fluid.viscosity == 1.0
    with pytest.raises(InputError, match=r"^fluid: missing"):
        parse_case(above)


def test_the_key_of_the_drag_says_that_discs_need_one() -> None:
    """A lone disc has none (Stokes's paradox); a sphere has 6 pi mu a."""
    assert "of discs (needed, or `drag_from`)" in keys("`[reduced]`")["drag"].meaning
    reduced: dict[str, Any] = VISCOUS | {"model": "reduced"}
    with pytest.raises(InputError, match=r"reduced\.drag: missing"):
        _ = parse_case(reduced).drag
