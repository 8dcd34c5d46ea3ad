"""What a picture shows, and how its absence is explained."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread
from numpy.typing import NDArray

from fsi.bodies import Configuration
from fsi.errors import InputError
from meshes.geometry import Box, HalfPlane
from postprocess import opengl
from postprocess.fields import read_step
from postprocess.panel import View
from postprocess.render import around_bodies, narrowest_gap, render_run

BODY = (0xF3, 0xEF, 0xE6)
WALL = (0xC9, 0xC9, 0xC9)


@pytest.fixture
def drawing() -> None:
    """Skips where no picture can be drawn."""
    try:
        opengl.require_opengl()
    except InputError as error:
        pytest.skip(str(error))


def share(picture: NDArray[np.float32], colour: tuple[int, int, int]) -> float:
    """Part of the pixels that have a colour, within 2 of 255."""
    return float(np.mean(np.all(np.abs(picture[..., :3] * 255.0 - colour) <= 2.0, axis=2)))


@pytest.mark.usefixtures("drawing")
def test_picture_shows_flow_body_and_wall(run: Path, capfd: pytest.CaptureFixture[str]) -> None:
    path = render_run(run)
    picture = imread(path)
    assert path == run / "flow.png"
    assert picture.shape[:2] == (1070, 2360)
    flow, close_up = picture[75:, :995], picture[75:, 1185:2175]
    # A disc of radius 1 in a window 5 wide covers pi/25 of it, without its pointer; there is no wall in it.
    assert share(flow, BODY) == pytest.approx(np.pi / 25.0, rel=0.03)
    assert share(flow, WALL) < 1e-3
    # The close-up of the gap 0.2 is 2.4 wide: the plane lies half a gap below its middle.
    assert share(close_up, WALL) == pytest.approx(0.5 - 0.1 / 2.4, abs=0.01)
    assert capfd.readouterr() == ("", "")


@pytest.mark.usefixtures("drawing")
def test_chosen_time_and_name(run: Path, tmp_path: Path) -> None:
    early, late = (imread(render_run(run, tmp_path / f"{t}.png", time=t)) for t in (0.0, 2.0))
    assert not np.array_equal(early, late)


def test_window_stays_in_the_domain(run: Path) -> None:
    fluid, _ = read_step(run)
    low_disc = Configuration(np.array([[0.0, 1.2]]), np.zeros(1), np.ones(1))
    view = around_bodies(low_disc, fluid)
    assert view.half == pytest.approx(2.5)
    np.testing.assert_allclose(
        view.centre, [0.0, 2.5], atol=0.03
    )  # moved up so that the plane is its lower edge


@pytest.mark.parametrize(
    ("centres", "middle", "gap"),
    [
        ([[3.0, 1.1], [6.0, 5.0]], [3.0, 0.05], 0.1),
        ([[3.0, 3.0], [5.01, 3.0]], [4.005, 3.0], 0.01),
        ([[8.8, 5.0]], [9.9, 5.0], 0.2),
    ],
    ids=["bottom", "pair", "right"],
)
def test_close_up_is_centred_on_the_narrowest_gap(
    centres: list[list[float]], middle: list[float], gap: float
) -> None:
    q = Configuration(np.array(centres), np.zeros(len(centres)), np.ones(len(centres)))
    view = narrowest_gap(q, Box((0.0, 0.0), (10.0, 10.0)), View(np.array([5.0, 5.0]), 5.0))
    np.testing.assert_allclose(view.centre, middle, atol=1e-9)
    assert view.half == pytest.approx(6.0 * gap)


def test_close_up_at_a_curved_wall_points_outwards(run: Path) -> None:
    ray = np.array([0.6, 0.8])
    q = Configuration(4.9 * ray[None], np.zeros(1), np.ones(1))
    view = narrowest_gap(q, HalfPlane(6.0), around_bodies(q, read_step(run)[0]))
    np.testing.assert_allclose(view.centre, 5.95 * ray, atol=1e-6)


def test_no_close_up_of_wide_gaps(run: Path) -> None:
    q = Configuration(np.array([[0.0, 3.0]]), np.zeros(1), np.ones(1))
    around = around_bodies(q, read_step(run)[0])
    assert narrowest_gap(q, HalfPlane(6.0), around) is around


def test_no_opengl_is_one_clear_line(run: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(opengl, "_DRAW", "import os; os.abort()")
    with pytest.raises(InputError, match=r"^render: no off-screen OpenGL.*install libegl1") as caught:
        render_run(run)
    assert caught.value.exit_code == 2
    assert not (run / "flow.png").exists()


def test_not_a_run_folder(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"there is no case\.toml; give the folder"):
        render_run(tmp_path)


@pytest.mark.parametrize("name", ["picture.jpg", "nowhere/picture.png"])
def test_output_must_be_a_png_file_in_a_folder(run: Path, name: str) -> None:
    with pytest.raises(InputError, match=r"output = .*: give the path of a \.png file"):
        render_run(run, run / name)
