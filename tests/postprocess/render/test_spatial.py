"""Pictures of flow in space."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
import pyvista as pv
from matplotlib.image import imread
from numpy.typing import NDArray

import fsi
from fsi.errors import InputError
from fsi.postprocess.plots.figure import Theme
from fsi.postprocess.render import cut, spatial
from fsi.postprocess.render.canvas import Picture
from fsi.postprocess.render.cut import Cut, cut_cells
from fsi.postprocess.render.picture import Framed
from fsi.postprocess.render.render import render_run
from fsi.postprocess.render.spatial import SpatialArtist
from fsi.postprocess.render.view import Choice
from tests.postprocess.spatial_run import write_spatial_run


@pytest.mark.usefixtures("drawing")
def test_picture_shows_the_ball(tmp_path: Path) -> None:
    run = fsi.open_run(write_spatial_run(tmp_path))
    picture = imread(render_run(run, tmp_path / "a.png", Choice(size=200)))
    panel = picture[28:228, 6:206, :3]
    beige = np.ptp(panel, axis=2) < 0.2  # the plane is in saturated colours
    # The window is 2.2 times 1.1 diameters wide.
    assert beige.mean() == pytest.approx(np.pi / 4.0 / 2.42**2, rel=0.1)


def drawn(folder: Path, choice: Choice) -> NDArray[np.float32]:
    """The panel of a plane."""
    picture = imread(render_run(fsi.open_run(folder), folder / "a.png", choice))
    return np.asarray(picture[28:228, 6:206, :3])


@pytest.mark.slow
@pytest.mark.usefixtures("drawing")
def test_a_plane_of_ones_choice(tmp_path: Path) -> None:
    """At a distance of 0.3 from its centre the ball of radius 0.5 is cut in a disc of radius 0.4."""
    write_spatial_run(tmp_path)
    planes = ("x=0.3", "y=-0.3", "z=0.3")
    panels = [drawn(tmp_path, Choice("pressure", plane=at, span=(-1.0, 1.0), size=200)) for at in planes]
    for plane, panel in zip(planes, panels, strict=True):
        body = np.all(np.abs(panel * 255.0 - (0xF3, 0xEF, 0xE6)) <= 2.0, axis=2)
        assert body.mean() == pytest.approx(0.64 * np.pi / 4.0 / 2.42**2, rel=0.06), plane
    # The pressure is x: on z = 0.3 it grows to the right, on x = 0.3 it is the same everywhere.
    same, _, right = panels
    assert (right[90:110, 180:190].mean(axis=(0, 1)) - right[90:110, 10:20].mean(axis=(0, 1)))[0] > 0.3
    assert np.ptp(same[5:15, 5:195], axis=(0, 1)).max() < 0.1


@pytest.mark.usefixtures("drawing")
def test_only_the_plane_of_a_panel_is_outlined(tmp_path: Path) -> None:
    """In orange among the spheres; with their traction alone the outline had nothing to tell of."""
    write_spatial_run(tmp_path)
    ball = pv.Icosphere(radius=0.5, nsub=2).cast_to_unstructured_grid()
    ball["traction"] = 1.0 + ball.points
    ball.save(tmp_path / "fields" / "surface_000000.vtu")
    text = (tmp_path / "fluid.pvd").read_text()
    (tmp_path / "surface.pvd").write_text(text.replace("fluid_", "surface_"))
    for field, outlined in ((None, True), ("traction", False)):
        coloured = np.ptp(drawn(tmp_path, Choice(field, size=200)), axis=2) > 0.1
        coloured[65:135, 65:135] = False  # the ball
        assert (coloured.sum() > 200) == outlined


@pytest.mark.slow
@pytest.mark.usefixtures("drawing")
def test_the_sides_of_cells_are_seen_on_a_plane(tmp_path: Path) -> None:
    write_spatial_run(tmp_path)
    plane = Cut(np.zeros(3), 1.0, np.array([1.0, 0.0, 0.0]))
    lines = cut_cells(fsi.open_run(tmp_path), 0, plane)
    x = np.asarray(lines.points)
    assert lines.n_cells > 10
    # They end at the walls, and lie on the plane.
    np.testing.assert_allclose(
        [x[:, 0].min(), x[:, 0].max(), np.abs(x[:, 2]).max()], [-2.0, 2.0, 0.0], atol=1e-6
    )
    plain, mesh = (
        drawn(tmp_path, Choice(name, span=(-20.0, 20.0), size=200)) for name in ("pressure", "mesh")
    )
    assert (
        np.abs(np.diff(mesh.sum(axis=2), axis=1)).mean()
        > 1.5 * np.abs(np.diff(plain.sum(axis=2), axis=1)).mean()
    )


@pytest.mark.usefixtures("drawing")
@pytest.mark.parametrize(
    ("plane", "label"),
    [
        ("x=0", r"$\partial_y u_z - \partial_z u_y$"),
        ("y=0", r"$\partial_x u_z - \partial_z u_x$"),
        ("z=0", r"$\partial_x u_y - \partial_y u_x$"),
    ],
)
def test_the_colour_bar_names_the_vorticity_across_the_plane(
    plane: str, label: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By the definition of the curl; seen from where the letters grow to the right and upwards."""
    labels: list[str] = []

    def composing(_: str, panels: Sequence[Framed], __: Theme) -> Picture:
        labels.extend(panel.label for panel in panels)
        return panels[0].image

    monkeypatch.setattr(spatial, "compose", composing)
    monkeypatch.setattr(cut, "_POINTS", 11)  # for speed
    run = fsi.open_run(write_spatial_run(tmp_path))
    list(SpatialArtist(run, Choice("vorticity", plane=plane, size=100)).pictures([0]))
    assert labels == [label]


@pytest.mark.parametrize(
    ("choice", "message"),
    [
        (Choice(plane="y"), "--plane y: give x=, y= or z= and a number"),
        (Choice(plane="r=1"), "--plane r=1: give x=, y= or z= and a number"),
        (Choice(plane="z=9"), "--plane z=9: misses what is shown; give z from -1.21 to 1.21"),
        (Choice(gap="ball,bottom", plane="z=0"), "give --gap or --plane, not both"),
        (Choice("traction", plane="z=0"), "--plane z=0: traction is seen on whole bodies; drop it"),
        (Choice("traction"), "--field traction: is seen on whole spheres of runs with fields"),
    ],
)
@pytest.mark.usefixtures("drawing")
def test_impossible_planes(choice: Choice, message: str, tmp_path: Path) -> None:
    write_spatial_run(tmp_path)
    with pytest.raises(InputError, match=message):
        render_run(fsi.open_run(tmp_path), tmp_path / "a.png", choice)
