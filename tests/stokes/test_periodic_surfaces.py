"""Traction and resistance in periodic domains: nothing depends on where the domain was opened."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fsi.case.load import parse_case
from fsi.errors import InputError
from fsi.meshes.geometry.box import Box
from fsi.meshes.resolution import Resolution
from fsi.stokes.resistance import case_resistance, held_at_rest, solve_resistance
from fsi.stokes.traction import places, traction
from tests.case_data import changed
from tests.flows import discs, held, mesh
from tests.periodic import in_cell, square


def test_traction_where_the_cut_meets_a_body() -> None:
    """A disc pulled along x through a square array, opened in all four gaps: images have one traction.

    It is even in y for t_x, and smooth. With the reaction of one copy alone it is half as large there.
    """
    found = in_cell(square(3.0), discs([(0.0, 0.0)], [1.0]), held((1.0, 0.0, 0.0)))
    x, t = found.surface.x, traction(found.surface)
    twice = len(x) - len(np.unique(places(found.surface)))
    assert twice == 4
    r = x - 3.0 * np.rint(x / 3.0)
    angle = np.arctan2(r[:, 1], r[:, 0])
    order = np.argsort(angle)
    angle, t_x = angle[order], t[order, 0]
    mirrored = np.interp(-angle, angle, t_x, period=2.0 * np.pi)
    assert_allclose(mirrored, t_x, atol=0.01 * np.abs(t_x).max())
    assert np.abs(np.diff(t_x)).max() < 0.1 * np.abs(t_x).max()


def test_resistance_in_a_periodic_channel() -> None:
    """The column of one motion is the load of that motion, and R does not know where the channel begins."""
    channel, fine = Box((0.0, -2.0), (6.0, 2.0), periodic=("x",)), Resolution(1.0, 24, 0.5)
    R = []
    for shift in (0.0, 2.3):
        q = discs([(1.0 + shift, -0.6), (3.6 + shift, 0.3)], [1.0, 0.8])
        R.append(solve_resistance(held_at_rest(mesh(channel, q, fine), channel, q), ("a", "b")).R)
    assert_allclose(R[1], R[0], atol=1e-5 * np.abs(R[0]).max())


@pytest.mark.parametrize(
    ("domain", "parts"),
    [
        ({"shape": "cell", "vectors": [[8.0, 0.0], [0.0, 8.0]]}, ['domain.shape = "cell"', "give a box"]),
        (
            {"lower": [-8.0, 0.0], "upper": [8.0, 16.0], "periodic": ["x"], "net_flux": 1.0},
            ["domain.net_flux = 1.0", "drop it"],
        ),
    ],
)
def test_no_resistance_where_the_mean_flow_is_a_result(domain: dict[str, object], parts: list[str]) -> None:
    with pytest.raises(InputError) as caught:
        case_resistance(parse_case(changed("domain", domain)))
    for part in parts:
        assert part in str(caught.value)
