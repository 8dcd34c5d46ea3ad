"""Fields that pictures show, and what their colours span: what pixels show, not films thinner than those."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import pyvista as pv

import fsi
from fsi.bodies.configuration import Configuration
from fsi.errors import InputError
from fsi.postprocess.render import fields
from fsi.postprocess.render.fields import RenderedField, field_names, register_field, rendered_field
from fsi.postprocess.render.picture import Framed, compose
from fsi.postprocess.render.scales import Linear, Span
from fsi.postprocess.render.scenes import Scene
from fsi.postprocess.render.view import View
from tests.commands import fsi_command
from tests.postprocess.render.test_exact_picture import colour_bars
from tests.postprocess.spatial_run import write_spatial_run


def scene(sides: list[float], values: list[float], away: float = 0.0) -> Scene:
    """Right triangles of those sides in a row, each with one pressure, and its size as the strain rate."""
    corners = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    starts = np.array([-0.9, -0.3, 0.3])[: len(sides)]
    x = np.concatenate(
        [side * corners + [start, 0.0, 0.0] for side, start in zip(sides, starts, strict=True)]
    )
    x[-3:, 0] += away
    cells = np.arange(len(x)).reshape(-1, 3)
    fluid = pv.UnstructuredGrid({pv.CellType.TRIANGLE: cells}, x)
    fluid["pressure"] = np.repeat(values, 3)
    fluid["strain_rate"] = np.abs(fluid["pressure"])
    nobody = Configuration.unturned(np.zeros((0, 2)), np.zeros(0))
    return Scene(View(np.zeros(2), 1.0), fluid, None, nobody, axisymmetric=False, viscosity=1.0)


def span(name: str, seen: Scene) -> Span:
    field = rendered_field(name)
    return field.scale.span(*seen.samples(field))


@pytest.mark.parametrize(("side", "largest"), [(1e-3, 4.0), (0.02, 1e6)])
def test_a_film_below_a_pixel_does_not_set_the_colours(side: float, largest: float) -> None:
    """Parts 1e-6 and 4e-4 of the area; the limit lies at 1e-4, a hundred pixels of 1000 x 1000."""
    seen = scene([0.5, 0.5, side], [1.0, 4.0, -1e6])
    assert span("pressure", seen) == (-largest, largest)
    low, high = span("dissipation", seen)
    assert high == largest**2
    assert low == max(1.0, 1e-8 * high)


@pytest.mark.parametrize(
    ("film", "asked", "value", "shown"),
    [
        (29.0, None, 14.5, 0.75),
        (1e3, None, 1.0, 0.5 + 0.5 * (10 / 9) / (10 / 9 + 3)),
        (1e6, None, 1e3, 0.5 + 0.5 * (10 / 9) / (10 / 9 + 3)),
        (1e3, (-1.0, 1.0), 0.5, 0.75),
        (29.0, (-1e3, 1e3), 1.0, 0.5 + 0.5 * (10 / 9) / (10 / 9 + 3)),
    ],
)
def test_signed_colours_are_in_proportion_unless_films_hide_the_rest(
    film: float, asked: Span | None, value: float, shown: float
) -> None:
    """Half of the area has sizes of 1, a film more: above 30 colours are linear up to 1, then logarithmic.

    A power of ten is 9/10 as wide as the linear part, which ends at a thousandth of the range at least. It
    ended at 0.03 of all ranges: 1 of 1000 was at 0.507, 0.5 of the range to 1 at 0.94.
    """
    field = rendered_field("pressure")
    seen = field.scale.seen(np.array([1.0, -1.0, 0.1, -film]), np.array([0.3, 0.3, 0.3, 0.1]))
    (found,) = np.asarray(field.shades([seen], asked).norm(np.array([value])), dtype=float)
    assert found == pytest.approx(shown, rel=1e-12)


def test_what_is_out_of_sight_does_not_either() -> None:
    seen = scene([0.5, 0.5, 0.5], [1.0, 4.0, 1e6], away=3.0)
    assert span("pressure", seen) == (-4.0, 4.0)


@pytest.mark.parametrize("name", ["dissipation", "pressure", "mesh", "disturbance"])
def test_what_is_zero_everywhere_has_one_colour_which_says_0(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No scale is invented for a fluid at rest: the bar has one label and no values beyond its ends."""
    bars, field = colour_bars(monkeypatch), rendered_field(name)
    shades = field.shades([field.scale.seen(np.zeros(3), np.ones(3))])
    assert len(np.unique(shades.to_rgba(np.array([-1.0, 0.0, 1.0])), axis=0)) == 1
    image = np.zeros((100, 100, 3), np.uint8)
    compose("title", [Framed(image, "title", 1.0, "label", shades, "both")])
    (bar,) = bars
    assert [label.get_text() for label in bar.ax.get_yticklabels()] == ["0"]
    assert bar.extend == "neither"


@pytest.mark.parametrize(("more", "shown"), [(1e-7, 1), (1e-5, 2)])
def test_differences_below_what_a_field_is_known_to_have_no_colours(more: float, shown: int) -> None:
    """The limit is 1e-6 of the largest value; pressures in films differ by some 1e-9 from node to node."""
    field = rendered_field("mesh")
    ends = -2e16, -2e16 * (1.0 - more)
    shades = field.shades([field.scale.seen(np.array(ends), np.ones(2))])
    assert len(np.unique(shades.to_rgba(np.array(ends)), axis=0)) == shown


def test_a_step_at_rest_does_not_make_the_colours_of_others_linear() -> None:
    """Logarithmic colours have no zero; where all values are spanned, zero is one of them."""
    spans = [(0.0, 0.0), (1.0, 2.0), (0.5, 1.0)]
    assert rendered_field("speed").scale.joined(spans) == (0.5, 2.0)
    assert rendered_field("mesh").scale.joined(spans) == (0.0, 2.0)


@pytest.mark.parametrize(("span", "shown"), [((0.0, 4.0), 0.25), ((0.25, 4.0), 0.5), ((-4.0, 4.0), 0.625)])
def test_a_range_from_zero_is_in_proportion(span: Span, shown: float) -> None:
    """Where 1 lies in it: logarithmic colours have no zero."""
    assert rendered_field("dissipation").scale.norm(span, 1.0)(1.0) == pytest.approx(shown)


@pytest.fixture
def upwards(monkeypatch: pytest.MonkeyPatch) -> RenderedField:
    """A field from outside the package, for the time of a test: u_x + p."""
    monkeypatch.setattr(fields, "_FIELDS", dict(fields._FIELDS))
    field = RenderedField(
        "upwards", "$u_x + p$", "a field of one's own", "viridis", Linear(), ("velocity", "pressure"),
        lambda at, _: at["velocity"][:, 0] + at["pressure"],
    )  # fmt: skip
    register_field(field)
    return field


@pytest.mark.usefixtures("drawing", "upwards")
def test_a_field_that_is_registered_can_be_rendered_by_its_name(
    run: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """In the plane and in space, by the command; the colours show the values."""
    assert fsi_command("render", run, "--field", "upwards", "--size", 200) == 0
    assert fsi_command("render", run, "--field", "pressure", "--size", 200, "-o", tmp_path / "p.png") == 0
    assert (run / "flow.png").read_bytes() != (tmp_path / "p.png").read_bytes()
    (tmp_path / "space").mkdir()
    space = write_spatial_run(tmp_path / "space")
    assert fsi_command("render", space, "--field", "upwards", "--size", 100) == 0
    capfd.readouterr()
    assert fsi_command("render", run, "--field", "other") == 2
    assert "--field other: give one of speed, pressure, " in (said := capfd.readouterr().err)
    assert said.rstrip().endswith("mesh, upwards, motion")


def test_values_of_a_registered_field(run: Path, upwards: RenderedField) -> None:
    """At the nodes of the cells its value is that of the data there; the files are in single precision."""
    flow = fsi.open_run(run).mesh(0)
    value = upwards.value(flow.point_data, 1.0)
    x = np.asarray(flow.points)
    np.testing.assert_allclose(value, 2.0 * x[:, 1] * np.sin(0.5 * x[:, 0]) + x[:, 0], rtol=1e-5, atol=1e-5)
    assert "upwards" in field_names()


def test_a_field_that_is_nan_is_refused(
    run: Path, upwards: RenderedField, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """It was drawn in one colour without a word; also with a range that is asked for, and in space."""
    lost = replace(upwards, name="lost", value=lambda at, _: np.nan * at["pressure"])
    register_field(lost)
    picture = tmp_path / "lost.png"
    assert fsi_command("render", run, "--field", "lost", "--range=0,1", "-o", picture) == 2
    said = capfd.readouterr().err
    assert said == "error: --field lost: is NaN or infinite in these steps; correct its `value`\n"
    assert not picture.exists()
    for name in ("speed", "pressure", "disturbance", "mesh"):
        field, nowhere = rendered_field(name), np.full(3, np.nan)
        for seen in (field.scale.seen(nowhere, np.ones(3)), field.scale.seen_on_plane(nowhere)):
            with pytest.raises(InputError, match=f"^--field {name}: is NaN"):
                field.shades([field.scale.seen(np.arange(3.0), np.ones(3)), seen])


@pytest.mark.usefixtures("upwards")
def test_a_field_whose_name_is_taken_is_refused() -> None:
    """Those of the program stay."""
    before = rendered_field("speed")
    mine = replace(before, value=lambda at, _: at["pressure"])
    with pytest.raises(
        ValueError, match=r'^"speed": is the name of fsi\.postprocess\.render\.fields\.<lambda>'
    ):
        register_field(mine)
    assert rendered_field("speed") is before


def test_the_help_lists_the_fields(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    assert fsi_command("render", "--help") == 0
    assert ", ".join(field_names()) in " ".join(capsys.readouterr().out.split())
