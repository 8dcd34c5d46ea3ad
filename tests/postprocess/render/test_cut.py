"""Planes through a flow in space: where they lie, what they cut, and the lines on them."""

from pathlib import Path

import numpy as np
import pytest
import pyvista as pv
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.image import imread

import fsi
from fsi.bodies.configuration import Configuration
from fsi.bodies.surface_gap import gap_between
from fsi.errors import InputError
from fsi.meshes.geometry.box import Box
from fsi.postprocess.render import cut as cut_module
from fsi.postprocess.render.cut import Cut, flow_on, through_gap
from fsi.postprocess.render.fields import rendered_field
from fsi.postprocess.render.render import render_run
from fsi.postprocess.render.view import Choice, View
from tests.postprocess.spatial_run import velocity, write_spatial_run

BOX = Box((-9.0, -9.0, -9.0), (9.0, 9.0, 9.0))
X, ORIGIN = np.array([1.0, 0.0, 0.0]), np.zeros(3)
number = st.floats(-3.0, 3.0)


@given(st.tuples(number, number, number), st.tuples(number, number, number))
def test_the_plane_of_a_gap_holds_the_line_of_centres(
    towards: tuple[float, ...], middle: tuple[float, ...]
) -> None:
    """Both spheres are cut in half: the discs have their radii and the gap between them."""
    if np.linalg.norm(towards) < 0.1:
        return
    b = 2.5 * np.array(towards) / np.linalg.norm(towards)
    q = Configuration(np.array([ORIGIN, b]), np.zeros((2, 3)), np.array([1.0, 0.7]))
    cut = through_gap(gap_between(q, BOX, (0, 1)), q, View(np.array(middle), 2.0))
    discs = cut.circles(q)
    np.testing.assert_allclose(discs.radii, q.radii / 2.0, atol=1e-5)
    assert np.linalg.norm(discs.centres[1] - discs.centres[0]) == pytest.approx(1.25, abs=1e-5)
    assert np.linalg.norm(cut.along) == pytest.approx(1.0)
    # The window is moved across the plane only.
    moved = cut.centre - middle
    np.testing.assert_allclose([moved @ cut.along, moved[2]], 0.0, atol=1e-9)


def test_a_sphere_beside_the_plane_is_cut_in_a_smaller_disc() -> None:
    q = Configuration(np.array([[0.0, 0.6, 0.5], [0.0, 1.1, 0.0]]), np.zeros((2, 3)), np.ones(2))
    discs = Cut(ORIGIN, 1.0, X).circles(q)
    np.testing.assert_allclose(discs.radii, [0.8])
    np.testing.assert_allclose(discs.centres, [[0.0, 0.5]])


@pytest.mark.parametrize(
    ("along", "letters"),
    [([1.0, 0.0, 0.0], ("x", "z")), ([0.0, 1.0, 0.0], ("y", "z")), ([0.0, -1.0, 0.0], ("s", "z")),
     ([0.6, 0.8, 0.0], ("s", "z"))],
)  # fmt: skip
def test_letters_are_those_of_coordinates_that_grow_that_way(
    along: list[float], letters: tuple[str, str]
) -> None:
    """Where -y points to the right, "y" would give the vorticity the other sign."""
    assert Cut(ORIGIN, 1.0, np.array(along)).letters == letters


def test_vorticity_is_what_its_letters_say(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """On x = 1.1, of u = (y z, z^2, x y): d_y u_z - d_z u_y = x - 2 z, from -1.9 to 4.1.

    The files have it at nodes, by which it goes on from cell to cell as x does; that of the elements errs by
    up to 0.07 in bent cells, and jumps.
    """
    monkeypatch.setattr(cut_module, "_POINTS", 11)  # for speed
    run, cut = fsi.open_run(write_spatial_run(tmp_path)), Cut(1.1 * X, 1.0, np.array([0.0, 1.0, 0.0]))
    surface, _ = flow_on(run, 0, cut, rendered_field("vorticity"), 1.5)
    assert cut.letters == ("y", "z")
    expected = 1.1 - 2.0 * np.asarray(surface.points)[:, 1]
    np.testing.assert_allclose(surface["value"], expected, atol=1e-5)  # nodes are in single precision


def test_rates_that_files_have_not_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As those of old runs."""
    monkeypatch.setattr(cut_module, "_POINTS", 3)
    run, cut = fsi.open_run(write_spatial_run(tmp_path)), Cut(X, 1.0, np.array([0.0, 1.0, 0.0]))
    file = tmp_path / "fields" / "fluid_000000.vtu"
    grid = pv.read(file)
    grid.point_data.remove("strain_rate")
    grid.save(file)
    flow_on(run, 0, cut, rendered_field("vorticity"), 1.5)
    with pytest.raises(InputError, match=r"--field dissipation: is not in the files of step 0"):
        flow_on(run, 0, cut, rendered_field("dissipation"), 1.5)


def test_streamlines_follow_the_flow_in_the_plane(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """On y = 1: u_x = z, u_z = x, so that x^2 - z^2 stays the same; the ball is not met there."""
    monkeypatch.setattr(cut_module, "_POINTS", 61)
    run = fsi.open_run(write_spatial_run(tmp_path))
    cut, speed = Cut(np.array([0.0, 1.0, 0.0]), 1.0, X), rendered_field("speed")
    surface, lines = flow_on(run, 0, cut, speed, 1.5)
    assert surface.area == pytest.approx(9.0, rel=1e-6)
    assert lines.n_cells > 10
    for line in range(0, lines.n_cells, 5):
        s, t, _ = np.asarray(lines.get_cell(line).points).T
        assert np.ptp(s**2 - t**2) < 0.3  # of 4.5 in all; the few bent cells meet the flow to 0.3
    x = Cut(np.array([0.0, 1.0, 0.0]), 1.0, X).points(*np.asarray(surface.points)[:, :2].T)
    np.testing.assert_allclose(surface["value"], np.linalg.norm(velocity(x), axis=1), atol=0.3)


def test_the_plane_ends_at_the_walls(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Half a window of 1.5 beyond x = 1 is cut at 2, square up to the corner."""
    monkeypatch.setattr(cut_module, "_POINTS", 31)
    run = fsi.open_run(write_spatial_run(tmp_path))
    surface, _ = flow_on(run, 0, Cut(np.array([1.0, 1.0, 1.0]), 1.0, X), rendered_field("pressure"), 1.5)
    assert surface.area == pytest.approx(2.5**2, rel=1e-6)


@pytest.mark.usefixtures("drawing")
def test_close_up_of_a_gap_to_a_wall(tmp_path: Path) -> None:
    """The gap of 1.5 is wider than a twelfth of the window, which then is that of the whole run."""
    run = fsi.open_run(write_spatial_run(tmp_path))
    picture = imread(render_run(run, tmp_path / "a.png", Choice(gap="ball,bottom", size=200)))
    panel = picture[28:228, 6:206, :3]
    body = np.all(np.abs(panel * 255.0 - (0xF3, 0xEF, 0xE6)) <= 2.0, axis=2)
    assert body.mean() == pytest.approx(np.pi / 4.0 / 2.42**2, rel=0.05)  # mixed on the rim
