"""What `fsi solve` prints of pores."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.commands import fsi_command
from tests.pore_cases import PULLED, case_of


def test_solve_prints_bodies_necks_and_that_the_viscosity_is_an_upper_bound(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "case.toml"
    file.write_text(case_of(time=None).as_toml())
    assert fsi_command("solve", file) == 0
    text = capsys.readouterr().out
    assert "an upper bound" in text
    assert "necks that dissipate most" in text
    assert fsi_command("solve", file, "--json") == 0
    data = json.loads(capsys.readouterr().out)
    assert data["upper_bound"] is True
    assert data["apparent_viscosity_error"] > 0.0
    assert data["necks"][0]["dissipation"] == max(neck["dissipation"] for neck in data["necks"])
    assert data["pores"]["modes"] == 1
    assert [body["name"] for body in data["bodies"]] == ["one", "other"]


def test_loaded_bodies_have_no_upper_bound(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "case.toml"
    file.write_text(case_of(time=None, bodies=PULLED).as_toml())
    assert fsi_command("solve", file, "--json") == 0
    assert json.loads(capsys.readouterr().out)["upper_bound"] is False


def no_number(word: str) -> float:
    """JSON has neither NaN nor Infinity."""
    raise AssertionError(word)


def test_checks_that_do_not_apply_are_left_out(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Bodies with loads have no viscosity that three ways agree on; the resolved flow leaves it out, too."""
    file = tmp_path / "case.toml"
    for bodies, applies in ((PULLED, False), (case_of().as_data()["bodies"], True)):
        file.write_text(case_of(time=None, bodies=bodies).as_toml())
        assert fsi_command("solve", file, "--json") == 0
        checks = json.loads(capsys.readouterr().out, parse_constant=no_number)["checks"]
        assert {"stress", "viscosity_bound"} <= checks.keys() if applies else "stress" not in checks
        assert checks.keys() >= {"residual", "power", "momentum"}
        assert fsi_command("solve", file) == 0
        table = capsys.readouterr().out
        assert "nan" not in table
        assert ("viscosity_bound" in table) == applies


@pytest.mark.parametrize(("most", "there"), [(2, True), (1, False)])
def test_the_viscosity_of_a_few_bodies_is_bounded_from_below(
    most: int,
    there: bool,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of so many that it would take longer than all else it is left out."""
    monkeypatch.setattr("fsi.pores.instant.FEW", most)
    file = tmp_path / "case.toml"
    file.write_text(case_of(time=None).as_toml())
    assert fsi_command("solve", file) == 0
    assert ("an upper bound; at least" in capsys.readouterr().out) == there
    assert fsi_command("solve", file, "--json") == 0
    data = json.loads(capsys.readouterr().out)
    assert (data["lower_bound"] is not None) == there
    assert not there or data["lower_bound"] < data["apparent_viscosity"]
