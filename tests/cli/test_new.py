"""`fsi new`: what it writes is the case that it is made of, and says what each key means."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

from fsi.case.load import load_case
from fsi.cli.new import KINDS
from tests.commands import fsi_command

CASES = Path(__file__).parents[2] / "cases"


@pytest.mark.parametrize("kind", KINDS)
def test_it_is_the_case_of_its_kind(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert fsi_command("new", "--kind", kind) == 0
    assert capsys.readouterr().out == f"wrote {kind}.toml; see what it holds with: fsi check {kind}.toml\n"
    written, shipped = load_case(Path(f"{kind}.toml")), load_case(CASES / KINDS[kind])
    assert written == shipped.model_copy(update={"name": kind, "expected": ()})
    text = Path(f"{kind}.toml").read_text()
    keys = {line.partition("=")[0].strip() for line in text.splitlines() if "=" in line.partition("#")[0]}
    told = {line.partition("=")[0].strip() for line in text.splitlines() if "  # " in line}
    assert told == keys


def test_a_name_is_quoted(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    assert fsi_command("new", "--kind", "shear", "--name", 'my "own" # one', "-o", path) == 0
    assert tomllib.loads(path.read_text())["name"] == 'my "own" # one'


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "--kind: missing; give one of settling"),
        (["--kind", "shar"], "--kind shar: there is no such kind; give one of settling"),
        (["--kind", "shear", "-o", "there.toml"], "is there already; give the name of a new file"),
        (["--kind", "shear", "-o", "none/there.toml"], "output = none/there.toml"),
    ],
)
def test_mistakes_are_one_line(
    words: list[str], said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    Path("there.toml").touch()
    assert fsi_command("new", *words) == 2
    told = capfd.readouterr()
    assert said in told.err
    assert (told.err.count("\n"), told.out) == (1, "")
