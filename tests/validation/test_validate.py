"""`fsi validate`: verdicts, exit codes, files; the same on several ranks."""

from __future__ import annotations

import csv
import json
import sys
from pathlib import Path

import numpy as np
import pytest

from fsi.case.load import load_case, parse_case
from fsi.errors import InputError
from fsi.integration.errors import ErrorEstimate
from fsi.observables.quantities import computed
from fsi.report.studies import summary
from fsi.validation.rows import Row, chosen_cases, exact_value, reference, swept
from tests.case_data import changed
from tests.cli.test_commands import ROOT, call, fsi
from tests.commands import fsi_command
from tests.ranks import needs_mpi, python_on

FOLDER = ROOT / "cases" / "validation"

QUICK = """
name = "concentric sphere"
geometry = "axisymmetric"
[fluid]
viscosity = 1.0
[domain]
shape = "round"
radius = 2.0
[[bodies]]
name = "ball"
radius = 1.0
position = [0.0, 0.0]
velocity = [0.0, 1.0]
[sweep]
key = "domain.radius"
values = [4.0, 2.0]
[[expected]]
quantity = "ball.force.z"
exact = "concentric_sphere"
rtol = 1e-5
source = "Cunningham 1910"
"""
EXACT = 'exact = "concentric_sphere"'
ROW = QUICK[QUICK.index("quantity") :]
WRONG = QUICK.replace('exact = "concentric_sphere"', "value = -137.6")  # 8e-4 off at R = 2


def row(value: float, error: float, digits: float = 1e-13, failure: str = "") -> Row:
    return Row("case", None, 0.1, "q", value, error, 0.0, 1.0, digits, 1e-3, "", "source", failure)


def folder_with(tmp_path: Path, **texts: str) -> Path:
    folder = tmp_path / "cases"
    folder.mkdir()
    for name, text in texts.items():
        (folder / f"{name}.toml").write_text(text)
    return folder


def test_all_verdicts_of_a_row() -> None:
    assert row(1.0 + 9e-4, 1e-3).passed
    assert not row(1.0 + 1.1e-3, 1e-3).passed
    assert not row(np.nan, np.nan, failure="it failed").passed
    assert row(1.0 + 9e-4, 1e-3).bar_holds is True
    assert row(1.0 + 9e-4, 8e-4).bar_holds is False  # too short
    assert row(1.0 + 9e-5, 1e-3).bar_holds is False  # too long
    assert row(1.0 + 1e-9, 1e-8, digits=1e-8).bar_holds is None


def test_the_summary_counts_only_known_errors() -> None:
    rows = [
        row(1.0009, 1e-3),
        row(1.0009, 1e-4),
        row(1.0, 1e-3, digits=1e-8),
        row(np.nan, np.nan, failure="no"),
    ]
    text = summary(rows)
    assert text.startswith("3 of 4 rows pass; 1 of 2 error bars (50 %)")
    assert text.endswith("1 more agree to all digits of the reference")


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.toml")), ids=lambda path: path.stem)
def test_the_shipped_cases_have_sound_references(path: Path) -> None:
    """Literal settling times are those of the exact functions; every reference is finite and not zero.

    It is known to 1e-6, or where a paper prints fewer digits, to a fifth of the tolerance.
    """
    for _, case in swept(path):
        for expected in case.expected:
            value, digits = reference(case, expected)
            assert np.isfinite(value)
            assert value != 0.0
            assert digits <= max(1e-6, 0.2 * expected.rtol)
            if path.stem == "settling_sphere":
                exact = exact_value(case, "sphere_settling", expected.quantity)
                assert value == pytest.approx(exact, rel=1e-12)


def test_a_sweep_may_be_one_of_whole_numbers(tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    path.write_text(
        QUICK.replace('"domain.radius"', '"discretisation.degree"').replace("[4.0, 2.0]", "[2, 3.0]")
    )
    assert [case.discretisation.degree for _, case in swept(path)] == [2, 3]


def test_values_are_those_of_their_own_kind() -> None:
    """Whatever a body is called: `velocity disc.force.y` is a force."""
    data = changed("bodies.0.name", "velocity disc")
    U, F = np.arange(6.0).reshape(2, 3), np.arange(10.0, 16.0).reshape(2, 3)
    results = ErrorEstimate(U, F, dissipation=7.0)
    quantities = {"velocity disc.force.y": -11.0, "velocity disc.velocity.y": 1.0, "other.torque": -15.0}
    for quantity, value in (quantities | {"dissipation": 7.0, "other.angular_velocity": 5.0}).items():
        assert computed(parse_case(data), results, quantity) == value


def test_a_settling_time_is_that_under_all_forces() -> None:
    """A weight as gravity is the same as one of the body's own."""
    case = load_case(FOLDER / "settling_disc.toml")
    own = case.motion(0.0).F[0, 1]
    data = case.model_dump(exclude_none=True)
    data["bodies"][0]["force"] = (0.0, 0.0)
    area = np.pi * case.bodies[0].radius ** 2
    data["forces"] = ({"kind": "gravity", "acceleration": (0.0, own / area), "density_difference": 1.0},)
    time = exact_value(case, "disc_settling", "time at gap 0.1")
    assert exact_value(parse_case(data), "disc_settling", "time at gap 0.1") == pytest.approx(time, rel=1e-12)


def test_names_are_those_of_files(tmp_path: Path) -> None:
    folder = folder_with(tmp_path, one=QUICK, two=QUICK)
    assert [path.stem for path in chosen_cases(folder, ["two"])] == ["two"]
    assert [path.stem for path in chosen_cases(folder, [])] == ["one", "two"]
    with pytest.raises(InputError, match="towo: no such validation case; the nearest is two"):
        chosen_cases(folder, ["towo"])
    with pytest.raises(InputError, match="no case files there; drop it"):
        chosen_cases(tmp_path / "nowhere", [])


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        (
            '"concentric_sphere"',
            '"concentric_spheer"',
            "no such exact result; the nearest is 'concentric_sphere'",
        ),
        ('exact = "concentric_sphere"', "", "needs either a value or the name of an exact result"),
        ("values = [4.0, 2.0]", "values = []", "sweep.values"),
        ('key = "domain.radius"', 'key = "domain.radios"', "unknown key; use domain.radius"),
        (
            'key = "domain.radius"\nvalues = [4.0, 2.0]',
            'key = "bodies.0.position.1"\nvalues = [0.0, 0.5]',
            "is for a body at the centre",
        ),
        ("[[expected]]", "[[expectid]]", "unknown key; use expected"),
        ("ball.force.z", "bell.force.z", "no such body; the nearest is 'ball'"),
        ("ball.force.z", "ball.torque", "a sphere on the axis does not turn"),
        ("ball.force.z", "ball.velocity.z", "gives a force, not ball.velocity.z"),
        (ROW, ROW.replace("force", "position").replace(EXACT, "value = 1.0"), "is given at time 0"),
        (
            'name = "concentric',
            'model = "reduced"\nname = "concentric',
            "only the resolved flow is validated",
        ),
        ("[sweep]", "[time]\nend = 1.0\n[sweep]", "validated by `time at gap ...` alone"),
    ],
)
def test_mistakes_in_a_validation_case(old: str, new: str, complaint: str, tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    path.write_text(QUICK.replace(old, new))
    with pytest.raises(InputError, match=complaint):
        list(swept(path))


@pytest.mark.parametrize("workers", [(), ("--workers", 1)])
@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ("[domain]", "[domains]", "domains = {"),
        ('source = "Cunningham 1910"', "", "expected.0.source: missing"),
        ("values = [4.0, 2.0]", "values = [4.0, 0.5]", "bodies.0.position = ["),
    ],
)
def test_a_bad_case_among_good_ones_is_named_and_nothing_is_written(
    old: str,
    new: str,
    complaint: str,
    workers: tuple[object, ...],
    tmp_path: Path,
    capfd: pytest.CaptureFixture[str],
) -> None:
    """The good one is first in the folder: nothing of it is solved either."""
    folder, output = folder_with(tmp_path, ball=QUICK, other=QUICK.replace(old, new)), tmp_path / "out"
    assert fsi_command("validate", "--cases", folder, "-o", output, *workers) == 2
    assert f"error: {folder / 'other.toml'}: {complaint}" in capfd.readouterr().err
    assert not output.exists()


def test_validate_writes_what_it_prints(tmp_path: Path) -> None:
    folder, output = folder_with(tmp_path, quick=QUICK), tmp_path / "out"
    done = fsi("validate", "--cases", str(folder), "-o", str(output))
    assert done.returncode == 0, done.stderr
    assert "2 of 2 rows pass; 2 of 2 error bars (100 %)" in " ".join(done.stdout.split())
    rows = json.loads((output / "validation.json").read_text())
    assert [row["sweep"] for row in rows] == [4.0, 2.0]
    assert all(row["passed"] and row["true_error"] < row["error_bar"] < 1e-5 for row in rows)
    with (output / "validation.csv").open(newline="") as file:
        assert [float(row["value"]) for row in csv.DictReader(file)] == [row["value"] for row in rows]
    assert (output / "validation.png").stat().st_size > 10_000
    again = fsi("validate", "--cases", str(folder), "-o", str(output))
    assert again.returncode == 2
    assert "exists and is not empty" in again.stderr


def test_a_wrong_reference_gives_exit_code_4_after_all_is_written(tmp_path: Path) -> None:
    folder, output = folder_with(tmp_path, wrong=WRONG), tmp_path / "out"
    done = fsi("validate", "wrong", "--cases", str(folder), "-o", str(output))
    assert done.returncode == 4
    assert "error: 2 of 2 rows fail, first wrong: ball.force.z = " in done.stderr
    assert len(json.loads((output / "validation.json").read_text())) == 2


@pytest.mark.slow
@pytest.mark.mpi
@needs_mpi
def test_two_ranks_give_the_same_verdicts(tmp_path: Path) -> None:
    """Numbers agree to rounding; an exit code of 4 is that of both."""
    folder = folder_with(tmp_path, quick=QUICK, wrong=WRONG)
    parts = ["-m", "fsi", "validate", "--cases", str(folder), "-o"]
    alone = call(sys.executable, *parts, str(tmp_path / "one"))
    both = call(*python_on(2), *parts, str(tmp_path / "two"))
    assert alone.returncode == both.returncode == 4
    assert both.stderr.count("error:") == 1
    one, two = (json.loads((tmp_path / name / "validation.json").read_text()) for name in ("one", "two"))
    assert [row["passed"] for row in one] == [row["passed"] for row in two] == [True, True, False, False]
    np.testing.assert_allclose([r["value"] for r in one], [r["value"] for r in two], rtol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", [path.stem for path in sorted(FOLDER.glob("*.toml")) if "fine" not in path.stem]
)
def test_the_shipped_cases_pass(name: str, tmp_path: Path) -> None:
    done = call(sys.executable, "-m", "fsi", "validate", name, "-o", str(tmp_path / "out"), timeout=600.0)
    assert done.returncode == 0, done.stderr
