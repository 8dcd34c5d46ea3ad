"""Bodies wider than a period overlap their images: told at once, not after all images are looked at."""

from __future__ import annotations

from typing import Any, NoReturn

import numpy as np
import pytest

from fsi.bodies import gaps
from fsi.bodies.configuration import Configuration
from fsi.bodies.gaps import find_gaps, gap_to_image, pair_gaps
from fsi.case.checks import sound
from fsi.case.load import parse_case
from fsi.errors import InputError
from fsi.meshes.geometry.outline import Outline
from fsi.meshes.geometry.unbounded import Unbounded
from tests.case_data import changed

pytestmark = pytest.mark.filterwarnings("error")

CELL = {"shape": "cell", "vectors": [[5.0, 0.0], [0.0, 5.0]]}
ELLIPSE = {"name": "a", "position": [0.0, 1.0], "shape": {"kind": "ellipse", "axes": [1.0, 0.7]}}


@pytest.fixture
def unlisted(monkeypatch: pytest.MonkeyPatch) -> None:
    """Who lists all images of such a body fills the memory of this machine."""

    def listed(*_: object, **__: object) -> NoReturn:
        raise AssertionError("all images are listed")

    monkeypatch.setattr(sound, "find_gaps", listed)


def refused(bodies: list[dict[str, Any]]) -> str:
    with pytest.raises(InputError) as caught:
        parse_case(changed("bodies", bodies) | {"domain": CELL})
    return str(caught.value)


@pytest.mark.usefixtures("unlisted")
@pytest.mark.parametrize("radius", [2.6, 100.0, 1e20, 8e49])
def test_a_disc_beside_an_ellipse(radius: float) -> None:
    """5 - 2 radius. All images within 2 radius were listed: 5000 of 100, 1e40 of 1e20."""
    line = refused([ELLIPSE, {"name": "b", "radius": radius, "position": [2.5, 2.0]}])
    what = f"bodies 'b' and its image overlap or touch (gap {5.0 - 2.0 * radius:.6g})"
    assert line == f"bodies.1.position = [2.5, 2.0]: {what}; move them apart"


@pytest.mark.usefixtures("unlisted")
def test_an_ellipse_across_several_periods() -> None:
    """Its width, 0.8, is less than a period; along x it is as long as twelve."""
    long = ELLIPSE | {"shape": {"kind": "ellipse", "axes": [30.0, 0.4]}}
    assert refused([long]).startswith("bodies.0.position = [0.0, 1.0]: bodies 'a' and its image overlap")


def test_an_ellipse_longer_than_the_shortest_period_fits_beside_its_images() -> None:
    """Across: 7 along x, where the period is 8, and 1.4 along y, where it is 5."""
    long = ELLIPSE | {"shape": {"kind": "ellipse", "axes": [3.5, 0.7]}}
    wide = {"shape": "cell", "vectors": [[8.0, 0.0], [0.0, 5.0]]}
    case = parse_case(changed("bodies", [long]) | {"domain": wide})
    assert gap_to_image(case.configuration(), 0, np.array([8.0, 0.0])) == pytest.approx(1.0, abs=1e-12)
    assert gap_to_image(case.configuration(), 0, np.array([0.0, 5.0])) == pytest.approx(3.6, abs=1e-12)


def test_outlines_are_followed_where_the_circles_around_them_meet(monkeypatch: pytest.MonkeyPatch) -> None:
    """Small discs around a large one: 40 beside it within a gap of 0.1, 0.05, and 40 far from it, 5."""
    turn = np.linspace(0.0, 2.0 * np.pi, 40, endpoint=False)
    ring = np.column_stack([np.cos(turn), np.sin(turn)])
    centres = np.concatenate([[[0.0, 0.0]], 10.15 * ring, 15.1 * ring])
    radii = np.r_[10.0, np.full(80, 0.1)]
    outlines = tuple(map(Outline.disc, radii.tolist()))
    q = Configuration(centres, np.zeros(81), radii, outlines=outlines)
    followed = []

    def counted(q: Configuration, pairs: Any, away: Any) -> Any:
        followed.append(len(pairs))
        return pair_gaps(q, pairs, away)

    monkeypatch.setattr(gaps, "pair_gaps", counted)
    found = find_gaps(q, Unbounded(), 0.1)
    assert followed == [40]
    np.testing.assert_allclose(found.pair_gaps, 0.05, rtol=0.0, atol=1e-12)
