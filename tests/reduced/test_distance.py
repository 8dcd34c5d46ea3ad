"""The distance of a pair by itself: positive whatever pushes it, and with the memory that it should have."""

from __future__ import annotations

import numpy as np
import pytest

from fsi.arrays import Array
from fsi.errors import SolveError
from fsi.lubrication.laws import CutLaw, LubricationLaw
from fsi.lubrication.named_laws import GapFilm, leading_law, slides_law
from fsi.reduced.first_integral import (
    FirstIntegral,
    Some,
    backward_euler_step,
)
from fsi.reduced.gap_laws import FilmLaw, Films, GapLaws

FILM = GapFilm("discs", 1e-2)
LAWS: dict[str, LubricationLaw] = {
    "slides": slides_law(FILM),
    "discs": leading_law(FILM),
    "discs, cut off": CutLaw(leading_law(FILM), 3.0),
}


def films(number: int) -> Films:
    return Films(np.ones(number), np.zeros(number), np.zeros(number, dtype=bool))


def integral_of(law: LubricationLaw) -> tuple[GapLaws, object]:
    for_all = FilmLaw((law,), np.zeros(1), "law")
    laws = GapLaws(for_all, for_all)

    def integral(x: Array, _: Some) -> tuple[Array, Array]:
        return laws.integral(x, films(len(x)))

    return laws, integral


@pytest.mark.parametrize("number", [10_000, pytest.param(100_000, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", LAWS)
def test_a_million_random_pushes_leave_the_gap_positive(name: str, number: int) -> None:
    """So many pairs, ten pushes each, over ten orders of magnitude; the first integral is kept to 1e-12.

    By default a tenth of a million.
    """
    random = np.random.default_rng(0)
    _, integral = integral_of(LAWS[name])
    x = np.log(10.0 ** random.uniform(-6.0, 0.0, number))
    g = 10.0 ** random.uniform(-1.0, 1.0, number)
    K, _ = integral(x, np.arange(number))  # type: ignore[operator]
    w = g * K + random.standard_normal(number)
    for _ in range(10):
        h = float(10.0 ** random.uniform(-4.0, 0.0))
        w = w + h * random.standard_normal(number) * 10.0 ** random.uniform(-5.0, 3.0, number)
        step = FirstIntegral(x, w, h, g, integral)  # type: ignore[arg-type]
        x = step.solve()
        assert np.isfinite(x).all()  # x = ln D: the gap is positive, whether or not exp(x) can be written
        assert step.defect(x) < 1e-12
        if name != "slides":
            assert np.all(np.exp(x) > 0.0)


def test_backward_euler_is_positive_too() -> None:
    random = np.random.default_rng(0)
    x, V = np.log(random.random(100_000)), random.standard_normal(100_000)
    for _ in range(10):
        x, V = backward_euler_step(x, V, 100.0 * random.standard_normal(100_000), 0.1, np.full(100_000, 1e-3))
        assert np.isfinite(x).all()


def test_backward_euler_takes_the_root_of_its_equation() -> None:
    """(D1 - D0)/h = V1 and (V1 - V0)/h = f - g mu V1 / D1."""
    D0, V0, f, h, g_mu = 0.3, -1.7, 2.0, 0.1, 0.05
    x, V = backward_euler_step(np.log([D0]), np.array([V0]), np.array([f]), h, np.array([g_mu]))
    D1 = np.exp(x)
    assert pytest.approx((D1 - D0) / h) == V
    assert (V - V0) / h == pytest.approx(f - g_mu * V / D1, rel=1e-12)


def test_one_step_keeps_the_push_and_the_literal_one_forgets_it() -> None:
    """A push by impulse -1, then a pull by 0.5: w = -0.5 still sticks, and the gap is exp(w/mu); by backward
    Euler it is at once wide open. Without viscosity the gluey limit says: closed."""
    law = slides_law(GapFilm("discs", 1e-3))
    _, integral = integral_of(law)
    x, g, h, one = np.log([0.5]), np.ones(1), 0.1, np.ones(1)
    w = 1e-3 * x
    X, V = x.copy(), np.zeros(1)
    for k in range(15):
        f = -10.0 if k < 10 else (1.0 if k < 15 else 0.0)
        w = w + h * f / (10.0 if k < 10 else 1.0) * one
        x = FirstIntegral(x, w, h, g, integral).solve()  # type: ignore[arg-type]
        X, V = backward_euler_step(X, V, np.array([f / (10.0 if k < 10 else 1.0)]), h, np.full(1, 1e-3))
    assert w[0] == pytest.approx(-0.5, abs=1e-3)
    assert x[0] == pytest.approx(w[0] / 1e-3, rel=1e-9)
    assert np.exp(X[0]) > 0.05


def test_two_held_sides_that_meet_are_refused() -> None:
    _, integral = integral_of(LAWS["slides"])
    with pytest.raises(SolveError, match="held"):
        FirstIntegral(np.log([0.1]), np.array([-2.0]), 0.1, np.zeros(1), integral).solve()  # type: ignore[arg-type]


def test_the_law_goes_on_below_the_smallest_number() -> None:
    """kappa D = mu and K = mu x for the slides at x = -30000, where D underflows."""
    laws, _ = integral_of(slides_law(GapFilm("discs", 1e-4)))
    x = np.array([-30000.0])
    K, slope = laws.integral(x, films(1))
    assert pytest.approx(-3.0, rel=1e-12) == K
    assert slope == pytest.approx(1e-4, rel=1e-12)
    assert laws.kappa(x, films(1)) == np.inf
