"""Files that appear whole, also after a power cut: content reaches the disk before its name does."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

import fsi
from fsi.errors import InputError, SolveError
from fsi.files import appearing, replace
from fsi.run_folder.folder import RunFolder
from fsi.run_folder.paraview import write_points
from fsi.runs import run
from tests.exact_model import by
from tests.small_run import make_model, small_case


@pytest.fixture
def synced(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The names of files that have been synchronised, in order, each with its length then."""
    names: list[str] = []

    def fsync(descriptor: int) -> None:
        name = Path(f"/proc/self/fd/{descriptor}").readlink().name
        names.append(f"{name} {os.fstat(descriptor).st_size}")

    monkeypatch.setattr(os, "fsync", fsync)
    return names


def test_a_file_is_on_the_disk_before_it_takes_its_place(synced: list[str], tmp_path: Path) -> None:
    replace(tmp_path / "a.txt", b"seven b")
    assert synced == ["a.txt.tmp 7"]
    assert [path.name for path in tmp_path.iterdir()] == ["a.txt"]


def test_a_field_file_is_on_the_disk_before_it_takes_its_place(synced: list[str], tmp_path: Path) -> None:
    """A checkpoint may know of it after a power cut."""
    write_points(tmp_path / "a.vtu", np.zeros((3, 2)), {"p": np.ones(3)})
    assert [path.name for path in tmp_path.iterdir()] == ["a.vtu"]
    assert synced == [f".partial-{os.getpid()}-a.vtu {(tmp_path / 'a.vtu').stat().st_size}"]


def test_tables_are_on_the_disk_before_the_checkpoint_that_knows_their_lengths(
    synced: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whole rows, each commit: else a power cut leaves a run that has lost rows and cannot be resumed."""
    monkeypatch.setattr("fsi.run_folder.folder.SELDOM", 0.0)
    run(small_case(), tmp_path / "run", make=by(make_model))
    order = [name.split()[0] for name in synced]
    commits = [k for k, name in enumerate(order) if name == "state.npz.tmp"]
    assert len(commits) > 3
    for before, commit in zip([-1, *commits], commits, strict=False):
        assert {"steps.csv", "bodies.csv"} <= set(order[before + 1 : commit])
    last = (tmp_path / "run" / "steps.csv").stat().st_size
    assert [name for name in synced if name.startswith("steps.csv ")][-1] == f"steps.csv {last}"


def test_two_processes_write_the_same_file_without_each_other(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The last one stays. In one place the other would find its file gone, and HDF5 waited for ever."""
    path = tmp_path / "a.txt"
    with appearing(path) as one:
        one.write_text("one")
        monkeypatch.setattr(os, "getpid", lambda: 1)
        with appearing(path) as other:
            other.write_text("other")
    assert {file.name: file.read_text() for file in tmp_path.iterdir()} == {"a.txt": "one"}


def test_fields_that_find_no_room_tell_of_the_run_without_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Dropping output.fields from the case, which is true by default, changed nothing."""

    def fsync(_: int) -> None:
        raise OSError(28, "No space left on device")

    folder = RunFolder.create(tmp_path / "a run", small_case(), {})
    monkeypatch.setattr(os, "fsync", fsync)
    with pytest.raises(SolveError) as told, folder.writing():
        write_points(folder.fields / "a.vtu", np.zeros((3, 2)), {})
    resume = f"fsi resume '{folder.path}'"
    assert "No space left on device" in str(told.value)
    assert str(told.value).endswith(
        f"; make room, or make it writable, and `{resume}`; or `{resume} --set output.fields=false`"
    )
    with pytest.raises(InputError) as said:  # of a solution there is no run
        fsi.solve(small_case()).write(tmp_path / "solved")
    assert str(said.value).endswith("; make room, or give another folder")


def test_nothing_is_left_of_a_file_that_could_not_be_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What was there before stays, whether writing or synchronising fails."""
    path = tmp_path / "a.txt"
    path.write_text("before")

    def interrupted() -> None:
        with appearing(path) as partial:
            partial.write_text("half a fi")
            raise KeyboardInterrupt

    def fsync(_: int) -> None:
        raise OSError(28, "No space left on device")

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    monkeypatch.setattr(os, "fsync", fsync)
    with pytest.raises(OSError, match="No space"):
        replace(path, b"after")
    assert {file.name: file.read_text() for file in tmp_path.iterdir()} == {"a.txt": "before"}
