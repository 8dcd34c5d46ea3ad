"""Pictures of the flow around an axis: what their colour bars say."""

from pathlib import Path

import pytest

import fsi
from fsi.postprocess.render.meridian import MeridianArtist
from fsi.postprocess.render.planar import PlanarArtist
from fsi.postprocess.render.render import artist
from fsi.postprocess.render.revolved import RevolvedArtist
from fsi.postprocess.render.scenes import window_on
from fsi.postprocess.render.view import Choice

ON_AXIS = r"$\partial_r u_z - \partial_z u_r$"  # docs/manual.md: counterclockwise where r points right, z up


@pytest.mark.parametrize(
    ("geometry", "label"),
    [("planar", r"$\partial_{x} u_{y} - \partial_{y} u_{x}$"), ("axisymmetric", ON_AXIS)],
)
@pytest.mark.parametrize("gap", [None, "disc,plane"])
def test_vorticity_on_the_plane(run: Path, geometry: str, label: str, gap: str | None) -> None:
    case = run / "case.toml"
    case.write_text(case.read_text().replace('"planar"', f'"{geometry}"'))
    drawn = artist(fsi.open_run(run), Choice("vorticity", gap))
    assert isinstance(drawn, PlanarArtist)
    assert [field.label for field, _ in drawn.panels] == [label]


def test_colours_turned_around_the_axis_are_those_of_the_plane(run: Path) -> None:
    """Nodes in films and on walls counted as much as others: the range was 0.02 to 54, not 0.95 to 37."""
    case = run / "case.toml"
    case.write_text(case.read_text().replace('"planar"', '"axisymmetric"'))
    here = fsi.open_run(run)
    window = window_on(here, [2], here.mesh(2))
    (flat,) = MeridianArtist(here, Choice("speed"))._shades([2], window)
    assert RevolvedArtist(here, Choice("speed", revolved=True))._seen(2, window).span == flat.get_clim()


def test_vorticity_turned_around_the_axis(run: Path) -> None:
    case = run / "case.toml"
    case.write_text(case.read_text().replace('"planar"', '"axisymmetric"'))
    drawn = artist(fsi.open_run(run), Choice("vorticity", revolved=True))
    assert isinstance(drawn, RevolvedArtist)
    assert drawn.field.label == ON_AXIS
