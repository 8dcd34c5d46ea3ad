"""Exact laws in reduced cases: each pair and wall has its own, at every gap."""

from __future__ import annotations

from math import log, pi

import numpy as np
import pytest

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.errors import InputError, SolveError
from fsi.lubrication import exact, spheres, two_discs
from fsi.lubrication.expansions import MODES, Shape
from fsi.lubrication.named_laws import exact_resistance
from fsi.models import make_model
from fsi.reduced.gap_laws import Films, make_laws, make_tangential_laws
from fsi.reduced.model import ReducedModel
from tests.reduced_data import EQUAL, LARGE, PLANE, disc, reduced_case


def resistance(radii: tuple[float, float], gap: float, shape: str) -> float:
    """Of a pair that is pushed together, the force of its film over the rate of its gap."""
    a, b = radii
    bodies = [
        {"name": "a", "radius": a, "position": [0.0, 0.0], "force": [0.0, -1.0]},
        {"name": "b", "radius": b, "position": [0.0, -a - b - gap], "force": [0.0, 1.0]},
    ]
    geometry = "planar" if shape == "discs" else "axisymmetric"
    found = ReducedModel(reduced_case(bodies, {"drag": 1.0}, domain=LARGE, geometry=geometry))(
        Configuration.unturned(np.array([body["position"] for body in bodies]), np.array(radii)), 0.0
    )
    (pair,) = np.flatnonzero(~found.pairs.is_wall)
    return float(found.force[pair] / found.rates[pair])


@pytest.mark.parametrize("shape", ["discs", pytest.param("spheres", marks=pytest.mark.slow)])
def test_the_exact_law_is_that_of_the_pair(shape: Shape) -> None:
    """Radii 2 : 6 at a gap of 0.3, of spheres less 6 pi a_r: that of equal bodies is off by 0.8 % or more."""
    own = float(exact_resistance(shape, "squeeze", 0.2, 3.0))
    unit, far = (1.0, 0.0) if shape == "discs" else (1.5, 6.0 * pi)
    assert resistance((2.0, 6.0), 0.3, shape) == pytest.approx(unit * (own - far), rel=1e-8)
    equal = float(exact_resistance(shape, "squeeze", 0.2, 1.0))
    assert abs(equal / own - 1.0) > 0.008


def many_films(radii: Array) -> tuple[Films, Array, Array]:
    """All pairs of these radii, and theirs, (P,)."""
    i, j = np.triu_indices(len(radii))
    a, b = radii[i], radii[j]
    a_r = a * b / (a + b)
    return Films(a_r, a_r / a * (1.0 - a_r / a), np.zeros(len(i), dtype=bool)), a, b


@pytest.mark.parametrize("gap", [1e-6, 0.1, 4.0, 300.0])
def test_many_discs_have_the_law_of_each_pair(gap: float) -> None:
    """50 radii from 1 to 50, less the law at the cutoff; polynomials in k are off by 1e-5, in rolling 5 %.

    Rolling of unlike discs is easier at some gap than at this cutoff, and refused there.
    """
    radii = np.geomspace(1.0, 50.0, 50)
    bodies = [disc(f"d{i}", 120.0 * i, 0.0, a) for i, a in enumerate(radii.tolist())]
    given = {"drag": 1.0, "cutoff": 1e4, "shear_law": "exact", "rotation_law": "exact"}
    case = reduced_case(bodies, given, domain={"shape": "unbounded"})
    laws, (films, a, b) = {"squeeze": make_laws(case), **make_tangential_laws(case)}, many_films(radii)
    resistances = (exact.relative_resistance, two_discs.sliding_resistance, two_discs.rolling_resistance)
    for mode, resistance in zip(MODES, resistances, strict=True):
        expected = resistance(gap, a, b, 1.0) - resistance(1e4, a, b, 1.0)
        resists = np.flatnonzero(expected > 0.0)
        assert len(resists) == len(a) or (mode == "rotation" and gap > 1.0 and len(resists) >= len(radii))
        kappa = laws[mode].kappa(np.full(len(resists), log(gap)), films.of(resists))
        if len(resists) < len(a):
            with pytest.raises(SolveError, match=r"^reduced\.rotation_law: .* shorten reduced\.cutoff"):
                laws[mode].kappa(np.full(len(a), log(gap)), films)
        # each of two numbers may be off by some 1e-16, also where they are nearly the same
        size = resistance(gap, a, b, 1.0).max()
        np.testing.assert_allclose(kappa, expected[resists], rtol=1e-11, atol=1e-14 * size)


@pytest.mark.slow
def test_many_spheres_share_laws_at_a_few_ratios() -> None:
    """20 radii from 1 to 10, without drag; measured 2e-10, by ten laws in k 6e-9."""
    radii = np.geomspace(1.0, 10.0, 20)
    bodies = [
        {"name": f"s{i}", "radius": a, "position": [0.0, 40.0 * i], "velocity": [0.0, 0.0]}
        for i, a in enumerate(radii.tolist())
    ]
    case = reduced_case(bodies, {"drag": 0.0}, domain={"shape": "unbounded"}, geometry="axisymmetric")
    laws, (films, a, b) = make_laws(case), many_films(radii)
    for gap in (1e-6, 0.01, 1.0, 60.0, 3000.0):
        kappa = laws.kappa(np.full(len(a), log(gap)), films)
        np.testing.assert_allclose(kappa, spheres.relative_resistance(gap, a, b, 1.0), rtol=2e-9)


def test_a_disc_in_a_round_container() -> None:
    """Concentric, `4 pi mu / (ln(R/a) - (R^2 - a^2)/(R^2 + a^2))`, of the annulus between circles."""
    case = reduced_case([disc("a", 0.0, 0.0)], {"drag": 1e-9}, domain={"shape": "round", "radius": 3.0})
    films = Films(np.array([1.5]), np.array([-0.75]), np.array([True]))
    K = make_laws(case).kappa(np.log([2.0]), films)
    assert pytest.approx(4.0 * pi / (log(3.0) - 0.8), rel=1e-9) == K


def test_the_law_of_a_plane_is_for_spheres_in_large_containers_only() -> None:
    """Beyond 100 radii it is within 1 %, of which 6 pi a are drag; less is refused."""
    ball, near = [disc("a", 0.0, 0.0)], {"shape": "round", "radius": 3.0}
    far = reduced_case(ball, {}, domain={"shape": "round", "radius": 200.0}, geometry="axisymmetric")
    films = Films(np.array([200.0 / 199.0]), np.array([-200.0 / 199.0**2]), np.array([True]))
    K = make_laws(far).kappa(np.log([0.1]), films)
    assert pytest.approx(float(spheres.normal_resistance(0.1, 1.0, 1.0)) - 6.0 * pi, rel=0.01) == K
    refusal = r"within a round wall of 3 radii; give reduced\.wall_law = \"leading\""
    with pytest.raises(InputError, match=refusal):
        make_model(reduced_case(ball, {}, domain=near, geometry="axisymmetric"))


def test_far_discs_have_the_exact_law() -> None:
    """`4 pi/(L - tanh L)` of equal discs at a gap of 200, cosh L = 20401, and 1000 beside a plane.

    The power of the gap at 100 reduced radii is 5.3 and 9.7 % off.
    """
    films = Films(np.array([0.5, 1.0]), np.array([0.25, 0.0]), np.array([False, True]))
    laws = make_laws(reduced_case(EQUAL, {"drag": 1.0}, domain=PLANE))
    L = np.arccosh([20401.0, 1001.0])
    np.testing.assert_allclose(
        laws.kappa(np.log([200.0, 1000.0]), films), 4.0 * pi / (L - np.tanh(L)), rtol=1e-12
    )
