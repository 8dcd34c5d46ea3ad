"""Points of quadrature suffice where pores would be flat: circles of fluid stand there."""

from __future__ import annotations

import numpy as np
import pytest

from fsi.bodies.configuration import Motion
from fsi.case.load import parse_case
from fsi.pores.circles import circles_in_pores
from fsi.pores.fluid_discs import pores_without_wide
from fsi.pores.forms import pore_forms
from fsi.pores.model import PoreModel
from fsi.pores.pore_data import pore_data
from fsi.pores.quadrature import WEIGHT, pore_points, rule
from fsi.pores.regions import shapes_of
from fsi.pores.solve import PoreFlow, PoreLoading, solve_pores
from fsi.pores.surfaces import BoundingSurfaces
from fsi.pores.system import PoreSystem
from fsi.pores.topology import linked
from fsi.stokes.model import StokesModel
from tests.pore_surfaces import box, cell, channel, round_container

MODES = 8
FINE = rule(20, 24, 25, 3.0)  # with MODES these are (7, 10, 17), 2
BOX = box(
    np.array([[2.8078, 0.629], [5.3753, 2.4886]]),
    np.array([0.5567, 0.4911]),
    np.zeros(2),
    np.array([6.2679, 3.0013]),
)
NARROW_BOX = box(
    np.array([[0.8403, 13.3697], [1.0867, 10.556]]),
    np.array([0.4383, 0.4458]),
    np.zeros(2),
    np.array([2.0154, 14.5845]),
)
CHANNEL = channel(np.array([[3.3861, 0.929]]), np.array([0.8738]), 8.3252, 2.008)
ROUND = round_container(
    np.array([[3.071, 0.2719], [-2.2541, 1.6533], [-2.3399, -1.4364]]),
    np.array([0.4229, 0.4003, 0.8699]),
    3.6472,
)
ECCENTRIC = round_container(np.array([[0.1, 0.0]]), np.ones(1), 1.5)
CRESCENT = round_container(np.array([[0.1, 0.0]]), np.array([0.8]), 1.0)  # where pores stay flat
WIDE = round_container(np.array([[-0.299, -2.8691], [-2.3376, -0.7824]]), np.array([0.4051, 0.7311]), 3.3019)

# The third of three circles of fluid is a tenth as large as another, and hides its end of a strip.
HIDDEN = cell(
    np.array(
        [
            [0.7708, 1.8945],
            [7.2115, 4.6573],
            [4.3115, 1.2779],
            [6.6112, 0.9094],
            [3.5211, 4.1339],
            [6.6405, 7.6501],
            [6.2659, 2.3418],
            [0.0134, 7.7877],
            [1.3436, 6.6291],
        ]
    ),
    np.array([1.6, 0.9, 0.3, 0.06, 1.6, 0.9, 0.3, 0.06, 1.6]),
    np.array([[9.0, 0.0], [1.3, 8.0]]),
)


def moving(surfaces: BoundingSurfaces) -> PoreFlow:
    """With bodies that move in different ways between walls at rest."""
    system = PoreSystem.make(surfaces, MODES, 1.0)
    U = np.random.default_rng(1).normal(size=(system.bodies, 3))
    still = np.zeros((surfaces.bounds, 3))
    return solve_pores(
        system, PoreLoading(Motion(np.ones_like(U, bool), U, 0.0 * U), still, np.zeros((2, 2)))
    )


def missed(flow: PoreFlow) -> float:
    """What points miss of the dissipation in all pores, over all of it."""
    off = 0.0
    for batch in flow.system.assembly.batches:
        x, shapes = flow.local_numbers(batch), flow.system.shapes.of(batch.pore)
        more = pore_forms(shapes, FINE, batch.orders).K - batch.forms.K
        off += np.abs(np.einsum("ei,eij,ej->e", x, more, x)).sum()
    return float(off / flow.dissipation)


@pytest.mark.parametrize(
    ("surfaces", "bound"),
    [
        (BOX, 1e-7),
        (NARROW_BOX, 2e-6),
        (ROUND, 3e-7),
        (CHANNEL, 2e-7),
        (ECCENTRIC, 1e-6),
        (CRESCENT, 3e-7),
        (WIDE, 3e-7),
    ],
)
def test_points_miss_little_of_the_dissipation(surfaces: BoundingSurfaces, bound: float) -> None:
    """Measured: 9e-9, 3e-7, 8e-8, 2e-8, 4e-7, 7e-8 and 5e-8.

    With circles in wide pores alone 7e-6, 0.37, 3e-3, 1e-3 and 2e-4 of the first five; with the points that
    other pores have 7e-5 of the sixth; with pores beside a container as wide as others 9e-6 of the last.
    """
    assert missed(moving(surfaces)) <= bound


def test_no_strip_folds_where_a_circle_is_in_its_way() -> None:
    """No weight is negative, and with those of circles they add up to the area of the fluid, to 1e-11.

    Where strips folded one weight was -2e-8, sizes of all were 3e-9 above that, and the cell was refused.
    """
    pores = pores_without_wide(HIDDEN)
    weights = pore_points(pore_data(shapes_of(pores)), FINE).rows[:, WEIGHT]
    radii, fluid = pores.surfaces.radius, pores.surfaces.fluid
    assert weights.min() >= 0.0  # 0 beyond the last point
    area = np.abs(weights).sum() + np.pi * np.sum(radii[fluid] ** 2)
    assert area == pytest.approx(72.0 - np.pi * np.sum(radii[~fluid] ** 2), rel=1e-11)


@pytest.mark.parametrize("surfaces", [BOX, NARROW_BOX, ROUND, CHANNEL])
def test_no_pore_asks_for_a_circle_in_the_end(surfaces: BoundingSurfaces) -> None:
    pores = pores_without_wide(surfaces)
    circles = circles_in_pores(pores.surfaces.shapes(), linked(pores.surfaces), flat=True)
    assert np.isinf(circles.asked).all()


def test_beside_a_disc_that_nearly_fills_its_container_flows_are_those_of_elements() -> None:
    """Measured: dissipation 8e-7 above, forces and torque within 1e-6 of the largest; with circles in wide
    pores alone 5e-3 below, and a torque 0.08 too small."""
    disc = {"name": "disc", "radius": 1.0803, "position": [-0.3603, 0.1439]}
    data = {
        "name": "crescent",
        "fluid": {"viscosity": 2.0},
        "domain": {"shape": "round", "radius": 1.5},
        "bodies": [disc | {"velocity": [1.0, 0.3], "angular_velocity": 0.5}],
    }
    case = parse_case(data | {"model": "resolved", "discretisation": {"degree": 5}})
    q = case.configuration()
    exact = StokesModel(case)(q, 0.0)
    found = PoreModel(parse_case(data | {"model": "pores", "pores": {"modes": 12}}))(q, 0.0)
    assert 0.0 < found.dissipation / exact.dissipation - 1.0 < 2e-6
    assert np.abs(found.F - exact.F).max() <= 2e-6 * np.abs(exact.F).max()


@pytest.mark.parametrize(("modes", "bound"), [(4, 4e-3), (8, 5e-5)])
def test_a_disc_in_a_bearing_has_the_drag_of_concentric_circles(modes: int, bound: float) -> None:
    """4 pi mu U / (ln k - (k^2 - 1)/(k^2 + 1)), an offset of 1e-4 of the clearance changes that by 1e-8.

    Measured: 2.7e-3 and 2.6e-5 above. Where circles went a part of the way around, eight on either side,
    sixteen modes were 1.7e-3 below, more than ten times their bar.
    """
    k = 1.2
    exact = 4.0 * np.pi / (np.log(k) - (k**2 - 1.0) / (k**2 + 1.0))
    D = dragged(round_container(np.array([[2e-5, 0.0]]), np.ones(1), k), modes)
    assert 0.0 < D / exact - 1.0 < bound


@pytest.mark.parametrize(
    ("radius", "out", "exact"), [(1.1, 0.95, 665880.74), (1.2, 0.999, 29667410.6), (1.1, 0.5, 54401.809)]
)
def test_a_disc_in_a_tight_container_has_the_drag_of_elements(
    radius: float, out: float, exact: float
) -> None:
    """Of elements (`discretisation.tolerance = 1e-7`), out to a part of the clearance: 5 to 8e-4 at most.

    At 0.95 circles come to an end after some 250, at 0.999 not: there 30 rounds of them do.
    """
    away = out * (radius - 1.0)
    surfaces = round_container(away * np.array([[np.cos(4.0), np.sin(4.0)]]), np.ones(1), radius)
    assert -1e-6 < dragged(surfaces, 4) / exact - 1.0 < 1.5e-3


def dragged(surfaces: BoundingSurfaces, modes: int) -> float:
    """What a disc dissipates that moves by (1, 0) and does not turn, which is its drag."""
    system, U = PoreSystem.make(surfaces, modes, 1.0), np.array([[1.0, 0.0, 0.0]])
    held = Motion(np.ones_like(U, bool), U, 0.0 * U)
    return solve_pores(system, PoreLoading(held, np.zeros((1, 3)), np.zeros((2, 2)))).dissipation
