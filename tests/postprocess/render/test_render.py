"""What a picture shows, and how its absence is explained."""

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.image import imread
from numpy.typing import NDArray
from PIL.GifImagePlugin import GifImageFile

import fsi
from fsi.bodies.configuration import Configuration
from fsi.bodies.surface_gap import SurfaceGap, narrowest_gap
from fsi.errors import InputError
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.round import HalfPlane
from fsi.postprocess.render import canvas
from fsi.postprocess.render.picture import round_length
from fsi.postprocess.render.planar import PlanarArtist
from fsi.postprocess.render.render import render_run
from fsi.postprocess.render.view import Choice, View, around_bodies

BODY = (0xF3, 0xEF, 0xE6)
WALL = (0xC9, 0xC9, 0xC9)


def share(picture: NDArray[np.float32], colour: tuple[int, int, int]) -> float:
    """Part of the pixels that have a colour, within 2 of 255."""
    return float(np.mean(np.all(np.abs(picture[..., :3] * 255.0 - colour) <= 2.0, axis=2)))


def drawn(run: Path, output: Path, choice: Choice | None = None, step: int | None = None) -> Any:
    """The pixels of a picture."""
    return imread(render_run(fsi.open_run(run), output, choice or Choice(), step))


@pytest.mark.usefixtures("drawing")
def test_picture_shows_flow_body_and_wall(run: Path, capfd: pytest.CaptureFixture[str]) -> None:
    picture = drawn(run, run / "flow.png")
    assert picture.shape[:2] == (1220, 2430)
    top, left, right = 140, 30, 1230  # the panels' corners
    flow, close_up = (
        picture[top : top + 1000, left : left + 1000],
        picture[top : top + 1000, right : right + 1000],
    )
    # A disc of radius 1 in a window 5 wide covers pi/25 of it; pointer, frame and edge take 3 %.
    assert share(flow, BODY) == pytest.approx(0.97 * np.pi / 25.0, rel=0.02)
    assert share(flow, WALL) < 1e-3
    # The close-up of the gap 0.2 is 2.4 wide and 0.96 high: the plane lies half a gap below its middle.
    strip = close_up[300:700]
    assert share(strip, WALL) == pytest.approx((0.48 - 0.1) / 0.96, abs=0.01)
    assert close_up[:250].min() == close_up[760:].min() == 1.0  # nothing above, and only the scale bar below
    assert capfd.readouterr() == ("", "")


@pytest.mark.usefixtures("drawing")
def test_nothing_is_cut_off(run: Path) -> None:
    """The margins are white all around."""
    picture = drawn(run, run / "flow.png", Choice(size=200))[..., :3]
    for border in (picture[0], picture[-1], picture[:, 0], picture[:, -1]):
        assert border.min() == 1.0


@pytest.mark.parametrize(("radius", "panels"), [(0.7, 2), (0.65, 1)])
def test_wide_gaps_have_no_close_up(
    radius: float, panels: int, run: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Below the disc at 1.2 they are 0.71 and 0.85 radii wide.

    Half of its window, 5 radii wide, is a strip one radius high, which a gap fills to 4/5 at most.
    """
    case = run / "case.toml"
    case.write_text(case.read_text().replace("radius = 1.0", f"radius = {radius}"))
    monkeypatch.setattr(PlanarArtist, "_shades", lambda *_: [])
    monkeypatch.setattr(PlanarArtist, "_picture", lambda painter, *_: len(painter.panels))
    assert [*PlanarArtist(fsi.open_run(run), Choice()).pictures([0, 2])] == [panels, panels]


@pytest.mark.usefixtures("drawing")
def test_bodies_have_rims_where_zero_is_as_pale(run: Path) -> None:
    """The pressure is x: left of the top of the disc, at 2.2, is nothing below 0.93 of white but the rim."""
    picture = drawn(run, run / "flow.png", Choice("pressure", span=(-50.0, 50.0), size=200))
    top = round(28 + 200 * (1.0 - 2.2 / 5.0))
    strip = picture[top - 4 : top + 4, 100:105, :3]
    assert strip.max(axis=2).min() < 0.8


@pytest.mark.slow
@pytest.mark.usefixtures("drawing")
def test_a_gap_of_ones_choice(run: Path) -> None:
    close_up = drawn(run, run / "gap.png", Choice("pressure", "disc,plane", (-1.0, 1.0), 200))
    assert share(close_up[28:108, 6:206], WALL) == pytest.approx((0.48 - 0.1) / 0.96, abs=0.03)
    same = drawn(run, run / "same.png", Choice("pressure", "0,plane", (-1.0, 1.0), 200))
    other = drawn(run, run / "other.png", Choice("pressure", "0,plane", (-2.0, 2.0), 200))
    assert np.array_equal(close_up, same)
    assert not np.array_equal(close_up, other)


@pytest.mark.usefixtures("drawing")
@pytest.mark.parametrize("suffix", [".gif", ".mp4"])
def test_animation_has_a_frame_for_each_step(run: Path, suffix: str) -> None:
    """The flow is three times as fast at the second one, on the same scale."""
    path = render_run(fsi.open_run(run), run / f"all{suffix}", Choice("speed", size=100))
    if suffix == ".gif":
        with GifImageFile(path) as movie:
            frames, size = int(movie.n_frames), movie.size
    else:
        import imageio_ffmpeg

        frames, _ = imageio_ffmpeg.count_frames_and_secs(str(path))
        size = imageio_ffmpeg.read_frames(str(path)).__next__()["size"]
    assert frames == 2
    assert size == (123 - (suffix == ".mp4"), 122)
    assert [file.name for file in run.glob("*all*")] == [path.name]


@pytest.mark.parametrize(
    ("choice", "message"),
    [
        (Choice(field="sped"), "--field sped: give one of speed, pressure"),
        (Choice(field="disturbance"), "--field disturbance: bodies disturb no sheared flow"),
        (Choice(plane="x=1"), "--plane x=1: is for flows in space"),
        (Choice(revolved=True), "--revolved: is for axisymmetric flows"),
        (Choice(gap="disc,disc"), "--gap disc,disc: give a body and another body or wall"),
        (Choice(gap="disc,1"), "--gap disc,1: there is no '1'; give two of disc, plane, far"),
        (Choice(gap="plane,far"), "--gap plane,far: give a body and"),
        (Choice(size=10), "--size 10: give at least 100"),
    ],
)
def test_impossible_choices(run: Path, choice: Choice, message: str) -> None:
    with pytest.raises(InputError, match=message):
        render_run(fsi.open_run(run), run / "flow.png", choice)
    assert not (run / "flow.png").exists()


def test_field_that_older_runs_have_not(run: Path) -> None:
    with pytest.raises(
        InputError, match="--field vorticity: is not in the files of step 2; run the case again"
    ):
        render_run(fsi.open_run(run), run / "flow.png", Choice("vorticity"))


@pytest.mark.parametrize(("most", "length"), [(1.0, 1.0), (0.99, 0.5), (4.9e-4, 2e-4), (7.0, 5.0)])
def test_scale_bars_are_round(most: float, length: float) -> None:
    assert round_length(most) == pytest.approx(length)


def test_window_stays_in_the_domain(run: Path) -> None:
    view = around_bodies(np.array([[0.0, 1.2]]), np.ones(1), fsi.open_run(run).mesh())
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
    found = narrowest_gap(q, Box((0.0, 0.0), (10.0, 10.0)))
    assert found is not None
    view = View(np.array([5.0, 5.0]), 5.0).close_up(found)
    assert found.width == pytest.approx(gap)
    np.testing.assert_allclose(view.centre, middle, atol=1e-9)
    assert view.half == pytest.approx(6.0 * gap)


def test_close_up_at_a_curved_wall_points_outwards() -> None:
    ray = np.array([0.6, 0.8])
    q = Configuration(4.9 * ray[None], np.zeros(1), np.ones(1))
    found = narrowest_gap(q, HalfPlane(6.0))
    assert found is not None
    np.testing.assert_allclose(found.middle, 5.95 * ray, atol=1e-6)


@pytest.mark.parametrize(
    ("gap", "half", "narrow"),
    [(0.4, 2.4, True), (0.5, 2.5, True), (1.59, 2.5, True), (1.61, 1.61 / 0.64, False), (2.0, 3.125, False)],
)
def test_a_close_up_is_half_as_wide_as_the_window_at_most(gap: float, half: float, narrow: bool) -> None:
    """It was as wide, half = 5: its frame left the panel. Wide gaps fill 0.8 of 0.4 times 2 half."""
    window, wide = View(np.zeros(2), 5.0), SurfaceGap(gap, np.ones(2), (0, 1), np.array([0.0, 1.0]))
    assert window.close_up(wide).half == pytest.approx(half)
    assert window.is_narrow(wide) is narrow


def test_no_opengl_is_one_clear_line(run: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(canvas, "_DRAW", "import os; os.abort()")
    with pytest.raises(
        InputError, match=r"^render: no off-screen OpenGL.*apt-get install -y libegl1"
    ) as caught:
        render_run(fsi.open_run(run), run / "flow.png", Choice())
    assert caught.value.exit_code == 2
    assert not (run / "flow.png").exists()


@pytest.mark.parametrize("name", ["picture.jpg", "nowhere/picture.png"])
def test_output_must_be_a_picture_in_a_folder(run: Path, name: str) -> None:
    with pytest.raises(InputError, match=r"output = .*: give the path of a \.png, \.mp4 or \.gif file"):
        render_run(fsi.open_run(run), run / name, Choice())


def test_an_animation_shows_all_steps(run: Path) -> None:
    with pytest.raises(InputError, match=r"shows all steps; give a \.png file for one step"):
        render_run(fsi.open_run(run), run / "all.mp4", Choice(), 2)


WITHOUT_ROOM = """
import resource, signal, sys
from pathlib import Path
import numpy as np
from fsi.errors import InputError
from fsi.postprocess.render.picture import write_pictures
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))
noise = np.random.default_rng(0)
pictures = (noise.integers(0, 255, (240, 320, 3), dtype=np.uint8) for _ in range(20))
try:
    write_pictures(pictures, Path(sys.argv[1]))
except InputError as error:
    print(error)
"""


@pytest.mark.parametrize("suffix", [".png", ".mp4", pytest.param(".gif", marks=pytest.mark.slow)])
def test_what_has_no_room_leaves_no_half_file(tmp_path: Path, suffix: str) -> None:
    """One line, and what was there before; half an animation of ffmpeg's was taken for a whole one."""
    output = tmp_path / f"all{suffix}"
    output.write_text("old")
    command = [sys.executable, "-c", WITHOUT_ROOM, str(output)]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    assert done.stdout.startswith(f"output = {output}: ")
    assert done.stdout.count("\n") == 1
    assert done.stderr == ""
    assert [(path, path.read_text()) for path in tmp_path.iterdir()] == [(output, "old")]


@pytest.mark.parametrize("time", [np.nan, np.inf])
def test_no_step_is_near_a_time_that_is_no_number(time: float, run: Path) -> None:
    with pytest.raises(InputError, match=f"^--time {time:g}: give a finite number$"):
        render_run(fsi.open_run(run), run / "flow.png", Choice(), time=time)
