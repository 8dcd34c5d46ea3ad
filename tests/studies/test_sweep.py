"""`fsi sweep`: tables over values and seeds, on this machine and on a cluster, whatever is killed."""

from __future__ import annotations

import csv
import math
import os
import signal
import time
import tomllib
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fsi.case.load import parse_case, toml_values
from fsi.errors import FsiError
from fsi.studies.evaluate import FoundValue, of_motion
from fsi.studies.member import LAUNCHES, RESULT, compute
from fsi.studies.sweep import SEED, SweepPlan, SweepRow, SweptKey, averages
from fsi.workers import launch, pools
from tests.cluster import process, scheduler, wait_until
from tests.commands import fsi_command

ROOT = Path(__file__).parents[2]
CASE = """
name = "four discs at random"
model = "reduced"
fluid.viscosity = 1.0
domain.walls.top = [1.0, 0.0]
arrangement = { kind = "random", number = 4, area_fraction = 0.3, gap = 0.02 }
reduced = { drag = 10.0, cutoff = 1.0, shear_law = "exact", rotation_law = "exact" }
time = { end = 0.2, first_step = 0.1 }
"""
PUSHED = """
name = "two spheres that are pushed together"
geometry = "axisymmetric"
model = "reduced"
fluid.viscosity = 1.0
domain = { shape = "round", radius = 100.0 }
reduced.wall_law = "leading"
time = { end = 8.0, tolerance = 1e-2 }
bodies = [
    { name = "upper", radius = 1.0, position = [0.0, 1.25], force = [0.0, -2.0] },
    { name = "lower", radius = 1.0, position = [0.0, -1.25], velocity = [0.0, 0.0] },
]
"""
FRACTION, VISCOSITY = "arrangement.area_fraction", "apparent viscosity"
QUANTITY = ["--quantity", VISCOSITY]


@pytest.fixture
def case(tmp_path: Path) -> Path:
    path = tmp_path / "four.toml"
    path.write_text(CASE)
    return path


@pytest.fixture
def here(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Runs in this process, one after the other, and in which order they were begun."""
    begun: list[str] = []

    def launched(_: str, folder: str, __: int) -> str:
        begun.append(Path(folder).name)
        try:
            compute(Path(folder))
        except FsiError as error:
            return str(error)
        return ""

    monkeypatch.setattr(launch, "launched", launched)
    return begun


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fsi.postprocess.plots.sweep.plot_sweep", lambda *_: None)


def swept(case: Path, folder: Path, *more: object) -> int:
    given = [f"{FRACTION}=0.2,0.3", "--seeds", 2, *QUANTITY, "--workers", 1, "-o", folder]
    return fsi_command("sweep", case, "--vary", *given, *more)


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_means_are_those_of_the_runs(case: Path, tmp_path: Path, here: list[str]) -> None:
    """And each run is the case with these values, solved by itself."""
    folder = tmp_path / "sweep"
    assert swept(case, folder) == 0
    assert len(here) == 4
    runs, means = rows(folder / "runs.csv"), rows(folder / "sweep.csv")
    assert [(row[FRACTION], row[SEED]) for row in runs] == [(x, s) for x in ("0.2", "0.3") for s in "12"]
    for mean, group in zip(means, (runs[:2], runs[2:]), strict=True):
        x = [float(row[VISCOSITY]) for row in group]
        assert len(set(x)) == 2
        assert (mean["count"], mean["failed"]) == ("2", "0")
        assert float(mean["mean"]) == pytest.approx(sum(x) / 2.0, rel=1e-14)
        deviation = math.sqrt(sum((v - sum(x) / 2.0) ** 2 for v in x))
        assert float(mean["deviation"]) == pytest.approx(deviation, rel=1e-12)
        assert float(mean["standard_error"]) == pytest.approx(deviation / math.sqrt(2.0), rel=1e-12)
    last = folder / runs[-1]["folder"]
    assert (last / "case.toml").is_file()
    assert (folder / "sweep.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.usefixtures("undrawn")
def test_what_is_done_is_not_done_again(case: Path, tmp_path: Path, here: list[str]) -> None:
    """More seeds and quantities cost what is new; a broken run alone is done again."""
    folder = tmp_path / "sweep"
    assert swept(case, folder) == 0
    before = rows(folder / "runs.csv")
    assert swept(case, folder) == 0
    assert len(here) == 4
    (folder / before[1]["folder"] / RESULT).unlink()
    assert swept(case, folder) == 0
    assert here[4:] == [Path(before[1]["folder"]).name]
    assert rows(folder / "runs.csv") == before
    assert swept(case, folder, "--seeds", 3) == 0
    assert len(here) == 7
    assert swept(case, folder, "--seeds", 3, "--quantity", "dissipation") == 0
    assert len(here) == 13
    assert rows(folder / "runs.csv")[0][VISCOSITY] == before[0][VISCOSITY]


@pytest.mark.usefixtures("undrawn")
def test_runs_that_fail_are_named_and_the_others_go_on(
    case: Path,
    tmp_path: Path,
    here: list[str],
    capfd: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """One of four fails, whatever it is, and is tried again."""
    folder = tmp_path / "sweep"
    assert swept(case, folder) == 0
    lost = rows(folder / "runs.csv")[2]["folder"]
    (folder / lost / RESULT).unlink()
    with monkeypatch.context() as patch:
        patch.setattr(launch, "launched", lambda *_: "the mesh is not valid")
        assert swept(case, folder) == 3
    assert f"1 of 4 runs failed, first {Path(lost).name}: the mesh is not valid" in capfd.readouterr().err
    table, means = rows(folder / "runs.csv"), rows(folder / "sweep.csv")
    assert [row["status"] for row in table if row["folder"] == lost] == ["failed: the mesh is not valid"]
    assert [(mean["count"], mean["failed"]) for mean in means] == [("2", "0"), ("1", "1")]
    assert swept(case, folder) == 0
    assert len(here) == 5


@pytest.mark.usefixtures("undrawn")
def test_runs_in_time_are_averaged(case: Path, tmp_path: Path, here: list[str]) -> None:
    """The mean over time of steps.csv, and what a body has in the last row of bodies.csv."""
    folder = tmp_path / "sweep"
    assert swept(case, folder, "--seeds", 0, "--run", "--quantity", "disc0001.position.x") == 0
    assert len(here) == 2
    row = rows(folder / "runs.csv")[0]
    run = folder / row["folder"] / "motion"
    steps, bodies = rows(run / "steps.csv"), rows(run / "bodies.csv")
    t, mu = (np.array([float(step[name]) for step in steps]) for name in ("t", "apparent_viscosity"))
    mean = sum(0.5 * (mu[1:] + mu[:-1]) * np.diff(t)) / t[-1]
    assert float(row[VISCOSITY]) == pytest.approx(mean, rel=1e-13)
    last = [body for body in bodies if body["body"] == "disc0001"][-1]
    assert float(row["disc0001.position.x"]) == float(last["x"])


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--vary", f"{FRACTION}=0.2,0.2"], "has a value twice"),
        (["--vary", f"{FRACTION}=0.2,,0.3"], "no key and values; write KEY=A,B,C"),
        (["--vary", "0.2"], "no key and values"),
        (["--vary", "arrangement.fraction=0.2"], "arrangement.fraction = 0.2: unknown key"),
        (["--vary", f"{FRACTION}=0.2,1.5"], "1.5"),
        (["--vary", "arrangement.kind=square", "--seeds", "2"], "arrangement.seed = 1: square has no such"),
        (
            [
                "--set",
                "model=gluey",
                "--set",
                "domain.walls={}",
                "--set",
                "time.step=0.1",
                "--set",
                "arrangement.number=16",
            ],
            "no velocities at an instant; add --run",
        ),
        (["--quantity", "viscosity"], "--quantity viscosity: no such number"),
        (["--quantity", "disc0001.position.x"], "no such number at an instant"),
        (["--scheduler", "tcp://127.0.0.1:9", "--workers", "2"], "--workers 2: the cluster has its own"),
    ],
)
def test_mistakes_are_one_line(
    words: list[str], said: str, case: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """And nothing is written."""
    assert fsi_command("sweep", case, *QUANTITY, *words, "-o", tmp_path / "none") == 2
    told = capfd.readouterr()
    assert said in told.err
    assert (told.err.count("\n"), told.out) == (1, "")
    assert not (tmp_path / "none").exists()


@pytest.mark.usefixtures("undrawn")
def test_a_folder_of_another_case_is_refused(
    case: Path, tmp_path: Path, here: list[str], capfd: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "sweep"
    assert swept(case, folder, "--seeds", 0) == 0
    assert swept(case, folder, "--seeds", 0, "--set", "arrangement.gap=0.03") == 2
    assert "holds a run of another case" in capfd.readouterr().err
    assert swept(case, folder, "--seeds", 0, "--run") == 2
    assert len(here) == 2


@given(st.lists(st.floats(-1e9, 1e9), min_size=1, max_size=4, unique=True), st.integers(0, 3))
def test_tables_have_a_row_for_each_point_whatever_failed(values: list[float], seeds: int) -> None:
    """The mean is over what was done; values at x are x + seed there, and the second seed fails."""
    plan = SweepPlan(
        Path(), (), [SweptKey("x", values), SweptKey("word", ["a", "b"])], seeds, ("q",), False, Path()
    )
    found = []
    for point in plan.points():
        for seed in range(1, max(seeds, 1) + 1):
            known = None if seed == 2 else {"q": FoundValue(point["x"] + seed)}
            found.append(SweepRow(SimpleNamespace(), known))  # type: ignore[arg-type]
    means = averages(plan, found)
    assert [(one.point["x"], one.point["word"]) for one in means] == [(x, w) for x in values for w in "ab"]
    for one in means:
        assert one.count + one.failed == max(seeds, 1)
        assert one.failed == (seeds >= 2)
        expected = one.point["x"] + (2.0 if seeds == 3 else 1.0)  # of 1, or of 1 and 3
        assert one.mean == pytest.approx(expected, rel=1e-12, abs=1e-6)


def test_the_bar_of_a_mean_is_the_largest() -> None:
    """Of runs that have one."""
    plan = SweepPlan(Path(), (), [SweptKey("x", [1.0])], 3, ("q",), False, Path())
    bars = (1e-4, 3e-4, None)
    found = [SweepRow(SimpleNamespace(), {"q": FoundValue(2.0, bar)}) for bar in bars]  # type: ignore[arg-type]
    assert [mean.error for mean in averages(plan, found)] == [3e-4]


def test_the_force_at_the_end_of_a_run_is_that_of_the_fluid(tmp_path: Path) -> None:
    """Of two spheres that are pushed together; the gap of 0.5 falls below 0.3 between two steps."""
    case = parse_case(tomllib.loads(PUSHED))
    found = of_motion(case, tmp_path / "run", ["upper.force.z", "time at gap 0.3"]).values
    assert found["upper.force.z"].value == pytest.approx(2.0, rel=1e-9)  # the push is -2
    steps = rows(tmp_path / "run" / "steps.csv")
    gaps = [float(step["smallest_gap"]) for step in steps]
    after = next(k for k, gap in enumerate(gaps) if gap < 0.3)
    t = [float(step["t"]) for step in steps]
    assert t[after - 1] < found["time at gap 0.3"].value < t[after]


def test_values_are_toml() -> None:
    assert toml_values("0.1, 2") == [0.1, 2]
    assert toml_values("square, rows") == ["square", "rows"]
    assert toml_values("[0.0, 1.0], [1.0, 0.0]") == [[0.0, 1.0], [1.0, 0.0]]
    assert toml_values("true, false") == [True, False]
    for wrong in ("1 2", "a b", "1,,2"):
        with pytest.raises(ValueError, match=r"."):
            toml_values(wrong)


def test_a_scheduler_that_is_not_there_is_one_line(
    case: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pools, "_PATIENCE", 0.3)
    given = [f"{FRACTION}=0.2", *QUANTITY, "-o", tmp_path / "s", "--scheduler", "tcp://127.0.0.1:9"]
    assert fsi_command("sweep", case, "--vary", *given) == 2
    assert "--scheduler tcp://127.0.0.1:9: no scheduler answers there" in capfd.readouterr().err
    assert not (tmp_path / "s").exists()


# ---- processes that are killed ---------------------------------------------------------------------------


def wait_for_results(folder: Path, count: int) -> None:
    """Until so many runs are done."""
    wait_until(lambda: len(list(folder.glob(f"runs/*/{RESULT}"))) >= count)


def launches(folder: Path) -> dict[str, int]:
    """How often each run was begun."""
    return {
        path.parent.name: len(path.read_text().splitlines()) for path in folder.glob(f"runs/*/{LAUNCHES}")
    }


@pytest.mark.slow
def test_a_killed_sweep_goes_on(case: Path, tmp_path: Path, here: list[str]) -> None:
    """kill -9 half-way: its runs end with it, what was done is kept, the table is that of a serial one."""
    folder, serial = tmp_path / "killed", tmp_path / "serial"
    words = [
        "sweep",
        case,
        "--vary",
        f"{FRACTION}=0.2,0.3",
        "--seeds",
        5,
        *QUANTITY,
        "--workers",
        2,
        "-o",
        folder,
    ]
    with process("fsi", *words) as one:
        wait_for_results(folder, 3)
        one.send_signal(signal.SIGKILL)
        one.wait()
    time.sleep(3.0)  # runs end within their next look at the pipe
    done = {path.parent.name: path.stat().st_mtime_ns for path in folder.glob(f"runs/*/{RESULT}")}
    assert 3 <= len(done) < 10
    time.sleep(3.0)
    assert len(list(folder.glob(f"runs/*/{RESULT}"))) == len(done)  # none went on alone
    with process("fsi", *words) as again:
        assert again.wait() == 0
    for path in folder.glob(f"runs/*/{RESULT}"):
        assert path.stat().st_mtime_ns == done.get(path.parent.name, path.stat().st_mtime_ns)
    assert fsi_command(*words[:-1], serial) == 0
    assert len(here) == 10
    for table in ("sweep.csv", "runs.csv"):
        assert (folder / table).read_bytes() == (serial / table).read_bytes()


@pytest.mark.slow
def test_a_cluster_gives_the_table_of_a_serial_sweep(case: Path, tmp_path: Path, here: list[str]) -> None:
    """100 runs over two workers in processes of their own, one killed half-way: all done, none twice."""
    folder, serial = tmp_path / "cluster", tmp_path / "serial"
    words = ["sweep", case, "--vary", f"{FRACTION}=0.1,0.2,0.25,0.3,0.35", "--seeds", 20, *QUANTITY, "-o"]
    with (
        scheduler(tmp_path) as (address, worker),
        process(*worker) as first,
        process(*worker),
        process("fsi", *words, folder, "--scheduler", address) as it,
    ):
        wait_for_results(folder, 40)
        os.kill(first.pid, signal.SIGKILL)
        said, _ = it.communicate()
        assert it.returncode == 0, said
    begun = launches(folder)
    assert len(begun) == 100
    assert sorted(begun.values())[:99] == [1] * 99  # only the killed one was begun twice
    assert max(begun.values()) <= 2
    assert fsi_command(*words, serial, "--workers", 1) == 0
    assert len(here) == 100
    for table in ("sweep.csv", "runs.csv"):
        assert (folder / table).read_bytes() == (serial / table).read_bytes()


@pytest.mark.slow
@pytest.mark.mpi
def test_a_run_of_two_ranks_is_one_task(tmp_path: Path) -> None:
    """A resolved disc on two ranks gives the force of one to 1e-9."""
    found = []
    for ranks in (1, 2):
        folder = tmp_path / str(ranks)
        given = [
            "--vary",
            "discretisation.degree=2",
            "--quantity",
            "disc.force.y",
            "-o",
            folder,
            "--ranks",
            ranks,
        ]
        assert fsi_command("sweep", ROOT / "cases" / "disc_in_box.toml", *given, "--workers", 1) == 0
        found.append(float(rows(folder / "runs.csv")[0]["disc.force.y"]))
    assert found[1] == pytest.approx(found[0], rel=1e-9)
    assert found[0] == pytest.approx(466.11048, rel=1e-3)  # cases/disc_in_box.toml, of coarser elements
