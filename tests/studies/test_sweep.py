"""`fsi sweep`: tables over values and seeds, what is done again, and what is refused."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from fsi.case.load import toml_values
from fsi.studies.keys import require_apart
from fsi.studies.member import RESULT
from fsi.studies.sweep import SEED
from fsi.workers import launch, pools
from tests.commands import fsi_command
from tests.small_run import rows
from tests.studies.small_sweep import FRACTION, QUANTITY, VISCOSITY, swept

TOP = "domain.walls.top"


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


def test_a_run_that_lacks_a_quantity_has_the_others(
    case: Path, tmp_path: Path, here: list[str], capfd: pytest.CaptureFixture[str]
) -> None:
    """Gaps of 0.02 to begin with: none is 9 before time.end, or ever."""
    folder, lacking = tmp_path / "sweep", "time at gap 9"
    assert swept(case, folder, "--seeds", 0, "--run", "--quantity", lacking) == 3
    said = (
        "2 of 2 runs failed, first arrangement.area_fraction=0.2: time at gap 9: the run begins at a gap of"
    )
    assert said in capfd.readouterr().err
    for row in rows(folder / "runs.csv"):
        assert row["status"].startswith("failed: time at gap 9: the run begins")
        assert float(row[VISCOSITY]) > 1.0
        assert row[lacking] == ""
    means = {(row[FRACTION], row["quantity"]): row for row in rows(folder / "sweep.csv")}
    for fraction in ("0.2", "0.3"):
        known, none = means[fraction, VISCOSITY], means[fraction, lacking]
        assert (known["count"], known["failed"], none["count"], none["failed"]) == ("1", "0", "0", "1")
    assert swept(case, folder, "--seeds", 0, "--run", "--quantity", lacking) == 3  # is tried again
    assert len(here) == 4
    assert swept(case, folder, "--seeds", 0, "--run") == 0
    assert len(here) == 4


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
    assert float(row[VISCOSITY]) == pytest.approx(
        PchipInterpolator(t, mu).integrate(0.0, t[-1]) / t[-1], rel=1e-12
    )
    last = [body for body in bodies if body["body"] == "disc0001"][-1]
    assert float(row["disc0001.position.x"]) == float(last["x"])


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--vary", f"{FRACTION}=0.2,0.2"], "has a value twice"),
        (["--vary", "reduced.drag=1,2", "--vary", "reduced.drag=3"], "--vary reduced.drag: is given twice;"),
        (["--vary", f"{SEED}=1,2", "--seeds", "2"], f"--vary {SEED}: --seeds 2 gives its values too; drop"),
        (
            ["--vary", f"{TOP}=[1.0, 0.0],[2.0, 0.0]", "--vary", f"{TOP}.0=1.0,2.0"],
            f"--vary {TOP}.0: is a part of {TOP}, which varies too; drop one of them",
        ),
        (
            ["--vary", "reduced.drag=1,2", "--set", "reduced.drag=3"],
            "--set reduced.drag=3: is lost, as reduced.drag varies; drop one of them",
        ),
        (
            ["--vary", f"{TOP}=[1.0, 0.0],[2.0, 0.0]", "--set", f"{TOP}.0=3.0"],
            f"--set {TOP}.0=3.0: is lost, as {TOP} varies; drop one of them",
        ),
        (["--seeds", "2", "--set", f"{SEED}=3"], f"--set {SEED}=3: is lost, as {SEED} varies; drop one"),
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
        (["--seeds", "2", "--set", "arrangement=none"], "--seeds 2: needs [arrangement], which has a seed"),
        (
            ["--run", "--set", "time=none"],
            "--run: needs a section [time] with its end; add one, or drop it\n",
        ),
        (["--run", "--set", "time=none", "--set", "model=gluey"], "[time] with its end; add one\n"),
        (["--quantity", "viscosity"], "--quantity viscosity: no such number"),
        (["--quantity", "disc0001.position.x"], "disc0001.position.x: is of a run, not of an instant;"),
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


def test_keys_beside_each_other_and_sections_around_them_are_apart() -> None:
    require_apart(["time.end", "time.end_gap", "bodies.1.radius", "bodies.10.radius"], ["time={end=2.0}"])


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
