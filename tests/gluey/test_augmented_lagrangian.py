"""One convex program for all eps >= 0: films against the implicit step, and their limit."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.optimize import brentq

from fsi.arrays import Array
from fsi.gluey.augmented_lagrangian import Program, minimise
from fsi.gluey.film import DiscFilm, Film, SphereFilm
from fsi.gluey.qp_solver import ContactResponse

H = 0.02


def chain(n: int) -> tuple[sp.csr_matrix, Array, Array]:
    """Gap rows of n + 1 bodies in a row, random gaps below 1e-3."""
    random = np.random.default_rng(2)
    G = sp.diags([-np.ones(n), np.ones(n)], [0, 1], shape=(n, n + 1)).tocsr()
    return G, random.uniform(1e-5, 1e-3, n), random.normal(size=n + 1)


@pytest.mark.parametrize("films", [SphereFilm, DiscFilm])
@pytest.mark.parametrize("eps", [1e-1, 1e-3])
def test_one_pair_is_the_implicit_step(films: type[Film], eps: float) -> None:
    """`(D1 - D)/h + gamma(D1) = w` solved by bracketing; w = u* here."""
    D, u = 1e-2, -0.3
    film = films(eps, 1.0, H)
    program = Program(sp.csr_matrix([[1.0]]), np.array([D / H]), np.ones(1), np.array([u]))
    best = minimise(program, np.zeros(1), film, 1e-13)
    expected = brentq(
        lambda D1: (D1 - D) / H + float(film.gamma(np.array([D1]))[0]) - u, 1e-300, 1.0, xtol=1e-16
    )
    assert D + H * best.u[0] == pytest.approx(expected, rel=1e-6, abs=1e-14)
    assert best.p[0] == pytest.approx(-float(film.gamma(np.array([expected]))[0]), rel=1e-6)


@pytest.mark.parametrize("films", [SphereFilm, DiscFilm])
def test_films_tend_to_the_gluey_step(films: type[Film]) -> None:
    """Gaps are positive at every eps (by gamma, they underflow); velocities tend to the dry ones."""
    G, D, u = chain(40)
    program = Program(G, D / H, np.ones(41), u)
    dry = minimise(program, np.zeros(40), ContactResponse.of_gaps(40), 1e-9)
    assert (D + H * (G @ dry.u)).min() >= -1e-10
    distances = []
    for eps in (1e-2, 1e-3, 1e-4):
        film = films(eps, 1.0, H)
        best = minimise(program, np.zeros(40), film, 1e-9)
        gaps = film.gap(-best.p)
        np.testing.assert_allclose(D + H * (G @ best.u), gaps, atol=1e-9)
        assert np.isfinite(best.p).all()  # so every gap is exp(-p/eps) > 0, however small
        distances.append(np.abs(best.u - dry.u).max())
    assert distances[0] > 5.0 * distances[1] > 25.0 * distances[2]
    assert distances[2] < (2e-4 if films is SphereFilm else 5e-3)
