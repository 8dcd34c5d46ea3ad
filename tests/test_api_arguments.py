"""What `import fsi` takes: arrays, numbers and paths of any kind, and what it refuses in one line."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import fsi
from tests.one_disc import DISC, reduced

ROOT = Path(__file__).parents[1]
BOX = ROOT / "cases" / "disc_in_box.toml"


def test_a_mistake_in_python_is_one_line_too() -> None:
    with pytest.raises(fsi.InputError, match=r"reduced\.darg = 10\.0: unknown key; use reduced\.drag"):
        reduced(reduced={"darg": 10.0})


@pytest.mark.parametrize("case", ["case.toml", None, {"name": "disc"}])
def test_what_is_no_case_is_refused(case: Any, tmp_path: Path) -> None:
    words = rf"^case: is of type {type(case).__name__}; give fsi\.load_case\(PATH\)"
    out = tmp_path / "out"
    for use in (fsi.solve, lambda it: fsi.run(it, out), lambda it: fsi.calibrate(it, out)):
        with pytest.raises(fsi.InputError, match=words):
            use(case)
    assert not out.exists()


def test_a_calibration_without_processes_writes_nothing(tmp_path: Path) -> None:
    case = fsi.load_case(ROOT / "cases" / "calibration" / "disc_wall.toml")
    with pytest.raises(fsi.InputError, match=r"^processes = 0: give at least 1$"):
        fsi.calibrate(case, tmp_path / "out", 0)
    assert not list(tmp_path.iterdir())


def test_a_case_takes_arrays_and_numbers_of_numpy() -> None:
    body = DISC | {"radius": np.int64(1), "position": np.array([0, 2]), "force": (np.float32(0), -1.0)}
    assert reduced(bodies=[body]) == reduced()
    assert reduced(bodies=np.array([body], dtype=object)) == reduced()
    assert reduced(bodies=[DISC | {"position": pd.Series([0.0, 2.0])}]) == reduced()
    with pytest.raises(fsi.InputError, match=r"^bodies\.0\.position\.0 = \[0\.0, 2\.0\]: must be a"):
        reduced(bodies=[DISC | {"position": np.array([[0.0, 2.0]])}])


def test_a_case_takes_paths_for_files(tmp_path: Path) -> None:
    """It said that the mesh must be a text."""
    mesh = tmp_path / "own.msh"
    domain = {"lower": [-3.0, 0.0], "upper": [3.0, 6.0], "mesh": mesh}
    with pytest.raises(fsi.InputError, match=r"^domain\.mesh = .*: no such file"):
        reduced(domain=domain, model="resolved")
    with pytest.raises(
        fsi.InputError, match=r"^domain\.mesh = .*: is a folder; give the path of a mesh file$"
    ):
        reduced(domain=domain | {"mesh": tmp_path}, model="resolved")
    mesh.touch()
    assert reduced(domain=domain, model="resolved").domain.mesh == str(mesh)


def test_links_that_lead_in_a_circle_are_no_defect(tmp_path: Path) -> None:
    """Python raises RuntimeError of them, which ended with exit code 70."""
    mesh = tmp_path / "loop.msh"
    mesh.symlink_to(mesh)
    with pytest.raises(fsi.InputError, match=r"^domain\.mesh = .*: no such file"):
        fsi.load_case(BOX, [f'domain.mesh="{mesh}"'])


def test_a_section_that_contains_itself_is_one_line() -> None:
    """It ended with Python's RecursionError."""
    fluid: dict[str, Any] = {"viscosity": 1.0}
    fluid["phases"] = [fluid]
    with pytest.raises(fsi.InputError, match=r"^case: a section contains itself; give sections as"):
        reduced(fluid=fluid)


API: Any = fsi  # as those use it who check no types


@pytest.mark.parametrize(
    ("ask", "words"),
    [
        (lambda _: API.load_case(None), "path: is of type NoneType"),
        (lambda _: API.load_case(3), "path: is of type int"),
        (lambda _: API.load_case(b"x"), "path: is of type bytes"),
        (lambda _: API.load_case(BOX, None), "overrides = None"),
        (lambda _: API.open_run(None), "path: is of type NoneType"),
        (lambda _: API.resume(None), "folder: is of type NoneType"),
        (lambda case: API.run(case, None), "folder: is of type NoneType"),
        (lambda case: API.run(case, "out", 3), "callback: is of type int"),
        (lambda case: API.solve(case).write(None), "folder: is of type NoneType"),
        (lambda _: API.load_case("a\0b"), r"path = 'a\\x00b': has a zero byte"),
        (lambda _: API.resume("a\0b"), r"folder = 'a\\x00b': has a zero byte"),
        (lambda case: API.run(case, "a\0b"), r"folder = 'a\\x00b': has a zero byte"),
        (lambda case: API.solve(case).write("a\0b"), r"folder = 'a\\x00b': has a zero byte"),
        (lambda case: API.calibrate(case, "out", "2"), "processes: is of type str"),
        (lambda case: API.calibrate(case, "out", 1.5), "processes: is of type float"),
    ],
)
def test_what_is_no_argument_is_refused_in_one_line(
    ask: Callable[[fsi.Case], object], words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(fsi.InputError, match=rf"^{words}[;:] give .+$"):
        ask(reduced())
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("ask", "words"),
    [
        (
            lambda here: API.open_run(here / "none"),
            "path = .*none: there is no case.toml; give the folder that",
        ),
        (lambda here: API.resume(here / "none"), "folder = .*none: not a run folder .*; give one made by"),
        (lambda here: API.run(reduced(), here), "folder = .*: exists and is not empty; give another folder"),
    ],
)
def test_a_path_is_told_by_the_name_of_its_argument(
    ask: Callable[[Path], object], words: str, tmp_path: Path
) -> None:
    """They told of `output` and `run`, as commands call them."""
    (tmp_path / "there").touch()
    with pytest.raises(fsi.InputError, match=f"^{words}"):
        ask(tmp_path)


@pytest.mark.parametrize(
    ("sections", "words"),
    [
        ({"arrangement": {"number": 4}, "bodies": []}, "bodies: the bodies are those of "),
        ({"model": "x"}, 'model = "x": there is no such model; give "resolved", "pores", '),
        ({"model": "limit"}, 'model = "limit": is now `fsi limit` of a case of one gluey body; give "gluey"'),
        (
            {"bodies_from": "\u00e9\n.json"},
            r'bodies_from = "\u00e9\n.json": No such file or directory; give ',
        ),
        ({"bodies_from": 5000 * "x"}, f'bodies_from = "{55 * "x"} ...: ends in nothing; give a .json or'),
        (
            {"bodies_from": "x.json"},
            "bodies_from = x.json: No such file or directory; give the path of a file",
        ),
        ({"name": "a\rb", "geometry": "a\rb"}, r'geometry = "a\rb": not one of the choices; give '),
    ],
)
def test_whatever_is_given_the_line_is_one(sections: dict[str, Any], words: str) -> None:
    with pytest.raises(fsi.InputError) as caught:
        reduced(**sections)
    assert str(caught.value).startswith(words)
    assert len(str(caught.value).splitlines()) == 1


def test_the_meaning_of_a_key_is_on_the_line_too() -> None:
    """It had the line break of a text in the code."""
    with pytest.raises(fsi.InputError) as caught:
        API.make_case(name="a", arrangement={"number": 4, "area_fraction": 0.4}, domain={})
    assert str(caught.value).startswith('arrangement.kind: missing; give "random", ')
    assert str(caught.value).endswith('"body-centred", "face-centred" or "close-packed" of spheres')


def test_a_line_break_in_a_path_does_not_break_the_message() -> None:
    with pytest.raises(fsi.InputError) as refused:
        fsi.load_case("a\nb.toml")
    assert "a b.toml" in str(refused.value)
    assert "\n" not in str(refused.value)
