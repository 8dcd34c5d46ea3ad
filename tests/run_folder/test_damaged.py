"""Damaged files of a run: one line that names the file, and nothing else on the terminal."""

import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.cli.test_commands import complaint
from tests.commands import fsi_command

CASE = Path(__file__).parents[2] / "cases" / "gluey" / "two_discs.toml"


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run that has not come to its end."""
    folder = tmp_path_factory.mktemp("runs") / "gluey"
    assert fsi_command("run", CASE, "--output", folder, "--set", "time.end=0.1") == 0
    case = folder / "case.toml"
    case.write_text(case.read_text().replace("end = 0.1", "end = 0.2"))
    return folder


def _half(path: Path) -> None:
    os.truncate(path, path.stat().st_size // 2)


def _pipe(path: Path) -> None:
    path.unlink()
    os.mkfifo(path)


def _written(text: bytes) -> Callable[[Path], object]:
    return lambda path: path.write_bytes(text)


DAMAGE: list[tuple[str, str, Callable[[Path], object]]] = [
    ("resume", "state.npz", _written(b"")),
    ("resume", "state.npz", _half),
    ("resume", "state.npz", _pipe),
    ("resume", "provenance.json", _written(b"[1, 2]")),
    ("resume", "provenance.json", _written(b'{"format": 3, "launches": 3}')),
    ("resume", "provenance.json", _written(b"[" * 3000)),
    ("resume", "bodies.pvd", _half),
    ("render", "state.npz", _written(b"")),
    ("render", "bodies.pvd", _half),
    ("render", "bodies.pvd", _written(b'<?xml version="1.0"?><x><DataSet part="0"/></x>')),
    ("render", "fields/bodies_000010.vtu", _written(b"garbage")),
    ("render", "fields/bodies_000010.vtu", _half),
    ("render", "fields/bodies_000010.vtu", _pipe),
    ("plot", "steps.csv", _pipe),
]


@pytest.mark.parametrize(("command", "name", "damage"), DAMAGE)
def test_a_damaged_file_is_one_line(
    command: str,
    name: str,
    damage: Callable[[Path], object],
    sound: Path,
    tmp_path: Path,
    capfd: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    run = tmp_path / "run"
    shutil.copytree(sound, run)
    damage(run / name)
    assert name in complaint(capfd, monkeypatch, command, str(run))


@pytest.mark.parametrize("name", ["flow.png", "flow.gif", "flow.mp4"])
def test_a_folder_that_takes_no_picture_is_one_line(
    name: str, sound: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """/proc takes no files, even from root."""
    assert f"/proc/{name}" in complaint(capfd, monkeypatch, "render", str(sound), "--output", f"/proc/{name}")
