"""`[arrangement]` in a case: the bodies of `fsi pack`, and the domain that they fill."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fsi.case.load import load_case, parse_case
from fsi.cli.pack import pack
from fsi.errors import InputError

GIVEN: dict[str, Any] = {"kind": "random", "number": 12, "area_fraction": 0.4, "seed": 5}
ORDERED: dict[str, Any] = {"kind": "square", "number": 16, "area_fraction": 0.4}
CASE: dict[str, Any] = {
    "name": "arranged",
    "fluid": {"viscosity": 1.0},
    "domain": {"walls": {"top": [1.0, 0.0]}},
}


def test_the_bodies_are_those_of_pack(tmp_path: Path) -> None:
    """And the domain is the box of the file, which a case of these bodies must have."""
    pack("random", output=tmp_path / "discs.json", number=12, seed=5)
    here = parse_case(CASE | {"arrangement": GIVEN})
    box = [f"{key} = {list(getattr(here.domain, key))}" for key in ("lower", "upper", "periodic")]
    text = ['name = "packed"', 'bodies_from = "discs.json"', "fluid.viscosity = 1.0", "[domain]", *box]
    (tmp_path / "case.toml").write_text("\n".join(text).replace("'", '"'))
    packed = load_case(tmp_path / "case.toml")
    np.testing.assert_array_equal(here.configuration().centres, packed.configuration().centres)
    assert here.names == packed.names
    assert np.sum(np.pi * here.configuration().radii ** 2) / here.container().volume == pytest.approx(0.4)


def test_a_cell_has_its_mean_flow() -> None:
    case = parse_case(CASE | {"domain": {"shear": 1.0}, "arrangement": GIVEN | {"cell": "periodic"}})
    assert (case.domain.shape, len(case.bodies)) == ("cell", 12)
    assert len(case.container().periods) == 2


def test_defaults_hold_for_arranged_bodies() -> None:
    case = parse_case(CASE | {"arrangement": GIVEN, "body_defaults": {"angle": 0.5}})
    assert {body.angle for body in case.bodies} == {0.5}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            {"arrangement": GIVEN | {"angle": 3.0}},
            r"arrangement.angle = 3.0: random has no such option",
        ),
        (
            {"arrangement": GIVEN, "domain": {"shape": "cell", "shear": 1.0}},
            r'domain.shape = "cell": .*; drop it or give arrangement.cell = "periodic"',
        ),
        (
            {"arrangement": GIVEN | {"kind": "heap"}},
            r'arrangement.kind = "heap": not one of the choices',
        ),
        (
            {"arrangement": GIVEN | {"area_fracton": 0.2}},
            r"area_fracton = 0.2: .*; use arrangement\.area_fraction ",
        ),
        ({"arrangement": 5}, r"^arrangement = 5: not a section"),
        ({"arrangement": {"kind": "square"}}, r"arrangement.number: missing; give how many bodies"),
        (
            {"arrangement": GIVEN | {"area_fraction": 1.2}},
            r"area_fraction = 1.2: bodies cannot fill all",
        ),
        (
            {"arrangement": GIVEN | {"area_fraction": 0.95}},
            r"^arrangement\.area_fraction = 0\.95: too large for 12",
        ),
        (
            {"arrangement": ORDERED | {"kind": "columns", "length": 2**62}},
            rf"^arrangement\.length = {2**62}: more discs side by side than number = 16; lower it$",
        ),
        (
            {"arrangement": ORDERED | {"kind": "chains", "rows": 9, "length": 2}},
            r"^arrangement\.rows = 9: more discs side by side than number = 16; lower it$",
        ),
        (
            {"arrangement": ORDERED | {"rows": 3}},
            r"^arrangement\.number = 16: no multiple of 3, .*; give 15$",
        ),
        (
            {"arrangement": ORDERED | {"kind": "rows", "cell": "box"}},
            r'^arrangement\.cell = "box": rows would cross walls at its ends; give .* "periodic"$',
        ),
        # The squares and cubes of these are no numbers: they raised OverflowError.
        ({"arrangement": GIVEN | {"gap": 1e200}}, r"^arrangement.gap = 1e\+200: out of range; .* to 1e\+50"),
        (
            {"arrangement": ORDERED | {"gap": 1e200}},
            r"^arrangement.gap = 1e\+200: out of range",
        ),
        ({"arrangement": GIVEN | {"area_fraction": 1e-300}}, r"^arrangement.area_fraction = 1e-300: out of"),
        ({"arrangement": GIVEN | {"radius": 1e-200}}, r"^arrangement.radius = 1e-200: out of range"),
        ({"arrangement": GIVEN, "bodies": []}, r"bodies: the bodies are those of \[arrangement\]; drop one"),
        (
            {"arrangement": GIVEN, "domain": {"lower": [0.0, 0.0]}},
            r"domain.lower = .*makes the domain; drop",
        ),
        ({"arrangement": GIVEN | {"number": 10**12}}, r"arrangement.number = 1000000000000, .*give fewer"),
    ],
)
def test_mistakes_name_their_key(changes: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        parse_case(CASE | changes)


def test_what_is_wrong_with_bodies_names_what_makes_them() -> None:
    """An array of four stands at b/2 = sqrt(pi / 0.4) / 2 from the corner; no user has written bodies.0."""
    half = 0.5 * np.sqrt(np.pi / 0.4)
    given = {"arrangement": ORDERED | {"number": 4}, "body_defaults": {"mass": 1.0}}
    with pytest.raises(
        InputError, match=r"^bodies\.0\.mass = 1\.0: .* \(the bodies are those of \[arrangement\]\)$"
    ):
        parse_case(CASE | given)
    assert parse_case(CASE | {"arrangement": given["arrangement"]}).bodies[0].position == (half, half)
    grid = {"name": "g", "counts": [3, 2], "lower": [0.5, 2.0], "spacing": 3.0, "radius": [1.0, 1.0]}
    box = {"lower": [0.0, 0.0], "upper": [9.0, 12.0]}
    own = {"name": "own", "radius": 0.5, "position": [1.0, 9.0]}
    data = CASE | {"domain": box, "bodies": [own], "grids": [grid, grid | {"name": "h", "counts": [1, 1]}]}
    made = r" \(bodies\.1 to 6 are those of grids\.0, bodies\.7 to 7 are those of grids\.1\)$"
    with pytest.raises(InputError, match=r"^bodies\.1\.position = .*'left' \(gap -0\.5\); .*" + made):
        parse_case(data)
    with pytest.raises(InputError, match=r"^bodies: g 0 and h 0 overlap by 2; move them apart" + made):
        parse_case(data | {"model": "gluey"})
