"""Samples of shapes from outside: other code of theirs is another sample."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from fsi.calibration.finding import pair_of
from fsi.calibration.pair import Pair
from fsi.calibration.sampling import key_of
from fsi.case.load import parse_case
from fsi.case.shapes.shape import BodyShape

MODULES = ("my_upright_shapes", "my_widths", "my_other_script")
SHAPES = """
from typing import Literal
from fsi.case.shapes.ellipse import Ellipse
from fsi.case.shapes.shape import register_shape
from my_widths import WIDTH

@register_shape
class Upright(Ellipse):
    kind: Literal["upright-of-tests"]
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Where modules of a user are, one of which has a shape, by another one."""
    for name, text in zip(MODULES, (SHAPES, "WIDTH = 1.0\n", "import my_upright_shapes\n"), strict=True):
        (tmp_path / f"{name}.py").write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(BodyShape.registry, "sections", [*BodyShape.registry.all()])
    importlib.import_module(MODULES[2])
    yield tmp_path
    for name in MODULES:
        del sys.modules[name]


def pair(kind: str = "upright-of-tests") -> Pair:
    body = {"name": "egg", "position": [0.0, 2.0], "shape": {"kind": kind, "axes": [1.0, 0.5]}}
    data = {"name": "own", "fluid": {"viscosity": 1.0}, "domain": {"shape": "half-plane", "radius": 1e3}}
    plan = {"pair": ["egg", "plane"], "range": [1e-2, 1e-1], "samples": 6}
    return pair_of(parse_case(data | {"bodies": [body], "calibration": plan}))


@pytest.mark.parametrize("changed", MODULES[:2])
def test_other_code_of_a_user_is_another_sample(changed: str, folder: Path) -> None:
    """Of the module of the shape, and of one beside it that it imports."""
    before = key_of(pair(), 0.05)
    assert key_of(pair(), 0.05) == before
    (folder / f"{changed}.py").write_text("WIDTH = 0.5\n")
    assert key_of(pair(), 0.05) != before


def test_code_that_makes_no_case_changes_no_sample(folder: Path) -> None:
    """A script beside it, and the module of a shape that the case does not have."""
    before = key_of(pair(), 0.05), key_of(pair("ellipse"), 0.05)
    (folder / f"{MODULES[2]}.py").write_text("WIDTH = 0.5\n")
    assert key_of(pair(), 0.05) == before[0]
    (folder / f"{MODULES[0]}.py").write_text("WIDTH = 0.5\n")
    assert key_of(pair("ellipse"), 0.05) == before[1]


def test_code_without_a_file_makes_another_sample_each_time(folder: Path) -> None:
    """As of a shape that is written in an interactive session."""
    (folder / f"{MODULES[0]}.py").unlink()
    assert key_of(pair(), 0.05) != key_of(pair(), 0.05)
