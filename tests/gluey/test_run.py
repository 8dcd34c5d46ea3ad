"""Gluey and macroscopic cases in run folders: what is written, refused, and resumed bit by bit."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from fsi.evolutions import EvolvingCase, load_evolving, model_of, resume_evolving, run_evolving

import fsi
from fsi.case.load import load_case
from fsi.errors import InputError, SolveError
from fsi.gluey.limit_study import LimitCase
from fsi.integration.state import StepRecord
from tests.small_run import contents, rows

CASES = Path(__file__).parents[2] / "cases"
SMALL = {
    "gluey/two_discs.toml": ("time.end=3", "time.step=0.05", "output.interval=0.5"),
    "macroscopic/blocks.toml": ("time.end=2", "time.step=0.1", "output.interval=0.5", "parcels=20"),
}


def small(name: str) -> EvolvingCase:
    case = load_evolving(CASES / name, SMALL[name])
    assert not isinstance(case, LimitCase)
    return case


@pytest.mark.parametrize(
    ("name", "series"), [("gluey/two_discs.toml", "bodies"), ("macroscopic/blocks.toml", "profile")]
)
def test_a_run_can_be_opened(name: str, series: str, tmp_path: Path) -> None:
    """Tables and fields by `fsi.open_run`; what needs a fluid says that there is none."""
    run_evolving(small(name), tmp_path / "run", lambda _: None)
    run = fsi.open_run(tmp_path / "run")
    assert run.end == run.steps["t"].iloc[-1] == small(name).time.end
    assert run.mesh(series=series).n_points == (2 if series == "bodies" else 20)
    with pytest.raises(InputError, match="no fluid"):
        _ = run.case


class KilledError(Exception):
    """Where a run is broken off."""


@pytest.mark.parametrize(
    ("name", "at"),
    [("gluey/two_discs.toml", 13), ("gluey/two_discs.toml", 33), ("macroscopic/blocks.toml", 13)],
)
def test_a_resumed_run_is_the_unbroken_one(name: str, at: int, tmp_path: Path) -> None:
    """Broken off before contact, at t = 1.65 in contact, at t = 1.3."""

    def kill(record: StepRecord) -> None:
        if record.step == at:
            raise KilledError

    run_evolving(small(name), tmp_path / "whole", lambda _: None)
    with pytest.raises(KilledError):
        run_evolving(small(name), tmp_path / "broken", kill)
    resumed = load_evolving(tmp_path / "broken" / "case.toml")
    assert not isinstance(resumed, LimitCase)
    assert resume_evolving(resumed, tmp_path / "broken", lambda _: None).steps > 0
    assert contents(tmp_path / "broken") == contents(tmp_path / "whole")
    assert resume_evolving(resumed, tmp_path / "broken", lambda _: None).steps == 0


@pytest.mark.slow
def test_two_discs_part_when_the_pull_has_paid_back(tmp_path: Path) -> None:
    """They meet at t = 1, stay until t = 4, and are a gap (t - 4)^2 apart: first order in the step 0.01."""
    case = load_evolving(CASES / "gluey" / "two_discs.toml", ["output.interval=6", "output.fields=false"])
    assert not isinstance(case, LimitCase)
    run_evolving(case, tmp_path / "run", lambda _: None)
    table = rows(tmp_path / "run" / "steps.csv")
    stuck = [float(row["t"]) for row in table if float(row["smallest_gamma"]) < 0.0]
    assert abs(stuck[0] - 1.0) <= 0.02
    assert abs(stuck[-1] - 4.0) <= 0.02
    x = [float(row["x"]) for row in rows(tmp_path / "run" / "bodies.csv")[-2:]]
    assert x[1] - x[0] - 2.0 == pytest.approx(4.0, abs=0.1)
    assert sum(float(row["V_x"]) for row in rows(tmp_path / "run" / "bodies.csv")[-2:]) == pytest.approx(
        0, abs=1e-12
    )


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("contact.friction=0.3", "contact"),
        ("contact.gamma_min=1.0", "gamma_min"),
        ("bodies.0.position=[0.0, 0.0]", "overlap"),
        ("contact={variant='film',eps=0.1,reference_gap=0.1}", "touch"),
        ("bodies.0.position=[0.0, 0.0, 0.0]", "components"),
        ("bodies.0.raduis=1.0", "radius"),
        ("time.step=10", r"time\.step"),
        ("model='gluy'", "model"),
        ("bodies.1.name='left'", "given twice"),
        ("grids=[{name='left',counts=[2,2],lower=[9,9],spacing=3,radius=[1,1]}]", r"grids\.0\.name"),
        ("grids=[{name='g',counts=[0,2],lower=[9,9],spacing=3,radius=[1,1]}]", r"grids\.0\.counts"),
        ("grids=[{name='g',counts=[2,2],lower=[9,9],spacing=3,radius=[-1,1]}]", r"grids\.0\.radius"),
        ("grids=[{name='g',counts=[2,2],lower=[9,9],spacing=3,radius=[2,1]}]", r"grids\.0\.radius"),
        ("cell={lower=[-9,-9],upper=[9,9],periodic=['z']}", r"cell\.periodic"),
        ("cell={lower=[-9,-9],upper=[9,9],periodic=['x','x']}", r"cell\.periodic"),
    ],
)
def test_mistakes_are_one_line(change: str, message: str) -> None:
    touching = ["bodies.0.position=[-0.5, 0.0]"] if "film" in change else []
    with pytest.raises(InputError, match=message) as mistake:
        load_evolving(CASES / "gluey" / "two_discs.toml", [*touching, change])
    assert "\n" not in str(mistake.value)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("force='1/0'", "force"),
        ("force='9**9**9**9'", "force"),  # of whole numbers it would never end
        ("force='sin(x, m, t, 1)'", "force"),
        ("force='where(x, 1)'", "force"),
        ("blocks.0.velocity='1/(x-x)'", r"blocks\.0\.velocity"),
    ],
)
def test_formulas_without_a_value_are_refused(change: str, message: str, tmp_path: Path) -> None:
    def run() -> None:
        case = load_evolving(CASES / "macroscopic" / "blocks.toml", [change])
        assert not isinstance(case, LimitCase)
        run_evolving(case, tmp_path / "run", lambda _: None)

    with pytest.raises(InputError, match=message) as mistake:
        run()
    assert "\n" not in str(mistake.value)
    assert not (tmp_path / "run").exists()


def test_a_force_that_ceases_to_be_ends_the_run(tmp_path: Path) -> None:
    """At the middle of the second step of 0.1; the first is kept."""
    case = load_evolving(CASES / "macroscopic" / "blocks.toml", ["force='sqrt(0.12-t)'", "time.step=0.1"])
    assert not isinstance(case, LimitCase)
    with pytest.raises(SolveError, match="force"):
        run_evolving(case, tmp_path / "run", lambda _: None)
    assert len(rows(tmp_path / "run" / "steps.csv")) == 2


@pytest.mark.parametrize(
    ("name", "commands"),
    [
        ("gluey/two_discs.toml", ["render", "plot", "report"]),
        ("macroscopic/blocks.toml", ["plot", "report"]),
    ],
)
def test_commands_for_a_fluid_name_those_that_work(name: str, commands: list[str], tmp_path: Path) -> None:
    """Of the case `fsi run`; of the run those that draw it. The quick ones are called."""
    from typer.testing import CliRunner

    from fsi.cli.main import app

    with pytest.raises(InputError, match="use `fsi run`"):
        load_case(CASES / name)
    run_evolving(small(name), tmp_path / "run", lambda _: None)
    with pytest.raises(InputError, match="no fluid") as refused:
        _ = fsi.open_run(tmp_path / "run").case
    assert re.findall("`fsi ([a-z]+)`", str(refused.value)) == commands
    for command in commands if "render" not in commands else ["plot"]:
        assert CliRunner().invoke(app, [command, str(tmp_path / "run")]).exit_code == 0


def test_every_case_loads() -> None:
    for folder in ("gluey", "macroscopic"):
        for path in sorted((CASES / folder).glob("*.toml")):
            assert model_of(path) is not None
            load_evolving(path)


@pytest.mark.slow
def test_films_of_a_case_keep_gaps_and_tend_to_the_gluey_motion(tmp_path: Path) -> None:
    """Gaps are positive at eps > 0, and the discs end nearer to the gluey step's places as eps falls."""

    def distance(name: str, *contact: str) -> float:
        times = ["time.end=5", "time.step=0.02", "output.interval=5", "output.fields=false"]
        case = load_evolving(CASES / "gluey" / "two_discs.toml", [*times, *contact])
        assert not isinstance(case, LimitCase)
        run_evolving(case, tmp_path / name, lambda _: None)
        x = [float(row["x"]) for row in rows(tmp_path / name / "bodies.csv")[-2:]]
        return x[1] - x[0]

    errors, gluey = [], distance("gluey")
    for eps in ("1e-2", "1e-3", "1e-4"):
        film = ("contact.variant=film", f"contact.eps={eps}", "contact.reference_gap=0.1")
        errors.append(abs(distance(eps, *film) - gluey))
        assert min(float(row["smallest_gap"]) for row in rows(tmp_path / eps / "steps.csv")) > 0.0
    assert errors[0] > 2.0 * errors[1] > 4.0 * errors[2]


def test_a_case_says_where_films_are_thinner_than_the_roughness(tmp_path: Path) -> None:
    from typer.testing import CliRunner

    from fsi.cli.main import app

    rough = ["contact.eps=0.1", "contact.reference_gap=0.1", "contact.roughness=0.01", "time.end=2"]
    overrides = [part for text in rough for part in ("--set", text)]
    case = str(CASES / "gluey" / "two_discs.toml")
    said = CliRunner().invoke(app, ["run", case, "-o", str(tmp_path / "run"), *overrides]).output
    assert "delta_eps < delta" in said
