from __future__ import annotations

import errno
import os
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

from fsi.bodies.configuration import Configuration, Inertia
from fsi.case.load import load_case, parse_case
from fsi.errors import InputError, SolveError
from fsi.integration.state import State, StepRecord
from fsi.run_folder.folder import Commit, RunFolder
from fsi.run_folder.provenance import git_commit, launch
from fsi.runs import resume, run
from tests.exact_model import DiscsBesidePlane, ExactInstant, by
from tests.small_run import contents, launches, make_model, rows, small_case, start


def test_tables_tell_every_step_with_all_digits(tmp_path: Path) -> None:
    records: list[StepRecord] = []
    case = small_case()
    outcome = run(case, tmp_path / "run", records.append, make=by(make_model))
    steps, bodies = rows(tmp_path / "run" / "steps.csv"), rows(tmp_path / "run" / "bodies.csv")
    assert outcome.steps == len(records) - 1 == len(steps) - 1
    assert list(steps[0])[:5] == ["step", "t", "h", "smallest_gap", "rejected"]
    assert list(steps[0])[-2:] == ["cpu_solve", "cpu_step"]
    assert [float(row["t"]) for row in steps] == [record.t for record in records]
    assert (steps[0]["step"], steps[0]["t"], steps[0]["h"]) == ("0", "0.0", "0.0")
    assert [row["body"] for row in bodies[-2:]] == ["left", "right"]
    columns = ("x", "y", "angle", "V_x", "V_y", "omega", "F_x", "F_y", "T")
    last = [[float(row[column]) for column in columns] for row in bodies[-2:]]
    q = records[-1].q
    expected = np.column_stack([q.centres, q.angles, records[-1].U, records[-1].F])
    assert np.array_equal(last, expected)
    assert min(row[1] for row in last) - 1.0 == float(steps[-1]["smallest_gap"])


def test_series_list_the_fields_at_the_output_times(unbroken: Path) -> None:
    entries = list(ElementTree.parse(unbroken / "fluid.pvd").iter("DataSet"))
    times = [0.0, 0.25, 0.5, 0.75, 1.0]
    assert [float(e.attrib["timestep"]) for e in entries] == [t for t in times for _ in range(2)]
    assert [e.attrib["part"] for e in entries] == ["0", "1"] * 5
    assert all((unbroken / e.attrib["file"]).is_file() for e in entries)
    assert len(list(ElementTree.parse(unbroken / "surface.pvd").iter("DataSet"))) == 5
    assert {"0.35"} < {row["t"] for row in rows(unbroken / "steps.csv")}


def test_the_case_in_the_folder_is_the_case(unbroken: Path) -> None:
    assert load_case(unbroken / "case.toml") == small_case()


def test_provenance(unbroken: Path) -> None:
    (entry,) = launches(unbroken)
    assert entry["packages"]["numpy"] == np.__version__
    assert (entry["ranks"], entry["seed"]) == (1, None)


def test_git_commit_is_that_of_the_checkout_only(tmp_path: Path) -> None:
    assert git_commit(tmp_path) is None
    assert launch()["git"] is None or len(launch()["git"].removesuffix("+dirty")) == 40


def test_without_fields_only_tables_are_written(tmp_path: Path) -> None:
    start(small_case(output={"fields": False}), tmp_path / "run")
    assert not list((tmp_path / "run" / "fields").iterdir())
    assert not list((tmp_path / "run").glob("*.pvd"))


def test_a_command_that_is_told_has_its_folder_quoted(tmp_path: Path) -> None:
    (tmp_path / "my run").mkdir()
    (tmp_path / "my run" / "case.toml").touch()
    with pytest.raises(InputError, match=r"or `fsi resume '.*my run'` to continue that run"):
        start(small_case(), tmp_path / "my run")


def test_folders_that_cannot_be_used(tmp_path: Path) -> None:
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "thesis.tex").write_text("")
    (tmp_path / "file").write_text("")
    for name in ("full", "file", "file/below"):
        with pytest.raises(InputError, match=rf"output = .*{name}: .*; give "):
            start(small_case(), tmp_path / name)
    with pytest.raises(InputError, match="not a run folder"):
        resume(tmp_path / "full", make=by(make_model))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "full"]
    (tmp_path / "empty").mkdir()
    start(small_case(), tmp_path / "empty")


def test_a_disk_without_room_for_the_case_keeps_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A hidden folder stayed beside it; a folder that the user has made stays, empty."""

    def full(path: Path, _: bytes) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))

    (tmp_path / "mine").mkdir()
    monkeypatch.setattr("fsi.run_folder.folder.replace", full)
    for name in ("new", "mine"):
        with pytest.raises(InputError, match=f"{name}: No space left .*; give a folder .*, or make room$"):
            start(small_case(), tmp_path / name)
    assert [path.relative_to(tmp_path) for path in tmp_path.rglob("*")] == [Path("mine")]


def test_an_empty_folder_is_filled_and_stays_the_one_that_it_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A shell in it was left in a folder that had been removed; its mode was that of new ones, here 755."""
    folder = tmp_path / "mine"
    folder.mkdir()
    folder.chmod(0o2770)
    before = folder.stat()
    monkeypatch.chdir(folder)
    start(small_case(), Path())
    assert (folder.stat().st_ino, folder.stat().st_mode) == (before.st_ino, before.st_mode)
    assert Path("case.toml").is_file()
    assert [path.name for path in tmp_path.iterdir()] == ["mine"]


def test_a_run_that_cannot_begin_leaves_an_empty_folder_empty(tmp_path: Path) -> None:
    """And takes away one that it has made."""

    class Refused(DiscsBesidePlane):
        def __call__(self, *_: Any, **__: Any) -> ExactInstant:
            raise InputError("no")

    (tmp_path / "given").mkdir()
    for name in ("given", "new"):
        with pytest.raises(InputError, match=r"^no$"):
            run(small_case(), tmp_path / name, make=by(partial(Refused, noise=1e-4)))
    assert [path.name for path in tmp_path.rglob("*")] == ["given"]


def test_links_that_lead_in_a_circle(tmp_path: Path) -> None:
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    with pytest.raises(InputError, match="loop: its links lead in a circle; give another folder"):
        start(small_case(), tmp_path / "loop")
    with pytest.raises(InputError, match="loop: its links lead in a circle; give another folder"):
        resume(tmp_path / "loop", make=by(make_model))


def test_a_run_that_was_killed_in_its_first_commit_begins_anew(unbroken: Path, tmp_path: Path) -> None:
    """It has field files and rows of step 0, the last of them cut off, and no state."""
    folder = tmp_path / "run"
    RunFolder.create(folder, small_case(), launch())
    for path in unbroken.glob("fields/*_000000*"):
        (folder / "fields" / path.name).write_bytes(path.read_bytes())
    for table in ("steps.csv", "bodies.csv"):
        lines = (unbroken / table).read_bytes().splitlines(keepends=True)
        (folder / table).write_bytes(lines[0] + lines[1][:-5])
    resume(folder, make=by(make_model))
    assert contents(folder) == contents(unbroken)


def test_rows_with_other_columns_than_their_table_are_refused(tmp_path: Path) -> None:
    """A step without a column would shift all that follow; also where another launch began the table."""
    case = small_case()

    class Forgetful(DiscsBesidePlane):
        def __call__(self, q: Configuration, t: float, inertia: Inertia | None = None) -> ExactInstant:
            found = super().__call__(q, t, inertia)
            return replace(found, record={k: v for k, v in found.record.items() if t < 0.3})

    with pytest.raises(InputError, match=r"the new rows of steps\.csv have other columns than it has"):
        run(case, tmp_path / "run", make=by(partial(Forgetful, noise=1e-4)))
    kept = len(rows(tmp_path / "run" / "steps.csv"))
    with pytest.raises(InputError, match=r"the new rows of steps\.csv have other columns"):
        resume(tmp_path / "run", make=by(partial(Forgetful, noise=1e-4)))
    assert len(rows(tmp_path / "run" / "steps.csv")) == kept


def test_a_case_without_time_cannot_be_run(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="time: missing"):
        start(parse_case(small_case().model_dump(exclude={"time"}, exclude_none=True)), tmp_path / "run")
    assert not list(tmp_path.iterdir())


def test_a_table_takes_no_rows_under_another_header(tmp_path: Path) -> None:
    """As many columns with other names would be read as what they are not."""
    folder = RunFolder.create(tmp_path / "run", small_case(), launch())
    folder.keep(step(0, "stress"))
    folder.keep(step(1, "stress"))
    with pytest.raises(InputError, match=r"the new rows of extra\.csv have other columns .*; put that right"):
        folder.keep(step(2, "strain"))
    folder.rescue()
    assert (tmp_path / "run" / "extra.csv").read_text() == "step,stress\n0,1.0\n1,1.0\n"
    assert [row["step"] for row in rows(tmp_path / "run" / "steps.csv")] == ["0", "1"]


@pytest.mark.parametrize(("seldom", "commits"), [(0.0, 5), (1e9, 1)])
def test_steps_that_follow_each_other_fast_are_committed_together(
    seldom: float, commits: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The first at once; what a kill would lose are those after the last commit."""
    monkeypatch.setattr("fsi.run_folder.folder.SELDOM", seldom)
    folder = RunFolder.create(tmp_path / "run", small_case(), launch())
    on_disk = []
    for number in range(5):
        folder.keep(step(number, "stress"))
        on_disk.append(len(rows(tmp_path / "run" / "steps.csv")))
    assert len(set(on_disk)) == commits
    checkpoint = RunFolder.reopen(tmp_path / "run").checkpoint
    assert checkpoint is not None
    assert checkpoint.state.step == on_disk[-1] - 1 == commits - 1
    folder.commit()
    assert [row["step"] for row in rows(tmp_path / "run" / "steps.csv")] == ["0", "1", "2", "3", "4"]


def test_a_commit_that_was_refused_is_made_whole_when_there_is_room(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The tables have its rows already, which must not come twice."""
    monkeypatch.setattr("fsi.run_folder.folder.SELDOM", 0.0)
    folder = RunFolder.create(tmp_path / "run", small_case(), launch())
    folder.keep(step(0, "stress"))

    def refuse(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as patch:
        patch.setattr("fsi.run_folder.folder.write_checkpoint", refuse)
        with pytest.raises(SolveError, match="No space left"):
            folder.keep(step(1, "stress"))
    folder.rescue()
    assert [row["step"] for row in rows(tmp_path / "run" / "extra.csv")] == ["0", "1"]
    checkpoint = RunFolder.reopen(tmp_path / "run").checkpoint
    assert checkpoint is not None
    assert checkpoint.state.step == 1


def step(number: int, column: str) -> Commit:
    """A step with a further table of one column."""
    q = small_case().configuration()
    state = State(0.1 * number, number, q, np.zeros((len(q), 3)), 0.1)
    record = StepRecord(number, state.t, 0.1, 1.0, 0, q, np.zeros((len(q), 3)), np.zeros((len(q), 3)), {})
    return Commit(record, (), {}, {"extra.csv": (["step", column], [[number, 1.0]])}, state, {})


@pytest.mark.parametrize("full", ["steps.csv", "fluid.pvd.tmp", "state.npz.tmp", "_1.vtu"])
def test_a_full_disk_is_one_line_and_the_run_goes_on_when_there_is_room(
    full: str, unbroken: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In whatever file it happens, of the folder or of the fields: what was committed stays."""
    folder, seen, refused = tmp_path / "run", list[str](), list[str]()

    def no_room(name: str, written: Callable[..., object], *given: object) -> object:
        seen.append(name)
        if name.endswith(full) and len(seen) > 20:
            refused.append(name)
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), name)
        return written(*given)

    def fsync(descriptor: int) -> None:
        no_room(Path(f"/proc/self/fd/{descriptor}").readlink().name, synced, descriptor)

    def write_bytes(path: Path, data: bytes) -> object:
        return no_room(path.name, written, path, data)

    synced, written = os.fsync, Path.write_bytes
    with monkeypatch.context() as patch:
        patch.setattr("fsi.run_folder.folder.SELDOM", 0.0)
        patch.setattr(os, "fsync", fsync)
        patch.setattr(Path, "write_bytes", write_bytes)
        with pytest.raises(SolveError) as told:
            start(small_case(), folder)
    words = f"output = {folder}: No space left on device ({refused[0]}); make room, or make it writable, and "
    without = f"; or `fsi resume {folder} --set output.fields=false`" if full.endswith(".vtu") else ""
    assert str(told.value) == f"{words}`fsi resume {folder}`{without}"
    committed = RunFolder.reopen(folder).checkpoint
    assert committed is not None
    assert 0.0 < committed.state.t < 1.0
    resume(folder, make=by(make_model))
    assert contents(folder) == contents(unbroken)
