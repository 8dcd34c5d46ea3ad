"""Gluey and macroscopic cases in run folders: what is written, refused, and resumed bit by bit."""

from __future__ import annotations

from pathlib import Path

import pytest

import fsi
from fsi.case.case import Case
from fsi.case.load import load_case
from fsi.cli.run import notes
from fsi.errors import InputError, SolveError
from fsi.models import make_evolution
from fsi.runs import resume
from fsi.runs import run as run_case
from tests.commands import fsi_command
from tests.small_run import break_off, contents, rows

CASES = Path(__file__).parents[2] / "cases"
ROUGH = "{eps=0.1, reference_gap=0.1, roughness=0.01}"
SMALL = {
    "gluey/two_discs.toml": ("time.end=3", "time.step=0.05", "output.interval=0.5"),
    "macroscopic/blocks.toml": (
        "time.end=2",
        "time.step=0.1",
        "output.interval=0.5",
        "macroscopic.parcels=20",
    ),
}


def small(name: str) -> Case:
    return load_case(CASES / name, SMALL[name])


@pytest.mark.parametrize(
    ("name", "series"), [("gluey/two_discs.toml", "bodies"), ("macroscopic/blocks.toml", "profile")]
)
def test_a_run_can_be_opened(name: str, series: str, tmp_path: Path) -> None:
    """Tables and fields by `fsi.open_run`; what needs a fluid says that there is none."""
    run_case(small(name), tmp_path / "run")
    run = fsi.open_run(tmp_path / "run")
    assert run.end == run.steps["t"].iloc[-1] == small(name).timing.end
    assert run.mesh(series=series).n_points == (2 if series == "bodies" else 20)
    assert run.case == small(name)


@pytest.mark.parametrize("command", ["check", "run"])
def test_a_case_without_time_is_for_nothing(command: str, capfd: pytest.CaptureFixture[str]) -> None:
    """A check called it an instant, and a run led to `fsi solve`, which led back."""
    assert fsi_command(command, CASES / "gluey" / "two_discs.toml", "--set", "time=none") == 2
    assert capfd.readouterr().err == "error: time: missing; add a section [time] with its end\n"


@pytest.mark.parametrize(
    ("name", "at"),
    [("gluey/two_discs.toml", 13), ("gluey/two_discs.toml", 33), ("macroscopic/blocks.toml", 13)],
)
def test_a_resumed_run_is_the_unbroken_one(name: str, at: int, tmp_path: Path) -> None:
    """Broken off before contact, at t = 1.65 in contact, at t = 1.3."""
    run_case(small(name), tmp_path / "whole")
    break_off(tmp_path / "broken", small(name), at, make_evolution)
    assert resume(tmp_path / "broken").steps > 0
    assert contents(tmp_path / "broken") == contents(tmp_path / "whole")
    assert resume(tmp_path / "broken").steps == 0


@pytest.mark.slow
def test_two_discs_part_when_the_pull_has_paid_back(tmp_path: Path) -> None:
    """They meet at t = 1, stay until t = 4, and are a gap (t - 4)^2 apart: first order in the step 0.01."""
    case = load_case(CASES / "gluey" / "two_discs.toml", ["output.interval=6", "output.fields=false"])
    run_case(case, tmp_path / "run")
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
        (
            "gluey.friction=0.3",
            r"^gluey\.friction = 0\.3: there is no solid contact; give gamma_min or the roughness$",
        ),
        (
            "gluey={variant='film',eps=0.1,reference_gap=0.1,roughness=0.01}",
            r'^gluey\.roughness = 0\.01: variant = "film" has none; drop it, or give another variant$',
        ),
        ("gluey.eps=0.1", r"^gluey\.eps = 0\.1: .* give reference_gap and roughness, or drop it$"),
        ("gluey={eps=0.1,reference_gap=0.1,roughness=0.1}", r"^gluey\.roughness = 0\.1: is not below"),
        ("gluey={gamma_min=0.0,eps=0.1}", r"^gluey\.gamma_min = 0\.0: .* drop it, or those$"),
        ("gluey={variant='film',eps=0.1}", r'^gluey\.variant = "film": .* give both$'),
        ("gluey.gamma_min=1.0", r"gluey\.gamma_min"),
        ("bodies.0.position=[0.0, 0.0]", "overlap"),
        ("gluey={variant='film',eps=0.1,reference_gap=0.1}", "touch"),
        ("bodies.0.position=[0.0, 0.0, 0.0]", "components"),
        ("bodies.0.raduis=1.0", "radius"),
        ("time.step=10", r"time\.step"),
        ("time.scheme='distance'", r"time\.scheme = \"distance\": model = \"gluey\" has a scheme of its own"),
        ("model='gluy'", "model"),
        ("bodies.1.name='left'", "has the same name"),
        ("grids=[{name='g',counts=[0,2],lower=[9,9],spacing=3,radius=[1,1]}]", r"grids\.0\.counts"),
        ("grids=[{name='g',counts=[2,2],lower=[9,9],spacing=3,radius=[-1,1]}]", r"grids\.0\.radius"),
        ("grids=[{name='g',counts=[2,2],lower=[9,9],spacing=3,radius=[2,1]}]", r"grids\.0\.radius"),
        (
            "grids=[{name='g',counts=[2,2],lower=[9,9],spacing=1.9,radius=[1,1]}]",
            r"^grids\.0\.spacing = 1\.9: neighbours overlap by 0\.1; widen it",
        ),
        ("grids=[{name='g',counts=[2,2],lower=[9,9,9],spacing=3,radius=[1,1]}]", r"grids\.0\.lower"),
        ("gluey.walls=[{name='w',point=[0,-9],normal=[0,0]}]", r"gluey\.walls\.0\.normal"),
        ("gluey.walls=[{name='left',point=[0,-9],normal=[0,1]}]", r"gluey\.walls\.0\.name"),
        ("gluey.walls=[{name='w',point=[0,-0.5],normal=[0,1]}]", "left and wall w overlap by 0.5"),
        ("domain={lower=[-9,-9],upper=[9,9],periodic=['z']}", r"domain\.periodic"),
        ("domain={shape='cell',vectors=[[9,0],[0,9]],shear=1.0}", "no fluid drives gluey bodies"),
        ("domain={shape='cell',vectors=[[9,0],[5,9]]}", "periods along the axes"),
        ("domain={shape='cell',vectors=[[7,0],[0,9]]}", "below four diameters"),
        ("domain={shape='half-plane',radius=50,walls={plane=[1.0,0.0]}}", r"domain\.walls\.plane.*at rest"),
        ("bodies.0.initial_velocity=[1.0,0.0,0.0]", r"bodies\.0\.initial_velocity"),
        ("domain={shape='round',radius=50}", r'domain\.shape = "round": .* give "box", "half-plane" or'),
        ("output.error_estimates=true", r"output\.error_estimates = true: .* has no mesh .*; drop it"),
        (
            "forces=[{kind='attraction',law='power',strength=1,length=1,exponent=2,cutoff=5}]",
            r'forces\.0\.law = "power": is infinite between bodies that touch; give "exponential"',
        ),
    ],
)
def test_mistakes_are_one_line(change: str, message: str) -> None:
    touching = ["bodies.0.position=[-0.5, 0.0]"] if "film" in change else []
    with pytest.raises(InputError, match=message) as mistake:
        load_case(CASES / "gluey" / "two_discs.toml", [*touching, change])
    assert "\n" not in str(mistake.value)


@pytest.mark.parametrize("wall", ["bottom", "slope"])
def test_no_body_is_called_as_tables_of_contacts_call_a_wall(wall: str) -> None:
    """Rows of both were one contact: what body and wall stored was mixed up."""
    walls = "gluey.walls=[{name='slope',point=[0,-9],normal=[0,1]}]"
    changes = ["domain={lower=[-50,-50],upper=[50,50]}", walls, "bodies.0.name='wall'"]
    refusal = rf'^bodies\.1\.name = "wall {wall}": contacts\.csv calls a wall so; give another one$'
    with pytest.raises(InputError, match=refusal):
        load_case(CASES / "gluey" / "two_discs.toml", [*changes, f"bodies.1.name='wall {wall}'"])
    assert load_case(CASES / "gluey" / "two_discs.toml", [*changes, "bodies.1.name='b'"]).names[0] == "wall"


def test_neighbours_of_a_grid_may_touch() -> None:
    grid = "grids=[{name='g',counts=[2,2],lower=[9,9],spacing=2,radius=[1,1]}]"
    assert len(load_case(CASES / "gluey" / "two_discs.toml", [grid]).bodies) == 6


def test_many_overlaps_are_told_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of n bodies in one heap, n^2/2 pairs, the names were put together for each pair: 31 s for 1000."""
    asked = []

    def names(case: Case) -> tuple[str, ...]:
        asked.append(case)
        return tuple(body.name for body in case.bodies)

    monkeypatch.setattr(Case, "names", property(names))
    bodies = ",".join(f"{{name='b{k}',radius=1,position=[{k / 100},0]}}" for k in range(40))
    with pytest.raises(InputError, match=r"b0 and b1 overlap by 1\.99; move them apart"):
        load_case(CASES / "gluey" / "two_discs.toml", [f"bodies=[{bodies}]"])
    assert len(asked) < 40  # 1560 for 780 pairs


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("macroscopic.force_per_mass='1/0'", r"macroscopic\.force_per_mass"),
        # of whole numbers it would never end
        ("macroscopic.force_per_mass='9**9**9**9'", r"macroscopic\.force_per_mass"),
        ("macroscopic.force_per_mass='sin(x, m, t, 1)'", r"macroscopic\.force_per_mass"),
        ("macroscopic.force_per_mass='where(x, 1)'", r"macroscopic\.force_per_mass"),
        ("macroscopic.blocks.0.initial_velocity='1/(x-x)'", r"macroscopic\.blocks\.0\.initial_velocity"),
    ],
)
def test_formulas_without_a_value_are_refused(change: str, message: str, tmp_path: Path) -> None:
    def run() -> None:
        case = load_case(CASES / "macroscopic" / "blocks.toml", [change])
        run_case(case, tmp_path / "run")

    with pytest.raises(InputError, match=message) as mistake:
        run()
    assert "\n" not in str(mistake.value)
    assert not (tmp_path / "run").exists()


def test_a_force_that_ceases_to_be_ends_the_run(tmp_path: Path) -> None:
    """At the middle of the second step of 0.1; the first is kept."""
    force = "macroscopic.force_per_mass='sqrt(0.12-t)'"
    case = load_case(CASES / "macroscopic" / "blocks.toml", [force, "time.step=0.1"])
    with pytest.raises(SolveError, match="force"):
        run_case(case, tmp_path / "run")
    assert len(rows(tmp_path / "run" / "steps.csv")) == 2


@pytest.mark.parametrize("name", SMALL)
def test_commands_that_draw_take_every_run(name: str, tmp_path: Path) -> None:
    from typer.testing import CliRunner

    from fsi.cli.main import app

    steps = (*SMALL[name], "time.end=0.4", "time.step=0.1", "output.interval=0.1")  # each a frame of the film
    run_case(load_case(CASES / name, steps), tmp_path / "run")
    for command in ("plot", "report"):
        assert CliRunner().invoke(app, [command, str(tmp_path / "run")]).exit_code == 0


@pytest.mark.parametrize(
    ("text", "remedy"),
    [
        ('model = "limit"', "is now `fsi limit` of a case of one gluey body"),
        ('model = "gluey"\n[contact]\nfriction = 0.1', r"contact = .*: an old key; use \[gluey\]"),
        ('model = "gluey"\n[cell]\nlower = [0.0, 0.0]', r"cell = .*: an old key; use \[domain\]"),
        ('model = "gluey"\ngravity = [0.0, -1.0]', r"gravity = .*: an old key; use \[\[forces\]\]"),
        ('model = "gluey"', "domain: missing"),
        ('model = "macroscopic"\nparcels = 4', "parcels = 4: an old key; use macroscopic.parcels"),
        ('[reduced]\nscheme = "distance"', 'reduced.scheme = "distance": an old key; use time.scheme'),
        ("[reduced]\nstep = 0.1", "reduced.step = 0.1: an old key; use time.step"),
    ],
)
def test_old_keys_name_the_new_ones(text: str, remedy: str, tmp_path: Path) -> None:
    path = tmp_path / "old.toml"
    path.write_text(f'name = "old"\n{text}\n')
    with pytest.raises(InputError, match=remedy):
        load_case(path)


@pytest.mark.slow
def test_films_of_a_case_keep_gaps_and_tend_to_the_gluey_motion(tmp_path: Path) -> None:
    """Gaps are positive at eps > 0, and the discs end nearer to the gluey step's places as eps falls."""

    def distance(name: str, *contact: str) -> float:
        times = ["time.end=5", "time.step=0.02", "output.interval=5", "output.fields=false"]
        case = load_case(CASES / "gluey" / "two_discs.toml", [*times, *contact])
        run_case(case, tmp_path / name)
        x = [float(row["x"]) for row in rows(tmp_path / name / "bodies.csv")[-2:]]
        return x[1] - x[0]

    errors, gluey = [], distance("gluey")
    for eps in ("1e-2", "1e-3", "1e-4"):
        film = ("gluey.variant=film", f"gluey.eps={eps}", "gluey.reference_gap=0.1")
        errors.append(abs(distance(eps, *film) - gluey))
        assert min(float(row["smallest_gap"]) for row in rows(tmp_path / eps / "steps.csv")) > 0.0
    assert errors[0] > 2.0 * errors[1] > 4.0 * errors[2]


def test_a_case_says_where_films_are_thinner_than_the_roughness(tmp_path: Path) -> None:
    from typer.testing import CliRunner

    from fsi.cli.main import app

    rough = [f"gluey={ROUGH}", "time.end=2"]
    overrides = [part for text in rough for part in ("--set", text)]
    case = str(CASES / "gluey" / "two_discs.toml")
    said = CliRunner().invoke(app, ["run", case, "-o", str(tmp_path / "run"), *overrides]).output
    first = next(row["t"] for row in rows(tmp_path / "run" / "steps.csv") if row["solid_contacts"] != "0")
    assert f"note: from t = {float(first):g} films are thinner" in said
    assert "delta_eps < delta" in said
    later = CliRunner().invoke(app, ["resume", str(tmp_path / "run"), "--set", "time.end=2.1"]).output
    assert f"note: from t = {float(first):g} films are thinner" in later  # of the run, not of its last part


@pytest.mark.parametrize(("law", "said"), [("{gamma_min=-0.1}", 0), (ROUGH, 1)])
def test_only_a_roughness_is_compared_with_films(law: str, said: int) -> None:
    """Contact that is solid at gamma_min is as was asked for."""
    case = load_case(CASES / "gluey" / "two_discs.toml", [f"gluey={law}"])
    assert len(list(notes(case, [{"t": 0.5, "solid_contacts": 1.0}]))) == said


def test_gaps_in_contact_are_zero_and_wide_ones_are_known(tmp_path: Path) -> None:
    """Discs 8 apart, four diameters, that meet at speed 2 each, are pushed together and stay.

    Their places in contact round to gaps of 1e-16 and below zero.
    """
    changes = ["time.end=4", "time.step=0.03", "output.interval=0.3"]
    changes += ["bodies.0.position=[-5.0,0.1]", "bodies.1.position=[5.0,-0.2]"]
    changes += ["bodies.0.initial_velocity=[2.0,0.0]", "bodies.1.initial_velocity=[-2.0,0.0]"]
    changes += ["bodies.0.force=[1.0,0.0]", "bodies.1.force=[-1.0,0.0]"]
    run_case(load_case(CASES / "gluey" / "two_discs.toml", changes), tmp_path / "run")
    steps = rows(tmp_path / "run" / "steps.csv")
    gap = [float(row["smallest_gap"]) for row in steps]
    assert gap[0] == pytest.approx((10.0**2 + 0.3**2) ** 0.5 - 2.0, rel=1e-14)
    assert gap[10] == pytest.approx(((10.0 - 2 * (0.6 + 0.045)) ** 2 + 0.3**2) ** 0.5 - 2.0, abs=0.02)
    remembers = [float(row["smallest_gamma"]) < 0.0 for row in steps]
    assert 10 < sum(remembers) < len(steps)
    for here, touching in zip(gap, remembers, strict=True):
        assert (here == 0.0) == touching
        assert here >= 0.0
    touched = rows(tmp_path / "run" / "contacts.csv")
    assert touched
    assert min(float(row["gap"]) for row in touched) >= 0.0
