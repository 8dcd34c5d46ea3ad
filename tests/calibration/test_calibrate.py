"""`fsi calibrate` with resolved forces: a small one killed; slow, one on two ranks and all shipped."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from errno import ENOSPC
from math import pi, sqrt
from os import strerror
from pathlib import Path
from typing import Any, cast

import pytest
from numpy.testing import assert_allclose

from fsi.calibration import calibrate
from fsi.calibration.calibrate import calibrate_case
from fsi.calibration.sampling import Sampling
from fsi.case.law_file import read_law_file
from fsi.case.load import load_case
from fsi.errors import InputError
from fsi.lubrication.laws import LubricationLaw
from fsi.lubrication.named_laws import GapFilm, exact_law
from tests.cli.test_commands import ROOT, call, complaint
from tests.ranks import MPIEXEC, needs_mpi

CASES = ROOT / "cases" / "calibration"
SETTINGS = (
    "discretisation.cells_per_circle=16", "discretisation.growth=0.4",
    "calibration.samples=6", "calibration.held_out=1", "calibration.range=[2e-3, 0.2]",
)  # fmt: skip
SMALL = [part for setting in SETTINGS for part in ("--set", setting)]


def command(name: str, folder: Path, *more: str) -> list[str]:
    parts = ("-m", "fsi", "calibrate", str(CASES / f"{name}.toml"), "-o", str(folder / "out"))
    return [sys.executable, *parts, "--cache", str(folder / "cache"), *more]


def found(folder: Path) -> dict[str, Any]:
    return dict(json.loads((folder / "out" / "calibration.json").read_text()))


@pytest.mark.slow
def test_a_killed_calibration_goes_on_and_its_law_is_right(tmp_path: Path) -> None:
    """Unequal discs, so that the closed form for these, which nobody has published, is tested as well."""
    line = command("unequal_discs", tmp_path, *SMALL, "--workers", "2")
    first = subprocess.Popen(line, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    cache, deadline = tmp_path / "cache", time.monotonic() + 120.0
    while len(list(cache.glob("*.json"))) < 2 and time.monotonic() < deadline:
        time.sleep(0.05)
    first.send_signal(signal.SIGKILL)
    first.wait()
    time.sleep(1.0)  # its workers leave with it
    before = {path.name: path.stat().st_mtime_ns for path in cache.glob("*.json")}
    assert 2 <= len(before) < 7
    assert not (tmp_path / "out").exists()
    done = call(*line, timeout=900)
    assert done.returncode == 0, done.stderr
    after = {path.name: path.stat().st_mtime_ns for path in cache.glob("*.json")}
    assert len(after) == 7
    assert before.items() <= after.items()
    data = found(tmp_path)
    for row in data["samples"]:
        exact = float(exact_discs().kappa(row["gap"], data["reduced_radius"]))
        assert abs(row["kappa"] - exact) <= row["error"] <= 0.01 * exact
    leading = data["coefficients"][0]
    assert leading["theory"] == pytest.approx(3.0 * sqrt(2.0) * pi)
    assert leading["inside"]
    assert abs(leading["difference"]) < 5e-3
    assert data["held_out_passed"]
    assert (tmp_path / "out" / "calibration.png").stat().st_size > 10_000
    assert "s^-1.5" in done.stdout
    assert "inside" in done.stdout
    assert f"wrote {tmp_path}/out" in "".join(done.stdout.split("\n"))


def timeless(folder: Path) -> dict[str, bytes]:
    """The files of a calibration and its cache, without what they say of times and dates."""
    texts = {
        path.relative_to(folder).as_posix(): path.read_text()
        for path in folder.rglob("*")
        if path.is_file() and path.suffix != ".png"
    }
    data, rows = json.loads(texts["out/calibration.json"]), texts["out/samples.csv"].splitlines()
    assert "seconds" in rows[0].split(",")
    spent = [str(sample["seconds"]) for sample in data["samples"]]
    fitted = str(read_law_file(folder / "out" / "law.toml").source["fitted"])
    for name, text in texts.items():
        for time_or_date in (*spent, fitted):
            text = text.replace(time_or_date, "")
        texts[name] = text
    return {name: text.encode() for name, text in texts.items()}


@pytest.mark.slow
def test_two_calibrations_differ_in_times_and_dates_alone(tmp_path: Path) -> None:
    """To the last bit, with one worker and with two; a sum in another order would change digits."""
    coarse = ["discretisation.degree=2", "discretisation.cells_per_circle=12", "discretisation.growth=0.8"]
    sampled = ["calibration.samples=6", "calibration.held_out=1", "calibration.range=[2e-2, 0.2]"]
    case = load_case(CASES / "disc_wall.toml", [*coarse, *sampled])
    for workers in (1, 2):
        folder = tmp_path / str(workers)
        calibrate_case(case, "disc_wall.toml", folder / "out", Sampling(folder / "cache", workers))
    one, two = timeless(tmp_path / "1"), timeless(tmp_path / "2")
    assert len(one) == 3 + 7
    assert one == two


def exact_discs() -> LubricationLaw:
    return exact_law(GapFilm("discs", 1.0, 2.0))


@pytest.mark.slow
@pytest.mark.mpi
@needs_mpi
def test_two_ranks_work_on_one_sample_together(tmp_path: Path) -> None:
    coarse = [*SMALL, "--set", "discretisation.degree=2"]
    line = command("disc_wall_shear", tmp_path / "one", *coarse, "--workers", "1")
    (tmp_path / "one").mkdir()
    (tmp_path / "two").mkdir()
    done = call(*line, timeout=900)
    assert done.returncode == 0, done.stderr
    both = call(str(MPIEXEC), "-n", "2", *command("disc_wall_shear", tmp_path / "two", *coarse), timeout=900)
    assert both.returncode == 0, both.stderr
    assert both.stdout.count("wrote") == 1
    one, two = found(tmp_path / "one"), found(tmp_path / "two")
    forces = [[row["kappa"] for row in data["samples"]] for data in (one, two)]
    assert_allclose(forces[0], forces[1], rtol=1e-9)
    assert one["coefficients"][0]["theory"] == pytest.approx(2.0 * sqrt(2.0) * pi)
    assert abs(one["coefficients"][0]["difference"]) < 1e-2


def test_a_wrong_pair_is_one_line_and_nothing_is_written(tmp_path: Path) -> None:
    done = call(*command("disc_wall", tmp_path, "--set", 'calibration.pair=["disc", "plan"]'))
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert "calibration.pair = " in done.stderr
    assert list(tmp_path.iterdir()) == []


# c1 in units of mu a_r^n, of the table, and the power of the leading term.
LEADING = {
    "sphere_wall": (6.0 * pi, -1.0),
    "equal_spheres": (6.0 * pi, -1.0),  # (3/2) pi mu a^2/d with a_r = a/2
    "unequal_spheres": (6.0 * pi, -1.0),
    "disc_wall": (3.0 * sqrt(2.0) * pi, -1.5),
    "equal_discs": (3.0 * sqrt(2.0) * pi, -1.5),  # (3 pi/2) mu (a/d)^(3/2)
    "unequal_discs": (3.0 * sqrt(2.0) * pi, -1.5),
    "disc_wall_shear": (2.0 * sqrt(2.0) * pi, -0.5),
    "disc_wall_rotation": (2.0 * sqrt(2.0) * pi, -0.5),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", LEADING)
def test_the_shipped_calibrations_give_the_laws_of_theory(name: str, tmp_path: Path) -> None:
    """Measured differences of c1 are some 1e-6; c2 of a sphere and a plane is 0.3 % off."""
    done = call(*command(name, tmp_path), timeout=1000.0)
    assert done.returncode == 0, done.stderr
    data, (c1, power) = found(tmp_path), LEADING[name]
    assert data["coefficients"][0]["value"] == pytest.approx(c1, rel=1e-4)
    assert all(row["inside"] for row in data["coefficients"] if row["theory"] is not None)
    assert data["exponent"] == pytest.approx(power, abs=1e-3)
    assert data["held_out_passed"]
    if name == "sphere_wall":
        assert data["coefficients"][1]["value"] == pytest.approx(1.2 * pi, rel=0.01)
    law = read_law_file(tmp_path / "out" / "law.toml").law()
    a = data["reduced_radius"]
    assert_allclose(law.kappa(data["range"][0] * a, a), data["samples"][0]["kappa"], rtol=1e-5)


def test_a_disk_that_takes_no_more_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError(ENOSPC, strerror(ENOSPC))

    monkeypatch.setattr(calibrate, "summary", lambda _: {})
    monkeypatch.setattr(calibrate, "replace", full)
    with pytest.raises(InputError, match=r"^output = .*out: No space left on device; make room, or"):
        calibrate.write_calibration(tmp_path / "out", cast(Any, None))


@pytest.mark.parametrize("option", ["--output", "--cache"])
def test_a_folder_that_cannot_be_written_is_refused_before_the_first_sample(
    option: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """/proc takes no files, even from root."""
    case = str(Path(__file__).parents[2] / "cases" / "calibration" / "disc_wall.toml")
    told = complaint(capsys, monkeypatch, "calibrate", case, "--output", "nowhere", option, "/proc/law")
    assert "/proc/law" in told
    assert "can be written" in told
