"""Pictures of runs without a flow: bodies, contacts and walls where they are."""

from pathlib import Path

import meshio
import numpy as np
import pytest
from matplotlib.image import imread
from numpy.typing import NDArray

import fsi
from fsi.errors import InputError
from fsi.postprocess.render import network, picture
from fsi.postprocess.render.network import NetworkArtist
from fsi.postprocess.render.picture import Framed
from fsi.postprocess.render.render import render_run
from fsi.postprocess.render.view import Choice

GLUEY = """
name = "pile"
model = "gluey"
[domain]
lower = [-9.0, -9.0]
upper = [9.0, 9.0]
periodic = ["y"]
[[gluey.walls]]
name = "plane"
point = [0.0, -1.0]
normal = [0.0, 2.0]
[[bodies]]
name = "a"
radius = 1.0
position = [-1.0, 0.0]
[[bodies]]
name = "b"
radius = 1.0
position = [1.0, 0.0]
[time]
end = 1.0
step = 0.1
"""
BODY, WALL = (0xF3, 0xEF, 0xE6), (0xC9, 0xC9, 0xC9)
STRONG, SIZE = -4.0, 400


@pytest.fixture
def pile(tmp_path: Path) -> Path:
    """Two touching discs of radius 1 on a plane; one contact is strong, one weak."""
    (tmp_path / "fields").mkdir()
    (tmp_path / "case.toml").write_text(GLUEY)
    x = np.array([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    points = meshio.Mesh(x, [("vertex", np.arange(2)[:, None])], point_data={"radius": np.ones(2)})
    ends = np.concatenate([x, [[1.0, 0.0, 0.0], [1.0, -1.0, 0.0]]])
    lines = meshio.Mesh(
        ends, [("line", np.array([[0, 2], [1, 3]]))], cell_data={"gamma": [np.array([STRONG, -0.1])]}
    )
    for series, mesh in (("bodies", points), ("contacts", lines)):
        mesh.write(tmp_path / "fields" / f"{series}_000000.vtu", file_format="vtu")
        entry = f'<DataSet timestep="0.0" part="0" file="fields/{series}_000000.vtu"/>'
        (tmp_path / f"{series}.pvd").write_text(f"<VTKFile><Collection>{entry}</Collection></VTKFile>")
    (tmp_path / "bodies.csv").write_text("step,t,body,x,y\n0,0.0,a,-1.0,0.0\n0,0.0,b,1.0,0.0\n")
    return tmp_path


def share(picture: NDArray[np.float32], colour: tuple[int, int, int]) -> float:
    return float(np.mean(np.all(np.abs(picture[..., :3] * 255.0 - colour) <= 2.0, axis=2)))


@pytest.mark.usefixtures("drawing")
def test_discs_wall_and_contacts_cover_what_they_should(pile: Path) -> None:
    picture = imread(render_run(fsi.open_run(pile), pile / "a.png", Choice(size=SIZE)))
    high = SIZE // 2
    panel = picture[56 : 56 + high, 12 : 12 + SIZE]
    wide = 4.4  # four radii and a tenth; the window is half as high
    # The strong bar is 2 long and half of 0.15 half windows wide; rims of the discs are a pixel wide.
    bar = 0.5 * 0.15 * 0.5 * wide
    rims = 4.0 * np.pi * wide / SIZE
    assert share(panel, BODY) == pytest.approx((2.0 * np.pi - 2.0 * bar - rims) / (0.5 * wide**2), rel=0.03)
    # The window has been raised until a twentieth of it lies below the plane.
    assert share(panel, WALL) == pytest.approx(0.05, abs=0.012)
    middle = (panel[:, SIZE // 2 - 3 : SIZE // 2 + 3, :3] * 255.0).min(axis=(1, 2))
    assert (middle < 60.0).sum() == pytest.approx(bar / wide * SIZE, abs=4)


def test_walls_of_a_gluey_case(pile: Path) -> None:
    """The sides of the cell across its periods' direction, and a plane."""
    found = fsi.open_run(pile).wall_distances(np.array([[1.0, 0.5]]))
    np.testing.assert_allclose(found, [[10.0, 8.0, 1.5]])


@pytest.mark.parametrize(
    ("choice", "message"),
    [
        (Choice("speed"), "--field speed: give one of gamma"),
        (Choice(gap="a,b"), "--gap a,b: there is no flow in this run"),
    ],
)
def test_impossible_choices(pile: Path, choice: Choice, message: str) -> None:
    with pytest.raises(InputError, match=message):
        NetworkArtist(fsi.open_run(pile), choice)


def test_contacts_that_are_none_are_refused(pile: Path) -> None:
    """The series of bodies in place of that of contacts has no force and no memory to show."""
    (pile / "contacts.pvd").write_text((pile / "bodies.pvd").read_text())
    with pytest.raises(InputError, match=r"its series contacts has no force or gamma; .*run the case again"):
        NetworkArtist(fsi.open_run(pile), Choice())


@pytest.mark.usefixtures("drawing")
def test_without_contacts_nothing_has_a_colour(pile: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A bar from 0 to 1 would be of no number in the run."""
    framed: list[Framed] = []

    def compose(_: str, panels: list[Framed], __: object) -> NDArray[np.uint8]:
        framed.extend(panels)
        return picture.compose("", panels)

    path = pile / "fields" / "contacts_000000.vtu"
    empty = {"line": np.empty((0, 2), dtype=int)}, {"gamma": [np.empty(0)]}
    meshio.Mesh(np.zeros((1, 3)), empty[0], cell_data=empty[1]).write(path, file_format="vtu")
    monkeypatch.setattr(network, "compose", compose)
    render_run(fsi.open_run(pile), pile / "a.png", Choice(size=SIZE))
    assert [(panel.shades, panel.title) for panel in framed] == [(None, "no contacts")]
