"""Rows of a validation and of a comparison by hand: errors, bars, digits, and what is good below a gap."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fsi.case.case import Case
from fsi.case.load import load_case, parse_case
from fsi.case.sections import Expected
from fsi.comparison.motion import RateComparison, Trajectories
from fsi.errors import InputError
from fsi.validation import resolved
from fsi.validation.rows import Row, reference, write_rows

CASES = Path(__file__).parents[2] / "cases"
ROW = Row("case", None, 0.1, "ball.force.z", 202.0, 0.01, 0.005, 200.0, 1e-6, 0.02, "", "a source")


def test_errors_are_relative_and_a_bar_has_two_parts() -> None:
    """202 for 200: 1 % off, with bars of 1 % of the mesh and 0.5 % of the container."""
    assert ROW.true_error == pytest.approx(0.01)
    assert ROW.error_bar == pytest.approx(0.015)
    assert ROW.passed
    assert not replace(ROW, rtol=0.009).passed
    assert not replace(ROW, value=float("nan")).passed
    assert replace(ROW, reference=0.0, value=1e-3, scale=0.5).true_error == 2e-3


@pytest.mark.parametrize(
    ("mesh", "truncation", "holds"),
    [(0.004, 0.005, False), (0.006, 0.005, True), (0.098, 0.0, True), (0.102, 0.0, False)],
)
def test_a_bar_holds_between_the_true_error_and_ten_times_it(
    mesh: float, truncation: float, holds: bool
) -> None:
    assert replace(ROW, mesh_error=mesh, truncation=truncation).bar_holds is holds
    assert replace(ROW, digits=0.02).bar_holds is None  # not known so well


@pytest.mark.parametrize(
    ("value", "digits"), [(1.25, 0.005 / 1.25), (466.11048, 5e-6 / 466.11048), (-2.0, 0.025)]
)
def test_a_reference_is_known_to_half_a_unit_of_its_last_digit(value: float, digits: float) -> None:
    row = Expected(quantity="dissipation", value=value, rtol=1e-3, source="by hand")
    case = load_case(CASES / "disc_in_box.toml")
    assert reference(case, row) == pytest.approx((value, digits), rel=1e-12)


@pytest.mark.parametrize("inertia", [[], ["bodies.0.mass=1.0", "bodies.0.moment_of_inertia=0.5"]])
def test_the_second_run_has_steps_half_as_long_again(
    inertia: list[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """What steps are chosen by goes with their third power, with and without mass: 1.5^3 times the tolerance.

    With mass the motion is of order 2, and 1.5^2 times the tolerance made steps 1.31 times as long.
    """
    case = load_case(
        CASES / "settling_disc.toml", ["time.tolerance=1e-3", "time.gap_loss=0.2", "expected=[]", *inertia]
    )
    asked: list[Any] = []

    def running(case: Case, _: Path) -> Any:
        asked.append(case.timing)
        return np.zeros(1), np.ones(1), np.zeros(1)

    monkeypatch.setattr(resolved, "_run", running)
    monkeypatch.setattr(resolved, "halved", lambda _: None)
    assert resolved._history(case, tmp_path) == []
    assert [time.tolerance for time in asked] == pytest.approx([1e-3, 3.375e-3])
    assert [time.gap_loss for time in asked] == pytest.approx([0.2, 0.3])


def test_a_channel_is_validated_by_the_gradient_of_its_flux(tmp_path: Path) -> None:
    """Plane Poiseuille flow, Q = -G H^3 / 12 mu; the flux, another number of the same flow, is 1.7."""
    mu, height, flux = 3.0, 5.0, 1.7
    domain = {"lower": [0.0, 0.0], "upper": [4.0, height], "periodic": ["x"], "net_flux": flux}
    row = {"quantity": "pressure gradient", "value": -12.0 * mu * flux / height**3}
    case = parse_case(
        {
            "name": "a channel", "fluid": {"viscosity": mu}, "domain": domain, "bodies": [],
            "discretisation": {"degree": 2, "cells_per_circle": 6, "growth": 1.0},
            "expected": [row | {"rtol": 1e-9, "source": "plane Poiseuille flow"}],
        }
    )  # fmt: skip
    (found,) = resolved.rows_at("channel", None, case, tmp_path)
    assert found.passed
    assert 0.0 < found.mesh_error < 1e-8
    assert found.truncation == 0.0


def compared(gaps: Any, errors: Any) -> RateComparison:
    """Samples with those gaps whose rates, 2, are off by those parts."""
    rate = np.full(len(gaps), 2.0)
    nothing = np.zeros((1, 1))
    return RateComparison(
        np.zeros(1), nothing, nothing, nothing[None], nothing[None], np.array(gaps), rate,
        rate * (1.0 + np.array(errors)),
    )  # fmt: skip


def test_a_model_is_good_below_a_gap_if_nine_tenths_of_the_samples_are() -> None:
    """Ten good samples, then one bad, then a good one, then bad ones: 11 of 12 are more than 9 of 10."""
    gaps = np.arange(1.0, 16.0)
    errors = [0.05] * 10 + [0.5, -0.05] + [0.5] * 3
    assert compared(gaps, errors).good_below(0.1) == 12.0
    assert compared(gaps, errors).good_below(0.01) is None
    assert compared([1.0, 2.0], [0.5, 0.05]).good_below(0.1) is None  # half are


def test_levels_differ_from_the_first() -> None:
    gap = {name: np.array([[1.0, 2.0], [a, 2.0]]) for name, a in (("one", 1.0), ("two", 1.5), ("three", 4.0))}
    assert Trajectories(np.array([0.0, 1.0]), gap).differences == {"one": 0.0, "two": 0.5, "three": 3.0}


def test_files_of_rows_appear_whole(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """On a full disk those that were there before stay."""
    write_rows([ROW], tmp_path)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    assert set(before) == {"validation.json", "validation.csv"}
    header, line = before["validation.csv"].decode().splitlines()
    assert header.split(",")[:4] == ["case", "sweep", "gap", "quantity"]
    assert line.split(",")[:4] == ["case", "", "0.1", "ball.force.z"]

    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(InputError, match=r"validation\.json: No space left on device"):
        write_rows([replace(ROW, value=1.0)], tmp_path)
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before
