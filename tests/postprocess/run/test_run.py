"""Opening run folders: finished, killed half-way, in parts, or none at all."""

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fsi
from fsi.errors import InputError
from fsi.run_folder.folder import RunFolder
from fsi.run_folder.provenance import launch
from tests.small_run import small_case, start

CELLS = 2 * 24 * 5


def test_opening_costs_an_import_nothing() -> None:
    code = "import sys, fsi; assert not {'pandas', 'pyvista', 'numpy'} & set(sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_times_and_meshes_of_the_steps_with_fields(run: Path) -> None:
    opened = fsi.open_run(str(run))
    assert opened.times.to_dict() == {0: 0.0, 2: 2.0}
    assert opened.case.name == "analytic"
    late, early = opened.mesh(), opened.mesh(0)
    assert late.n_cells == CELLS
    np.testing.assert_allclose(late["velocity"], 3.0 * early["velocity"])
    nodes = late.cell_connectivity.reshape(CELLS, -1)
    assert len(np.unique(nodes[:, :3])) == 24 * 6  # the parts share the nodes of their border
    assert opened.nearest(0.4) == 0
    assert opened.configuration(2).angles == pytest.approx([0.2])


def test_another_series_is_refused_with_those_there_are(run: Path) -> None:
    with pytest.raises(InputError, match=r"^series = foo: the run has none of it; give fluid"):
        fsi.open_run(run).mesh(0, "foo")
    with pytest.raises(InputError, match=r"^table = foo: the run has none of it; give bodies$"):
        fsi.open_run(run).table("foo")


def test_a_run_without_bodies_says_so(tmp_path: Path) -> None:
    """Of blocks: it was told to be continued, though it was finished."""
    block = {"left": 0.0, "right": 1.0, "density": 0.5, "initial_velocity": "1.0"}
    parcels = {"parcels": 4, "blocks": [block]}
    case = fsi.make_case(
        name="blocks", model="macroscopic", domain={"shape": "unbounded"}, macroscopic=parcels,
        time={"end": 1.0, "step": 0.5},
    )  # fmt: skip
    done = fsi.run(case, tmp_path / "run")
    assert done.finished
    with pytest.raises(InputError, match=r"the run has no bodies, and so no bodies\.csv$"):
        done.table("bodies")
    with pytest.raises(InputError, match=r"^table = contacts: the run has none of it; give profiles, steps$"):
        done.table("contacts")


def test_a_step_without_fields(run: Path) -> None:
    with pytest.raises(InputError, match=r"step = 1: has no fields; give one of 0, 2$"):
        fsi.open_run(run).mesh(1)


def test_a_step_that_is_not_the_only_one(run: Path) -> None:
    """A run that was stopped at its start has one."""
    lines = (run / "fluid.pvd").read_text().splitlines(keepends=True)
    (run / "fluid.pvd").write_text("".join(line for line in lines if 'timestep="2.0"' not in line))
    with pytest.raises(InputError, match=r"step = 2: has no fields; give one of 0$"):
        fsi.open_run(run).mesh(2)


def test_steps_and_times_that_are_none(run: Path, tmp_path: Path) -> None:
    start(small_case(time={"end": 0.1}), tmp_path / "small")
    small = fsi.open_run(tmp_path / "small")
    last = small.steps["step"].iloc[-1]
    for ask in (small.time, small.container, small.configuration):
        with pytest.raises(InputError, match=f"^step = 99: is not there, the last is {last}; give"):
            ask(99)
    opened = fsi.open_run(run)
    times: list[Any] = [np.nan, np.inf, "x", None]
    for time in times:
        with pytest.raises(InputError, match=f"^time = {time}: give a finite number$"):
            opened.nearest(time)


def test_a_run_without_fields(run: Path) -> None:
    (run / "fluid.pvd").unlink()
    with (run / "case.toml").open("a") as case:
        case.write("[output]\nfields = false\n")
    opened = fsi.open_run(run)
    assert opened.times.empty
    with pytest.raises(InputError, match=r"fluid\.pvd.*no fields; set output\.fields = true"):
        opened.mesh()


def test_a_run_killed_before_its_first_step_is_continued(tmp_path: Path) -> None:
    """Its case asks for fields already, and its folder is that of a run: these were the remedies."""
    RunFolder.create(tmp_path / "run", small_case(), launch())
    opened = fsi.open_run(tmp_path / "run")
    with pytest.raises(
        InputError, match=r"steps\.csv: is not there yet; continue the run with `fsi resume`$"
    ):
        opened.mesh()
    with pytest.raises(
        InputError, match=r"bodies\.csv: is not there yet; continue the run with `fsi resume`$"
    ):
        opened.table("bodies")


def test_not_a_run_folder(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"there is no case\.toml; give the folder"):
        fsi.open_run(tmp_path)


def test_tables_are_copies(tmp_path: Path) -> None:
    """What a user writes into them changed what the run says of itself."""
    start(small_case(), tmp_path / "run")
    opened = fsi.open_run(tmp_path / "run")
    told, last = repr(opened), int(opened.steps["step"].iloc[-1])
    before = opened.configuration(last).centres
    steps, bodies = opened.steps, opened.bodies
    steps["t"] = bodies["x"] = 1000.0
    assert repr(opened) == told
    assert opened.end == 1.0
    np.testing.assert_array_equal(opened.configuration(last).centres, before)


def test_a_killed_run_ends_at_its_last_complete_step(tmp_path: Path) -> None:
    """What was written after the last commit, here half a row and a bad one, is not there for readers."""
    folder = tmp_path / "run"
    start(small_case(), folder)
    whole = fsi.open_run(folder)
    assert whole.finished
    with (folder / "steps.csv").open("a") as steps, (folder / "bodies.csv").open("a") as bodies:
        steps.write("99,3.0,0.1,0.2")
        bodies.write("99,3.0,left,oops\n")
    cut = fsi.open_run(folder)
    assert cut.steps.equals(whole.steps)
    assert cut.bodies.equals(whole.bodies)
    assert (cut.end, cut.finished) == (whole.end, True)
