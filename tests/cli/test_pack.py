"""`fsi pack` from the command line."""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
from pathlib import Path
from typing import Literal, get_args

import pytest

from fsi.arrangements.names import CellKind, Kind, Outline, Sizes
from fsi.case.load import load_case
from fsi.cli.pack import pack
from fsi.errors import InputError


def test_what_it_writes_is_what_a_case_takes(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "fsi", "pack", "random", "-n", "12", "--cell", "box", "--seed", "5"]
    more = ["--sizes", "bidisperse", "-o", str(tmp_path / "discs.json")]
    done = subprocess.run([*command, *more], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    said = done.stdout.splitlines()
    assert said[0].startswith("12 bodies, area fraction 0.4, smallest gap ")
    text = ['name = "packed"', 'bodies_from = "discs.json"', "fluid.viscosity = 1.0", *said[1:3]]
    (tmp_path / "case.toml").write_text("\n".join(text))
    case = load_case(tmp_path / "case.toml")
    written = json.loads((tmp_path / "discs.json").read_text())
    assert [list(body.position) for body in case.bodies] == [[b["x"], b["y"]] for b in written["bodies"]]
    assert {round(b["radius"], 12) for b in written["bodies"]} == {round(2 / 2.4, 12), round(2.8 / 2.4, 12)}
    assert (written["kind"], written["seed"], written["spread"]) == ("random", 5, 1.4)
    assert (tmp_path / "discs.png").read_bytes().startswith(b"\x89PNG")


def test_ellipses_are_what_a_case_takes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("fsi.arrangements.oriented_packing.MOVES", 20)
        given = {"area_fraction": 0.3, "shape": "ellipse", "ratio": 3.0, "aligned": 0.0}
        pack("random", output=tmp_path / "ellipses.json", number=12, **given)  # type: ignore[arg-type]
    lines = capsys.readouterr().out.splitlines()[1:-1]
    text = ['name = "packed"', 'bodies_from = "ellipses.json"', "fluid.viscosity = 1.0", *lines]
    (tmp_path / "case.toml").write_text("\n".join(text))
    case = load_case(tmp_path / "case.toml")
    assert case.fraction == pytest.approx(0.3, rel=1e-12)
    assert case.names[0] == "ellipse0001"
    assert {body.angle for body in case.bodies} == {0.0}
    assert (tmp_path / "ellipses.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("cell", ["channel", "periodic", "box"])
def test_what_it_prints_is_the_domain(
    cell: Literal["channel", "periodic", "box"], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pack("square", output=tmp_path / "discs.json", number=4, cell=cell)
    lines = capsys.readouterr().out.splitlines()[1:-1]
    text = ['name = "packed"', 'bodies_from = "discs.json"', "fluid.viscosity = 1.0", *lines]
    (tmp_path / "case.toml").write_text("\n".join(text))
    sides = json.loads((tmp_path / "discs.json").read_text())["upper"]
    container = load_case(tmp_path / "case.toml").container()
    assert len(container.periods) == {"channel": 1, "periodic": 2, "box": 0}[cell]
    assert container.size() == pytest.approx(math.hypot(*sides))


def test_rows_that_are_not_given_are_even_where_they_must_be(tmp_path: Path) -> None:
    """12 discs: 3 rows of 4 are the nearest to a square, 4 rows of 3 the nearest even ones."""
    pack("hexagonal", output=tmp_path / "discs.json", number=12, cell="periodic")
    assert json.loads((tmp_path / "discs.json").read_text())["rows"] == 4
    pack("hexagonal", output=tmp_path / "discs.json", number=12)
    assert json.loads((tmp_path / "discs.json").read_text())["rows"] == 3


def test_spheres_fill_a_part_of_the_volume(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """So it is printed and drawn; the picture, whose texts an SVG file has, names the plane that is seen."""
    output, picture = tmp_path / "spheres.json", tmp_path / "spheres.svg"
    pack("simple-cubic", output=output, picture=picture, number=8, cell="periodic")
    assert capsys.readouterr().out.startswith("8 bodies, volume fraction 0.4, ")
    drawn = picture.read_text()
    assert all(f"<!-- {text}" in drawn for text in ("N = 8, volume fraction 0.4,", "x (seen along y)", "z"))


def test_the_help_names_what_may_be_given() -> None:
    command, wide = [sys.executable, "-m", "fsi", "pack", "--help"], {"COLUMNS": "300"}
    said = subprocess.run(command, capture_output=True, text=True, check=True, env=os.environ | wide).stdout
    for words in (Kind, CellKind, Outline, Sizes):
        assert "|".join(get_args(words)) in said


@pytest.mark.parametrize(
    ("options", "parts"),
    [
        ({"kind": "square", "seed": 3}, ["--seed 3", "square has no such option", "takes rows"]),
        ({"kind": "rows", "aspect": 2.0}, ["--aspect 2.0", "rows has no such option"]),
        ({"area_fraction": 0.9}, ["area_fraction = 0.9", "largest possible is 0.7"]),
        ({"area_fraction": 1.0}, ["--area-fraction 1", "below 1"]),
        ({"area_fraction": 0.0}, ["--area-fraction 0", "above 0"]),
        ({"radius": -1.0}, ["--radius -1"]),
        ({"gap": -0.1}, ["--gap -0.1"]),
        ({"spread": 2.0}, ["--spread 2", "equal", "--sizes"]),
        ({"ratio": 3.0}, ["--ratio 3", "discs have none", "--shape ellipse"]),
        ({"shape": "rod", "ratio": 1.0}, ["--ratio 1", "above 1"]),
        ({"shape": "rod", "dimension": 3}, ["--shape rod", "--dimension 2"]),
        ({"sizes": "bidisperse", "spread": 0.5}, ["--spread 0.5", "of 1 or more"]),
        ({"kind": "chains", "number": 10, "length": 4}, ["number = 10", "give 8"]),
        ({"kind": "chains", "number": 8, "angle": 0.0}, ["angle = 0", "take rows"]),
        ({"kind": "columns", "cell": "periodic"}, ["columns stand between walls"]),
        ({"kind": "rows", "cell": "box"}, ["periodic along x"]),
        ({"kind": "hexagonal", "cell": "periodic", "number": 12, "rows": 3}, ["rows = 3", "even"]),
        ({"kind": "hexagonal", "cell": "periodic", "number": 15}, ["number = 15", "even"]),
        ({"kind": "rows", "area_fraction": 0.8}, ["area_fraction = 0.8", "largest possible is 0.7623"]),
        ({"kind": "body-centred", "number": 7}, ["number = 7", "no multiple of 2", "give 6"]),
        ({"kind": "face-centred", "number": 4, "seed": 3}, ["--seed 3", "face-centred takes none"]),
        ({"output": Path("a.csv")}, ["a.csv", ".json"]),
        ({"output": Path("/nowhere/a.json")}, ["/nowhere/a.json", "no file can be written"]),
    ],
)
def test_mistakes(tmp_path: Path, options: dict[str, object], parts: list[str]) -> None:
    given = {"kind": "random", "output": tmp_path / "a.json"} | options
    with pytest.raises(InputError) as caught:
        pack(**given)  # type: ignore[arg-type]
    assert "\n" not in str(caught.value)
    for part in parts:
        assert part in str(caught.value)
    assert list(tmp_path.iterdir()) == []
