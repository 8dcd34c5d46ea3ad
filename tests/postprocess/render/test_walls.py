"""Open walls are none: beyond them pictures show the page."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread
from numpy.typing import NDArray

from fsi.postprocess.render.canvas import new_panel
from fsi.postprocess.render.render import render_run
from fsi.postprocess.render.view import Choice, View
from fsi.postprocess.render.walls import draw_open_walls
from fsi.postprocess.run.run import open_run
from tests.postprocess.spatial_run import CASE as BALL
from tests.postprocess.spatial_run import write_spatial_run

CASE = """
name = "open"
geometry = "{geometry}"
fluid.viscosity = 1.0
domain.lower = [{left}, 0.0]
domain.upper = [1.0, 2.0]
domain.walls.top = "open"
{more}
"""
PAGE, SOLID, DARK, SIZE = 255, 0xC9, 150, 400


def seen(folder: Path, case: str) -> NDArray[np.uint8]:
    """Walls around the middle 2 x 2 of a square with sides of 4 around (0, 1), the darkest of each pixel."""
    (folder / "case.toml").write_text(case)
    panel = new_panel(View(np.array([0.0, 1.0]), 2.0), SIZE)
    draw_open_walls(panel, open_run(folder))
    return np.asarray(panel.image().min(axis=2))


@pytest.mark.usefixtures("drawing")
@pytest.mark.parametrize(
    ("geometry", "left", "more", "right"),
    [
        ("planar", -1.0, "", SOLID),
        ("planar", -1.0, "domain.walls.right = {pressure = 2.0}", PAGE),
        ("axisymmetric", 0.0, "", SOLID),
    ],
)
def test_the_page_is_beyond_open_walls_and_beside_the_ends_of_solid_ones(
    geometry: str, left: float, more: str, right: int, tmp_path: Path
) -> None:
    picture = seen(tmp_path, CASE.format(geometry=geometry, left=left, more=more))
    near, middle, far = SIZE // 8, SIZE // 2, -SIZE // 8
    around = [(row, column) for row in (near, middle, far) for column in (near, middle, far)]
    found = [int(picture[place]) for place in around if place != (middle, middle)]
    assert found == [PAGE, PAGE, PAGE, SOLID, right, SOLID, SOLID, right]
    # Half of the opening is dashes, and nothing beside it.
    dark = (picture[SIZE // 4 - 2 : SIZE // 4 + 2] < DARK).any(axis=0)
    assert dark[SIZE // 4 + 4 : 3 * SIZE // 4 - 4].mean() == pytest.approx(0.5, abs=0.15)
    assert not dark[: SIZE // 4 - 4].any()


def share(picture: NDArray[np.float32]) -> float:
    """Of what is wall."""
    return float(np.mean(np.all(np.abs(picture[..., :3] * 255.0 - SOLID) <= 2.0, axis=2)))


@pytest.mark.usefixtures("drawing")
def test_a_flow_has_no_wall_where_it_is_open(run: Path) -> None:
    """Below the close-up of a gap to a solid plane 0.4 of the strip are wall."""
    case = run / "case.toml"
    walls = [share(close_up(run))]
    case.write_text(case.read_text().replace("domain.radius", 'domain.walls.plane = "open"\ndomain.radius'))
    walls.append(share(close_up(run)))
    np.testing.assert_allclose(walls, [0.38 / 0.96, 0.0], atol=0.03)


def close_up(run: Path) -> NDArray[np.float32]:
    """The strip around the gap to the plane."""
    choice = Choice("pressure", "disc,plane", (-1.0, 1.0), 200)
    return np.asarray(imread(render_run(open_run(run), run / "a.png", choice))[28:108, 6:206])


@pytest.mark.usefixtures("drawing")
def test_bodies_alone_have_no_wall_where_it_is_open(run: Path) -> None:
    """The window is a tenth wider than the disc, which touches the plane."""
    (run / "bodies.csv").write_text("step,t,body,x,y,angle,V_x,V_y,omega\n0,0.0,disc,0.0,1.0,0,0,1,0\n")
    (run / "steps.csv").write_text("step,t\n0,0.0\n")
    text, walls = (run / "case.toml").read_text(), []
    for condition in ("[0.0, 0.0]", '"open"'):
        wall = f"domain.walls.plane = {condition}\ndomain.radius"
        (run / "case.toml").write_text(text.replace("domain.radius", wall))
        picture = imread(render_run(open_run(run), run / "a.png", Choice("motion", size=200)))
        walls.append(share(picture[28:228, 6:206]))
    np.testing.assert_allclose(walls, [0.1 / 2.2, 0.0], atol=0.012)


@pytest.mark.usefixtures("drawing")
def test_a_plane_in_space_has_no_wall_where_it_is_open(tmp_path: Path) -> None:
    """The window is 2.42 wide, the box 2; its solid sides take the rest but for what is above the lid."""
    write_spatial_run(tmp_path)
    (tmp_path / "case.toml").write_text(BALL.replace("2.0", "1.0") + '[domain.walls]\ntop = "open"\n')
    choice = Choice("pressure", plane="y=0", span=(-1.0, 1.0), size=200)
    picture = imread(render_run(open_run(tmp_path), tmp_path / "a.png", choice))[28:228, 6:206]
    high, edge = 2.21 / 2.42, 0.21 / 2.42
    assert share(picture) == pytest.approx(high - (high - edge) * (1.0 - 2.0 * edge), abs=0.03)
