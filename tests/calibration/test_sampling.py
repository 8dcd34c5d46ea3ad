"""Samples, exact instead of resolved: computed once, kept at once, and the law that comes of them."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

import fsi.calibration.calibrate
import fsi.calibration.sampling
from fsi.calibration.calibrate import calibrate_case, summary
from fsi.calibration.finding import pair_of
from fsi.calibration.pair import Pair, planned_gaps
from fsi.calibration.result import HeldOut, fit_law
from fsi.calibration.samples import Sample, Samples, as_arrays, keep_sample, read_sample
from fsi.calibration.sampling import Sampling, key_of, take_samples
from fsi.case.case import Case
from fsi.case.law_file import read_law_file
from fsi.case.load import load_case
from fsi.cli.plot import plot
from fsi.errors import InputError, SolveError
from fsi.lubrication import exact
from fsi.report.studies import lines

CASE = Path(__file__).parents[2] / "cases" / "calibration" / "disc_wall.toml"
SMALL = ("calibration.samples=8", "calibration.held_out=2", "calibration.range=[1e-3, 0.5]")


class ExactModel:
    """Stands for `resolved_sample`: the exact force, 1e-7 off, and what it was asked for."""

    def __init__(self) -> None:
        self.asked: list[float] = []
        self.fails: set[int] = set()

    def __call__(self, pair: Pair, gap: float, *, held_out: bool) -> Sample:
        self.asked.append(gap)
        if len(self.asked) in self.fails:
            raise SolveError("singular")
        kappa = float(exact.normal_resistance(gap, pair.reduced_radius, pair.case.fluid.viscosity))
        return Sample(gap, held_out, kappa * (1.0 + 1e-7), 1e-6 * kappa, 0.0, 1000, 1e-12, 0.1)


@pytest.fixture
def model(monkeypatch: pytest.MonkeyPatch) -> ExactModel:
    stand_in = ExactModel()
    monkeypatch.setattr(fsi.calibration.sampling, "resolved_sample", stand_in)
    return stand_in


def small_case(*changes: str) -> Case:
    return load_case(CASE, (*SMALL, *changes))


def silent(there: int, total: int) -> None:
    assert 0 <= there <= total


def test_the_gaps_are_the_range_and_middles() -> None:
    gaps = planned_gaps(pair_of(small_case()))
    taken = [gap for gap, held_out in gaps if not held_out]
    assert_allclose(taken, np.geomspace(1e-3, 0.5, 8))
    assert_allclose(
        [gap for gap, held_out in gaps if held_out],
        [(taken[0] * taken[1]) ** 0.5, (taken[6] * taken[7]) ** 0.5],
    )
    assert not any(held_out for _, held_out in planned_gaps(pair_of(small_case("calibration.held_out=0"))))


def test_no_sample_is_computed_twice(model: ExactModel, tmp_path: Path) -> None:
    """Neither in the same calibration nor in one that shares gaps with it."""
    first = take_samples(pair_of(small_case()), Sampling(tmp_path, 1, silent))
    assert len(model.asked) == len(first) == 10
    assert take_samples(pair_of(small_case()), Sampling(tmp_path, 1, silent)) == first
    assert len(model.asked) == 10
    take_samples(
        pair_of(small_case("calibration.held_out=3", "calibration.form=table", "name=other")),
        Sampling(tmp_path, 1, silent),
    )
    assert len(model.asked) == 11


CHANGES = ("fluid.viscosity=2", "calibration.mode=shear", "discretisation.degree=2", "domain.radius=99.0")


@pytest.mark.parametrize("change", CHANGES)
def test_what_changes_a_sample_changes_its_key(change: str) -> None:
    assert key_of(pair_of(small_case()), 0.1) != key_of(pair_of(small_case(change)), 0.1)


@pytest.mark.parametrize(
    "change", ["bodies.0.position=[0.0, 3.0]", "bodies.0.force=[0.0, 5.0]", "time={end = 1.0}"]
)
def test_what_does_not_change_a_sample_does_not(change: str) -> None:
    """0.5 and 0.25 are exact in binary, so that the body comes to the same place."""
    assert key_of(pair_of(small_case()), 0.25) == key_of(pair_of(small_case(change)), 0.25)


def test_other_code_is_another_sample(monkeypatch: pytest.MonkeyPatch) -> None:
    before = key_of(pair_of(small_case()), 0.1)
    monkeypatch.setattr(metadata, "version", lambda name: f"{name} 9")
    assert key_of(pair_of(small_case()), 0.1) != before


SOURCES = ("meshes/build.py", "stokes/solve.py", "stokes/cells.c", "stokes/cells.h", "calibration/pair.py")


@pytest.mark.parametrize("file", SOURCES)
def test_other_sources_are_another_sample(file: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Those of a linked folder too, as `meshes` of a checkout is one."""
    package = tmp_path / "fsi"
    (tmp_path / "meshes").mkdir()
    for room in ("stokes", "calibration"):
        (package / room).mkdir(parents=True)
    (package / "meshes").symlink_to(tmp_path / "meshes")
    monkeypatch.setattr(fsi.calibration.sampling, "_PACKAGE", package)
    for name in SOURCES:
        (package / name).write_text("one")
    before = key_of(pair_of(small_case()), 0.1)
    (package / file).write_text("two")
    assert key_of(pair_of(small_case()), 0.1) != before


def test_a_sample_that_was_held_out_may_make_a_law_later(tmp_path: Path) -> None:
    """The cache knows the resistance; whether it tests a law is the case's to say, each time."""
    keep_sample(tmp_path, "key", Sample(0.1, True, 5.0, 1e-3, 2e-4, 100, 1e-12, 0.1))
    again = read_sample(tmp_path, "key", 0.1, held_out=False)
    assert again is not None
    assert (again.held_out, again.kappa) == (False, 5.0)


def test_the_bar_of_a_sample_is_that_of_mesh_and_truncation() -> None:
    samples = [Sample(d, False, 1.0 / d, 1e-3, 2e-4, 100, 1e-12, 0.1) for d in (0.2, 0.1)]
    assert_allclose(as_arrays(samples, held_out=False).bars, [1.2e-3, 1.2e-3], rtol=1e-14)


def test_what_is_held_out_has_no_part_in_the_law(model: ExactModel, tmp_path: Path) -> None:  # noqa: ARG001
    """Held-out samples 10 % too large change no coefficient, and fail the law."""
    pair = pair_of(small_case())
    samples = take_samples(pair, Sampling(tmp_path, 1, silent))
    wrong = [replace(one, kappa=1.1 * one.kappa) if one.held_out else one for one in samples]
    law, other = (fit_law(pair, of, "disc.toml") for of in (samples, wrong))
    assert other.law.series == law.law.series
    assert law.test is not None
    assert law.test.passed
    assert other.test is not None
    assert not other.test.passed


@pytest.mark.usefixtures("model")
def test_what_is_held_out_tells_the_error_of_a_table(tmp_path: Path) -> None:
    """Held-out samples 10 % too large: the law is off by 1 - 1/1.1, but for its error between points."""
    pair = pair_of(small_case("calibration.form=table"))
    samples = take_samples(pair, Sampling(tmp_path, 1, silent))
    wrong = [replace(one, kappa=1.1 * one.kappa) if one.held_out else one for one in samples]
    right, other = (fit_law(pair, of, "disc.toml") for of in (samples, wrong))
    assert right.test is not None
    assert other.test is not None
    exact_at = exact.normal_resistance(right.test.samples.d, pair.reduced_radius, right.law.viscosity)
    between = np.abs(right.law.law().kappa(right.test.samples.d, pair.reduced_radius) / exact_at - 1.0).max()
    assert right.test.error == pytest.approx(between, abs=1e-6)
    assert other.test.error == pytest.approx(1.0 - 1.0 / 1.1, abs=2.0 * between)
    assert summary(other)["held_out_error"] == other.test.error
    assert other.test.passed is None
    assert "held_out_passed" not in summary(other)
    told = f"2 samples held out: law off by at most {other.test.error:.1e}, which is all that is known"
    assert any(line.startswith(told) for line in lines(other))


@pytest.mark.parametrize(("errors", "passes"), [(0.9, True), (1.1, False), (2.0, False)])
def test_a_law_passes_within_the_errors_that_are_stated(errors: float, passes: bool) -> None:
    """Band 3 and bars 1: their sum counts, on both sides."""
    samples = Samples(np.array([0.1, 0.2]), np.array([50.0, 20.0]), np.ones(2))
    for sign in (1.0, -1.0):
        law = samples.kappa + np.array([0.0, sign * errors * 4.0])
        assert HeldOut(samples, law, np.full(2, 3.0)).passed is passes


def test_a_sample_that_fails_costs_no_other(model: ExactModel, tmp_path: Path) -> None:
    model.fails = {3, 5}
    with pytest.raises(
        SolveError, match=r"2 of 10 samples failed, first at the gap .*: singular; the others"
    ):
        take_samples(pair_of(small_case()), Sampling(tmp_path, 1, silent))
    assert len(model.asked) == 10
    model.fails = set()
    assert len(take_samples(pair_of(small_case()), Sampling(tmp_path, 1, silent))) == 10
    assert len(model.asked) == 12


def interrupt(there: int, _: int) -> None:
    """Ctrl-C when four samples are there."""
    if there == 4:
        raise KeyboardInterrupt


def test_a_broken_off_calibration_goes_on(model: ExactModel, tmp_path: Path) -> None:
    """Ctrl-C between samples; what was there is not computed again."""
    with pytest.raises(KeyboardInterrupt):
        take_samples(pair_of(small_case()), Sampling(tmp_path, 1, interrupt))
    assert len(model.asked) == 4
    take_samples(pair_of(small_case()), Sampling(tmp_path, 1, silent))
    assert len(set(model.asked)) == len(model.asked) == 10


def test_a_broken_off_calibration_goes_on_in_its_own_folder(
    model: ExactModel, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Ctrl-C at a sample, with the samples in the folder of the law, and then between its files."""

    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    def calibrate(show: Callable[[int, int], None]) -> None:
        calibrate_case(small_case(), "disc.toml", out, Sampling(out / "samples", 1, show))

    out = tmp_path / "out"
    with pytest.raises(KeyboardInterrupt):
        calibrate(interrupt)
    assert [path.name for path in out.iterdir()] == ["samples"]
    with monkeypatch.context() as patch:
        patch.setattr(fsi.calibration.calibrate, "save_law", interrupted)
        with pytest.raises(KeyboardInterrupt):
            calibrate(silent)
    calibrate(silent)
    assert len(model.asked) == 10
    assert (out / "law.toml").exists()
    (out / "calibration.json").unlink()
    with pytest.raises(InputError, match="exists and is no calibration; give another folder"):
        calibrate(silent)  # law.toml and samples.csv may be someone's


def test_the_folder_of_a_law(model: ExactModel, tmp_path: Path) -> None:  # noqa: ARG001
    out = tmp_path / "out"
    case = small_case("fluid.viscosity=2.0", "bodies.0.radius=0.5")
    found = calibrate_case(case, "disc.toml", out, Sampling(tmp_path / "cache", 1, silent))
    assert {path.name for path in out.iterdir()} == {"law.toml", "samples.csv", "calibration.json"}
    plot([out], tmp_path / "law.svg")  # as the command does
    assert (tmp_path / "law.svg").read_bytes().startswith(b"<?xml")
    law = read_law_file(out / "law.toml").law()
    d = np.geomspace(1e-3, 0.5, 40)
    assert_allclose(law.kappa(d, 0.5), exact.normal_resistance(d, 0.5, 2.0), rtol=1e-4)
    data: dict[str, Any] = json.loads((out / "calibration.json").read_text())
    assert data["held_out_passed"] is True
    assert data["coefficients"][0]["inside"] is True
    assert abs(data["coefficients"][0]["difference"]) < 1e-4
    assert abs(data["exponent"] + 1.5) < 1e-4
    assert len(data["samples"]) == 10
    assert found.law.source["case"] == "disc.toml"
    calibrate_case(case, "disc.toml", out, Sampling(tmp_path / "cache", 1, silent))  # replaces its own folder


def test_a_series_that_rises_is_no_law() -> None:
    """Through stairs that fall; a case would refuse the file. A step up that was held out is said first."""
    pair, stairs = pair_of(small_case()), iter([10.0, 9.999, 9.998, 5.0, 4.999, 4.998, 1.0, 0.999])
    gaps = [gap for gap, held_out in planned_gaps(pair) if not held_out]
    samples = [Sample(gap, False, next(stairs), 1e-9, 0.0, 1000, 1e-12, 0.1) for gap in gaps]
    with pytest.raises(
        SolveError, match=r'series rises at s = 0\.00\d+; give .* calibration\.form = "table"'
    ):
        fit_law(pair, samples, "disc.toml")
    between = replace(samples[4], gap=(gaps[4] * gaps[5]) ** 0.5, held_out=True, kappa=4.9995)
    with pytest.raises(SolveError, match="sampled resistances do not decrease with the gap; end"):
        fit_law(pair, [*samples, between], "disc.toml")


def test_samples_of_meshes_made_again_are_told(model: ExactModel, tmp_path: Path) -> None:  # noqa: ARG001
    found = calibrate_case(small_case(), "disc.toml", tmp_path / "out", Sampling(tmp_path / "all", 1, silent))
    again = [replace(one, mesh_instead=k < 3) for k, one in enumerate(found.samples)]
    said = "the sizes of the case gave 3 samples no valid mesh; see mesh_instead in samples.csv"
    assert lines(replace(found, samples=again)) == [*lines(found), said]
    assert "mesh_instead" in (tmp_path / "out" / "samples.csv").read_text().splitlines()[0].split(",")


def test_a_table_is_an_alternative(model: ExactModel, tmp_path: Path) -> None:  # noqa: ARG001
    found = calibrate_case(
        small_case("calibration.form=table"),
        "disc.toml",
        tmp_path / "out",
        Sampling(tmp_path / "cache", 1, silent),
    )
    taken = [sample for sample in found.samples if not sample.held_out]
    law = read_law_file(tmp_path / "out" / "law.toml").law()
    assert_allclose(law.kappa([one.gap for one in taken], 1.0), [one.kappa for one in taken], rtol=1e-13)
    assert (found.fit, found.coefficients) == (None, [])


def test_a_folder_of_something_else_is_left_alone(model: ExactModel, tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(InputError, match="exists and is no calibration; give another folder"):
        calibrate_case(small_case(), "disc.toml", tmp_path, Sampling(tmp_path / "cache", 1, silent))
    assert model.asked == []
