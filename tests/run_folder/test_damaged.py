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


@pytest.fixture
def copied(sound: Path, tmp_path: Path) -> Path:
    """That run in a folder of its own."""
    return shutil.copytree(sound, tmp_path / "run")


def _half(path: Path) -> None:
    os.truncate(path, path.stat().st_size // 2)


def _pipe(path: Path) -> None:
    path.unlink()
    os.mkfifo(path)


def _written(text: bytes) -> Callable[[Path], object]:
    return lambda path: path.write_bytes(text)


def _edited(old: str, new: str) -> Callable[[Path], object]:
    return lambda path: path.write_text(path.read_text().replace(old, new, 1))


def _last_cell(column: str, word: str) -> Callable[[Path], object]:
    """Put a word into the last row, so that the table stays as long as the run knows it to be."""

    def damage(path: Path) -> None:
        header, *rows = [line.split(",") for line in path.read_text().splitlines()]
        k = header.index(column)
        width = len(rows[-1][k])
        rows[-1][k] = word.ljust(width)[:width]
        path.write_text("".join(",".join(row) + "\n" for row in (header, *rows)))

    return damage


def _exchanged(path: Path) -> None:
    """Put the two bodies of step 0 in the other order: each has the other's place, and all is as long."""
    header, first, second, *rest = path.read_bytes().splitlines(keepends=True)
    path.write_bytes(b"".join([header, second, first, *rest]))


def _of_a_future_version(path: Path) -> None:
    """An archive whose first file needs version 25.3 of ZIP (its central header has the version at 6)."""
    archive = bytearray(path.read_bytes())
    archive[archive.index(b"PK\x01\x02") + 6] = 253
    path.write_bytes(archive)


DAMAGE: list[tuple[str, str, Callable[[Path], object]]] = [
    ("resume", "state.npz", _written(b"")),
    ("resume", "state.npz", _half),
    ("resume", "state.npz", _pipe),
    ("resume", "state.npz", Path.unlink),
    ("resume", "bodies.csv", _edited(".", ".#")),
    ("resume", "state.npz", _written(b"garbage" * 500)),
    ("resume", "state.npz", _of_a_future_version),
    ("resume", "bodies.csv", _edited("\n0,0.0,", "\n0,nan,")),
    ("resume", "bodies.csv", _last_cell("x", "nan")),
    ("resume", "bodies.csv", _exchanged),
    ("resume", "steps.csv", _last_cell("kkt", "nan")),
    ("resume", "steps.csv", _last_cell("t", "-5")),
    ("resume", "steps.csv", _last_cell("t", "99")),
    ("resume", "provenance.json", _written(b"[1, 2]")),
    ("resume", "provenance.json", _written(b'{"format": 3, "launches": 3}')),
    ("resume", "provenance.json", _written(b"[" * 3000)),
    ("resume", "bodies.pvd", _half),
    ("render", "state.npz", _written(b"")),
    ("render", "state.npz", _written(b"garbage" * 500)),
    ("render", "state.npz", _of_a_future_version),
    ("render", "bodies.pvd", _half),
    ("render", "bodies.pvd", Path.unlink),
    ("render", "bodies.pvd", _written(b'<?xml version="1.0"?><x><DataSet part="0"/></x>')),
    ("render", "fields/bodies_000010.vtu", _written(b"garbage")),
    ("render", "fields/bodies_000010.vtu", _half),
    ("render", "fields/bodies_000010.vtu", _pipe),
    ("plot", "steps.csv", _pipe),
    ("plot", "bodies.csv", _exchanged),
    ("plot", "steps.csv", _last_cell("kkt", "nan")),
    ("plot", "steps.csv", _last_cell("t", "-5")),
    ("plot", "steps.csv", _last_cell("t", "99")),
]


@pytest.mark.parametrize(("command", "name", "damage"), DAMAGE)
def test_a_damaged_file_is_one_line(
    command: str,
    name: str,
    damage: Callable[[Path], object],
    copied: Path,
    capfd: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    damage(copied / name)
    before = _files(copied)
    told = complaint(capfd, monkeypatch, command, str(copied))
    assert name in told
    assert "pickle" not in told  # NumPy's way to load what is no archive, which is unsafe
    assert _files(copied) == before


def _files(folder: Path) -> dict[Path, int]:
    """All that is in a folder, with its sizes."""
    return {path: path.lstat().st_size for path in folder.rglob("*")}


@pytest.mark.parametrize(("name", "commands"), [("steps.csv", "plot report watch"),
                                                ("provenance.json", "plot report watch resume")])  # fmt: skip
def test_a_lost_file_is_told_alike_by_all(
    name: str, commands: str, copied: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Watched, a lost table had lost bytes at its end; without its record a run was reported unchecked."""
    (copied / name).unlink()
    for command in commands.split():
        told = complaint(capfd, monkeypatch, command, str(copied))
        assert f"{copied / name}: No such file or directory; put that right or run the case again" in told


@pytest.mark.parametrize("left", ["fields", "steps.csv", "bodies.csv"])
def test_a_run_that_has_lost_its_state_is_left_as_it_is(
    left: str, copied: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Any of these tells that there were steps, which `fsi resume` removed to begin anew."""
    for name in {"state.npz", "steps.csv", "bodies.csv"} - {left}:
        (copied / name).unlink()
    if left != "fields":
        shutil.rmtree(copied / "fields")
    before = _files(copied)
    told = complaint(capfd, monkeypatch, "resume", str(copied))
    assert "state.npz is missing" in told
    assert _files(copied) == before


@pytest.mark.parametrize("command", ["plot", "render", "report", "export"])
def test_a_case_that_was_edited_is_not_that_of_the_run(
    command: str, copied: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    case = copied / "case.toml"
    case.write_text(case.read_text().replace("radius = 1.0", "radius = 0.5", 1))
    told = complaint(capfd, monkeypatch, command, str(copied))
    assert "bodies.0.radius = 1.0 -> 0.5; put the old values back" in told


@pytest.mark.parametrize("name", ["flow.png", "flow.gif", "flow.mp4"])
def test_a_folder_that_takes_no_picture_is_one_line(
    name: str, sound: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """/proc takes no files, even from root."""
    assert f"/proc/{name}" in complaint(capfd, monkeypatch, "render", str(sound), "--output", f"/proc/{name}")
