"""Paths of bodies, and of one as another sees it."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

import fsi
from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.errors import InputError
from fsi.meshes.geometry.ellipsoid import Ellipsoid
from fsi.postprocess.plots.histories import plot_runs, read_history
from fsi.postprocess.plots.trajectories import (
    _outlines,
    paths,
    plot_paths,
    relative_path,
    space_time_figure,
)
from tests.commands import fsi_command

CASE = """
name = "pair"
fluid.viscosity = 1.0
domain.lower = [0.0, 0.0]
domain.upper = [10.0, 4.0]
domain.periodic = ["x"]
domain.walls.top = [1.0, 0.0]
[[bodies]]
name = "a"
radius = 1.0
position = [1.0, 1.5]
[[bodies]]
name = "b"
radius = 0.5
position = [9.5, 2.5]
[time]
end = 2.0
"""


@pytest.fixture
def run(tmp_path: Path) -> fsi.Run:
    """Body a rests; b goes 3 to the right, through the end of the period, and 1 up."""
    (tmp_path / "case.toml").write_text(CASE)
    rows = [
        f"{n},{n}.0,{body},{x},{y},{0.5 * n},0,0,0,0,0,0"
        for n in range(3)
        for body, x, y in (("a", 1.0, 1.5), ("b", 9.5 + 1.5 * n, 2.5 + 0.5 * n))
    ]
    head = "step,t,body,x,y,angle,V_x,V_y,omega,F_x,F_y,T"
    (tmp_path / "bodies.csv").write_text("\n".join([head, *rows]) + "\n")
    (tmp_path / "steps.csv").write_text("step,t\n0,0.0\n1,1.0\n2,2.0\n")
    return fsi.open_run(tmp_path)


def test_paths(run: fsi.Run) -> None:
    np.testing.assert_allclose(paths(run)[:, 1], [[9.5, 2.5], [11.0, 3.0], [12.5, 3.5]])


def test_a_body_is_followed_from_its_nearest_image_on(run: fsi.Run) -> None:
    """It begins at 9.5 - 10 - 1 = -1.5 from the other and passes over it, whatever image is nearest."""
    np.testing.assert_allclose(relative_path(run, "b, a"), [[-1.5, 1.0], [0.0, 1.5], [1.5, 2.0]])
    np.testing.assert_allclose(relative_path(run, "a,b"), [[1.5, -1.0], [0.0, -1.5], [-1.5, -2.0]])


def test_the_image_that_is_followed_moves_with_the_lattice(tmp_path: Path) -> None:
    """Two bodies that a shear flow carries are apart by e + t e_y: e = (0.2, -2.3), by the image 6 below."""
    cell = CASE.replace("domain.lower = [0.0, 0.0]", 'domain.shape = "cell"').replace(
        "domain.upper = [10.0, 4.0]", "domain.vectors = [[6.0, 0.0], [0.0, 6.0]]"
    )
    case = cell.replace('domain.periodic = ["x"]', "domain.shear = 1.0").replace(
        "domain.walls.top = [1.0, 0.0]\n", ""
    )
    (tmp_path / "case.toml").write_text(case)
    rows = [
        f"{n},{n}.0,{body},{x + n * y},{y},0,0,0,0,0,0,0"
        for n in range(3)
        for body, x, y in (("a", 3.0, 1.2), ("b", 3.2, 4.9))
    ]
    head = "step,t,body,x,y,angle,V_x,V_y,omega,F_x,F_y,T"
    (tmp_path / "bodies.csv").write_text("\n".join([head, *rows]) + "\n")
    (tmp_path / "steps.csv").write_text("step,t\n0,0.0\n1,1.0\n2,2.0\n")
    apart = relative_path(fsi.open_run(tmp_path), "b,a")
    np.testing.assert_allclose(apart, [[0.2, -2.3], [-2.1, -2.3], [-4.4, -2.3]], atol=1e-12)


def test_places_and_angles_over_time(run: fsi.Run) -> None:
    panels = read_history(run, curves="x, angle").panels
    assert [*panels] == ["x", "angle"]
    np.testing.assert_allclose(panels["x"]["b"], [9.5, 11.0, 12.5])
    np.testing.assert_allclose(panels["angle"]["a"], [0.0, 0.5, 1.0])
    assert [*read_history(run).panels] == ["gap", "speed"]


def test_a_shape_that_seems_to_turn_has_its_angle_drawn(run: fsi.Run) -> None:
    """Nothing else of an ellipse in shear moves; discs turn unseen, and 1e-6 radians are none."""
    case = run.path / "case.toml"
    case.write_text(CASE.replace("radius = 1.0", 'shape = { kind = "ellipse", axes = [1.0, 0.5] }'))
    angles = read_history(fsi.open_run(run.path)).panels["angle"]
    assert [*angles] == ["a"]
    np.testing.assert_allclose(angles["a"], [0.0, 0.5, 1.0])
    assert [*read_history(fsi.open_run(run.path), curves="angle").panels["angle"]] == ["a", "b"]
    table = run.path / "bodies.csv"
    table.write_text(table.read_text().replace("1.5,0.5,", "1.5,1e-6,").replace("1.5,1.0,", "1.5,2e-6,"))
    assert "angle" not in read_history(fsi.open_run(run.path)).panels


def test_a_body_looks_alike_in_all_panels(run: fsi.Run, drawn: list[Figure]) -> None:
    """Also where others are left out, as discs are of angles: b looked like a there.

    The gap of two looks like neither. An angle has no zero of its own: from 0.05 to 1.05 its axis is even.
    """
    case, table = run.path / "case.toml", run.path / "bodies.csv"
    case.write_text(CASE.replace("radius = 0.5", 'shape = { kind = "ellipse", axes = [0.5, 0.3] }'))
    rows = pd.read_csv(table)
    rows.assign(angle=rows["angle"] + 0.05).to_csv(table, index=False)
    plot_runs([fsi.open_run(run.path)], run.path / "a.png")
    gap, *_, angle = (
        {line.get_label(): (line.get_color(), line.get_linestyle()) for line in axes.lines}
        for axes in drawn[0].axes
    )
    assert [*angle] == ["b"]
    assert angle["b"] == gap["b"]
    assert all(a != b for a, b in zip(gap["a"], gap["b"], strict=True))
    assert drawn[0].axes[-1].get_yscale() == "linear"
    plot_runs([fsi.open_run(run.path)], run.path / "a.png", gap="a,b")
    (of_two,) = drawn[1].axes[0].lines
    assert of_two.get_color() not in (gap["a"][0], gap["b"][0])
    assert of_two.get_label() == "gap a,b"


def test_sheared_runs_are_drawn_over_strain_whatever_is_asked(run: fsi.Run, drawn: list[Figure]) -> None:
    """Walls 4 apart at speeds of 0 and 1: t / 4. The legend of two runs tells viscosities from gaps of a."""
    (run.path / "steps.csv").write_text("step,t,apparent_viscosity\n0,0.0,2.0\n1,1.0,2.5\n2,2.0,3.0\n")
    sheared = fsi.open_run(run.path)
    assert read_history(sheared, curves="gap,x").strain == pytest.approx([0.0, 0.25, 0.5], rel=1e-12)
    plot_runs([sheared, sheared], run.path / "a.png", curves="gap,apparent viscosity")
    assert drawn[0].axes[-1].get_xlabel() == "strain"
    shown = [text.get_text().replace("\n", " ") for text in drawn[0].legends[0].get_texts()]
    shown = [text.rpartition(" (")[2] for text in shown]
    viscosities = ["1): apparent viscosity", "2): apparent viscosity"]
    assert shown == ["1): a", "1): b", "2): a", "2): b", *viscosities]


def write_turning_sphere(folder: Path) -> Path:
    """A sphere in space that turns about x and z, beside the side of a box."""
    (folder / "case.toml").write_text(
        'name = "turning"\ngeometry = "spatial"\nfluid.viscosity = 1.0\ndomain.lower = [-3.0, -3.0, -3.0]\n'
        'domain.upper = [3.0, 3.0, 3.0]\n[[bodies]]\nname = "ball"\nradius = 1.0\n'
        "position = [0.0, 0.0, 0.0]\n[time]\nend = 2.0\n"
    )
    vectors = [f"{name}_{axis}" for name in ("angle", "V", "omega", "F", "T") for axis in "xyz"]
    head = ",".join(["step", "t", "body", *"xyz", *vectors])
    rows = [f"{n},{n}.0,ball,0,0,0,{0.5 * n},0,{-0.2 * n},0,0,0,0.5,0,-0.2,0,0,0,0,0,0" for n in range(3)]
    (folder / "bodies.csv").write_text("\n".join([head, *rows]) + "\n")
    (folder / "steps.csv").write_text("step,t\n0,0.0\n1,1.0\n2,2.0\n")
    return folder


def test_angles_in_space_have_three_components(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """Curves that the run has not are refused by name, alone and beside others, with those that it has."""
    folder = write_turning_sphere(tmp_path)
    panels = read_history(fsi.open_run(folder), curves="angle_x,angle_z").panels
    np.testing.assert_allclose(panels["angle_x"]["ball"], [0.0, 0.5, 1.0])
    np.testing.assert_allclose(panels["angle_z"]["ball"], [0.0, -0.2, -0.4])
    assert fsi_command("plot", folder, "--curves", "angle_x,angle_y,angle_z") == 0
    for curves in ("angle", "x,angle"):
        (tmp_path / "history.png").unlink(missing_ok=True)
        capfd.readouterr()
        assert fsi_command("plot", folder, "--curves", curves) == 2
        assert capfd.readouterr().err == (
            f"error: --curves {curves}: the run has no 'angle'; it has gap, speed, x, y, z, "
            "angle_x, angle_y, angle_z\n"
        )
        assert not (tmp_path / "history.png").exists()


def test_figures_and_refusals(run: fsi.Run, capfd: pytest.CaptureFixture[str]) -> None:
    plot_paths(run, run.path / "a.pdf", "b,a")
    assert (run.path / "a.pdf").read_bytes().startswith(b"%PDF")
    assert fsi_command("plot", run.path, "--paths") == 0
    assert (run.path / "paths.png").is_file()
    with pytest.raises(InputError, match="--relative b,c: give the names of two bodies of a, b"):
        relative_path(run, "b,c")
    for words, message in (
        (("--curves", "speeds"), "the run has no 'speeds'; it has gap, speed, x, y, angle\n"),
        (("--paths", "--gap", "a,b"), "draw one run, without --gap and --curves"),
        (("--paths", "-o", "a.jpg"), "a.jpg: give the path of a .png, .svg or .pdf file"),
    ):
        assert fsi_command("plot", run.path, *words) == 2
        assert message in capfd.readouterr().err


def test_discs_over_profiled_walls_have_paths(run: fsi.Run, drawn: list[Figure]) -> None:
    """Two circles for each of the two, at both ends."""
    wave = '{ kind = "wave", height = 0.1, length = 1.0, number = 2, start = 1.0 }'
    walls = CASE.replace('periodic = ["x"]', f"profiles.bottom = {wave}")
    walls = walls.replace("[0.0, 0.0]", "[-4.0, 0.0]").replace("10.0,", "14.0,")
    (run.path / "case.toml").write_text(walls)
    plot_paths(fsi.open_run(run.path), run.path / "a.png")
    centres = np.array([outline.mean(axis=0) for outline in outlines(drawn[0])])
    np.testing.assert_allclose(centres, [[1.0, 1.5], [1.0, 1.5], [9.5, 2.5], [12.5, 3.5]])
    around = [outline - centre for outline, centre in zip(outlines(drawn[0]), centres, strict=True)]
    np.testing.assert_allclose(np.hypot(*around[1].T), 1.0, rtol=1e-12)
    np.testing.assert_allclose(np.hypot(*around[3].T), 0.5, rtol=1e-12)
    assert len(around) == 4


def outlines(figure: Figure) -> list[Array]:
    """Of the bodies at both ends of their paths, (n, 2) each."""
    return [np.asarray(patch.get_path().vertices)[:-1] for patch in figure.axes[0].patches]


@pytest.mark.parametrize(("relative", "centre"), [(None, (1.0, 1.5)), ("b,a", (0.0, 0.0))])
def test_paths_of_shapes_have_their_outlines_as_they_are_turned(
    relative: str | None, centre: tuple[float, float], run: fsi.Run, drawn: list[Figure]
) -> None:
    """An ellipse turns from 0 to 1: (x/1)^2 + (y/0.5)^2 = 1 along its axes; unturned that is up to 3.1."""
    shapes = CASE.replace("radius = 1.0", 'shape = { kind = "ellipse", axes = [1.0, 0.5] }')
    (run.path / "case.toml").write_text(shapes)
    plot_paths(fsi.open_run(run.path), run.path / "a.png", relative)
    found = outlines(drawn[0])
    assert len(found) == 4
    for outline, angle in zip(found[:2] if relative is None else found[2:], (0.0, 1.0), strict=True):
        turned = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        x, y = turned @ (outline - centre).T
        np.testing.assert_allclose(x**2 + (y / 0.5) ** 2, 1.0, rtol=1e-9)


def test_an_ellipsoid_is_seen_as_it_reaches_along_x_and_z() -> None:
    """In a direction n it reaches |M^T n|, its outline that less (pi/200)^2/2 at most; cut through, less."""
    form, turn = Ellipsoid(np.array([1.0, 0.5, 0.3])), np.array([[0.4, 0.9, -0.5]])
    q = Configuration(np.zeros((1, 3)), turn, np.ones(1), ellipsoids=(form,))
    (outline,) = _outlines(q)
    for n in np.array([[1.0, 0.0], [0.0, 1.0], [0.6, 0.8]]):
        reach = np.linalg.norm(q.standing[0].axes.T @ [n[0], 0.0, n[1]])
        assert (outline @ n).max() == pytest.approx(reach, rel=2e-4)


@pytest.mark.parametrize(("gamma", "ends"), [(-4e-14, (-1.0, 1.0)), (-0.5, (-0.5, 0.0))])
def test_space_and_time_show_the_run_and_no_rounding(gamma: float, ends: tuple[float, float]) -> None:
    """Two profiles, at 0 and 0.2: cells around them reach from -0.1 to 0.3, the axis does not.

    A mass of 2 that moves by 1 makes memories of 2: 4e-14 is rounding then, about which colours span as much.
    """
    x = np.array([0.0, 1.0, 2.0])
    table = pd.DataFrame(
        {
            "step": np.repeat([0, 1], 3), "t": np.repeat([0.0, 0.2], 3), "x": np.tile(x, 2),
            "m": np.tile(x, 2), "rho": 1.0, "u": 1.0, "gamma": np.repeat([0.0, gamma], 3),
        }
    )  # fmt: skip
    run: Any = SimpleNamespace(table=lambda _: table, path=Path("run"))
    figure = space_time_figure(run, Figure())
    for axes in figure.axes[:3]:
        assert axes.get_ylim() == (0.0, 0.2)
    assert figure.axes[2].collections[0].get_clim() == pytest.approx(ends)
