"""Pictures of flow in space."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread

import fsi
from fsi.errors import InputError
from fsi.postprocess.render.render import render_run
from fsi.postprocess.render.view import Choice
from tests.postprocess.spatial_run import write_spatial_run


@pytest.mark.usefixtures("drawing")
def test_picture_shows_the_ball(tmp_path: Path) -> None:
    run = fsi.open_run(write_spatial_run(tmp_path))
    picture = imread(render_run(run, tmp_path / "a.png", Choice(size=200)))
    panel = picture[28:228, 6:206, :3]
    beige = np.ptp(panel, axis=2) < 0.2  # the plane is in saturated colours
    # The window is 2.2 times 1.1 diameters wide; the ball's outline is the front half and the cut.
    assert beige.mean() == pytest.approx(np.pi / 4.0 / 2.42**2, rel=0.1)
    with pytest.raises(InputError, match="--field mesh: give one of speed, pressure"):
        render_run(run, tmp_path / "a.png", Choice("mesh", size=200))
