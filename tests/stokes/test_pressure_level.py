"""The level of the pressure: of the field, of tractions and of stresslets, wherever a domain is opened.

A body alone in its cell, pulled without a mean flow: turned by 180 degrees about its centre q the flow is the
same, and the pressure `G.(x - q) + periodic` changes its sign.
"""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fsi.case.load import parse_case
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.cell import Cell
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.round import Round
from fsi.stokes.model import StokesModel
from fsi.stokes.solution import StokesSolution
from fsi.stokes.traction import traction
from tests.flows import SMALL_BOX, discs, held, solved
from tests.periodic import LIGHT, in_cell, in_channel
from tests.stokes import spatial_flows

OBLIQUE = Cell(((3.0, 0.0), (0.7, 2.8)), ((0.0, 0.0), (0.0, 0.0)))
PULLED = held((1.0, 0.5, 0.0))


@pytest.mark.parametrize("centre", [(0.0, 0.0), (0.2, 0.3), (1.85, 1.4), (-2.1, 5.0)])
def test_a_disc_pulled_through_its_cell(centre: tuple[float, float]) -> None:
    """Its stresslet vanishes; with the mean of p over what is meshed zero its diagonal was 146 at the first.

    The pressure at opposite points is opposite about its value at q, which is G.q.
    """
    found = in_cell(OBLIQUE, discs([centre], [1.0]), PULLED, LIGHT)
    assert found.bulk is not None
    assert found.mean_pressure_gradient is not None
    assert_allclose(found.bulk.stresslets[0], 0.0, atol=1e-3)
    r = np.array([[1.3, 0.2], [0.1, 1.25], [1.2, 1.1]])
    p = [found.evaluate(np.array(centre) + side)[1] for side in (r, -r)]
    at_centre = found.mean_pressure_gradient @ np.array(centre)
    assert_allclose(0.5 * (p[0] + p[1]), at_centre, atol=2e-2)  # of a rise of 64 along a period


def test_a_sphere_pulled_through_its_cell() -> None:
    """In eight parts; with the mean of p over what is meshed zero its diagonal was 0.37."""
    cell = {"shape": "cell", "vectors": [[3.2, 0.0, 0.0], [0.4, 3.0, 0.0], [0.0, 0.2, 3.1]]}
    body = {"name": "ball", "radius": 1.0, "position": [0.0, 0.0, 0.0], "force": [1.0, 0.5, 0.0]}
    sizes = {"degree": 2, "cells_per_circle": 10, "cells_per_gap": 0.5, "growth": 0.8}
    case = parse_case(
        {
            "name": "pulled", "geometry": "spatial", "fluid": {"viscosity": 1.0}, "domain": cell,
            "bodies": [body], "discretisation": sizes,
        }
    )  # fmt: skip
    found = StokesModel(case)(case.configuration(), 0.0)
    assert found.bulk is not None
    assert_allclose(found.bulk.stresslets[0], 0.0, atol=2e-2)


def normal_traction_and_pressure(found: StokesSolution, centre: tuple[float, float]) -> float:
    """The mean of n.sigma n + p over the nodes of a disc: 0, as n.e n vanishes on what is rigid."""
    q, x = np.array(centre), found.surface.x
    r = x - q - discs([centre], [1.0]).to_images(found.surface.lattice, np.zeros(len(x), dtype=int), x)
    n = -r / np.linalg.norm(r, axis=1)[:, None]
    _, p = found.evaluate(q + r)
    return float(np.nanmean(np.einsum("nd,nd->n", traction(found.surface), n) + p))


@pytest.mark.parametrize("container", [SMALL_BOX, Round(4.0)], ids=["box", "round"])
def test_tractions_have_the_level_of_the_pressure(container: Container) -> None:
    """With the pressure zero at one node of the mesh, as it is solved for, they were off by 0.9 and 3.6."""
    found = solved(container, discs([(0.4, 0.3)], [1.0]), held((1.0, 0.4, 0.2)), resolution=LIGHT)
    assert normal_traction_and_pressure(found, (0.4, 0.3)) == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize("centre", [(1.85, 1.4), (0.0, 0.0), (-2.1, 5.0)])
def test_tractions_in_a_cell_have_it_too(centre: tuple[float, float]) -> None:
    """Around where the body is said to be, whichever of its images the mesh has."""
    found = in_cell(OBLIQUE, discs([centre], [0.6]), PULLED, LIGHT)
    assert normal_traction_and_pressure(found, centre) == pytest.approx(0.0, abs=0.01)


def test_a_disc_pulled_along_a_channel() -> None:
    """Midway between walls: the pressure is odd about q, but for its rise from the middle of the channel."""
    channel = Box((1.0, 0.0), (6.0, 4.0), periodic=("x",))
    found = in_channel(channel, discs([(2.2, 2.0)], [1.0]), held((1.0, 0.0, 0.0)), pressure_gradient=3.0)
    assert found.bulk is not None
    assert_allclose(found.bulk.stresslets[0], 0.0, atol=1e-3)
    p = [found.evaluate(np.array([[2.2 + side * 1.4, 2.0 + side * 0.9]]))[1] for side in (1.0, -1.0)]
    assert_allclose(0.5 * (p[0] + p[1]), 3.0 * (2.2 - 3.5), atol=1e-2)


def test_a_pressure_all_around_adds_itself_alone() -> None:
    """Of 1e4 residuals of 1e-10 moved spheres by 1e-7; the traction on a surface is its own, -1e4 n."""
    found = []
    for outside in (0.0, 1e4):
        walls = {"bottom": {"pressure": outside + 1.0}, "top": {"pressure": outside}}
        data = spatial_flows.BOX | {"domain": spatial_flows.BOX["domain"] | {"walls": walls}}
        found.append(spatial_flows.solved(spatial_flows.case(data, solver="iterative", growth=1.0)))
    below, above = found
    assert_allclose(above.U, below.U, atol=1e-9 * np.abs(below.U).max())
    assert_allclose(above.F, below.F, atol=1e-9 * np.abs(below.F).max())
    x = np.array([[2.3, 0.2, 0.1], [-1.5, 1.4, -2.5]])
    (u, p), (of_both, level) = below.evaluate(x), above.evaluate(x)
    assert_allclose(of_both, u, atol=1e-9 * np.abs(u).max())
    assert_allclose(level - p, 1e4, rtol=1e-9)
    on_large = above.surface.x[:, 2] < -0.5
    r = (above.surface.x - [-0.5, 0.2, -1.5])[on_large]
    more = (traction(above.surface) - traction(below.surface))[on_large]
    assert_allclose(more, 1e4 * r, atol=100.0)  # n = -r out of the fluid; 1e4 if left out
