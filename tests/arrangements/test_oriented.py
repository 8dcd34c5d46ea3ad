"""Ellipses and rods at random: exact gaps by another method, the area fraction, and what is refused."""

from __future__ import annotations

from itertools import product
from math import pi
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fsi.arrangements.arrangement import Arrangement, Wanted
from fsi.arrangements.convex import ConvexShape, Couples, apart
from fsi.arrangements.kinds import arrange
from fsi.case.shapes.shape import BodyShape
from fsi.errors import InputError
from fsi.meshes.geometry.placed import Placed


def section_of(table: dict[str, Any]) -> BodyShape:
    shape: BodyShape = BodyShape.registry.section_for(table).model_validate(table)
    return shape


def placed(arrangement: Arrangement) -> list[Placed]:
    """The bodies as a case has them, whose gaps are those of closest points."""
    return [
        Placed(
            section_of(body["shape"]).outline,
            np.array(body["position"]),
            body["angle"],
        )
        for body in arrangement.bodies()
    ]


@settings(max_examples=25, deadline=None)
@given(
    kind=st.sampled_from(["ellipse", "rod"]), ratio=st.floats(1.05, 6.0), turn=st.floats(0.0, 7.0),
    angles=st.tuples(st.floats(0.0, 7.0), st.floats(0.0, 7.0)), away=st.floats(0.5, 6.0),
)  # fmt: skip
def test_how_far_two_are_apart_is_the_gap_of_their_closest_points(
    kind: str, ratio: float, turn: float, angles: tuple[float, float], away: float
) -> None:
    shape = ConvexShape("ellipse" if kind == "ellipse" else "rod", ratio)
    d = away * np.array([np.cos(turn), np.sin(turn)])
    s, phi = apart(shape, Couples(d[None], np.ones((1, 2)), np.array([angles])))
    section = shape.described(1.0)
    outline = section_of(section).outline
    assert outline.area == pytest.approx(pi, rel=1e-13)
    gap = Placed(outline, d, angles[0]).gap_to(Placed(outline, np.zeros(2), angles[1])).gap
    assert (s[0] > 0.0) == (gap > 0.0) or abs(gap) < 1e-9
    if gap > 0.0:
        assert s[0] == pytest.approx(gap, abs=1e-12)
    # The derivative of s by the angles is that of h.
    h, slope = shape.support(phi - angles[0])
    assert h[0] >= shape.half_width
    ahead, behind = (shape.support(phi - angles[0] + e)[0][0] for e in (1e-6, -1e-6))
    if abs(np.cos(phi[0] - angles[0])) > 1e-3:
        assert slope[0] == pytest.approx((ahead - behind) / 2e-6, abs=1e-6)


@pytest.mark.parametrize(
    ("shape", "cell", "aligned"),
    [("ellipse", "channel", None), ("rod", "periodic", 20.0), ("rod", "box", None)],
)
def test_no_two_are_nearer_than_the_gap(shape: str, cell: str, aligned: float | None) -> None:
    """By closest points, images and walls included; all fill what is asked for, and a seed is one of them."""
    wanted = Wanted(
        16, 0.35, 0.05, radius=2.0, cell=cell, shape=shape, ratio=2.5, aligned=aligned, seed=3, aspect=1.5
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("fsi.arrangements.oriented_packing.MOVES", 30)
        arrangement, again = (arrange("random", wanted) for _ in range(2))
    bodies = placed(arrangement)
    np.testing.assert_array_equal(again.centres, arrangement.centres)
    assert arrangement.angles is not None
    steps = [(-1, 0, 1) if so else (0,) for so in arrangement.cell.periodic]
    moved = [(j, np.array(m) * arrangement.cell.sides) for j in range(16) for m in product(*steps)]
    farthest = 2.0 * 2.5 * 2.0  # centres beyond it are farther apart than two bodies are long
    gaps = [
        body.gap_to(bodies[j].moved(bodies[j].centre + away)).gap
        for i, body in enumerate(bodies)
        for j, away in moved
        if (j > i or (i == j and away.any()))
        and np.linalg.norm(bodies[j].centre + away - body.centre) < farthest
    ]
    assert min(gaps) >= 0.05 - 1e-12
    assert arrangement.smallest_gap() == pytest.approx(min(gaps), abs=1e-12)
    rims = np.concatenate([body.at(np.linspace(0.0, 1.0, 200)).x for body in bodies])
    assert arrangement.cell.wall_distances(rims).min(initial=np.inf) >= 0.05
    area = sum(body.outline.area for body in bodies)
    assert area / arrangement.cell.volume == pytest.approx(0.35, rel=1e-12)
    if aligned is None:
        assert np.ptp(arrangement.angles) > 1.0
    else:
        np.testing.assert_allclose(arrangement.angles, np.radians(aligned))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"fraction": 0.8}, "area_fraction = 0.8: too large for rods"),
        ({"number": 4, "fraction": 0.5}, "number = 4: the cell is shorter than two rods of ratio 4"),
        ({"number": 14, "fraction": 0.68}, "area_fraction = 0.68: no arrangement of 14 rods"),
    ],
)
def test_what_does_not_fit_is_refused_by_name(change: dict[str, float], message: str) -> None:
    given = {"number": 12, "fraction": 0.3, "gap": 0.02, "shape": "rod", "ratio": 4.0} | change
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("fsi.arrangements.oriented_packing.TRIES", 1)
        patch.setattr("fsi.arrangements.oriented_packing.ITERATIONS", 60)
        with pytest.raises(InputError, match=message):
            arrange("random", Wanted(**given))  # type: ignore[arg-type]
