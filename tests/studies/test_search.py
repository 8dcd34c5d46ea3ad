"""`fsi search`: values of keys for which a quantity has a given value."""

from __future__ import annotations

import json
import math
import runpy
from collections.abc import Callable
from itertools import islice
from pathlib import Path

import pytest

from fsi.case.load import load_case
from fsi.errors import InputError
from fsi.studies.evaluate import require_quantity
from fsi.studies.search import JUMPS, PARTS, KeyTrial, Search, trial_of
from tests.commands import fsi_command

ROOT = Path(__file__).parents[2]
CASES = ROOT / "cases"
ROWS = CASES / "slides" / "rows.toml"
QUANTITY = ["--quantity", "apparent viscosity"]
GIVEN = ["--quantity", "nope", "--target", "1", "--vary", "fluid.viscosity=1,2"]


def search(f: Callable[[float], float], low: float, high: float, target: float, tolerance: float) -> Search:
    return Search("key", low, high, target, tolerance, lambda x: KeyTrial(x, f(x)))


def test_a_root_is_closed_in_on() -> None:
    """x^3 = 0.3 at the cube root."""
    wanted = search(lambda x: x**3, 0.0, 1.0, 0.3, 1e-9)
    assert list(wanted.trying())[-1] == wanted.found()
    assert wanted.found().value == pytest.approx(0.3 ** (1.0 / 3.0), rel=1e-8)
    assert len(wanted.trials) < 15


@pytest.mark.parametrize(("target", "noted"), [("1.200", True), ("1.2", False)])
def test_an_error_bar_beyond_the_digits_is_noted(
    target: str, noted: bool, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """0.02 is 40 times half a unit of the last digit of 1.200, 0.4 times that of 1.2: not a word was said."""
    monkeypatch.setattr("fsi.cli.search._trial", lambda _, __, value, ___: KeyTrial(value, 1.2, 0.02))
    given = ["--quantity", "dissipation", "--target", target, "--vary", "fluid.viscosity=1.0,2.0", "--json"]
    assert fsi_command("search", CASES / "disc_in_box.toml", *given) == 0
    told = capfd.readouterr().err
    assert ("error bar 2e-02 is 40 times 0.0005, half a unit of the last digit" in told) == noted
    assert (told == "") != noted


def test_a_quantity_that_is_equal_at_both_ends_is_looked_at_between() -> None:
    """sin has 0.9 twice on (0, pi); at both ends, and in the middle of halves, it lies on one side."""
    wanted = search(math.sin, 0.0, math.pi, 0.9, 1e-6)
    list(wanted.trying())
    assert math.sin(wanted.found().value) == pytest.approx(0.9, abs=1e-6)


def test_whole_numbers_are_tried_one_by_one() -> None:
    wanted = search(lambda x: (7 * x) % 10, 1, 9, 6.0, 0.4)
    list(wanted.trying())
    assert (wanted.found().value, len(wanted.trials)) == (8, 8)


def test_the_last_whole_number_is_tried_too() -> None:
    found = search(lambda k: 2.0 * k, 1, 4, 8.0, 0.1)
    assert [trial.value for trial in found.trying()] == [1, 2, 3, 4]
    assert found.found().quantity == 8.0


def test_out_of_reach_is_refused_with_the_range() -> None:
    wanted = search(lambda x: 1.0 + x * x, -1.0, 2.0, 7.0, 1e-3)
    assert len(list(wanted.trying())) == PARTS + 1
    with pytest.raises(
        InputError, match=r"not reached for key from -1 to 2, .* goes from 1.* to 5 in 17 trials"
    ):
        wanted.found()


def test_a_jump_over_the_target_is_refused_by_its_place() -> None:
    """It jumps at 0.3 by 1 and at 0.7 by 1 - x/2 = 0.65; of both the smaller one is told.

    It was called out of reach from 0 to 1, with the advice to give a target between them.
    """
    wanted = search(lambda x: 1.0 - 0.5 * x if 0.3 < x < 0.7 else 0.0, 0.0, 1.0, 0.5, 0.1)
    list(wanted.trying())
    told = r"jumps over it, from 0\.65 to 0 at key = 0\.7, in \d+ trials; give a target outside of the jump"
    with pytest.raises(InputError, match=told):
        wanted.found()


def test_between_other_neighbours_than_those_at_a_jump() -> None:
    """-2 jumps to 1 at 0.3; from there on 1 - 4 (x - 0.3) has 0.5 at 0.425: the search ended at the jump."""
    wanted = search(lambda x: -2.0 if x < 0.3 else 1.0 - 4.0 * (x - 0.3), 0.0, 1.0, 0.5, 1e-6)
    list(wanted.trying())
    assert wanted.found().value == pytest.approx(0.425, abs=1e-6)


@pytest.mark.parametrize("scale", [1.0, 1e9])
def test_a_search_over_many_jumps_ends(scale: float) -> None:
    """Eleven of them; each costs some forty trials, and with 1 in 1e9 Brent's method ends by rounding."""
    wanted = search(lambda x: float(int(11.0 * (x - scale)) % 2), scale, scale + 1.0, 0.5, 0.1)
    list(islice(wanted.trying(), 100))
    with pytest.raises(InputError, match=r"jumps over it, from (0 to 1|1 to 0)"):
        wanted.found()
    assert len(wanted.trials) < PARTS + 1 + JUMPS * 50


def test_whole_numbers_that_pass_by_the_target() -> None:
    """3 k is nowhere in 10 +- 0.4; nearest is 9, of what goes from 3 to 12."""
    wanted = search(lambda k: 3.0 * k, 1, 4, 10.0, 0.4)
    list(wanted.trying())
    with pytest.raises(InputError, match=r"comes to 9 at key = 3 in 4 trials and no nearer; give fewer"):
        wanted.found()


def test_a_quantity_is_that_of_expected_rows() -> None:
    case = load_case(CASES / "pores" / "couette_N10.toml")
    trial = trial_of(case, 0.0, "disc 1.velocity.x")
    # couette_N10.json; ten modes err by 2.3e-6
    assert trial.quantity == pytest.approx(-0.0376208681, rel=1e-5)
    assert trial.error is not None
    for wrong in ("viscosity", "time at gap 0.1", "disc 1.position.x", "disc 99.velocity.x"):
        with pytest.raises(InputError, match=f"--quantity {wrong}: .*(give|nearest)"):
            require_quantity(case, wrong)


def test_from_the_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The case that it writes has the value, and not what is expected of the other; 6.54, with pores."""
    found = tmp_path / "found.toml"
    columns = [CASES / "slides" / "columns.toml", "--set", "model=pores", *QUANTITY, "--json", "-o", found]
    code = fsi_command("search", *columns, "--target", "6.54", "--vary", "arrangement.angle=93.0,96.0")
    assert code == 0
    data = json.loads(capsys.readouterr().out)
    assert data["quantity"] == pytest.approx(6.54, abs=5e-3)
    assert load_case(CASES / "slides" / "columns.toml").expected  # 6.32 at the angle that stands there
    assert load_case(found).expected == ()
    assert trial_of(load_case(found), 0.0, QUANTITY[1]).quantity == pytest.approx(data["quantity"], rel=1e-12)


@pytest.mark.parametrize(
    ("vary", "target", "words"),
    [
        ("arrangement.gap=0.02", "2", "--vary arrangement.gap=0.02: no key and interval"),
        ("arrangement.gap=0.3,0.02", "2", "LOW below HIGH"),
        ("arrangement.gap=0.02,0.1", "two", "--target two: not a number"),
        ("arrangement.gap=0.02,0.1", "1e400", "--target 1e400: too small or too large"),
        ("arrangement.gap=0.02,0.1", "0e400", "--target 0e400: too small or too large"),
        ("arrangement.gap=0.02,0.1", "-1.1e50", "--target -1.1e50: too small or too large"),
        ("arrangement.gap=0.02,0.1", "9e-51", "--target 9e-51: too small or too large"),
        ("arrangement.gap=0.02,0.1", "1e-400", "--target 1e-400: too small or too large"),
        ("pores.modes=0,3", "2", "one of 0, 1, 2, 4, 6, 8, 10, 12, 16, with nothing between; use `fsi sweep"),
        ("pores.modes=0,2", "nan", "--target nan: not a number"),  # each of these is one of the choices
        ("name.x=1.5,2.0", "2", "error: --vary name.x=1.5: name = "),
        ("arrangement.gape=0.02,0.1", "2", "arrangement.gape = 0.02: unknown key; use arrangement.gap "),
        ("arrangement.angle=60.0,90.0", "2", "arrangement.angle = 60.0: rows has no such option; drop it"),
    ],
)
def test_mistakes_are_one_line(vary: str, target: str, words: str, capfd: pytest.CaptureFixture[str]) -> None:
    code = fsi_command("search", ROWS, *QUANTITY, "--target", target, "--vary", vary)
    said = capfd.readouterr()
    assert (code, said.out) == (2, "")
    assert words in said.err
    assert said.err.count("\n") == 1


@pytest.mark.parametrize(
    ("quantity", "words"), [("nope", "no such number; give"), ("disc 9.torque", "there is no such body; the")]
)
def test_a_quantity_that_there_is_not_is_not_the_fault_of_the_key(
    quantity: str, words: str, capfd: pytest.CaptureFixture[str]
) -> None:
    """The line began with the key and its first value, which are right."""
    given = ["--quantity", quantity, "--target", "1", "--vary", "fluid.viscosity=1,2"]
    assert fsi_command("search", CASES / "disc_in_box.toml", *given) == 2
    assert capfd.readouterr().err.startswith(f"error: --quantity {quantity}: {words}")


def test_what_only_a_run_has_is_not_offered(capfd: pytest.CaptureFixture[str]) -> None:
    """The time at a gap and positions stood among what is taken, and were refused when they were given."""
    for command in (["--help"], [CASES / "disc_in_box.toml", *GIVEN]):
        fsi_command("search", *command)
        out, err = capfd.readouterr()
        told = " ".join(f"{out}{err}".replace("│", " ").split())
        assert '"BODY.force.x" (by the fluid; velocity; y), "BODY.torque", "BODY.angular_velocity"' in told
        assert "of a run" not in told


def test_a_change_of_the_key_that_is_sought_is_refused(capfd: pytest.CaptureFixture[str]) -> None:
    """It was undone without a word."""
    key, given = "arrangement.gap=0.02,0.1", ["--target", "2", "--set", "arrangement.gap=0.5"]
    assert fsi_command("search", ROWS, *QUANTITY, "--vary", key, *given) == 2
    told = "--set arrangement.gap=0.5: is lost, as arrangement.gap varies; drop one of them"
    assert told in capfd.readouterr().err


def test_the_four_viscosities_of_the_slides(tmp_path: Path) -> None:
    """By pores of four modes, to the digits of the slides; `tests/test_cases.py` has the resolved ones."""
    example = runpy.run_path(str(ROOT / "docs" / "examples" / "four_viscosities.py"))
    found = example["solutions"]("model=pores", "pores.modes=4")
    for name, solution in found.items():
        case = solution.case
        discs = sum(math.pi * body.radius**2 for body in case.bodies)
        assert discs / case.container().volume == pytest.approx(0.3351, rel=1e-12)
        assert solution.apparent_viscosity == pytest.approx(example["SLIDES"][name], abs=5e-3)
    example["draw"](found, tmp_path / "four.png")
    assert (tmp_path / "four.png").read_bytes().startswith(b"\x89PNG")
