"""One period of a flow in space: where it is, and that the flow is found at all its places."""

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

import fsi
from fsi.bodies.configuration import Configuration
from fsi.case.load import load_case
from fsi.meshes.geometry.cell import Cell
from fsi.postprocess.render.periodic_box import PeriodicBox
from fsi.postprocess.run.probe import FLUID, probe
from fsi.runs import run

CASES = Path(__file__).parents[3] / "cases"
SHEARED = Cell(((4.0, 0.0, 0.0), (0.0, 4.0, 0.0), (1.0, 0.0, 3.0)), ((0.0, 0.0, 1.0), (0.0,) * 3, (0.0,) * 3))


def test_the_box_and_what_is_in_it() -> None:
    """The third period leans by 1; the box, around (2.5, 2, 1.5), does not.

    The window around it has the half 2.16. Of the first sphere the images at (4 i + k, 4 j, 3 k) reach into
    it, with i, j, k of 0 and 1, of the second one alone.
    """
    box = PeriodicBox.of(SHEARED)
    assert_allclose(box.corners.min(axis=0), [0.5, 0.0, 0.0], atol=1e-12)
    assert_allclose(box.corners.max(axis=0), [4.5, 4.0, 3.0])
    lengths = np.sort(np.linalg.norm(np.diff(box.edges, axis=1)[:, 0], axis=1))
    assert_allclose(lengths, np.repeat([3.0, 4.0], [4, 8]))
    view = box.view()
    assert_allclose(view.half, 0.54 * 4.0)
    q = Configuration.unturned(np.array([[4.0, -4.0, 0.0], [2.5, 2.0, 1.5]]), np.array([0.5, 0.4]))
    shown = box.bodies(q, view)
    at = [(x, y, z) for z, row in ((0.0, (0.0, 4.0)), (3.0, (1.0, 5.0))) for x in row for y in (0.0, 4.0)]
    assert {tuple(c) for c in shown.centres[shown.radii == 0.5].round(9).tolist()} == set(at)
    assert_allclose(shown.centres[shown.radii == 0.4], [[2.5, 2.0, 1.5]], atol=1e-12)


def test_images_in_the_box() -> None:
    """Each is a lattice vector away; without the order of the periods some would stay outside."""
    box, x = PeriodicBox.of(SHEARED), np.random.default_rng(1).uniform(-20.0, 20.0, (200, 3))
    home = box.home(x)
    m = (x - home) @ np.linalg.inv(SHEARED.periods)
    assert_allclose(m, np.rint(m), atol=1e-9)
    assert np.all((home >= [0.5, 0.0, 0.0]) & (home <= [4.5, 4.0, 3.0]))


@pytest.mark.slow
def test_the_flow_is_found_at_images(tmp_path: Path) -> None:
    """u(x + e) = u(x) + E e, and p(x + e) = p(x) without forces; a missed place would not be fluid."""
    case = load_case(CASES / "sheared_spheres.toml", ["time.end=0.001", "output.interval=0.001"])
    run(case, tmp_path / "run")
    found = fsi.open_run(tmp_path / "run")
    container = found.container(0)
    x = np.random.default_rng(0).uniform(-3.0, 6.0, (60, 3))
    e = np.array([1, -2, 1]) @ container.periods
    here, there = (probe(found, at, 0) for at in (x, x + e))
    fluid = (here["where"] == FLUID).to_numpy()
    assert fluid.sum() > 40
    assert ((there["where"] == FLUID).to_numpy() == fluid).all()
    u, v = (table.loc[fluid, ["u_x", "u_y", "u_z"]].to_numpy(dtype=float) for table in (here, there))
    assert_allclose(v, u + container.mean_velocity(e[None]), rtol=0, atol=1e-6)
    p, same = (table.loc[fluid, "p"].to_numpy(dtype=float) for table in (here, there))
    assert_allclose(same, p, rtol=0, atol=1e-6)
