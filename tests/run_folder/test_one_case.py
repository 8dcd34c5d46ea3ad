"""A run is one case: what has been changed of it is refused by its key, or taken and recorded."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import tomli_w

import fsi
from fsi.case.case import Case
from fsi.case.law_file import LawFile, TableSection, save_law
from fsi.case.load import load_case, named_files, read_toml
from fsi.errors import InputError
from fsi.models import make_evolution
from fsi.run_folder.one_case import case_record, identity
from fsi.runs import MakeEvolution, resume, run
from tests.commands import fsi_command
from tests.reduced_data import heap, reduced_case
from tests.small_run import EXACT, break_off, launches, made_older, rows, small_case, start

CASES = Path(__file__).parents[2] / "cases"


def stopped(folder: Path, case: Case, make: MakeEvolution = EXACT, step: int = 4) -> Path:
    """A run that was broken off after so many steps."""
    break_off(folder, case, step, make)
    return folder


def everything(folder: Path) -> dict[str, bytes]:
    """Every file of a folder, bit by bit."""
    files = {path.relative_to(folder).as_posix(): path for path in folder.rglob("*") if path.is_file()}
    return {name: path.read_bytes() for name, path in files.items()}


def edit(folder: Path, change: Callable[[dict[str, Any]], object]) -> None:
    """As a user edits case.toml."""
    data = read_toml(folder / "case.toml")
    change(data)
    (folder / "case.toml").write_text(tomli_w.dumps(data))


CHANGES: dict[str, tuple[Callable[[dict[str, Any]], object], str]] = {
    "radius": (lambda c: c["bodies"][0].update(radius=1.25), r"bodies\.0\.radius = 1\.0 -> 1\.25;"),
    "viscosity": (lambda c: c["fluid"].update(viscosity=2.0), r"fluid\.viscosity = 1\.0 -> 2\.0;"),
    "a body less": (lambda c: c["bodies"].pop(), r"bodies = 2 sections -> 1 sections;"),
    "no load": (
        lambda c: c["bodies"][0].update(force=["x"]),
        r"\.force = \[1\.0, -20\.0\] -> \[\"x\"\]; put",
    ),
    "bodies that overlap": (lambda c: c["bodies"][0].update(radius=20.0), r"\.radius = 1\.0 -> 20\.0; put"),
    "an end that is none": (
        lambda c: c["time"].update(end="x"),
        r"time\.end = \"x\": must be a valid number",
    ),
    "a mass more": (
        lambda c: c["bodies"][0].update(mass=1.0, moment_of_inertia=0.5),
        r"bodies\.0\.mass = none -> 1\.0, bodies\.0\.moment_of_inertia = none -> 0\.5;",
    ),
    "tolerance": (lambda c: c["time"].update(tolerance=1e-5), r"time\.tolerance = 1e-06 -> 1e-05;"),
    "columns": (
        lambda c: c["output"].update(error_estimates=True),
        r"output\.error_estimates = false -> true;",
    ),
    "two keys, one of which may": (
        lambda c: (c["time"].update(end=2.0), c["fluid"].update(viscosity=2.0)),
        r"with: fluid\.viscosity = 1\.0 -> 2\.0; put the old values back, or run",
    ),
    "an earlier end": (
        lambda c: c["time"].update(end=1e-3),
        r"time\.end = 0\.001: the run is at t = .* later",
    ),
}


@pytest.mark.parametrize("name", CHANGES)
def test_a_changed_case_is_refused_by_its_keys_and_nothing_is_touched(name: str, tmp_path: Path) -> None:
    """Also what a killed step has left behind stays as it is."""
    folder = stopped(tmp_path / "run", small_case())
    with (folder / "steps.csv").open("a") as table:
        table.write("5,0.5")
    (folder / "fields" / "fluid_000099_0.vtu").write_text("half a fi")
    change, words = CHANGES[name]
    edit(folder, change)
    before = everything(folder)
    with pytest.raises(InputError, match=words):
        resume(folder, make=EXACT)
    assert everything(folder) == before


def test_a_later_end_and_output_are_taken_and_recorded(tmp_path: Path) -> None:
    """By --set and by an edited file; the steps that were there stay.

    The smallest step is 1e-9 of the end, 1e-9 at last, not 5e-10 for good: nobody has given it.
    """
    start(small_case(time={"end": 0.5, "tolerance": 1e-6, "first_step": 0.5}), tmp_path / "run")
    old = (tmp_path / "run" / "bodies.csv").read_bytes()
    resume(tmp_path / "run", make=EXACT, overrides=["time.end=0.75", "output.interval=0.125"])
    edit(tmp_path / "run", lambda c: c["time"].update(end=1.0))
    resume(tmp_path / "run", make=EXACT)
    assert (tmp_path / "run" / "bodies.csv").read_bytes().startswith(old)
    times = [float(row["t"]) for row in rows(tmp_path / "run" / "steps.csv")]
    assert {0.5, 0.625, 0.75, 0.875, 1.0} < set(times)
    assert times == sorted(set(times))
    assert times[-1] == 1.0
    changed = [entry.get("changed") for entry in launches(tmp_path / "run")]
    assert changed == [
        None,
        {
            "time.end": [0.5, 0.75],
            "time.smallest_step": [1e-9 * 0.5, 1e-9 * 0.75],
            "output.interval": [0.25, 0.125],
        },
        {"time.end": [0.75, 1.0], "time.smallest_step": [1e-9 * 0.75, 1e-9]},
    ]
    case = load_case(tmp_path / "run" / "case.toml")
    assert (case.timing.end, case.timing.smallest_step, case.output.interval) == (1.0, 1e-9, 0.125)
    kept = json.loads((tmp_path / "run" / "provenance.json").read_text())["case"]
    assert kept == json.loads(json.dumps(case.as_data()))


@pytest.mark.parametrize("end", [None, "0.5", -1.0])
def test_a_record_without_its_end_is_no_defect(end: object, tmp_path: Path) -> None:
    """Where the record of a run has been damaged its case is as it was, and goes on to the new end."""
    start(small_case(time={"end": 0.5, "tolerance": 1e-6}), tmp_path / "run")
    record = tmp_path / "run" / "provenance.json"
    data = json.loads(record.read_text())
    data["case"]["time"]["end"] = end
    record.write_text(json.dumps(data))
    resume(tmp_path / "run", make=EXACT, overrides=["time.end=0.75"])
    case = load_case(tmp_path / "run" / "case.toml")
    assert (case.timing.end, case.timing.smallest_step) == (0.75, 1e-9 * 0.5)


@pytest.mark.parametrize(("first", "smallest"), [(0.05, 1e-7), (0.25e-9, 0.25e-9)])
def test_a_smallest_step_that_was_given_stays(first: float, smallest: float, tmp_path: Path) -> None:
    """1e-9 of the end is no longer than a first step that was given, or the case would not be sound."""
    given = {"smallest_step": smallest} if smallest > 1e-9 else {}
    time = {"end": 0.2, "tolerance": 1e-6, "first_step": first, **given}
    start(small_case(time=time), tmp_path / "run")
    resume(tmp_path / "run", make=EXACT, overrides=["time.end=1"])
    assert load_case(tmp_path / "run" / "case.toml").timing.smallest_step == smallest


def gluey() -> Case:
    return load_case(
        CASES / "gluey" / "two_discs.toml", ["time.end=3", "time.step=0.05", "output.interval=0.5"]
    )


def macroscopic() -> Case:
    changes = ["time.end=2", "time.step=0.1", "output.interval=0.5", "macroscopic.parcels=20"]
    return load_case(CASES / "macroscopic" / "blocks.toml", changes)


def reduced() -> Case:
    given = {"law": "exact", "drag": 12.0, "cutoff": 0.5}
    return reduced_case(heap(), given, time={"end": 0.8, "tolerance": 1e-3}, output={"interval": 0.2})


@pytest.mark.parametrize(
    ("made", "key", "now"),
    [
        (gluey, "bodies.0.mass", 2.0),
        (macroscopic, "macroscopic.blocks.0.density", 0.25),
        (reduced, "reduced.drag", 13.0),
    ],
)
def test_every_model_refuses_another_case_and_goes_on_to_a_later_end(
    made: Callable[[], Case], key: str, now: float, tmp_path: Path
) -> None:
    case = made()
    folder = stopped(tmp_path / "run", case, make_evolution, step=3)
    before = everything(folder)
    with pytest.raises(InputError, match=rf"{key} = .* -> {now}; put the old values back"):
        resume(folder, overrides=[f"{key}={now}"])
    assert everything(folder) == before
    end = 1.25 * case.timing.end
    assert resume(folder, overrides=[f"time.end={end}"]).state.t == end


def test_a_changed_law_file_is_refused(tmp_path: Path) -> None:
    """The case is the same, the physics is not."""
    law = LawFile(form="table", shape="discs", viscosity=1.0, table=TableSection(s=(1e-4, 1.0), K=(9.0, 1.0)))
    save_law(tmp_path / "law.toml", law)
    law_and_file = {"law": "exact", "wall_law": str(tmp_path / "law.toml"), "extrapolate": True}
    given = law_and_file | {"drag": 12.0, "cutoff": 0.5}
    case = reduced_case(heap(), given, time={"end": 0.2, "tolerance": 1e-3}, output={"interval": 0.2})
    folder = stopped(tmp_path / "run", case, make_evolution, step=2)
    changed = law.model_copy(update={"table": TableSection(s=(1e-4, 1.0), K=(9.5, 1.0))})
    save_law(tmp_path / "law.toml", changed)
    before = everything(folder)
    with pytest.raises(
        InputError, match=r"the file of reduced\.wall_law = \"\w{12}\" -> \"\w{12}\"; put the old"
    ):
        resume(folder)
    assert everything(folder) == before
    save_law(tmp_path / "law.toml", law)
    assert resume(folder).state.t == 0.2


def test_files_are_found_by_the_keys_of_a_case() -> None:
    """A law that has a name is no file."""
    data = {"domain": {"mesh": "/m.msh"}, "reduced": {"law": "exact", "wall_law": "/l.toml"}}
    assert list(named_files(data)) == [
        ("domain.mesh", Path("/m.msh")),
        ("reduced.wall_law", Path("/l.toml")),
    ]


DAMAGES: dict[str, tuple[str, Callable[[bytes], bytes]]] = {
    "no state": ("state.npz", lambda _: b""),
    "half a state": ("state.npz", lambda data: data[: len(data) // 2]),
    "a state with other bytes": ("state.npz", lambda data: data.replace(b"\0\0\0\0\0\0\xf0?", b"\0" * 8, 1)),
    "another provenance": ("provenance.json", lambda _: b"[]"),
    "no launches": ("provenance.json", lambda data: data.replace(b"launches", b"lunches")),
    "no case": ("provenance.json", lambda data: data.replace(b'"case"', b'"caste"')),
    "half a series": ("fluid.pvd", lambda data: data[: len(data) // 2]),
    "a shorter series": ("fluid.pvd", lambda data: data.replace(b"<DataSet", b"<Dataset", 1)),
    "lost rows": ("bodies.csv", lambda data: data[:-30]),
    "a field without an end": ("bodies.csv", lambda data: data[:-200_000] + 200_000 * b"1" + b"\n"),
    "a lost column": ("bodies.csv", lambda data: data.replace(b",", b";", 1)),
    "no case file": ("case.toml", lambda _: b""),
    "half a case file": ("case.toml", lambda data: data[: len(data) // 2]),
}


@pytest.mark.parametrize("name", DAMAGES)
def test_nothing_is_touched_before_every_file_has_been_found_sound(name: str, tmp_path: Path) -> None:
    """One line that names the folder or the file; what a killed step has left behind stays, too."""
    folder = stopped(tmp_path / "run", small_case(output={"interval": 0.05}))
    (folder / "fields" / "fluid_000099_0.vtu").write_text("half a fi")
    file, damage = DAMAGES[name]
    (folder / file).write_bytes(damage((folder / file).read_bytes()))
    before = everything(folder)
    with pytest.raises(InputError, match=r"run") as raised:
        resume(folder, make=EXACT)
    assert "\n" not in str(raised.value)
    assert everything(folder) == before


def test_a_memory_that_the_model_does_not_know_is_refused(tmp_path: Path) -> None:
    """Gluey contacts remember their gamma; a state without is that of another model."""
    folder = stopped(tmp_path / "run", gluey(), make_evolution, step=3)
    other = stopped(tmp_path / "other", small_case())
    (folder / "state.npz").write_bytes((other / "state.npz").read_bytes())
    for table in ("steps.csv", "bodies.csv", "fluid.pvd", "surface.pvd"):
        (folder / table).write_bytes((other / table).read_bytes())
    made_older(folder)  # or it is refused as that of another case
    before = everything(folder)
    with pytest.raises(InputError, match=r"state\.npz is damaged .*; put that right or run the case again"):
        resume(folder)
    assert everything(folder) == before


def test_a_folder_of_two_cases_is_refused_by_all_that_go_on_with_it_or_read_it(tmp_path: Path) -> None:
    """All but case and provenance is of a run in twice as viscous a fluid: it was gone on with, and drawn."""
    folder = stopped(tmp_path / "run", small_case())
    other = stopped(tmp_path / "other", small_case(fluid={"viscosity": 2.0}))
    for name, data in everything(other).items():
        if name not in ("case.toml", "provenance.json"):
            (folder / name).write_bytes(data)
    before = everything(folder)
    told = r"run: a run is one case, and state\.npz is of another one than provenance\.json; put the files"
    with pytest.raises(InputError, match=told):
        resume(folder, make=EXACT)
    for name in ("steps", "bodies"):
        with pytest.raises(InputError, match=told):
            fsi.open_run(folder).table(name)
    with pytest.raises(InputError, match=told):
        fsi.open_run(folder).mesh()
    assert everything(folder) == before


def test_what_may_change_makes_no_other_case() -> None:
    """A later end, with its smallest step, and other output; the viscosity, or the file of a law, do."""
    record = case_record(small_case())
    later = small_case(time={"end": 2.0, "tolerance": 1e-6, "first_step": 0.5}, output={"fields": False})
    assert case_record(later) != record
    assert identity(case_record(later)) == identity(record)
    assert identity(case_record(small_case(fluid={"viscosity": 2.0}))) != identity(record)
    assert identity(record | {"files": {"reduced.wall_law": "0"}}) != identity(record)


def test_the_command_and_python_say_the_same(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "run"
    run(gluey(), folder)
    assert fsi_command("resume", folder, "--set", "bodies.0.radius=0.5") == 2
    said = capfd.readouterr().err
    assert said.count("\n") == 1
    assert "bodies.0.radius = 1.0 -> 0.5; put the old values back" in said
    with pytest.raises(InputError, match=r"bodies\.0\.radius = 1\.0 -> 0\.5"):
        fsi.resume(folder, overrides=["bodies.0.radius=0.5"])
    assert fsi_command("resume", folder, "--set", "time.end=3.5") == 0
    assert "steps to t = 3.5" in capfd.readouterr().out
    assert fsi.resume(folder, overrides=["time.end=4"]).end == 4.0
