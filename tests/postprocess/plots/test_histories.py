"""Histories as curves, and the laws that go with them."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text

import fsi
from fsi.case.load import parse_case
from fsi.errors import InputError
from fsi.postprocess.analysis.settling import asymptotic_gap, exact_gap
from fsi.postprocess.plots.figure import plain
from fsi.postprocess.plots.histories import plot_runs, read_history
from fsi.postprocess.plots.panels import PANELS, of_steps, register_panel
from tests.commands import fsi_command

Fill = Callable[[list[float], list[float]], Path]
BODY = {"name": "body", "radius": 0.5, "position": [0.0, 0.6], "force": [0.0, -3.0]}
IN_SPACE = BODY | {"position": [0.3, 0.0, 0.6], "force": [0.0, 0.0, -3.0]}


def filled(fill: Fill) -> Path:
    """The folder of a disc with its times and heights, and the table of its steps."""
    folder = fill([0.0, 1.0, 2.0], [1.2, 1.1, 1.01])
    (folder / "steps.csv").write_text("step,t,apparent_viscosity\n0,0.0,2.0\n1,1.0,2.5\n2,2.0,3.0\n")
    return folder


def test_curves_of_a_run(settling_run: Fill) -> None:
    history = read_history(fsi.open_run(filled(settling_run)))
    np.testing.assert_allclose(history.panels["gap"]["disc"], [0.2, 0.1, 0.01], rtol=1e-12)
    np.testing.assert_allclose(history.panels["load"]["disc"], 1.0)
    np.testing.assert_allclose(history.panels["apparent viscosity"][""], [2.0, 2.5, 3.0])
    assert history.laws["exact"][1][0] == pytest.approx(0.2, rel=1e-12)
    assert [*history.laws] == ["exact"]  # its asymptote is wide above that until t = 59.6


def test_chosen_gap_and_many_bodies(settling_run: Fill) -> None:
    run = fsi.open_run(filled(settling_run))
    far = read_history(run, "disc,far").panels["gap"]["gap disc,far"]
    np.testing.assert_allclose(far, 6.0 - np.array([1.2, 1.1, 1.01]) - 1.0, rtol=1e-12)
    summed = read_history(run, singly=0).panels["gap"]
    assert list(summed) == [f"{what} of 1 bodies" for what in ("smallest", "median", "largest")]


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("[time]", "slip_length = 0.1\n[time]"),
        ("domain.radius", "domain.walls.plane = {slip_length = 0.2}\ndomain.radius"),
        (
            "[time]",
            '[[forces]]\nkind = "gravity"\nacceleration = [0.0, -9.0]\ndensity_difference = 1.0\n[time]',
        ),
    ],
)
def test_no_curve_is_called_exact_where_the_law_does_not_hold(settling_run: Fill, old: str, new: str) -> None:
    """Slip on the body or on the plane, and a weight beside its force."""
    case = filled(settling_run) / "case.toml"
    assert "exact" in read_history(fsi.open_run(case.parent)).laws
    case.write_text(case.read_text().replace(old, new))
    history = read_history(fsi.open_run(case.parent))
    assert "gap" in history.panels
    assert history.laws == {}


@pytest.mark.parametrize(
    ("geometry", "late", "difference"),
    [("planar", 1e4, 2e-3), ("axisymmetric", 40.0, 1e-9), ("spatial", 40.0, 1e-9)],
)
def test_asymptote_is_that_of_the_exact_gap(geometry: str, late: float, difference: float) -> None:
    """Discs: a last term of order t^-1 is left; spheres: only the prefactor was fitted, the rate was not."""
    case = parse_case(
        {
            "name": "settling",
            "geometry": geometry,
            "fluid": {"viscosity": 0.7},
            "domain": {"shape": "half-plane", "radius": 100.0},
            "bodies": [IN_SPACE if geometry == "spatial" else BODY],
        }
    )
    t = np.array([0.9, 1.0]) * late
    np.testing.assert_allclose(asymptotic_gap(case, t), exact_gap(case, t), rtol=difference)


@pytest.mark.parametrize("suffix", [".png", ".svg", ".pdf"])
def test_files_by_suffix(settling_run: Fill, suffix: str) -> None:
    run = fsi.open_run(filled(settling_run))
    output = run.path / f"history{suffix}"
    plot_runs([run, run], output)
    begins = {".png": b"\x89PNG", ".svg": b"<?xml", ".pdf": b"%PDF"}
    assert output.read_bytes().startswith(begins[suffix])


def test_unknown_suffix(settling_run: Fill) -> None:
    run = fsi.open_run(filled(settling_run))
    with pytest.raises(InputError, match=r"history\.jpg: give the path of a \.png, \.svg or \.pdf file"):
        plot_runs([run], run.path / "history.jpg")


def test_a_panel_that_is_registered_is_drawn(settling_run: Fill, monkeypatch: pytest.MonkeyPatch) -> None:
    run = fsi.open_run(filled(settling_run))
    for title in ("twice", "none"):
        monkeypatch.setitem(PANELS, title, of_steps(title))  # taken out again at the end
    register_panel("twice", lambda asked: {"": 2.0 * asked.run.steps["apparent_viscosity"].to_numpy()})
    register_panel("none", of_steps("no_such_column"))
    panels = read_history(run).panels
    assert [*panels][-2:] == ["apparent viscosity", "twice"]
    np.testing.assert_allclose(panels["twice"][""], [4.0, 5.0, 6.0])
    plot_runs([run], run.path / "history.png")


def test_an_asymptote_begins_at_the_first_gap(
    settling_run: Fill, drawn: list[Figure], tmp_path: Path
) -> None:
    """It is (12 pi / t)^2 / 2, 0.2 at t = 59.6; at the run's own times it is 1.78 at 20, and sets the axis.

    Laws are as smooth as they are, whatever steps there were; so also beside another run.
    """
    folder = settling_run([0.0, 20.0, 60.0, 100.0], [1.2, 1.1, 1.06, 1.03])
    (folder / "steps.csv").write_text("step,t\n0,0.0\n1,20.0\n2,60.0\n3,100.0\n")
    run = fsi.open_run(folder)
    t, gap = read_history(run).laws["asymptote"]
    assert t[0] == pytest.approx(12.0 * np.pi / np.sqrt(0.4), abs=1.0)
    np.testing.assert_allclose(gap, 0.5 * (12.0 * np.pi / t) ** 2, rtol=1e-12)
    assert np.diff(t).max() < 0.6
    for runs in ([run], [run, run]):
        plot_runs(runs, tmp_path / "a.png")
        assert drawn[-1].axes[0].get_ylim()[1] < 0.22


def resting(fill: Fill, height: float, rows: int) -> fsi.Run:
    """A disc that stays at a height for so many rows."""
    folder = fill([0.1 * k for k in range(rows)], [height] * rows)
    steps = [f"{k},{0.1 * k}" for k in range(rows)]
    (folder / "steps.csv").write_text("\n".join(["step,t", *steps]) + "\n")
    return fsi.open_run(folder)


def test_an_axis_of_a_constant_goes_upwards(settling_run: Fill, drawn: list[Figure], tmp_path: Path) -> None:
    """A coordinate of -2 stands between -2.4 and 0, one of 2 between 0 and 2.4, a fifth beyond."""
    for y, ends in ((-2.0, (-2.4, 0.0)), (2.0, (0.0, 2.4))):
        plot_runs([resting(settling_run, y, 2)], tmp_path / "a.png", curves="y")
        assert drawn[-1].axes[0].get_ylim() == pytest.approx(ends)


@pytest.mark.parametrize(
    ("ends", "axis"),
    [((4.0, 4.0004), (3.9981998, 4.0022002)), ((1000.0, 1001.1), (999.945, 1001.155))],
)
def test_an_axis_of_what_hardly_changes(
    ends: tuple[float, ...],
    axis: tuple[float, float],
    settling_run: Fill,
    drawn: list[Figure],
    tmp_path: Path,
) -> None:
    """It is a thousandth of 4.0004 long at least, about 4.0002, not 4.4e-4, where noise looks like a trend.

    Beyond that it has room of a twentieth. Labels have all digits: "+1e3" stood beside times from 0 to 0.5.
    """
    folder = settling_run([1000.0, 1000.5], list(ends))
    (folder / "steps.csv").write_text("step,t\n0,1000.0\n1,1000.5\n")
    plot_runs([fsi.open_run(folder)], tmp_path / "a.png", curves="y")
    drawn[0].draw_without_rendering()
    axes = drawn[0].axes[0]
    assert axes.get_ylim() == pytest.approx(axis, rel=1e-9)
    for axis_of, places in ((axes.xaxis, axes.get_xticks()), (axes.yaxis, axes.get_yticks())):
        assert axis_of.get_offset_text().get_text() == ""
        labels = [float(label.get_text()) for label in axis_of.get_ticklabels()]
        np.testing.assert_allclose(labels, places, rtol=1e-12)


@pytest.mark.parametrize(("rows", "marker"), [(1, "o"), (20, "")])
def test_few_rows_have_marks(
    rows: int, marker: str, settling_run: Fill, drawn: list[Figure], tmp_path: Path
) -> None:
    """One row alone draws no line."""
    plot_runs([resting(settling_run, 1.2, rows)], tmp_path / "a.png")
    for axes in drawn[0].axes:
        assert {line.get_marker() for line in axes.lines if line.get_label() == "disc"} == {marker}


def write_pair(folder: Path, load: float, spin: float = 0.0, speed: float = 1.0) -> fsi.Run:
    """Body _a with a load of 38, _b with the given one; both with these speeds; two rows."""
    case = (
        'name = "$a_1$ and $"\nfluid.viscosity = 2.0\ndomain.lower = [0.0, 0.0]\ndomain.upper = [9.0, 9.0]\n'
    )
    bodies = [("_a", 2.0, 38.0), ("_b", 6.0, load)]
    for name, x, _ in bodies:
        case += f'[[bodies]]\nname = "{name}"\nradius = 1.0\nposition = [{x}, 2.0]\n'
    (folder / "case.toml").write_text(case)
    rows = [f"{n},{n}.0,{name},{x},2.0,0,{speed},0,{spin},{F},0,0" for n in range(2) for name, x, F in bodies]
    head = "step,t,body,x,y,angle,V_x,V_y,omega,F_x,F_y,T"
    (folder / "bodies.csv").write_text("\n".join([head, *rows]) + "\n")
    (folder / "steps.csv").write_text("step,t\n0,0.0\n1,1.0\n")
    return fsi.open_run(folder)


@pytest.mark.parametrize(("load", "shown"), [(3e-14, 0.0), (3e-3, 3e-3)])
def test_a_free_body_beside_a_held_one_has_no_load(tmp_path: Path, load: float, shown: float) -> None:
    """Rounding of 3e-14 beside 38 put an axis over 15 decades; 3e-3 is a load."""
    found = read_history(write_pair(tmp_path, load)).panels["load"]
    np.testing.assert_array_equal(found["_a"], 38.0)
    np.testing.assert_array_equal(found["_b"], shown)


def test_a_body_that_only_turns_has_no_load(tmp_path: Path) -> None:
    """Of a force that is 1e-8 of viscosity times radius times spin; without a spin it is drawn."""
    for spin, has in ((3e9, False), (0.0, True)):
        run = write_pair(tmp_path, 0.0, spin, speed=0.0)
        assert ("load" in read_history(run).panels) is has


def test_names_are_drawn_as_they_are(tmp_path: Path, drawn: list[Figure]) -> None:
    """Titles have their $, legends the bodies whose names begin with _."""
    plot_runs([write_pair(tmp_path, 1.0)], tmp_path / "a.png")
    assert drawn[0].axes[0].get_title(loc="left") == r"\$a_1\$ and \$"
    assert [text.get_text()[-2:] for text in drawn[0].legends[0].get_texts()] == ["_a", "_b"]


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("letters", [60, 120])
def test_long_names_leave_room_for_curves(letters: int, tmp_path: Path, drawn: list[Figure]) -> None:
    """Axes were 0.24 of the figure beside 60 letters, without any layout beside 120; titles ran into legends.

    A line of 30 letters, 0.085 inches each, is some 0.3 of 8.5 inches.
    """
    write_pair(tmp_path, 1.0)
    for file in (tmp_path / "case.toml", tmp_path / "bodies.csv"):
        file.write_text(file.read_text().replace("_b", "b" * letters).replace("$a_1$ and $", "name " * 12))
    plot_runs([fsi.open_run(tmp_path)], tmp_path / "a.png")
    (figure,) = drawn
    figure.draw_without_rendering()
    axes, (legend,) = figure.axes[0], figure.legends
    (title,) = axes.findobj(lambda artist: isinstance(artist, Text) and artist.get_text().count("name") > 1)
    assert axes.get_position().width > 0.4
    assert title.get_window_extent().x1 < legend.get_window_extent().x0
    assert legend.get_window_extent().x1 <= figure.bbox.x1


def test_runs_of_one_name_have_a_colour_each(tmp_path: Path, drawn: list[Figure]) -> None:
    """In the legend too; the folders here are one and the same."""
    (folder := tmp_path / "pair").mkdir()
    run = write_pair(folder, 1.0)
    plot_runs([run, run], tmp_path / "a.png")
    legend = drawn[0].legends[0]
    expected = [f"pair ({n}): {body}" for n in (1, 2) for body in ("_a", "_b")]
    assert [text.get_text() for text in legend.get_texts()] == [plain(label) for label in expected]
    colours = [line.get_color() for line in legend.get_lines()]
    assert colours[0] == colours[1] != colours[2] == colours[3]


@pytest.mark.parametrize("words", [(), ("--paths",)])
def test_a_folder_that_is_none_is_told_of_before_its_figure(
    words: tuple[str, ...], tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    assert fsi_command("plot", tmp_path / "nonexist", *words) == 2
    assert capfd.readouterr().err.startswith(f"error: run = {tmp_path / 'nonexist'}: there is no case.toml")
