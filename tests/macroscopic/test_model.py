"""The macroscopic model against exact solutions (theory: M1, M2, M3), and the gluey chain against it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.optimize import isotonic_regression

from fsi.arrays import Array
from fsi.case.gluey import ContactLaw
from fsi.gluey.contacts import Room
from fsi.gluey.film import SphereFilm
from fsi.gluey.step import advance
from fsi.gluey.system import GlueyState, System
from fsi.macroscopic.evolution import smallest_gap
from fsi.macroscopic.model import Force, Parcels, blocks
from fsi.meshes.geometry.unbounded import Unbounded

NUMBERS = (200, 800, 3200)


def march(parcels: Parcels, f: Force, end: float, steps: int) -> Parcels:
    h = end / steps
    for k in range(steps):
        parcels = parcels.advance(f, k * h, h)
    return parcels


def free(x: Array, _m: Array, _t: float) -> Array:
    return np.zeros_like(x)


def two_blocks(n: int, shift: float = 0.0) -> Parcels:
    parcels, block = blocks([(shift - 2.0, shift - 1.0, 1.0), (shift + 1.0, shift + 2.0, 1.0)], n)
    return parcels.moving(np.where(block == 0, 1.0, -0.5))


def converging(n: int) -> Parcels:
    parcels, _ = blocks([(-1.0, 1.0, 0.5)], n)
    return parcels.moving(-parcels.X)


@pytest.mark.parametrize("n", [50, 800])
def test_sticky_blocks_merge(n: int) -> None:
    """M1: they meet at t = 4/3 and go on at u = 1/4 with max pi = 3/4 (momentum of the halves)."""
    before = march(two_blocks(n), free, 1.3, 20)
    assert before.gamma.min() == pytest.approx(0.0, abs=1e-9)
    after = march(two_blocks(n), free, 2.0, 2 * n)
    np.testing.assert_allclose(after.u, 0.25, atol=1e-9)
    assert after.gamma.min() == pytest.approx(-0.75, abs=1e-9)
    # The middle of all goes from 0 at 1/4.
    np.testing.assert_allclose(after.X, 0.5 + after.m - 1.0, atol=1e-9)


@pytest.mark.parametrize(
    ("shift", "h", "steps"),
    [(0.0, 5e-3, 400), (1e6, 5e-3, 400), (1e9, 5e-3, 400), (0.0, 1e-9, 50), (0.0, 1e-12, 50)],
)
def test_nothing_is_lost_far_from_the_origin_or_in_tiny_steps(shift: float, h: float, steps: int) -> None:
    """M1, with exact momentum 1/2, and u = 1/4 after t = 4/3; short of it u = w and no memory at all.

    From differences of places u missed 2e-7 at 1e6, 3e-4 at 1e9, 5e-6 in steps of 1e-9.
    """
    parcels = march(two_blocks(400, shift), free, steps * h, steps)
    assert parcels.u.sum() * parcels.dm == pytest.approx(0.5, rel=1e-13)
    assert parcels.gamma.max() <= 1e-13
    assert parcels.density.max() <= 1.0
    if steps * h < 4.0 / 3.0:
        np.testing.assert_array_equal(parcels.u, parcels.w)
    else:
        np.testing.assert_allclose(parcels.u, 0.25, rtol=1e-13)
        assert parcels.gamma.min() == pytest.approx(-0.75, rel=1e-13)
    # The middle of all; their places round to 1e-7 at 1e9.
    assert parcels.X.mean() - shift == pytest.approx(0.25 * steps * h, abs=1e-13 + 3e-16 * shift)


def test_what_touches_is_pushed_together_in_tiny_steps() -> None:
    """Neighbours at 0.3, 0.1, -0.1 and -0.5, with s = 2, in a step of 1e-12: all go on at their mean, -0.05.

    Of w + s/h itself only three digits of w would be left.
    """
    parcels, _ = blocks([(0.0, 1.0, 1.0), (3.0, 4.0, 1.0)], 8)
    w = np.array([-1.0, -1.0, -1.0, -1.0, 0.3, 0.1, -0.1, -0.5])
    after = parcels.moving(w).advance(free, 0.0, 1e-12)
    np.testing.assert_allclose(after.u, np.repeat([-1.0, -0.05], 4), rtol=1e-14)
    # pi: what each pushes, dm times the sum of w - u from the left
    np.testing.assert_allclose(-after.gamma[5:8], 0.25 * np.array([0.35, 0.5, 0.45]), rtol=1e-14)


def memory_error(n: int) -> float:
    """M2: from t1 = 2 the halves are pulled by -+a: gap a (t - t1 - 0.75/a)^2, here at t = 4 with a = 1."""
    pull: Force = lambda x, m, t: np.where((t > 2.0) & (x < np.inf), np.where(m < 1.0, -1.0, 1.0), 0.0)  # noqa: E731
    end = march(two_blocks(n), pull, 4.0, 2 * n)
    return float(abs(end.X[n // 2] - end.X[n // 2 - 1] - end.dm - 1.25**2))


def bulk_error(n: int) -> float:
    """M3: pulled by 2 b m from t1 = 1, released after 1/b: rho = 1/(1 + b (t - t1 - 1/b)^2)."""
    pull: Force = lambda x, m, t: np.where(t > 1.0, 2.0 * (m - 0.5), 0.0) + 0.0 * x  # noqa: E731
    end = march(converging(n), pull, 4.0, 2 * n)
    return float(np.abs(end.density - 0.2).max())


@pytest.mark.parametrize("error", [memory_error, bulk_error])
def test_errors_fall_by_four_when_parcels_and_steps_grow_by_four(error: Callable[[int], float]) -> None:
    errors = [error(n) for n in NUMBERS]
    assert errors[-1] <= 1e-3
    np.testing.assert_allclose([errors[0] / errors[1], errors[1] / errors[2]], 4.0, rtol=0.1)


def test_the_bulk_stores_a_parabola() -> None:
    """M3: after congestion pi = 1/4 - m^2, m counted from the middle; exact, as u is linear."""
    parcels = march(converging(400), free, 0.75, 100)
    ends = np.arange(401) * parcels.dm - 0.5
    np.testing.assert_allclose(parcels.gamma, ends**2 - 0.25, atol=1e-12)


def chain(n: int, X: Array, u: Array, dm: float) -> tuple[System, GlueyState]:
    """n spheres of diameter dm and mass dm on a line."""
    room = Room(np.empty((0, 1)), np.empty((0, 1)), Unbounded(dimension=1))
    mass = np.full((n, 1), dm)
    radii = np.full(n, dm / 2)
    system = System(radii, mass, room, lambda _t0, _t1: np.zeros((n, 1)), ContactLaw(), SphereFilm)
    return system, GlueyState.at(X[:, None], u[:, None])


def test_a_chain_of_a_thousand_is_the_isotonic_solution() -> None:
    """Random velocities: the projection of every step equals the pool of adjacent violators to 1e-8."""
    n, h = 1000, 0.05
    random = np.random.default_rng(3)
    m = np.arange(n, dtype=np.float64) + np.float64(0.5)
    slack, u = np.sort(random.uniform(0.0, 100.0, n)), random.normal(size=n)
    parcels = Parcels(m, 1.0, 0.0, slack, u, u)
    dm = 1.0
    system, state = chain(n, parcels.X, parcels.u, dm)
    assert np.allclose(isotonic_regression(slack).x, slack)
    for k in range(10):
        state, _, checks = advance(system, state, k * h, h)
        parcels = parcels.advance(free, k * h, h)
        assert checks.kkt <= 1e-8
        np.testing.assert_allclose(state.centres[:, 0], parcels.X, atol=1e-8)


def test_chains_tend_to_the_macroscopic_model() -> None:
    """u = x^2 - sin(pi x) on a half-full line: positions at given masses differ by less for more spheres."""
    errors = []
    fine = macroscopic_positions(3200)
    for n in (15, 30, 60):
        begin = running_together(n)
        system, state = chain(n, begin.X, begin.u, begin.dm)
        h = 0.4 / (2 * n)
        for k in range(2 * n):
            state, _, _ = advance(system, state, k * h, h)
        errors.append(np.abs(state.centres[:, 0] - np.interp(begin.m, *fine)).max())
    assert errors[0] > 1.7 * errors[1] > 1.7**2 * errors[2]


def running_together(n: int) -> Parcels:
    parcels, _ = blocks([(-1.0, 1.0, 0.5)], n)
    return parcels.moving(parcels.X**2 - np.sin(np.pi * parcels.X))


def macroscopic_positions(n: int) -> tuple[Array, Array]:
    end = march(running_together(n), free, 0.4, n)
    return end.m, end.X


def test_gaps_of_congested_parcels_are_zero() -> None:
    """Places of blocks in contact round to gaps of a few 1e-16 and below zero; a real gap stays."""
    merged = march(two_blocks(300), free, 2.0, 60)
    gaps = np.diff(merged.X) - merged.dm
    assert 0.0 < np.abs(gaps).max() < 1e-14
    assert smallest_gap(merged) == 0.0
    middle = np.arange(1, len(merged.X)) == len(merged.X) // 2
    before = march(two_blocks(300), free, 1.0, 30)  # the blocks have come 3/2 nearer, of 2
    assert smallest_gap(before, middle) == pytest.approx(0.5, rel=1e-12)
