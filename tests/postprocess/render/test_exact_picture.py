"""An exact flow, in whose picture the colour of a pixel is the value there; what is written around it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest
import pyvista as pv
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from numpy.typing import NDArray

import fsi
from fsi.bodies.configuration import Configuration
from fsi.postprocess.plots.figure import Theme
from fsi.postprocess.render import planar
from fsi.postprocess.render.canvas import new_panel
from fsi.postprocess.render.picture import Framed, _frame, compose
from fsi.postprocess.render.planar import PlanarArtist
from fsi.postprocess.render.scales import Signed
from fsi.postprocess.render.view import Choice, View

SIZE, SIDE, VISCOSITY = 200, 2.0, 3.0
CASE = f"""
name = "shear"
fluid.viscosity = {VISCOSITY}
domain.lower = [0.0, 0.0]
domain.upper = [{SIDE}, {SIDE}]
domain.walls.top = [{SIDE}, 0.0]
"""
SQUARES = 8
TIMES = {0: 0.0, 3: 0.25, 5: 0.5}


@pytest.fixture
def shear(tmp_path: Path) -> fsi.Run:
    """u = y e_x in a box of 2 by 2 on quadratic cells, p = x - 1, at three times of output."""
    (tmp_path / "fields").mkdir()
    (tmp_path / "case.toml").write_text(CASE)
    n = 2 * SQUARES + 1
    y, x = (
        index.ravel() * SIDE / (n - 1) for index in np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    )
    i, j = (2 * index.ravel() for index in np.meshgrid(np.arange(SQUARES), np.arange(SQUARES)))
    lower = [(0, 0), (2, 0), (0, 2), (1, 0), (1, 1), (0, 1)]  # corners, then the middles of 01, 12, 20
    upper = [(2, 2), (0, 2), (2, 0), (1, 2), (1, 1), (2, 1)]
    cells = [[(j + b) * n + i + a for a, b in triangle] for triangle in (lower, upper)]
    connected = np.concatenate([np.column_stack(triangle) for triangle in cells])
    grid = pv.UnstructuredGrid(
        {pv.CellType.LAGRANGE_TRIANGLE: connected}, np.column_stack([x, y, np.zeros(n * n)])
    )
    grid.point_data["velocity"] = np.column_stack([y, 0.0 * y, 0.0 * y])
    grid.point_data["pressure"] = x - 1.0
    grid.point_data["vorticity"] = np.full(n * n, -1.0)
    grid.point_data["strain_rate"] = np.ones(n * n)
    entries = []
    for step, t in TIMES.items():
        grid.save(tmp_path / "fields" / f"fluid_{step:06d}.vtu")
        entries.append(f'<DataSet timestep="{t!r}" part="0" file="fields/fluid_{step:06d}.vtu"/>')
    text = f"<VTKFile><Collection>{''.join(entries)}</Collection></VTKFile>"
    (tmp_path / "fluid.pvd").write_text(text)
    return fsi.open_run(tmp_path)


def panel(run: fsi.Run, choice: Choice) -> NDArray[np.float64]:
    """The pixels of the only panel, from the bottom upwards, in 0 to 1."""
    (picture,) = PlanarArtist(run, choice).pictures([3])
    return np.asarray(picture[28 : 28 + SIZE, 6 : 6 + SIZE][::-1] / 255.0)


def colours(name: str, parts: Any) -> NDArray[np.float64]:
    return np.asarray(mpl.colormaps[name](parts))[..., :3]


PLACES = (np.arange(SIZE) + 0.5) * SIDE / SIZE


@pytest.mark.usefixtures("drawing")
def test_colours_and_streamlines_of_the_speed_are_where_they_should_be(shear: fsi.Run) -> None:
    """|u| = y in colours from what 95 % of the area exceed to what 1e-4 of it do, and 24 lines of y^2/2.

    On cells of height 1/4, whose middles lie 1/12 above the bottom and below the top. Lines of equal flux
    between them stand at y^2/2 = 2 k/25.
    """
    found = panel(shear, Choice("speed", size=SIZE))
    span = 1.0 / 12.0, SIDE - 1.0 / 12.0
    expected = colours("viridis", np.clip(LogNorm(*span)(PLACES), 0.0, 1.0))
    lines = np.sqrt(2.0 * SIDE**2 / 2.0 * np.arange(1, 25) / 25.0)
    away = np.abs(PLACES[:, None] - lines).min(axis=1) * SIZE / SIDE  # in pixels
    rows = found[:, 10:-10]
    # Colours are linear on triangles of 12 pixels, too coarse for a logarithm where y is that small.
    clear = (away > 2.5) & (PLACES > 0.12) & (PLACES < SIDE - 0.02)
    assert clear.sum() > 60
    off = np.abs(rows[clear] - expected[clear, None]).max(axis=(1, 2))
    assert off.max() < 0.03  # a hundredth of the value is 0.004
    on_lines = np.abs(PLACES[:, None] - lines[:12]).argmin(axis=0)
    brighter = rows[on_lines].mean(axis=1) - expected[on_lines]
    assert brighter.mean(axis=1).min() > 0.1


@pytest.mark.usefixtures("drawing")
@pytest.mark.parametrize(
    ("field", "span", "colour_map", "parts"),
    [
        ("pressure", (-1.0, 1.0), "RdBu_r", 0.5 * PLACES),
        ("dissipation", (0.3, 30.0), "magma", np.full(SIZE, 0.5)),  # mu gamma^2 = 3
        ("vorticity", (-1.0, 1.0), "PuOr_r", np.zeros(SIZE)),
    ],
)
def test_colours_of_the_other_fields(
    field: str, span: tuple[float, float], colour_map: str, parts: NDArray[np.float64], shear: fsi.Run
) -> None:
    """Along x, given the ends of the scale; but where triangles of 12 pixels hold a pressure of zero."""
    found = panel(shear, Choice(field, span=span, size=SIZE))
    off = np.abs(found[20:-20] - colours(colour_map, parts)).max(axis=(0, 2))
    from_middle = np.abs(PLACES - 1.0)
    assert off[(from_middle > 0.12) & (from_middle < 0.95)].max() < 0.03


@pytest.mark.usefixtures("drawing")
def test_lines_of_the_mesh_are_where_its_cells_end(shear: fsi.Run) -> None:
    """Every 25 pixels, seen in the lower part of a row of squares; the pressure is brighter to the right."""
    found = panel(shear, Choice("mesh", span=(-1.0, 1.0), size=SIZE))[106].max(axis=1)
    for k in range(25, SIZE, 25):
        assert found[k - 1 : k + 1].min() < 0.8 * min(found[k - 4], found[k + 4])
    assert found[190] > found[100] + 0.2 > found[10] + 0.4


def drawn_around(run: fsi.Run, steps: Sequence[int], choice: Choice, monkeypatch: Any) -> list[Any]:
    """Titles and panels that are composed to pictures."""
    composed: list[Any] = []

    def composing(title: str, panels: Sequence[Framed], theme: Theme) -> Any:
        composed.append((title, panels))
        return compose(title, panels, theme)

    monkeypatch.setattr(planar, "compose", composing)
    list(PlanarArtist(run, choice).pictures(steps))
    return composed


@pytest.mark.usefixtures("drawing")
def test_what_is_written_above_pictures_and_beside_them(
    shear: fsi.Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each output has its own time; the colour bar has the name and the range of what is drawn."""
    composed = drawn_around(shear, [0, 3, 5], Choice("speed", size=100), monkeypatch)
    assert [title for title, _ in composed] == ["shear,  t = 0", "shear,  t = 0.25", "shear,  t = 0.5"]
    for _, (only,) in composed:
        assert (only.title, only.label, only.half, only.cut) == ("speed and streamlines", "|u|", 1.0, "both")
        assert only.shades.get_clim() == pytest.approx((1.0 / 12.0, SIDE - 1.0 / 12.0))


def colour_bars(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """Those that are drawn from now on, one after the other."""
    bars: list[Any] = []
    drawing = Figure.colorbar

    def colorbar(figure: Figure, shades: Any, **more: Any) -> Any:
        bars.append(drawing(figure, shades, **more))
        return bars[-1]

    monkeypatch.setattr(Figure, "colorbar", colorbar)
    return bars


@pytest.mark.usefixtures("drawing")
def test_what_is_written_above_a_gap(run: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A disc 0.2 above a plane, in a window of 5 and one of twelve gaps; no labels of a bar meet."""
    bars = colour_bars(monkeypatch)
    ((title, panels),) = drawn_around(fsi.open_run(run), [2], Choice(size=100), monkeypatch)
    assert title == "analytic,  t = 2"
    assert [panel.title for panel in panels] == [
        "speed and streamlines",
        "narrowest gap, 0.2: pressure and mesh",
    ]
    assert [panel.half for panel in panels] == pytest.approx([2.5, 1.2])
    assert [bar.mappable for bar in bars] == [panel.shades for panel in panels]
    ((_, (only,)),) = drawn_around(
        fsi.open_run(run), [2], Choice("pressure", "disc,plane", size=100), monkeypatch
    )
    assert only.title == "gap disc - plane, 0.2: pressure"


@pytest.mark.parametrize("largest", [0.08, 2.5])
def test_a_signed_colour_bar_ends_where_its_colours_end(
    largest: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ticks beyond, as at 1 of colours to 0.08, would stretch it; powers of ten inside are labelled."""
    bars = colour_bars(monkeypatch)
    shades = mpl.cm.ScalarMappable(Signed().norm((-largest, largest), 0.03 * largest), "PuOr_r")
    compose("title", [Framed(np.zeros((100, 100, 3), np.uint8), "title", 1.0, "label", shades, "both")])
    (bar,) = bars
    assert bar.ax.get_ylim() == pytest.approx((-largest, largest))
    ticks = bar.get_ticks()
    assert np.abs(ticks).max() <= largest
    assert {0.0, largest, -largest} < set(ticks)


@pytest.mark.parametrize(
    ("norm", "ends"),
    [
        (Signed().norm((-8.0, 8.0), 0.2), ("\N{MINUS SIGN}8", "8")),
        (Signed().norm((-8.0, 8.0), 0.05), ("\N{MINUS SIGN}8", "8")),  # 0.01 is 0.03 from 0
        (LogNorm(0.5 + 1e-12, 1.0), ("0.5", "1")),  # one contact, whose push is 1
        (LogNorm(0.09004, 23.0 / 12.0), ("0.09", "1.92")),  # 0.1 would lie upon the end
        (LogNorm(2.999e-7, 30.0), ("3e\N{MINUS SIGN}07", "30")),
    ],
)
def test_the_ends_of_a_logarithmic_colour_bar_are_labelled(
    norm: Normalize, ends: tuple[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """With three digits, at its ends; labels are a letter apart. Colours to 8 had -1, 0 and 1 alone.

    Powers of ten inside have the minus sign of formulas; a hyphen stood at the end.
    """
    bars = colour_bars(monkeypatch)
    shades = mpl.cm.ScalarMappable(norm, "viridis")
    compose("title", [Framed(np.zeros((400, 400, 3), np.uint8), "title", 1.0, "label", shades, "both")])
    labels = sorted(bars[0].ax.get_yticklabels(), key=lambda label: label.get_position()[1])
    shown = [label.get_text() for label in labels]
    places = norm(np.array([label.get_position()[1] for label in labels]))
    assert (shown[0], shown[-1]) == ends
    np.testing.assert_allclose(places[[0, -1]], [0.0, 1.0], atol=1e-12)
    assert np.diff(places).min() > 0.04


@pytest.mark.parametrize(
    ("low", "high"), [(1000.0, 1000.02), (2e16, 2e16 * (1.0 + 2e-6)), (-4e-14, 0.0), (-0.0025, 0.0025)]
)
@pytest.mark.parametrize("norm", [Normalize, LogNorm])
def test_labels_of_a_colour_bar_have_room(
    norm: type[Normalize], low: float, high: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """They end inside the picture, say different numbers and the whole of these: no offset above the bar."""
    if norm is LogNorm and low <= 0.0:
        low, high = 1.00001, 1.00003
    bars = colour_bars(monkeypatch)
    shades = mpl.cm.ScalarMappable(norm(low, high), "viridis")
    compose("title", [Framed(np.zeros((400, 1000, 3), np.uint8), "title", 1.0, "p", shades)])
    (bar,) = bars
    shown = [label for label in bar.ax.get_yticklabels() if low <= label.get_position()[1] <= high]
    assert len(shown) >= 3
    assert len({label.get_text() for label in shown}) == len(shown)
    assert max(label.get_window_extent().x1 for label in shown) < bar.ax.figure.bbox.x1
    assert not bar.ax.yaxis.get_offset_text().get_text()


def test_the_scale_bar_is_as_long_as_it_says() -> None:
    """In a window 5 wide the longest round length up to a quarter of it is 1: a fifth of the panel."""
    axes = Figure().subplots()
    _frame(axes, Framed(np.zeros((1, 1, 3), np.uint8), "title", 2.5, "label", mpl.cm.ScalarMappable()))
    ends = np.asarray(axes.lines[0].get_xdata(), dtype=float)
    np.testing.assert_allclose(ends, [0.0, 0.2])
    assert [text.get_text() for text in axes.texts] == ["1"]


@pytest.mark.usefixtures("drawing")
def test_a_pointer_turns_with_its_disc() -> None:
    """Counterclockwise by a right angle from where it points to the right: upwards."""
    page = new_panel(View(np.zeros(2), 1.25), 400)
    page.bodies(Configuration(np.zeros((1, 2)), np.array([0.5 * np.pi]), np.ones(1)), turning=True)
    disc = page.image()[60:340, 60:340].max(axis=2)  # inside the rim
    dark = disc < 180
    assert dark[20:130, 138:142].any(axis=1).all()
    assert not dark[150:, 100:180].any()
    assert not dark[100:180, :130].any()
    assert not dark[100:180, 150:].any()
