"""Runs of one case at several levels: on several ranks root alone decides what is there."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import fsi
from fsi.bodies.configuration import Configuration
from fsi.case.case import Case
from fsi.comparison.motion import History, compare_rates, rates_json, trajectories
from fsi.files import json_text
from fsi.postprocess.plots.studies import plot_comparison
from fsi.postprocess.run.run import open_run
from fsi.reduced.model import ReducedModel
from tests.cli.test_commands import ROOT, call
from tests.ranks import needs_mpi, python_on
from tests.reduced_data import reduced_case

LATE = """
import sys, time
from pathlib import Path
import fsi, fsi.parallel as parallel
from fsi.comparison.levels import run_levels

exists = Path.exists

def late(path, **more):
    if parallel.rank() == 1 and path.name == "reduced":
        time.sleep(1.0)
    return exists(path, **more)

Path.exists = late
case = fsi.load_case(sys.argv[1], ["model=reduced", "reduced.drag=10", "time.end=0.1"])
for _ in range(2):  # the second time the runs are there
    run_levels({"reduced": case}, Path(sys.argv[2]))
"""


@needs_mpi
@pytest.mark.mpi
def test_a_rank_that_looks_late_does_what_the_others_do(tmp_path: Path) -> None:
    """It saw the folder that root had made meanwhile, and took the run for one to go on with."""
    case = ROOT / "cases" / "settling_discs.toml"
    done = call(*python_on(2), "-c", LATE, str(case), str(tmp_path / "out"), timeout=120.0)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "out" / "reduced" / "state.npz").exists()


def test_gaps_are_compared_as_long_as_both_runs_go_on(tmp_path: Path) -> None:
    """The reduced run ends at t = 0.4 with a gap of 0.4, the resolved one has 0.6 there."""
    bodies = [{"name": "disc", "radius": 1.0, "position": [3.0, 2.0], "force": [0.0, -4.0]}]
    case = reduced_case(bodies, {"drag": 12.0, "cutoff": 1.5})
    resolved, reduced = (falling(case, t, fall) for t, fall in ((0.8, 1.0), (0.4, 1.5)))
    found = compare_rates(case, resolved, reduced)
    assert found.common.tolist() == [t <= 0.4 for t in resolved.t.tolist()]
    (row,) = found.bodies()
    assert row["final_gap"] == pytest.approx(0.6)
    assert row["final_reduced_gap"] == pytest.approx(0.4)
    assert row["gap_difference"] == pytest.approx(1.0 / 3.0)
    data = json.loads(json_text(rates_json(case.names, "lubrication", found)))
    assert data["reduced_gap"][-1] == [None]
    plot_comparison(case.names, found, tmp_path / "of.png")


def test_a_body_that_meets_nothing_has_no_rates_to_compare(tmp_path: Path) -> None:
    """JSON has no infinite gaps, and the axes of an empty plot no numbers: it says so, without a warning."""
    body = {"name": "disc", "radius": 0.1, "position": [3.0, 5.0]}
    case = reduced_case([body], {"drag": 2.0, "cutoff": 0.1})
    history = falling(case, 1.0, 0.0)
    found = compare_rates(case, history, history)
    assert not len(found.sample_gap)
    assert json.loads(json_text(rates_json(case.names, "lubrication", found)))["smallest_gap"] is None
    plot_comparison(case.names, found, tmp_path / "of.png")


def test_gaps_in_a_lattice_that_a_stress_shears_are_those_of_the_run(tmp_path: Path) -> None:
    """As in steps.csv. With the lattice at rest they were 0.0068 where they are 0.2014."""
    cell = {"shape": "cell", "vectors": [[6.0, 0.0], [0.0, 6.0]], "stress": 2.0}
    places = {"b": [1.0, 2.0], "c": [3.5, 5.0]}
    bodies = [{"name": name, "radius": 1.0, "position": x} for name, x in places.items()]
    time, output = {"end": 0.2, "tolerance": 1e-2}, {"fields": False}
    case = reduced_case(bodies, {}, domain=cell, model="pores", time=time, output=output)
    fsi.run(case, tmp_path / "run")
    run = open_run(tmp_path / "run")
    history = History.of_tables(case, run.columns("bodies"), run.columns("steps"))
    found = trajectories({"pores": case}, {"pores": history}).smallest["pores"]
    steps = run.columns("steps")
    assert steps["strain"][-1] > 0.1
    assert found[[0, -1]] == pytest.approx(steps["smallest_gap"][[0, -1]], rel=1e-12)


def falling(case: Case, end: float, speed: float) -> History:
    """A history of the first body at a constant speed, under the loads of the reduced model."""
    t = np.linspace(0.0, end, 5)
    start = case.configuration().centres
    centres = start - np.multiply.outer(t, np.array([[0.0, speed]]))
    model = ReducedModel(case)
    F = np.array([model(Configuration.unturned(x, case.configuration().radii), 0.0).F for x in centres])
    U = np.broadcast_to(np.array([0.0, -speed, 0.0]), F.shape)
    return History(t, centres, U, F)
