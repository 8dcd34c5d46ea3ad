"""Bodies coloured by their velocity less the mean flow, drawn from tables alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread

from fsi.errors import InputError
from fsi.postprocess.render.render import artist, render_run
from fsi.postprocess.render.suspended import MOTION, MotionArtist
from fsi.postprocess.render.view import Choice
from fsi.postprocess.run.run import Run, open_run

CASE = """
name = "two"
model = "pores"
[fluid]
viscosity = 1.0
[domain]
shape = "cell"
vectors = [[8.0, 0.0], [0.0, 8.0]]
shear = 2.0
[[bodies]]
name = "carried"
radius = 1.0
position = [2.0, 2.0]
[[bodies]]
name = "ahead"
radius = 1.0
position = [5.0, 6.0]
[time]
end = 1.0
[output]
interval = 0.5
fields = false
"""
GLUEY_DOMAIN = "[domain]\nlower = [0.0, 0.0]\nupper = [8.0, 8.0]\n"
SIZE, TIMES = 300, (0.0, 0.2, 0.5, 1.0)


@pytest.fixture
def run(tmp_path: Path) -> Run:
    """Of two discs the first moves with the mean flow (2 y, 0), the other 3 and -4 faster."""
    (tmp_path / "case.toml").write_text(CASE)
    steps, bodies = ["step,t"], ["step,t,body,x,y,angle,V_x,V_y,omega"]
    for step, t in enumerate(TIMES):
        steps.append(f"{step},{t}")
        bodies += [
            f"{step},{t},carried,2.0,2.0,0.0,4.0,0.0,0.0",
            f"{step},{t},ahead,5.0,6.0,0.0,15.0,-4.0,0.0",
        ]
    (tmp_path / "steps.csv").write_text("\n".join([*steps, ""]))
    (tmp_path / "bodies.csv").write_text("\n".join([*bodies, ""]))
    return open_run(tmp_path)


def painter(run: Run) -> MotionArtist:
    found = artist(run, Choice(field=MOTION))
    assert isinstance(found, MotionArtist)
    return found


@pytest.mark.usefixtures("drawing")
def test_bodies_have_the_colour_of_how_much_faster_than_the_flow_they_are(run: Run, tmp_path: Path) -> None:
    picture = imread(render_run(run, tmp_path / "bodies.png", Choice(field=MOTION, size=SIZE)))
    # Its window is 9.6 wide around the middle (4, 4) of the cell; the panel stands at (0.03, 0.14) widths.
    places = [((x + 0.8) / 9.6 + 0.03, (8.8 - y) / 9.6 + 0.14) for x, y in ((2, 2), (5, 6), (5, 2))]
    seen = [picture[round(down * SIZE), round(across * SIZE), :3] for across, down in places]
    expected = [(0.987, 0.991, 0.750), (0.001, 0.0005, 0.014), (1.0, 1.0, 1.0)]  # ends of magma; the page
    np.testing.assert_allclose(seen, expected, atol=0.02)


def test_speeds_are_those_less_the_mean_flow(run: Run) -> None:
    np.testing.assert_allclose(painter(run)._moving(2).speed, [0.0, 5.0], atol=1e-12)  # 3, -4


def test_a_film_keeps_to_the_interval_and_needs_no_fields(run: Run) -> None:
    assert painter(run).film == [0, 2, 3]
    assert painter(run).step(1) == 1
    assert painter(run).step(None) == 3


def test_what_has_no_such_picture_is_refused(run: Run, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="--gap carried,ahead: --field motion shows all bodies"):
        artist(run, Choice(field=MOTION, gap="carried,ahead"))
    with pytest.raises(InputError, match="--step 9: give one from 0 to 3"):
        render_run(run, tmp_path / "bodies.png", Choice(field=MOTION), step=9)
    gluey = (
        CASE.replace("pores", "gluey")
        .replace("[fluid]\nviscosity = 1.0", "")
        .replace("[time]", "[time]\nstep = 0.1")
    )
    gluey = gluey[: gluey.index("[domain]")] + GLUEY_DOMAIN + gluey[gluey.index("[[bodies]]") :]
    (tmp_path / "case.toml").write_text(gluey)
    with pytest.raises(InputError, match="--field motion: is for bodies in a viscous fluid in the plane"):
        artist(open_run(tmp_path), Choice(field=MOTION))
