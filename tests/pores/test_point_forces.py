"""The stress of point forces: in equilibrium, with these forces, periodic; series sum it."""

from __future__ import annotations

import numpy as np
import pytest

from fsi.arrays import Array
from fsi.pores.fluid_discs import pores_without_wide
from fsi.pores.force_series import ForceSeries
from fsi.pores.point_forces import PointForces
from fsi.pores.regions import shapes_of
from fsi.pores.surfaces import BoundingSurfaces
from tests.pore_surfaces import couette

NONE = np.zeros((0, 2))
ROW = np.array([[0.0, 2.0]])
LATTICE = np.array([[3.0, 0.4], [-0.5, 2.0]])
FAR = np.array([[0.3, -9.0], [1.0, 0.0]])
PERIODS = {"none": NONE, "row": ROW, "lattice": LATTICE, "rows far apart": FAR}


def forces(periods: Array) -> PointForces:
    rng = np.random.default_rng(0)
    dp_dx = 0.3 if len(periods) == 1 else 0.0
    return PointForces(
        rng.uniform(size=(3, 2)), rng.normal(size=(3, 3)), periods, dp_dx, np.array([0.3, -0.2])
    )


def sigma(of: PointForces, x: Array) -> Array:
    p, D = of.stress(x)
    return np.stack([D.real - p, D.imag, D.imag, -D.real - p], axis=1).reshape(-1, 2, 2)


@pytest.mark.parametrize("periods", PERIODS.values(), ids=PERIODS)
def test_the_stress_is_in_equilibrium_and_its_pressure_harmonic(periods: Array) -> None:
    """By differences, off by 2e-5 of the largest; with a term of another sign by as much as that."""
    of, h = forces(periods), 1e-4
    x = np.random.default_rng(1).uniform(-1.0, 2.0, size=(40, 2))
    x = x[np.linalg.norm(x[:, None] - of.at, axis=2).min(axis=1) > 0.3]
    steps = h * np.eye(2)
    rise = np.stack([(sigma(of, x + e) - sigma(of, x - e)) / (2.0 * h) for e in steps], axis=-1)
    scale = np.abs(rise).max()
    assert np.abs(np.einsum("nijj->ni", rise)).max() < 1e-4 * scale
    bend = sum(of.stress(x + e)[0] + of.stress(x - e)[0] - 2.0 * of.stress(x)[0] for e in steps) / h**2
    assert np.abs(bend).max() < 1e-2 * scale


@pytest.mark.parametrize("periods", PERIODS.values(), ids=PERIODS)
def test_tractions_around_a_point_are_its_force_and_torque(periods: Array) -> None:
    """The fluid outside takes F from what is inside: the integral of sigma n is -F, of its moment -T."""
    of, angle, r = forces(periods), 2.0 * np.pi * np.arange(100) / 100, 0.05
    n = np.column_stack([np.cos(angle), np.sin(angle)])
    for at, F in zip(of.at, of.F, strict=True):
        t = 2.0 * np.pi * r / 100 * np.einsum("nij,nj->ni", sigma(of, at + r * n), n)
        moment = r * (n[:, 0] @ t[:, 1] - n[:, 1] @ t[:, 0])
        np.testing.assert_allclose([*t.sum(axis=0), moment], -F, atol=1e-12)


@pytest.mark.parametrize("periods", [ROW, LATTICE, FAR])
def test_the_stress_is_periodic_and_the_pressure_rises_by_its_mean_gradient(periods: Array) -> None:
    """In a lattice it balances the forces over the area of a cell; between walls it is given."""
    of, x = forces(periods), np.random.default_rng(2).uniform(-2.0, 2.0, size=(40, 2))
    area = abs(np.linalg.det(periods)) if len(periods) == 2 else np.nan
    G = of.F[:, :2].sum(axis=0) / area if len(periods) == 2 else [0.0, 0.3]
    np.testing.assert_allclose(of.gradient, G)
    p, D = of.stress(x)
    for period in periods:
        shifted = of.stress(x + 3.0 * period)
        np.testing.assert_allclose(shifted[1], D, atol=1e-10 * np.abs(D).max())
        np.testing.assert_allclose(shifted[0], p + 3.0 * period @ of.gradient, atol=1e-10 * np.abs(p).max())


def test_the_stress_does_not_know_which_image_is_the_nearest() -> None:
    """Half a period away from a force another image becomes it: p and D are the same on both sides, to 1e-6.

    A wrong linear part of a lattice would make a step of a tenth and more.
    """
    of = PointForces(np.zeros((1, 2)), np.array([[1.0, 2.0, 0.5]]), LATTICE, 0.0, np.zeros(2))
    for first, other in (LATTICE, LATTICE[::-1]):
        p, D = of.stress((0.5 + np.array([[-1e-8], [1e-8]])) * first + 0.3 * other)
        assert abs(p[1] - p[0]) < 1e-6
        assert abs(D[1] - D[0]) < 1e-6


def in_pores(surfaces: BoundingSurfaces, of: PointForces) -> tuple[ForceSeries, Array]:
    """The series, and points in pores and in fluid discs, (P, 4, 2)."""
    pores = pores_without_wide(surfaces)
    shapes, surfaces = shapes_of(pores), pores.surfaces
    fluid = surfaces.centre[surfaces.fluid], surfaces.radius[surfaces.fluid]
    around = fluid[0][:, None] + 0.9 * fluid[1][:, None, None] * np.array([[0, 0], [1, 0], [0, 1], [-1, 0]])
    middle = shapes.touch.mean(axis=1, keepdims=True)
    return ForceSeries.of(of, shapes, surfaces), np.concatenate(
        [np.concatenate([middle, shapes.touch], 1), around]
    )


@pytest.mark.parametrize("periodic", [True, False])
def test_series_sum_the_same_stress(periodic: bool) -> None:
    """What they leave out is 1e-12 of what is left of far forces; ten discs between walls, or not."""
    surfaces, _, _ = couette()
    bodies = ~surfaces.fluid & (surfaces.radius > 0.0)
    F = np.random.default_rng(3).normal(size=(int(bodies.sum()), 3))
    periods = surfaces.periods if periodic else NONE
    of = PointForces(surfaces.centre[bodies], F, periods, 0.2 if periodic else 0.0, np.zeros(2))
    series, x = in_pores(surfaces, of)
    assert np.mean(series.radius > 0.0) > 0.5
    p, D = series.stress(np.arange(len(x)), x)
    exact_p, exact_D = of.stress(x.reshape(-1, 2))
    np.testing.assert_allclose(p.ravel(), exact_p, atol=1e-10 * np.abs(exact_p).max())
    np.testing.assert_allclose(D.ravel(), exact_D, atol=1e-10 * np.abs(exact_D).max())
