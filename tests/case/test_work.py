"""Work is estimated before it starts: right to a factor 3, and refused by name beyond what there is."""

from pathlib import Path

import pytest

import fsi.case.checks.work as work
from fsi.bodies.gaps import find_gaps
from fsi.case.checks.work import check_work, require_room
from fsi.case.load import load_case
from fsi.errors import InputError
from fsi.meshes.estimate import cells_of
from fsi.observables.truncation import halved
from fsi.runs import run
from fsi.stokes.meshes import CaseMeshes
from tests.cli.test_commands import complaint

CASES = Path(__file__).parents[2] / "cases"


@pytest.mark.parametrize(
    ("case_file", "changes"),
    [
        ("disc_in_box.toml", []),
        ("disc_in_box.toml", ["bodies.0.position=[0.0, 1.00001]"]),
        ("disc_in_box.toml", ["discretisation.cells_per_circle=500"]),
        ("disc_in_box.toml", ["discretisation.cells_per_gap=6"]),
        ("disc_beside_plane.toml", ["discretisation.growth=0.04"]),
        ("two_discs.toml", ["discretisation.growth=1.0"]),
        ("settling_spheres.toml", []),
        ("couette_N10.toml", []),
        ("suspensions/random.toml", []),
        ("sphere_in_space.toml", []),
    ],
)
def test_cells_are_estimated_to_a_factor_three(case_file: str, changes: list[str]) -> None:
    """Of one half at 0.4 to 1.5; a law of sizes that is another one makes 10 and more of it."""
    case = load_case(CASES / case_file, changes)
    meshes, q = CaseMeshes(case), case.configuration()
    gaps = find_gaps(q, case.container())
    estimate = cells_of(case.container(), q.radii, work.narrows(case, gaps), meshes.resolution)
    assert 1.0 / 3.0 < estimate / meshes.mesh(q).cells() < 3.0


TOO_MUCH = [
    ("disc_beside_plane.toml", "bodies.0.position=[0.0, 1.0000000001]", "below the 1e-08 that are resolved"),
    ("disc_in_box.toml", "bodies.0.position=[0.0, 1.0000000000001]", "'disc' and 'bottom'"),
    ("disc_in_box.toml", "discretisation.cells_per_circle=100000000", "cells_per_circle = 100000000: a mesh"),
    (
        "disc_in_box.toml",
        "discretisation.cells_per_gap=1e300",
        "discretisation.cells_per_gap = 1e+300: a mesh",
    ),
    ("sphere_in_space.toml", "bodies.0.position=[0.0, 0.0, 1.0000002]", "bodies: 1, smallest gap 2e-07"),
    ("gluey/layers.toml", "time.step=1e-300", "time.step = 1e-300: "),
    ("settling_disc.toml", "output.interval=1e-300", "output.interval = 1e-300: "),
    (
        "gluey/layers.toml",
        "grids.0.counts=[100000, 100000]",
        "grids.0.counts = [100000, 100000]: makes 1e+10",
    ),
    ("macroscopic/blocks.toml", "macroscopic.parcels=100000000000", "macroscopic.parcels = 100000000000"),
    ("calibration/disc_wall.toml", "calibration.samples=100000000000", "calibration.samples = 100000000000"),
    ("pushed_then_pulled.toml", "limit.steps=[100000000000]", "limit.steps = 100000000000"),
]


@pytest.mark.parametrize(("case_file", "change", "words"), TOO_MUCH)
def test_what_no_machine_holds_is_refused_by_name(
    case_file: str,
    change: str,
    words: str,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert words in complaint(capsys, monkeypatch, "check", str(CASES / case_file), "--set", change)


def test_a_gap_of_1e_8_radii_is_taken() -> None:
    assert check_work(load_case(CASES / "disc_in_box.toml", ["bodies.0.position=[0.0, 1.00000001]"])) is None


def test_what_takes_long_is_said_beforehand() -> None:
    assert check_work(load_case(CASES / "gluey/layers.toml")) is None
    warning = check_work(load_case(CASES / "gluey/layers.toml", ["time.step=1e-6"]))
    assert warning is not None
    assert "1.8e+07 steps" in warning  # 18 / 1e-6


def test_files_are_looked_for_room_where_they_will_stand(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The disk of the current directory was asked, and for a solve too, which writes nothing."""
    asked: list[Path] = []

    def free(path: Path) -> float:
        asked.append(path)
        return 1e6

    monkeypatch.setattr("fsi.machine.resources.free_disk", free)
    case = load_case(CASES / "settling_disc.toml", ["output.interval=1e-6"])
    check_work(case)
    assert not asked
    with pytest.raises(
        InputError,
        match=rf"^output\.interval = 1e-06: .* of files, of 1 MB free in {tmp_path / 'run'};",
    ):
        require_room(case, tmp_path / "run")
    assert set(asked) == {tmp_path / "run"}
    with pytest.raises(InputError, match=r"^output\.interval"):
        run(case, tmp_path / "run")
    assert not list(tmp_path.iterdir())


def test_what_files_take_is_told_as_it_is_estimated(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """2e8 steps of one disc, (200 + 150) bytes each, are 70 GB; a third of it is what must have room."""
    case = load_case(
        CASES / "settling_disc.toml", ["output.interval=1e-6", "time.end=200.0", "output.fields=false"]
    )
    monkeypatch.setattr("fsi.machine.resources.free_disk", lambda _: 24e9)
    require_room(case, tmp_path)
    monkeypatch.setattr("fsi.machine.resources.free_disk", lambda _: 23e9)
    with pytest.raises(InputError, match=r" with some 70 GB of files, of 23 GB free in "):
        require_room(case, tmp_path)


def test_longer_steps_are_no_remedy_where_nothing_can_be_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two steps of one disc take 2 (200 + 150) bytes without fields: a third, 233.3, must be free."""
    case = load_case(CASES / "settling_disc.toml", ["output.interval=0.1", "output.fields=false"])
    with pytest.raises(InputError, match=r"^output = /proc/x: .*; give a folder that can be written$"):
        require_room(case, Path("/proc/x"))
    monkeypatch.setattr("fsi.machine.resources.free_disk", lambda _: 233.0)
    with pytest.raises(
        InputError, match=r"^output = .*/run: two steps, .*; make room, or give another folder$"
    ):
        require_room(case, tmp_path / "run")
    monkeypatch.setattr("fsi.machine.resources.free_disk", lambda _: 234.0)
    with pytest.raises(InputError, match=r"^output\.interval = 0\.1: .*; give longer ones$"):
        require_room(case, tmp_path / "run")


def test_pores_take_time_and_memory_by_their_modes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Fifty discs with eight modes: 0.011 s a disc and step; one: 1.9e5 bytes a disc."""
    file, often = CASES / "pores/history.toml", ["output.interval=1e-3"]
    assert check_work(load_case(file, often)) is None
    assert check_work(load_case(file, [*often, "pores.modes=8"])) == (
        "50 bodies, 3e+03 steps: some 28 minutes or more"
    )
    (tmp_path / "memory.max").write_text("2000000\n")
    monkeypatch.setattr("fsi.machine.resources._LIMITS", {"": (tmp_path, "memory.max")})
    with pytest.raises(InputError, match=r"bodies: 50, with pores.modes = 1, .* some 9.5 MB .* give fewer"):
        check_work(load_case(file))


def test_half_a_radius_that_leaves_no_room_for_a_mesh_is_left_out() -> None:
    case = load_case(CASES / "validation/concentric_sphere.toml", ["domain.radius=2.0000002"])
    assert halved(case) is None


def test_memory_that_a_container_may_take(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    limit = tmp_path / "memory.max"
    limit.write_text("1000000000\n")
    monkeypatch.setattr("fsi.machine.resources._LIMITS", {"": (tmp_path, limit.name)})
    with pytest.raises(InputError, match="of 1 GB here"):
        check_work(load_case(CASES / "macroscopic/blocks.toml", ["macroscopic.parcels=1000000"]))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (
            ["pack", "random", "--number", "1000000000", "-o", "{folder}/p.json"],
            "--number 1000000000, for which",
        ),
        (["render", "{folder}", "--size", "1000000"], "--size 1000000: 1e+12 pixels"),
        (["probe", "{folder}", "--plane", "0,0,1,1", "--count", "1000000"], "--count 1000000: 1e+12 points"),
    ],
)
def test_options_that_no_machine_holds_are_refused(
    arguments: list[str],
    words: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    (tmp_path / "case.toml").write_text((CASES / "settling_disc.toml").read_text())
    given = [argument.format(folder=tmp_path) for argument in arguments]
    assert words in complaint(capsys, monkeypatch, *given)
    assert [path.name for path in tmp_path.iterdir()] == ["case.toml"]
