"""Bodies from a file."""

import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fsi.case.body_file import read_bodies
from fsi.case.load import load_case
from fsi.cli.pack import pack
from fsi.errors import InputError
from fsi.runs import run
from tests.exact_model import DiscsBesidePlane, by

REFERENCE = Path(__file__).parents[1] / "reference" / "couette_N50.json"
CASE = """
name = "test"
bodies_from = "{file}"
fluid.viscosity = 1.0
domain.lower = [0.0, 0.0]
domain.upper = [{L}, {L}]
"""


def write_case(folder: Path, file: str, content: str, L: float = 8.0, more: str = "") -> Path:
    """A case in one folder whose bodies are in a file of another one."""
    (folder / "discs").mkdir(exist_ok=True)
    (folder / "discs" / file).write_text(content)
    path = folder / "case.toml"
    path.write_text(CASE.format(file=f"discs/{file}", L=L) + more)
    return path


def message(folder: Path, file: str, content: str, L: float = 8.0, more: str = "") -> str:
    with pytest.raises(InputError) as caught:
        load_case(write_case(folder, file, content, L, more))
    assert "\n" not in str(caught.value)
    return str(caught.value)


OWN = {
    "bodies": [{"radius": 1, "x": 2, "y": 2.5, "angle": 0.25}, {"name": "b", "radius": 0.5, "x": 5, "y": 5}]
}
AS_CSV = "name, radius, x, y, angle\ndisc0001, 1, 2, 2.5, 0.25\nb, 0.5, 5, 5, 0\n"


def test_json_and_csv_give_the_same_bodies(tmp_path: Path) -> None:
    cases = [
        load_case(write_case(tmp_path, "two.json", json.dumps(OWN))),
        load_case(write_case(tmp_path, "two.csv", AS_CSV)),
    ]
    assert cases[0] == cases[1]
    first, second = cases[0].bodies
    assert (first.name, first.radius, first.position, first.angle) == ("disc0001", 1.0, (2.0, 2.5), 0.25)
    assert (second.name, second.radius, second.position, second.angle) == ("b", 0.5, (5.0, 5.0), 0.0)
    assert first.motion == ("free",) * 3


def test_the_reference_suspension_is_read() -> None:
    """The file's own sides: its discs cross the walls that are periodic sides there, so it is read alone."""
    given = json.loads(REFERENCE.read_text())
    file = read_bodies(REFERENCE)
    assert file.sides == (given["L"], given["H"])
    assert [list(body["position"]) for body in file.bodies] == given["centers"]
    assert {body["radius"] for body in file.bodies} == {1.0}
    assert [file.bodies[k]["name"] for k in (0, 49)] == ["disc0001", "disc0050"]


def test_listed_bodies_come_first_and_defaults_fill_what_is_missing(tmp_path: Path) -> None:
    more = """
    body_defaults = { velocity = [0.0, 0.0], angular_velocity = 0.0, radius = 0.75 }
    bodies = [{ name = "mine", position = [6.5, 1.5], velocity = ["free", 1.0] }]
    """
    case = load_case(write_case(tmp_path, "two.json", json.dumps(OWN), more=more))
    assert case.names == ("mine", "disc0001", "b")
    assert [body.radius for body in case.bodies] == [0.75, 1.0, 0.5]
    assert [body.motion for body in case.bodies] == [("free", 1.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)]


def test_the_resolved_case_stands_alone(tmp_path: Path) -> None:
    path = write_case(
        tmp_path, "two.json", json.dumps(OWN), more="time.end = 0.01\nbody_defaults.torque = 1.0"
    )
    case = load_case(path)
    run(case, tmp_path / "run", make=by(DiscsBesidePlane))
    (tmp_path / "discs" / "two.json").unlink()
    resolved = (tmp_path / "run" / "case.toml").read_text()
    assert "bodies_from" not in resolved
    assert "body_defaults" not in resolved
    assert load_case(tmp_path / "run" / "case.toml") == case


def test_another_file_may_be_asked_for_on_the_command_line(tmp_path: Path) -> None:
    path = write_case(tmp_path, "two.json", json.dumps(OWN))
    (tmp_path / "one.csv").write_text("radius,x,y\n1,2,3\n")
    assert load_case(path, ['bodies_from="one.csv"']).names == ("disc0001",)


def row(**values: Any) -> str:
    return json.dumps({"bodies": [{"radius": 1.0, "x": 2.0, "y": 2.0} | values]})


@pytest.mark.parametrize(
    ("file", "content", "parts"),
    [
        ("a.json", "{", ["not JSON", "line 1"]),
        ("a.json", "[]", ["give an object with `bodies`"]),
        ("a.json", '{"bodies": []}', ["no bodies in it"]),
        ("a.json", '{"bodies": [3]}', ["row 1 = 3", "give it radius, x and y"]),
        ("a.json", '{"bodies": [{"radius": 1, "x": 2}]}', ["row 1", "no 'y'"]),
        ("a.json", row(raduis=2), ["row 1", "'raduis'", "use 'radius'"]),
        ("a.json", row(radius=-1), ["row 1: radius = -1", "a number > 0"]),
        ("a.json", row(radius=True), ["radius = true"]),
        ("a.json", row(x="2"), ['x = "2"', "finite number"]),
        ("a.json", row(x=math.inf), ["x = inf", "finite number"]),
        ("a.json", row(name=3), ["bodies.0.name = 3", "valid string"]),
        ("a.json", row(z=3.0), ["bodies.0.position"]),
        ("a.json", row(x=0.5), ["'disc0001'", "'left'", "gap -0.5"]),
        ("a.json", '{"centers": [[1, 2], [3]], "radius": 1}', ["centre 2 = [3]", "not [x, y]"]),
        ("a.json", '{"centers": [[1, 2]]}', ["radius = None"]),
        ("a.csv", "radius,x,yy\n1,2,2\n", ["the header", "'yy'", "use 'y'"]),
        ("a.csv", "radius,x,y\n1,2\n", ["row 1", "as many values"]),
        ("a.csv", "radius,x,y\n1,2,2,2\n", ["row 1", "as many values"]),
        ("a.csv", "radius,x,y\n1,2,two\n", ["row 1", 'y = "two"']),
        ("a.csv", "radius,x,y\n1,2,2\n1,2,3\n", ["disc0001", "disc0002", "gap -1"]),
        ("a.txt", "", ["ends in .txt", ".json or a .csv"]),
    ],
)
def test_mistakes(tmp_path: Path, file: str, content: str, parts: list[str]) -> None:
    said = message(tmp_path, file, content)
    for part in parts:
        assert part in said


def test_a_missing_file(tmp_path: Path) -> None:
    (tmp_path / "case.toml").write_text(CASE.format(file="none.json", L=8.0))
    with pytest.raises(InputError, match=r"bodies_from = .*none\.json: No such file"):
        load_case(tmp_path / "case.toml")


def test_a_box_of_another_size_is_refused(tmp_path: Path) -> None:
    """A length with fewer digits than the file's gives another area fraction: 8.00001 for 8."""
    own = json.dumps(OWN | {"lower": [0.0, 0.0], "upper": [8.0, 8.0]})
    assert "its box is 8 x 8, but the domain is 8.00001 x 8.00001" in message(
        tmp_path, "a.json", own, 8.00001
    )
    assert len(load_case(write_case(tmp_path, "a.json", own)).bodies) == 2


def test_a_default_without_meaning_is_refused(tmp_path: Path) -> None:
    said = message(tmp_path, "a.json", row(), more="body_defaults.mas = 1.0")
    assert "body_defaults.mas = 1.0: unknown key; use body_defaults.mass" in said
    assert "body_defaults.name" in message(tmp_path, "a.json", row(), more='body_defaults.name = "a"')


def in_cell(folder: Path, vectors: str) -> Path:
    """The reference suspension in a cell of given vectors."""
    path = folder / "cell.toml"
    path.write_text(
        f'name = "t"\nbodies_from = "{REFERENCE}"\nfluid.viscosity = 1.0\n'
        f'domain.shape = "cell"\ndomain.vectors = {vectors}\n'
    )
    return path


@pytest.mark.parametrize("sheared", [0.0, 19.816636])
def test_the_vectors_of_a_cell_span_the_box_of_the_file(tmp_path: Path, sheared: float) -> None:
    """The walls of this file are 0.02 from the discs, whose images are 0.04 apart across them."""
    assert len(load_case(in_cell(tmp_path, f"[[19.816636, 0.0], [{sheared}, 19.816636]]")).bodies) == 50


@pytest.mark.parametrize("second", ["[0.0, 19.9]", "[1.0, 19.816636]", "[0.0, 39.633272]"])
def test_another_cell_than_that_of_the_file_is_refused(tmp_path: Path, second: str) -> None:
    with pytest.raises(
        InputError,
        match=r"its box is 19.816636 x 19.816636, but domain.vectors span another; give vectors = \[\[",
    ):
        load_case(in_cell(tmp_path, f"[[19.816636, 0.0], {second}]"))


def test_spheres_of_a_file_in_a_cell(tmp_path: Path) -> None:
    """The vectors that `fsi pack` prints are taken; others are refused with those that fit."""
    pack("face-centred", output=tmp_path / "spheres.json", number=4, cell="periodic", area_fraction=0.2)
    side = float((80.0 * np.pi / 3.0) ** (1.0 / 3.0))
    text = 'name = "packed"\ngeometry = "spatial"\nbodies_from = "spheres.json"\nfluid.viscosity = 1.0\n'
    for factor in (1.0, 1.5):
        vectors = (factor * side * np.eye(3)).tolist()
        (tmp_path / "case.toml").write_text(f'{text}domain = {{ shape = "cell", vectors = {vectors} }}\n')
        if factor == 1.0:
            assert load_case(tmp_path / "case.toml").configuration().centres.shape == (4, 3)
        else:
            fit = rf"give vectors = {re.escape(str((side * np.eye(3)).tolist()))}$"  # all of it
            with pytest.raises(InputError, match=fit):
                load_case(tmp_path / "case.toml")
