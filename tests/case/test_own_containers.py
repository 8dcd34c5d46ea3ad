"""Domains of one's own: what their containers say is checked, walls may end, or be round from outside."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.bodies.gaps import find_gaps
from fsi.case.case import Case
from fsi.case.checks.containers import faults
from fsi.case.checks.work import narrows
from fsi.case.domains.domain import Walled, register_domain
from fsi.case.load import parse_case
from fsi.errors import InputError
from fsi.lubrication.below import OpenedGaps
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.curves import segment
from fsi.meshes.geometry.reentrant import reentrant_corners
from fsi.meshes.geometry.round import HalfPlane, Round
from fsi.meshes.geometry.unbounded import Unbounded
from fsi.reduced.enclosure import make_enclosure
from fsi.reduced.model import ReducedModel
from fsi.reduced.pairs import find_pairs
from fsi.stokes.model import StokesModel
from fsi.stokes.walls import singular_corners
from tests.case.own_domains import Annulus, AnnulusDomain, Elbow, ElbowDomain

L = {"shape": "elbow-of-tests", "length": 6.0, "width": 3.0}
RING = {"shape": "annulus-of-tests", "inner": 1.0, "outer": 4.0}
HELD = {
    "name": "hole",
    "radius": 1.0,
    "position": [0.0, 0.0],
    "velocity": [0.0, 0.0],
    "angular_velocity": 0.0,
}
BETWEEN = {"law": "exact", "shear_law": "exact", "rotation_law": "exact"}
ALL_LAWS = BETWEEN | {"wall_shear_law": "leading", "wall_rotation_law": "leading", "cutoff": 0.5}


@pytest.fixture(autouse=True)
def registered(monkeypatch: pytest.MonkeyPatch) -> None:
    """Registered for one test only: messages list all shapes."""
    monkeypatch.setattr(Walled.registry, "sections", [*Walled.registry.all()])
    for domain in (ElbowDomain, AnnulusDomain):
        register_domain(domain)


def disc_in(domain: dict[str, Any], position: list[float], *others: dict[str, Any], **more: Any) -> Case:
    disc = {"name": "disc", "radius": 0.5, "position": position, "velocity": [0.0, -1.0]}
    disc |= {"angular_velocity": 0.0} | more.pop("moving", {})
    data = {"name": "own", "fluid": {"viscosity": 1.0}, "domain": domain, "reduced": {"drag": 10.0}}
    return parse_case(data | {"bodies": [disc, *others]} | more)


def sides(which: Callable[[int], int], first: int = 0, last: int = 6, step: int = 1) -> Any:
    """An outline of the L with other numbers of walls, without some, or run backwards."""

    def outline(container: Elbow) -> Any:
        x = np.array([container.corners, np.roll(container.corners, -1, axis=0)])[::step]
        return tuple(segment(which(k), *x[:, k]) for k in range(first, last))

    return outline


def along_lines(container: Elbow, x: Array) -> Array:
    """Distances to the lines that the walls are parts of."""
    start = container.corners
    side = np.roll(start, -1, axis=0) - start
    left = np.column_stack([-side[:, 1], side[:, 0]]) / np.linalg.norm(side, axis=1)[:, None]
    return np.asarray(np.einsum("nkd,kd->nk", x[:, None] - start, left))


@pytest.mark.parametrize(
    ("answer", "wrong", "fault"),
    [
        ("distances", lambda c, x: 2.0 * c.to_segments(x)[0], r"`distances` grow at the rate 2 .*'bottom'"),
        ("distances", lambda c, x: c.to_segments(x)[0], r"`distances` is negative behind wall 'bottom'"),
        ("distances", along_lines, r"`distances` to wall 'inner' are negative inside.*nearest point"),
        ("normals", lambda c, x: -c.to_segments(x)[1], r"`normals` are not those of wall 'bottom'"),
        ("normals", lambda c, x: 2.0 * c.to_segments(x)[1], r"`normals` are not those .*unit vectors"),
        ("volume", property(lambda _: 36.0), "volume is 36, the area in its outline 27"),
        ("size", lambda _: 5.0, "size, 5, is less than that of its outline"),
        ("outline", sides(lambda k: k, step=-1), "outline runs clockwise"),
        ("outline", sides(lambda k: k, last=5), r"does not close at \[0\.0, 6\.0\]"),
        ("outline", sides(lambda k: k, first=1), r"does not close at \[0\.0, 0\.0\]"),
        ("outline", sides(lambda k: (k + 1) % 6), "wall 'right' where its `distances` .* same numbers"),
    ],
)
def test_a_container_agrees_with_itself(
    answer: str, wrong: Any, fault: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """All of these were accepted, or refused with an untrue remedy."""
    disc_in(L, [1.5, 1.5])
    monkeypatch.setattr(Elbow, answer, wrong)
    with pytest.raises(InputError, match=rf'domain\.shape = "elbow-of-tests": .*{fault}'):
        disc_in(L, [1.5, 1.5])


def test_round_walls_say_which_circle_they_follow(monkeypatch: pytest.MonkeyPatch) -> None:
    """Laws took a wall without it for a plane."""
    inner, outer = Annulus(1.0, 4.0).spheres
    for given, fault in (((None, outer), "is curved"), ((outer, inner), "is not on its circle")):
        monkeypatch.setattr(Annulus, "spheres", given)
        with pytest.raises(InputError, match=rf"wall 'inside' {fault}"):
            disc_in(RING, [2.5, 0.0])


@pytest.mark.parametrize(
    "container",
    [
        Box((0.0, -1.0), (2.0, 1.0)),
        Box((0.0, -1.0), (2.0, 1.0), periodic=("x",)),
        Box((0.0, -1.0), (2.0, 1.0), axisymmetric=True),
        Round(3.0),
        Round(3.0, axisymmetric=True),
        HalfPlane(3.0),
        HalfPlane(3.0, axisymmetric=True),
        Elbow(6.0, 3.0).scaled(1e-6),
        Annulus(1.0, 4.0),
    ],
)
def test_sound_containers_pass(container: Container) -> None:
    assert list(faults(container)) == []


def test_a_round_wall_from_outside_is_like_a_body_that_is_held() -> None:
    """Load and torque of squeeze, and of sliding and turning; squeeze was 5.2 times as much by a R/(R - a).

    kappa of squeeze is 4 pi mu/(L - tanh L), cosh L = 1 + s + k s^2/2, s = D/a_r and k = a_r/a (1 - a_r/a).
    """
    for motion in ({"velocity": [-1.0, 0.0]}, {"velocity": [0.0, 1.0], "angular_velocity": 0.7}):
        cases = [
            disc_in(
                domain,
                [1.51, 0.0],
                *others,
                moving=motion,
                model="reduced",
                reduced=ALL_LAWS | {"drag": 10.0},
            )
            for domain, others in ((RING, ()), ({"shape": "round", "radius": 4.0}, (HELD,)))
        ]
        F, held = (ReducedModel(case)(case.configuration(), 0.0).F[0] for case in cases)
        np.testing.assert_allclose(F, held, rtol=1e-12, atol=1e-12)
    case = disc_in(RING, [1.51, 0.0], moving={"velocity": [-1.0, 0.0]}, model="reduced")
    D, a_r = np.array([0.01, 1.99]), np.array([0.5 / 1.5, 2.0 / 3.5])
    s, k = D / a_r, 2.0 * a_r * (1.0 - 2.0 * a_r)
    angle = np.arccosh(1.0 + s + 0.5 * k * s**2)
    expected = 10.0 + np.sum(4.0 * np.pi / (angle - np.tanh(angle)))
    assert pytest.approx(-expected, rel=1e-9) == ReducedModel(case)(case.configuration(), 0.0).F[0, 0]


def test_laws_below_a_gap_take_it_for_that_body_too() -> None:
    """The sum of resistance times rate times rate of all rows, which was five times that of squeeze."""
    q, moved = ([[1.51, 0.0], [0.0, 0.0]], [[1.55, 0.0], [0.0, 0.0]])

    def resistance(container: Container, bodies: int) -> Array:
        here, there = (
            Configuration(np.array(x[:bodies]), np.zeros(bodies), np.array([0.5, 1.0][:bodies]))
            for x in (q, moved)
        )
        rates = OpenedGaps(here, there, container, 0.05, ("inside",), False, 1.0).rates()
        return np.asarray(np.einsum("r,ri,rj->ij", rates.resistance, rates.G[:, :3], rates.G[:, :3]))

    np.testing.assert_allclose(resistance(Annulus(1.0, 4.0), 1), resistance(Unbounded(), 2), atol=1e-9)


def test_meshes_beside_it_are_estimated_by_the_curvature_of_its_gap() -> None:
    """1/a + 1/R on the inner circle, 1/a - 1/R within the outer one."""
    case = disc_in({"shape": "annulus-of-tests", "inner": 1.0, "outer": 2.2}, [1.6, 0.0])
    found = narrows(case, find_gaps(case.configuration(), case.container()))
    np.testing.assert_allclose(found.curvature, [3.0, 2.0 - 1.0 / 2.2], rtol=1e-14)


def test_corners_wider_than_a_straight_angle() -> None:
    """Meshes are graded there, and bars are of two meshes; without F missed by 4.9e-3 with a bar of 3e-3."""
    np.testing.assert_array_equal(singular_corners(disc_in(L, [1.5, 1.5])), [[3.0, 3.0]])
    for container in (Annulus(1.0, 4.0), Box((0.0, 0.0), (1.0, 2.0)), HalfPlane(3.0)):
        assert reentrant_corners(container).shape == (0, 2)


def test_the_flow_around_such_a_corner() -> None:
    """25.61794 with growth 0.15 (regression); it was 25.6130."""
    case = disc_in(L, [1.5, 1.5], moving={"angular_velocity": "free"})
    instant = StokesModel(case)(case.configuration(), 0.0)
    assert pytest.approx(25.61794, abs=1e-4) == abs(instant.F[0, 1])


def test_beside_such_a_corner_one_gap_is_counted_once() -> None:
    """Both walls end there, and each had the gap to it; in the corner (0, 0) there are two gaps."""
    enclosure = make_enclosure(disc_in(L, [1.5, 1.5], model="reduced"), 0.0)
    names = enclosure.container.walls

    def near(x: float, y: float) -> list[str]:
        q = Configuration(np.array([[x, y]]), np.zeros(1), np.array([0.5]))
        return [names[k - 1] for k in find_pairs(q, enclosure, 0.2).j]

    away = 0.6 / np.sqrt(2.0)
    assert near(3.0 - away, 3.0 - away) == ["shelf"]
    assert near(2.999, 2.4) == near(3.001, 2.4) == ["shelf"]
    assert near(2.4, 2.999) == ["shelf"]
    assert near(2.4, 3.001) == ["inner"]
    assert near(0.6, 0.6) == ["bottom", "left"]
