"""The network's solve against dense algebra, and what must hold for any forces."""

from __future__ import annotations

import numpy as np
import pytest

from fsi.bodies.configuration import Configuration
from fsi.case.wall_velocity import WallVelocities, WallVelocity
from fsi.meshes.geometry.box import Box
from fsi.reduced.enclosure import Enclosure
from fsi.reduced.network import make_network
from fsi.reduced.pairs import Pairs, find_pairs


def cluster(d: int, number: int, reach: float = 0.5) -> tuple[Configuration, Pairs]:
    """Spheres or discs on a disturbed lattice in a box."""
    random = np.random.default_rng(5)
    n = round(number ** (1.0 / d))
    grid = np.stack(np.meshgrid(*[np.arange(n)] * d, indexing="ij"), axis=-1).reshape(-1, d)
    x = 2.2 * grid + 0.1 * random.uniform(-1.0, 1.0, grid.shape) + 1.15
    box = Box((0.0,) * d, (2.2 * n + 0.1,) * d)
    q = Configuration.unturned(x, np.ones(len(x)))
    return q, find_pairs(q, without_flow(box, 1.0), reach)


def without_flow(box: Box, speed: float = 0.0) -> Enclosure:
    """Walls that all move so fast along each axis, and no flow."""
    d = box.dimension
    walls = WallVelocities((WallVelocity.uniform([speed] * d),) * (2 * d))
    return Enclosure(box, np.ones(2 * d, bool), walls, np.zeros(d), np.zeros((d, d)))


@pytest.mark.parametrize("d", [2, 3])
def test_the_solve_is_that_of_the_dense_system(d: int) -> None:
    """Z u + G^T kappa (G u - b) = f."""
    q, pairs = cluster(d, 27 if d == 3 else 25)
    random = np.random.default_rng(1)
    Z, f = 1.0 + random.random(q.centres.shape), random.standard_normal(q.centres.shape)
    kappa = pairs.gap**-1.5
    network = make_network(pairs, kappa, 1.0 / Z)
    u, force = network.solve(f / Z, 1.0 / Z)
    G = network.G.toarray()
    dense = np.linalg.solve(
        np.diag(Z.ravel()) + G.T @ (kappa[:, None] * G), f.ravel() + G.T @ (kappa * pairs.b)
    )
    assert u.ravel() == pytest.approx(dense, rel=1e-11, abs=1e-12)
    assert force == pytest.approx(kappa * network.rates(u), rel=1e-9, abs=1e-11)


@pytest.mark.parametrize("d", [2, 3])
def test_iterations_find_what_factors_find(d: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Large networks are solved by conjugate gradients."""
    q, pairs = cluster(d, 216)
    f = np.random.default_rng(1).standard_normal(q.centres.shape)
    network = make_network(pairs, pairs.gap**-1.0, np.ones_like(f))
    direct, _ = network.solve(f, np.ones_like(f))
    monkeypatch.setattr("fsi.reduced.gap_forces.LARGEST_DIRECT", 10)
    iterated, _ = network.solve(f, np.ones_like(f))
    assert not np.array_equal(iterated, direct)
    assert iterated == pytest.approx(direct, abs=1e-12)


def test_a_long_chain_of_stiff_gaps_is_factorised(monkeypatch: pytest.MonkeyPatch) -> None:
    """A push at one end of N rigid discs in a row moves all with f / N; iterations need about N for it."""
    N = 2000
    q = Configuration.unturned(np.column_stack([2.01 * np.arange(N), np.zeros(N)]), np.ones(N))
    box = Box((-1e6, -1e6), (1e6, 1e6))
    pairs = find_pairs(q, without_flow(box), 0.5)
    network = make_network(pairs, np.full(len(pairs), 1e14), np.ones((N, 2)))
    f = np.zeros((N, 2))
    f[0, 0] = 1.0
    monkeypatch.setattr("fsi.reduced.gap_forces.LARGEST_DIRECT", 10)
    u, _ = network.solve(f, np.ones((N, 2)))
    assert u[:, 0] == pytest.approx(1.0 / N, rel=1e-6)  # cut off after 300 iterations most would be at rest


@pytest.mark.parametrize("kappa", [1e-300, 1e-3, 1e8, 1e300, np.inf])
def test_momentum_and_rigidity_at_any_stiffness(kappa: float) -> None:
    """More gaps than freedoms, and resistances without bound: the limit is a rigid cluster, not nonsense."""
    q, pairs = cluster(2, 36)
    pairs = find_pairs(q, without_flow(Box((-1e4, -1e4), (1e4, 1e4))), 0.5)
    f = np.random.default_rng(1).standard_normal(q.centres.shape)
    network = make_network(pairs, np.full(len(pairs), kappa), np.ones_like(f), stored=True)
    u, force = network.solve(f, np.ones_like(f))
    assert np.isfinite(force).all()
    assert np.abs(u + network.loads(force) - f).max() < 1e-12 * max(1.0, np.abs(force).max())
    assert u.sum(axis=0) == pytest.approx(f.sum(axis=0), abs=1e-11)
    if kappa >= 1e300:
        assert np.abs(network.rates(u)).max() < 1e-11
    if kappa <= 1e-300:
        assert u == pytest.approx(f, abs=1e-15)


def test_a_rigid_motion_costs_nothing() -> None:
    q, pairs = cluster(2, 16)
    keep = ~pairs.is_wall
    spin = np.column_stack([2.0 - 3.0 * q.centres[:, 1], 3.0 * q.centres[:, 0] - 1.0])
    network = make_network(pairs, pairs.gap**-1.0, np.ones_like(spin))
    assert np.abs((network.G @ spin.ravel())[keep]).max() < 1e-13 * np.abs(spin).max()
    assert np.abs((network.G @ spin.ravel())[~keep]).max() > 1.0
