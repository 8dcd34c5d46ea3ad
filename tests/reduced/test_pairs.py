"""Neighbours against all pairs of all images."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import product

import numpy as np
import pytest

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.case.wall_velocity import WallVelocities
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.lattice import reduced
from fsi.meshes.geometry.round import HalfPlane, Round
from fsi.reduced.enclosure import Enclosure
from fsi.reduced.network import gradient
from fsi.reduced.pairs import Pairs, find_pairs, of_keys, turning


@dataclass(frozen=True, eq=False)
class Far(Round):
    """A wall that nobody meets, and any periods."""

    radius: float = 1e6
    vectors: Array = field(default_factory=lambda: np.empty((0, 1)))

    @property
    def periods(self) -> Array:
        return self.vectors


def space(container: Container, d: int, gradient: Array | None = None) -> Enclosure:
    rest = WallVelocities.given(container.walls, {}, d)
    E = np.zeros((d, d)) if gradient is None else gradient
    return Enclosure(container, np.ones(len(container.walls), bool), rest, np.zeros(d), E)


def bodies(d: int, number: int, room: float, seed: int = 0) -> Configuration:
    random = np.random.default_rng(seed)
    return Configuration.unturned(room * random.random((number, d)), 0.3 + 0.4 * random.random(number))


def brute_force(q: Configuration, periods: Array, reach: float) -> dict[tuple[float, ...], float]:
    """The gaps of all pairs of bodies and images, by sides and rounded shift."""
    found = {}
    for i, j in product(range(len(q)), repeat=2):
        for m in product(range(-5, 6) if len(periods) < 3 else range(-3, 4), repeat=len(periods)):
            shift = np.array(m) @ periods if len(periods) else np.zeros(q.dimension)
            gap = np.linalg.norm(q.centres[i] - q.centres[j] - shift) - q.radii[i] - q.radii[j]
            first = (i, j) < (j, i) or (i == j and m > (0,) * len(m))
            if gap <= reach and first:
                found[(i, j, *np.round(shift, 6))] = gap
    return found


SHEARED = np.array([[3.0, 0.0], [7.3, 3.2]])
LATTICES = {
    "none": np.empty((0, 2)),
    "channel": np.array([[3.1, 0.0]]),
    "square": np.diag([3.0, 3.5]),
    "sheared": SHEARED,
    "space": np.diag([2.5, 2.6, 2.7]),
    "none in space": np.empty((0, 3)),
}


@pytest.mark.parametrize("name", LATTICES)
def test_all_pairs_of_images_are_found(name: str) -> None:
    periods = LATTICES[name]
    q = bodies(periods.shape[1], 12, 3.0)
    # Bodies that have wandered into other cells are the same bodies.
    if len(periods):
        steps = np.random.default_rng(1).integers(-1, 2, (12, len(periods)))
        q = Configuration.unturned(q.centres + steps @ periods, q.radii)
    pairs = find_pairs(
        q, space(Far(vectors=periods, dimension=periods.shape[1]), periods.shape[1]), reach=0.8
    )
    expected = brute_force(q, periods, 0.8)
    found = {
        (int(i), int(j), *np.round(shift, 6)): gap
        for i, j, shift, gap in zip(pairs.i, pairs.j, pairs.shift, pairs.gap, strict=True)
    }
    normal = {_positive(key): gap for key, gap in found.items()}
    assert len(normal) == len(pairs)
    assert normal.keys() == {_positive(key) for key in expected}
    for key, gap in expected.items():
        assert normal[_positive(key)] == pytest.approx(gap, abs=1e-12)


def _positive(key: tuple[float, ...]) -> tuple[float, ...]:
    """A body and its own image: +s and -s are one pair."""
    i, j, *shift = key
    shift = [s + 0.0 for s in shift]
    return (i, j, *max(shift, [-s + 0.0 for s in shift])) if i == j else (i, j, *shift)


def test_the_reduced_basis_spans_the_same_lattice_and_is_short() -> None:
    a, b = reduced(SHEARED)
    m = np.array([a, b]) @ np.linalg.inv(SHEARED)
    assert np.allclose(m, np.round(m))
    assert abs(round(float(np.linalg.det(m)))) == 1
    assert abs(a @ b) <= 0.5 * (a @ a) + 1e-12


CONTAINERS: list[tuple[Container, int]] = [
    (Box((-1.0, -1.0), (4.0, 4.0)), 2),
    (HalfPlane(100.0), 2),
    (Round(6.0), 2),
    (Box((-1.0, -1.0), (4.0, 4.0), periodic=("x",)), 2),
    (Box((-1.0, -1.0, -1.0), (4.0, 4.0, 4.0)), 3),
]


def gaps_at(x: Array, q: Configuration, room: Enclosure, key: Pairs) -> Array:
    return of_keys(Configuration.unturned(x, q.radii), room, key.key).gap


@pytest.mark.parametrize(("container", "d"), CONTAINERS)
def test_g_is_the_gradient_of_the_gap_and_turning_its_second_derivative(container: Container, d: int) -> None:
    """Central differences of D along straight ways; at 1e-5 and 1e-4 their errors are below these bounds."""
    q = bodies(d, 6, 3.0, seed=3)
    room = space(container, d)
    pairs = find_pairs(q, room, np.inf)
    assert pairs.is_wall.sum() == 6 * len(container.walls) - 6 * isinstance(container, HalfPlane)
    u = np.random.default_rng(2).standard_normal(q.centres.shape)
    up, down = (gaps_at(q.centres + h * u, q, room, pairs) for h in (1e-5, -1e-5))
    assert gradient(pairs, 6) @ u.ravel() == pytest.approx((up - down) / 2e-5, abs=1e-8)
    up, down = (gaps_at(q.centres + h * u, q, room, pairs) for h in (1e-4, -1e-4))
    assert turning(pairs, u) == pytest.approx((up + down - 2.0 * pairs.gap) / 1e-8, abs=1e-5)


def test_images_move_with_the_lattice() -> None:
    """D' of a pair across the top of a sheared cell is -n.(E s), for bodies at rest."""
    E = np.array([[0.0, 2.0], [0.0, 0.0]])
    q = Configuration.unturned(np.array([[0.2, 0.1], [0.1, 2.9]]), np.array([0.3, 0.3]))
    pairs = find_pairs(q, space(Far(vectors=np.diag([9.0, 3.0])), 2, E), reach=0.5)
    assert len(pairs) == 1
    assert abs(pairs.shift[0, 1]) == 3.0
    assert pairs.b[0] == pytest.approx(pairs.n[0] @ E @ pairs.shift[0])
    assert pairs.b[0] != 0.0


def test_the_reduced_radius_of_a_round_wall() -> None:
    q = Configuration.unturned(np.array([[0.0, 3.0]]), np.array([2.0]))
    pairs = find_pairs(q, space(Round(6.0), 2), np.inf)
    assert pairs.radius[0] == pytest.approx(1.0 / (1.0 / 2.0 - 1.0 / 6.0))
    assert pairs.gap[0] == pytest.approx(1.0)


@pytest.mark.parametrize(("gap", "near"), [(0.999, True), (1.001, False)])
def test_a_pair_is_near_up_to_the_reach_and_no_farther(gap: float, near: bool) -> None:
    """A disc and a wall, and two discs, 0.1 % within a reach of 1 and 0.1 % beyond."""
    disc = Configuration.unturned(np.array([[0.0, 1.0 + gap]]), np.ones(1))
    assert (len(find_pairs(disc, space(HalfPlane(100.0), 2), 1.0)) == 1) is near
    two = Configuration.unturned(np.array([[0.0, 50.0], [2.0 + gap, 50.0]]), np.ones(2))
    assert (len(find_pairs(two, space(HalfPlane(200.0), 2), 1.0)) == 1) is near


def test_the_far_end_of_a_half_plane_is_no_wall() -> None:
    """It stands for infinity: who comes near it meets nobody."""
    q = Configuration.unturned(np.array([[0.0, 98.5]]), np.ones(1))
    assert len(find_pairs(q, space(HalfPlane(100.0), 2), 1.0)) == 0
