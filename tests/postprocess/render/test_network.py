"""Pictures of runs without a flow: bodies, contacts and walls where they are."""

from pathlib import Path

import meshio
import numpy as np
import pytest
from matplotlib.image import imread
from numpy.typing import NDArray

import fsi
from fsi.bodies.configuration import Configuration
from fsi.errors import InputError
from fsi.meshes.geometry.cell import Cell
from fsi.postprocess.render import network, picture
from fsi.postprocess.render.network import ContactNetwork, NetworkArtist, _lines
from fsi.postprocess.render.picture import Framed
from fsi.postprocess.render.render import render_run
from fsi.postprocess.render.scenes import images
from fsi.postprocess.render.view import Choice, around_period

GLUEY = """
name = "pile"
model = "gluey"
[domain]
lower = [-9.0, -9.0]
upper = [9.0, 9.0]
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


CHANNEL = """
name = "channel"
model = "reduced"
fluid.viscosity = 1.0
reduced.law = "exact"
reduced.cutoff = 1.5
reduced.drag = 1.0
[domain]
lower = [0.0, 0.0]
upper = [8.0, 4.0]
periodic = ["x"]
walls.top = [1.0, 0.0]
[[bodies]]
name = "a"
radius = 1.0
position = [1.1, 2.0]
[[bodies]]
name = "b"
radius = 1.0
position = [6.9, 2.0]
[time]
end = 1.0
"""
CELL = Cell(((6.0, 0.0), (0.0, 3.0)), ((0.0, 1.0), (0.0, 0.0)), 0.7)


def write_step(folder: Path, case: str, x: NDArray[np.float64], mesh: meshio.Mesh) -> Path:
    """A run with one step: bodies a and b of radius 1 at x, (2, 2), and lines."""
    (folder / "fields").mkdir()
    (folder / "case.toml").write_text(case)
    at = np.column_stack([x, np.zeros(2)])
    points = meshio.Mesh(at, [("vertex", np.arange(2)[:, None])], point_data={"radius": np.ones(2)})
    for series, grid in (("bodies", points), ("contacts", mesh)):
        grid.write(folder / "fields" / f"{series}_000000.vtu", file_format="vtu")
        entry = f'<DataSet timestep="0.0" part="0" file="fields/{series}_000000.vtu"/>'
        (folder / f"{series}.pvd").write_text(f"<VTKFile><Collection>{entry}</Collection></VTKFile>")
    rows = [f"0,0.0,{name},{at[0]},{at[1]},0.0" for name, at in zip("ab", x.tolist(), strict=True)]
    (folder / "bodies.csv").write_text("\n".join(["step,t,body,x,y,angle", *rows, ""]))
    (folder / "steps.csv").write_text("step,t\n0,0.0\n")
    return folder


@pytest.fixture
def pile(tmp_path: Path) -> Path:
    """Two touching discs of radius 1 on a plane; one contact is strong, one weak."""
    x = np.array([[-1.0, 0.0], [1.0, 0.0]])
    ends = np.array([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, -1.0, 0.0]])
    lines = meshio.Mesh(
        ends, [("line", np.array([[0, 1], [2, 3]]))], cell_data={"gamma": [np.array([STRONG, -0.1])]}
    )
    return write_step(tmp_path, GLUEY, x, lines)


@pytest.fixture
def channel(tmp_path: Path) -> Path:
    """Two discs that touch across the end of a period of 8, the stored places of one two periods away."""
    x = np.array([[17.0, 2.0], [7.0, 2.0]])
    ends = np.array([[7.0, 2.0, 0.0], [9.0, 2.0, 0.0]])
    values = {name: [np.array([-1.0])] for name in ("force", "gamma")}
    return write_step(
        tmp_path, CHANNEL, x, meshio.Mesh(ends, [("line", np.array([[0, 1]]))], cell_data=values)
    )


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


@pytest.mark.usefixtures("drawing")
def test_a_contact_across_the_period_reaches_both_bodies(channel: Path) -> None:
    """One period, 8 wide, 1.14 times 4 high, from wall to wall: each end has half of the bar and a disc."""
    picture = imread(render_run(fsi.open_run(channel), channel / "a.png", Choice(size=SIZE)))
    high, unit = round(0.57 * SIZE), SIZE / 8.0
    panel = picture[56 : 56 + high, 12 : 12 + SIZE, :3]
    dark = panel.max(axis=2) < 60.0 / 255.0
    row = np.flatnonzero(dark[high // 2, 3:-3]) + 3
    assert row[row < SIZE // 2].max() == pytest.approx(unit, abs=3)  # to the centre at x = 1
    assert row[row > SIZE // 2].min() == pytest.approx(7.0 * unit, abs=3)
    assert len(row) == pytest.approx(2.0 * unit, abs=8)
    bar = 0.5 * 0.15 * 4.0 * 2.0  # half of 0.15 half windows wide, 2 long
    rims = 4.0 * np.pi * 8.0 / SIZE
    assert share(panel, BODY) == pytest.approx((2.0 * np.pi - bar - rims) / (8.0 * 4.56), rel=0.05)
    # The wall above moves: three arrows in its middle, 0.4 half windows long, and none in that below.
    wall = round(0.28 * unit)
    ink = dark[wall // 2 - 1 : wall // 2 + 2, 3:-3]
    assert ink.any(axis=0).mean() == pytest.approx(3.0 * 0.4 / 2.0, abs=0.05)
    assert not dark[2 : wall // 2 - 5, 3:-3].any()  # nothing of them is cut off
    assert not dark[high - wall + 1 : high - 3, 3:-3].any()


def test_lines_and_bodies_have_the_same_images_in_a_sheared_cell() -> None:
    """Of a line from body to body each end in the window lies on an image of its body, and none lacks one."""
    e = CELL.periods
    x = np.array([[1.0, 1.0], [2.5, 1.5]])
    stored = np.array([x[0] + 3.0 * e[0], x[1]])
    ends = np.array([[stored[1], x[0] + e[1] - x[1] + stored[1]]])
    view = around_period(CELL)
    q = Configuration.unturned(stored, np.array([0.5, 0.4]))
    one = ContactNetwork(q, np.pad(ends, ((0, 0), (0, 0), (0, 1))), np.ones(1))
    shown, values = _lines(one, CELL, view)
    bodies, which = images(q, CELL, view)
    assert len(values) == len(np.unique(np.round(shown, 9), axis=0)) == len(shown)
    for side, body in ((0, 1), (1, 0)):
        at = {tuple(place) for place in np.round(shown[:, side, :2], 9).tolist()}
        centres = bodies.centres[which == body]
        inside = np.all(np.abs(centres - view.centre) < view.half, axis=1)
        assert at >= {tuple(place) for place in np.round(centres[inside], 9).tolist()}


def test_walls_of_a_gluey_case(pile: Path) -> None:
    """The sides of the cell across its periods' direction, and a plane."""
    periodic = GLUEY.replace("upper = [9.0, 9.0]", 'upper = [9.0, 9.0]\nperiodic = ["y"]')
    (pile / "case.toml").write_text(periodic)
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


@pytest.mark.parametrize(
    ("name", "values", "title"),
    [
        ("force", [-1.0, 2.0], "force (+ pulls, - pushes)"),
        ("force", [-1.0, -2.0], "-force (- pulls, + pushes)"),
        ("gamma", [-1.0, -2.0], "-gamma (+ remembers a push)"),
        ("impulse", [1.0, 2.0], "impulse (+ pushes, - pulls)"),
        ("solid", [1.0, 2.0], "solid (+ pushes)"),
        ("gap", [1.0, 2.0], "gap"),
    ],
)
def test_titles_say_what_signs_mean(
    name: str, values: list[float], title: str, pile: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The force of a gap is that on its opening, the impulse of a contact against its closing."""
    blank = np.zeros((50, 100, 3), dtype=np.uint8)
    monkeypatch.setattr(NetworkArtist, "_plane", lambda *_: blank)
    monkeypatch.setattr(network, "compose", lambda _, panels, __: panels)
    path = pile / "fields" / "contacts_000000.vtu"
    lines = meshio.read(path)
    meshio.Mesh(lines.points, lines.cells, cell_data={name: [np.array(values)]}).write(path)
    (framed,) = NetworkArtist(fsi.open_run(pile), Choice(name)).pictures([0])
    assert [panel.title for panel in framed] == [f"contacts, width and colour by {title}"]


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
