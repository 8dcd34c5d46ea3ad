"""Chains of close discs, and what lubrication dissipates in them."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fsi
from fsi.case.case import Case
from fsi.case.load import load_case, parse_case
from fsi.errors import InputError
from fsi.pores.instant import PoreInstant
from fsi.postprocess.analysis import chains
from fsi.postprocess.analysis.chains import chains_data, read_chains, wall_to_wall
from fsi.postprocess.analysis.links import ChainLinks, find_links
from fsi.postprocess.run.run import open_run
from tests.commands import fsi_command

CASES = Path(__file__).parents[3] / "cases"
HEADER = "step,t,body,x,y,angle,V_x,V_y,omega,F_x,F_y,T\n"
# A chain from wall to wall (a, b, c), a pair (d, e) and a lone disc; V_y closes or opens gaps.
DISCS: list[tuple[str, float, float, float, float]] = [
    ("a", 1.0, -3.0, 1.02, 0.5), ("b", 1.0, -3.0, 3.05, -0.5), ("c", 0.5, -3.0, 4.59, -0.5),
    ("d", 1.0, 2.0, 2.5, 0.0), ("e", 1.0, 4.06, 2.5, 0.0), ("f", 0.5, 7.0, 2.5, 0.0),
]  # fmt: skip


@pytest.fixture
def run(tmp_path: Path) -> Path:
    """A run folder of two steps by hand: at the second nothing moves."""
    bodies: list[dict[str, Any]] = [{"name": n, "radius": a, "position": [x, y]} for n, a, x, y, _ in DISCS]
    domain = {"lower": [-8.0, 0.0], "upper": [8.0, 5.1], "walls": {"top": [1.0, 0.0]}}
    case = parse_case(
        {"name": "t", "fluid": {"viscosity": 2.0}, "domain": domain, "bodies": bodies, "time": {"end": 1.0}}
    )
    (tmp_path / "case.toml").write_text(case.as_toml())
    (tmp_path / "steps.csv").write_text("step,t,dissipation\n0,0.0,50000.0\n1,1.0,1.0\n")
    rows = [
        f"{s},{s}.0,{n},{x},{y},0,0,{V if s == 0 else 0.0},0,0,0,0\n"
        for s in (0, 1)
        for n, _, x, y, V in DISCS
    ]
    (tmp_path / "bodies.csv").write_text(HEADER + "".join(rows))
    return tmp_path


def test_chains_and_their_dissipation_by_hand(run: Path) -> None:
    found = read_chains(open_run(run))
    assert (found.step, found.t) == (0, 0.0)  # that which dissipates most
    chain, pair = found.chains
    assert (chain.bodies, pair.bodies) == ((0, 1, 2), (3, 4))
    assert [found.case.container().walls[k] for k in chain.walls] == ["bottom", "top"]
    assert chain.smallest_gap == pytest.approx(0.01)
    # a leaves the bottom and c the top at 1/2, a and b (equal) approach at 1, b and c move together
    to_walls = 3 * math.sqrt(2) * math.pi * 2.0 * (0.02**-1.5 + (0.5 / 0.01) ** 1.5) * 0.5**2
    equal = 1.5 * math.pi * 2.0 * 0.03**-1.5
    assert chain.dissipation == pytest.approx(to_walls + equal, rel=1e-9)
    assert pair.dissipation == 0.0


def test_unequal_discs_have_their_reduced_radius(run: Path) -> None:
    """b and c, of radii 1 and 1/2: a = 1/3; each gap by itself in the list of links."""
    links = read_chains(open_run(run), 0).links
    k = [tuple(end) for end in links.ends.tolist()].index((1, 2))
    assert links.gaps[k] == pytest.approx(0.04)
    assert links.rates[k] == 0.0
    table = (run / "bodies.csv").read_text().replace("c,-3.0,4.59,0,0,-0.5", "c,-3.0,4.59,0,0,0.5")
    (run / "bodies.csv").write_text(table)
    links = read_chains(open_run(run), 0).links
    kappa = 3 * math.sqrt(2) * math.pi * 2.0 * (1 / 3 / 0.04) ** 1.5
    assert links.dissipation[k] == pytest.approx(kappa * 1.0**2, rel=1e-9)


def test_more_room_makes_longer_links(run: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Gaps below 0.03 of the mean radius 5/6 are only those to the walls."""
    assert {chain.bodies for chain in read_chains(open_run(run), 1).chains} == {(0, 1, 2), (3, 4)}
    monkeypatch.setattr(chains, "CLOSE", 0.03)
    assert {chain.bodies for chain in read_chains(open_run(run), 1).chains} == {(0,), (2,)}


def test_the_table_and_the_picture(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert fsi_command("analyse", "chains", run, "--step", 0) == 0
    said = capsys.readouterr().out
    assert "step 0" in said
    assert "a, b, c" in said
    assert f"picture: {run / 'chains.png'}" in said.replace("\n", "")
    assert (run / "chains.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(("step", "part"), [("7", "the run has the steps 0 to 1"), ("x", "a valid integer")])
def test_mistakes(run: Path, capfd: pytest.CaptureFixture[str], step: str, part: str) -> None:
    assert fsi_command("analyse", "chains", run, "--step", step) == 2
    assert part in capfd.readouterr().err


def test_the_model_must_be_resolved(run: Path) -> None:
    (run / "steps.csv").write_text("step,t\n0,0.0\n")
    with pytest.raises(InputError, match="no column dissipation"):
        read_chains(open_run(run))


def test_the_data_of_the_table(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert fsi_command("analyse", "chains", run, "--json") == 0
    data = json.loads(capsys.readouterr().out)
    assert [chain["bodies"] for chain in data["chains"]] == [["a", "b", "c"], ["d", "e"]]
    assert data["chains"][0]["walls"] == ["bottom", "top"]
    assert (data["step"], data["dissipation"]) == (0, 50000.0)


def test_chains_have_no_part_in_a_dissipation_that_is_infinite(
    run: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """It is where the velocities of walls jump: 0.0 % of it was said of every chain."""
    (run / "steps.csv").write_text("step,t,dissipation\n0,0.0,inf\n1,1.0,inf\n")
    assert fsi_command("analyse", "chains", run, "--json") == 0
    assert json.loads(capsys.readouterr().out)["dissipation"] is None
    assert fsi_command("analyse", "chains", run) == 0
    assert "of infinite" in capsys.readouterr().out


def test_rates_are_slopes_of_gaps(run: Path) -> None:
    found = read_chains(open_run(run), 0)
    h = 1e-6
    V = np.array([[0.0, disc[4]] for disc in DISCS])
    for (i, j), gap, rate in zip(found.links.ends.tolist(), found.links.gaps, found.links.rates, strict=True):
        x = found.q.centres + h * V
        a = found.q.radii
        if j < len(DISCS):
            moved = float(np.linalg.norm(x[i] - x[j])) - a[i] - a[j]
        else:
            moved = float(found.case.container().distances(x)[i, j - len(DISCS)]) - a[i]
        assert (moved - gap) / h == pytest.approx(rate, abs=1e-6)


def test_what_a_chain_carries_of_the_apparent_viscosity(tmp_path: Path) -> None:
    """Discs about to touch in a square lattice at 45 degrees: one pair is pressed, one pulled, by E.

    All of the viscosity is lubrication then: mu_app -> sum (d n.E.n)^2 kappa / |Omega| with d n.E.n = d / 2.
    Its two links dissipate as much as they carry, as the bodies move with the mean flow.
    """
    d = 2.0001 / math.sqrt(2.0)
    domain = {"shape": "cell", "vectors": [[d, d], [-d, d]], "shear": 1.0}
    body = {"name": "a", "radius": 1.0, "position": [0.3, 0.0]}
    data = {
        "name": "t",
        "fluid": {"viscosity": 2.0},
        "domain": domain,
        "bodies": [body],
        "time": {"end": 1.0},
    }
    (tmp_path / "case.toml").write_text(parse_case(data).as_toml())
    kappa, area = 1.5 * math.pi * 1e-4**-1.5, 2.0001**2
    mu = 2.0 * (0.5 * 2.0001) ** 2 * kappa / area
    (tmp_path / "steps.csv").write_text(
        f"step,t,dissipation,apparent_viscosity\n0,0.0,{2.0 * mu * area},{mu}\n1,1e-9,1.0,nan\n"
    )
    rows = [f"{step},{step}e-9,a,0.3,0.0,0,0,0,-0.5,0,0,0\n" for step in (0, 1)]
    (tmp_path / "bodies.csv").write_text(HEADER + "".join(rows))
    found = read_chains(open_run(tmp_path), 0)
    assert found.shares is not None
    np.testing.assert_allclose(found.shares, np.array([0.5, 0.5]), rtol=1e-6)
    assert found.chains[0].dissipation == pytest.approx(found.dissipation, rel=1e-6)
    assert fsi_command("analyse", "chains", tmp_path, "--step", 0) == 0
    assert read_chains(open_run(tmp_path), 1).shares is None


def links_of(*each: tuple[int, int, float]) -> ChainLinks:
    """Links between sides that dissipate so much."""
    n = len(each)
    ends, lost = np.array([link[:2] for link in each]), np.array([link[2] for link in each])
    return ChainLinks(
        ends, np.zeros((n, 2)), 0.1 * np.arange(1, n + 1).astype(np.float64), np.zeros(n), np.zeros(n), lost
    )


LEVELS = ['model="reduced"', 'time.scheme="distance"', "time.step=0.05", "time.end=2.0"]


@pytest.mark.parametrize("fields", ["true", "false"])
def test_gaps_that_a_run_stored_are_taken_with_its_law(
    fields: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Without drag the only pair dissipates all; at the gap of the bodies it would be 38 % at the step 14."""
    more = [f"output.fields={fields}", "output.interval=0.1"]
    fsi.run(load_case(CASES / "levels.toml", [*LEVELS, *more]), tmp_path / "run")
    run = open_run(tmp_path / "run")
    found = read_chains(run)
    assert found.step == 14
    assert found.links.dissipation == pytest.approx([found.dissipation], rel=1e-12)
    assert found.links.gaps == pytest.approx(10.0 ** run.columns("steps")["log10_stored_gap"][[14]])
    assert fsi_command("analyse", "chains", run.path, "--step", 0) == 0  # where nothing moves yet
    assert fsi_command("analyse", "chains", run.path, "--step", 20) == 0
    assert "100.0%" in capsys.readouterr().out


def test_of_many_pairs_the_stored_gaps_are_those_that_were_written(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Three discs, nearly in a row, none far from another: their pairs dissipate all, as there is no drag."""
    data = load_case(CASES / "levels.toml", LEVELS).as_data()
    data["output"] = {"interval": 0.1}
    data["time"]["end"] = 0.8
    third = data["bodies"][1] | {"name": "third", "position": [3.65, 0.1]}
    data["bodies"] = [*data["bodies"], third]
    fsi.run(parse_case(data), tmp_path / "run")
    run = open_run(tmp_path / "run")
    monkeypatch.setattr(chains, "CLOSE", 5.0)
    found = read_chains(run, int(run.times_of("contacts").index[-1]))
    assert sorted(found.links.gaps) == pytest.approx(sorted(run.mesh(found.step, "contacts")["gap"]))
    assert run.steps["drift"].iloc[-1] > 1e-3
    assert found.links.dissipation.sum() == pytest.approx(found.dissipation, rel=1e-3)
    between = next(step for step in run.steps["step"] if step not in run.times_of("contacts").index)
    assert fsi_command("analyse", "chains", tmp_path / "run", "--step", between) == 2
    assert "has not written which gaps it stored there; give a step with fields" in capfd.readouterr().err


def test_the_chain_from_wall_to_wall_is_that_whose_least_link_dissipates_most() -> None:
    """Walls are 4 and 5. By 0 and 1 the least is 2, by 2 and 3 it is 1; 0 and 1 have two links."""
    links = links_of(
        (0, 4, 9.0), (0, 1, 0.5), (0, 1, 2.0), (1, 5, 3.0), (2, 4, 9.0), (2, 3, 1.0), (3, 5, 50.0)
    )
    chain = wall_to_wall(links, 4)
    assert chain is not None
    assert (chain.bodies, chain.walls, chain.links) == ((0, 1), (0, 1), (0, 2, 3))
    assert (chain.dissipation, chain.smallest_gap) == pytest.approx((14.0, 0.1))
    assert wall_to_wall(links_of((0, 4, 1.0), (1, 5, 1.0), (1, 1, 7.0)), 2 + 2) is None


@pytest.fixture
def without_pressure(monkeypatch: pytest.MonkeyPatch) -> None:
    """In the files of pores, where it takes longer than all else."""
    monkeypatch.setattr("fsi.pores.instant.FEW", 0)


@pytest.mark.usefixtures("without_pressure")
def test_a_run_of_pores_says_what_its_necks_dissipate(tmp_path: Path) -> None:
    """Ten sheared discs: five of them close a chain that takes two fifths of the power, from wall to wall.

    By lubrication along lines of centres all twelve links together would take 4 %: they roll and slide.
    """
    case = load_case(CASES / "pores" / "couette_N10.toml", ["pores.modes=1", "time.end=1e-6"])
    fsi.run(case, tmp_path / "run")
    found = read_chains(open_run(tmp_path / "run"), 0)
    solved = fsi.solve(case).instant
    assert isinstance(solved, PoreInstant)
    necks = solved.necks
    of_pair = {
        tuple(sides): lost for sides, lost in zip(necks.sides.tolist(), necks.dissipation, strict=True)
    }
    pairs = [tuple(sorted(ends)) for ends in found.links.ends.tolist()]
    assert found.links.dissipation == pytest.approx([of_pair[pair] for pair in pairs], rel=1e-9)
    chain = found.across
    assert chain is not None
    assert [found.case.names[k] for k in chain.bodies] == ["disc 5", "disc 1", "disc 8", "disc 7", "disc 9"]
    assert chain.dissipation / found.dissipation == pytest.approx(0.41, abs=0.01)  # regression
    assert found.measured
    estimated = find_links(case, found.q, solved.U[:, :2], 0.0, 0.1).dissipation.sum()
    assert estimated / found.dissipation == pytest.approx(0.04, abs=0.01)  # regression
    assert chains_data(found)["wall_to_wall"]["walls"] == ["bottom", "top"]


def round_case(model: str) -> Case:
    """A pair and the wall of a round container, close to each other, and a lone disc."""
    bodies = [
        {"name": "a", "radius": 1.0, "position": [1.95, 0.0], "force": [0.0, -1.0]},
        {"name": "b", "radius": 0.5, "position": [0.4, 0.0]},
        {"name": "c", "radius": 0.5, "position": [-1.5, 0.5]},
    ]
    domain = {"shape": "round", "radius": 3.0}
    data = {"name": "t", "model": model, "fluid": {"viscosity": 2.0}, "domain": domain, "bodies": bodies}
    return parse_case(data | {"time": {"end": 1e-6}})


@pytest.mark.usefixtures("without_pressure")
def test_chains_in_a_round_container(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    fsi.run(round_case("pores"), tmp_path / "run")
    assert fsi_command("analyse", "chains", tmp_path / "run", "--step", 0) == 0
    assert "a, b" in capsys.readouterr().out
    assert (tmp_path / "run" / "chains.png").read_bytes().startswith(b"\x89PNG")
    found, solved = read_chains(open_run(tmp_path / "run"), 0), fsi.solve(round_case("pores")).instant
    assert isinstance(solved, PoreInstant)
    necks = zip(solved.necks.sides.tolist(), solved.necks.dissipation, strict=True)
    of_pair = {tuple(sides): lost for sides, lost in necks}
    assert found.links.ends.tolist() == [[0, 1], [0, 3]]
    assert found.links.dissipation == pytest.approx([of_pair[0, 1], of_pair[0, 3]], rel=1e-9)


def test_a_round_wall_has_its_reduced_radius() -> None:
    """a R / (R - a) = 3/2 of radii 1 and 3; a plane wall would have 1."""
    case = round_case("resolved")
    V = np.array([[1.0, 0.0], [1.0, 0.0], [0.0, 0.0]])
    links = find_links(case, case.configuration(), V, 0.0, 0.1)
    kappa = 3 * math.sqrt(2) * math.pi * 2.0 * (1.5 / 0.05) ** 1.5
    assert links.ends[1].tolist() == [0, 3]
    assert links.dissipation[1] == pytest.approx(kappa * 1.0**2, rel=1e-9)
