"""Files that nobody means: pipes, links in a circle, deep nesting, numbers and texts that are none."""

import os
from pathlib import Path

import pytest

from fsi.case.body_file import read_bodies
from fsi.case.load import load_case
from fsi.errors import InputError
from fsi.files import content, json_of

CASE = Path(__file__).parents[1] / "cases" / "disc_in_box.toml"


def test_a_pipe_a_folder_and_a_circle_of_links_are_refused(tmp_path: Path) -> None:
    """A pipe that nobody writes to would be waited for, for ever."""
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "circle").symlink_to(tmp_path / "circle")
    for name, words in (
        ("pipe", "no regular file"),
        (".", "directory"),
        ("circle", "symbolic links"),
        ("\0", "null"),
    ):
        with pytest.raises(InputError, match=words):
            content(tmp_path / name, "give another")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (b"x = " + b"[" * 2000 + b"]" * 2000, "nested too deeply"),
        (b"x = " + b"[" * 100 + b"]" * 100, "nested too deeply"),
        (b"x = " + b"9" * 5000, "digits"),
        (b"x = " + b"9" * 400, "more than 64 bits"),
        (b'x = "\\uD800"', "not TOML"),
        (b'x = "\\u0000"', "zero byte"),
        (b"x = \xff", "utf-8"),
        (b"x = \0", "not TOML"),
    ],
)
def test_toml_that_nobody_means(tmp_path: Path, text: bytes, words: str) -> None:
    (tmp_path / "case.toml").write_bytes(text)
    with pytest.raises(InputError, match=words) as raised:
        load_case(tmp_path / "case.toml")
    assert len(str(raised.value)) < 600


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ("9" * 400, "more than 64 bits; correct it"),
        ("9" * 5000, "digits"),
        ("[" * 2000 + "]" * 2000, "recursion|nested"),
        ('"\\u0000"', "zero byte; correct it"),
        ('"\udc80"', "surrogates not allowed"),
    ],
)
def test_changes_that_nobody_means(value: str, words: str) -> None:
    with pytest.raises(InputError, match=f"the value is not TOML: .*({words})"):
        load_case(CASE, [f"bodies.0.radius={value}"])


@pytest.mark.parametrize("text", ["9" * 400, "[" * 2000 + "]" * 2000, '"\\ud800"'])
def test_json_that_nobody_means(tmp_path: Path, text: str) -> None:
    (tmp_path / "data.json").write_text(text)
    with pytest.raises(InputError, match="not JSON"):
        json_of(tmp_path / "data.json", "give another")


def test_fields_of_csv_of_any_length(tmp_path: Path) -> None:
    (tmp_path / "discs.csv").write_text(f"name,radius,x,y\n{'a' * 200_000},1,0,0\n")
    with pytest.raises(InputError, match="field larger than field limit"):
        read_bodies(tmp_path / "discs.csv")


@pytest.mark.parametrize("formula", ["+" * 20_000 + "x", "+".join(["x"] * 10_000), "(" * 20_000])
def test_formulas_of_any_length(formula: str) -> None:
    case = CASE.parent / "macroscopic" / "blocks.toml"
    with pytest.raises(InputError, match="longer than 500 signs"):
        load_case(case, [f'macroscopic.force_per_mass="{formula}"'])
