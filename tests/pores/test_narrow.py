"""Narrow necks, whose flux and speed of closing are numbers of their own: the same flow, with its digits."""

from __future__ import annotations

from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bench.random_cases import random_case
from fsi.arrays import Array
from fsi.case.case import Case
from fsi.case.load import load_case, parse_case
from fsi.pores import narrow
from fsi.pores.instant import PoreInstant
from fsi.pores.model import PoreModel
from fsi.pores.resistance import with_modes
from fsi.stokes.model import StokesModel

CASES = Path(__file__).parents[2] / "cases"
WALLS = {"bottom": [-1.0, 0.0], "top": [1.0, 0.0]}
DOMAINS: dict[str, dict[str, Any]] = {
    "channel": {"lower": [0.0, 0.0], "upper": [9.0, 7.0], "periodic": ["x"], "walls": WALLS},
    "cell": {"shape": "cell", "vectors": [[9.0, 0.0], [0.0, 7.0]], "shear": 1.0},
    "box": {"lower": [0.0, 0.0], "upper": [9.0, 7.0]},
    "round": {"shape": "round", "radius": 6.0},
}
CHECKS = ("residual", "power", "momentum")


def cluster(domain: str, gap: float, **more: Any) -> Case:
    """Three free discs, each so near to both others; where nothing else drives them they are pushed."""
    place = np.array([-0.8, -0.9] if domain == "round" else [4.0, 3.0])
    directions = [(np.cos(angle), np.sin(angle)) for angle in (0.4, 0.4 + np.pi / 3.0)]
    places = place + (2.0 + gap) * np.array([(0.0, 0.0), *directions])
    loads = [[0.0, -1.0], [0.3, 0.0], [0.0, 0.2]] if domain in ("box", "round") else 3 * [[0.0, 0.0]]
    bodies = [
        {"name": f"disc {i}", "radius": 1.0, "position": x, "force": F}
        for i, (x, F) in enumerate(zip(places.tolist(), loads, strict=True))
    ]
    data = {"name": "t", "model": "pores", "fluid": {"viscosity": 2.0}, "domain": DOMAINS[domain]}
    return parse_case(data | {"bodies": bodies} | more)


def solved(case: Case) -> PoreInstant:
    return PoreModel(case)(case.configuration(), 0.0)


KINDS = ["box, walls at rest", "channel, driven", "cell", "round container"]


@pytest.mark.parametrize(("kind", "seed"), [*product(KINDS, (2, 3)), ("cell", 9)])
def test_the_flow_is_that_without_numbers_of_their_own(
    kind: str, seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Random bodies, held and free, of all necks as if they were narrow.

    A wrong sign, arm or image would be off by order 1. Without, necks of gaps of 0.01 leave 1e-10, of 0.004
    up to 1.4e-8. The last case has necks to images of discs.
    """
    data = random_case(kind, seed).model_dump(mode="json", exclude_unset=True)
    del data["discretisation"]
    case = with_modes(parse_case(data | {"model": "pores"}), 4)
    monkeypatch.setattr(narrow, "NARROW", 0.0)
    without = solved(case)
    monkeypatch.setattr(narrow, "NARROW", 1e9)
    found = solved(case)
    assert found.flow.system.assembly.ties.shape[0] > without.flow.system.assembly.ties.shape[0] == 0
    for of_one, of_other in (
        (found.U, without.U),
        (found.F, without.F),
        (found.flow.dissipation_of_pores(), without.flow.dissipation_of_pores()),
        (found.necks.dissipation, without.necks.dissipation),
        (found.necks.flux, without.necks.flux),
    ):
        assert np.abs(of_one - of_other).max() <= 1e-7 * np.abs(of_other).max()
    assert found.dofs == without.dofs
    if found.bulk is not None and without.bulk is not None:
        assert np.abs(found.bulk.mean - without.bulk.mean).max() <= 1e-8 * np.abs(without.bulk.mean).max()
    x = np.random.default_rng(1).uniform(0.0, 1.0, (40, 2)) * 3.0
    u, v = found.velocity(x), without.velocity(x)
    assert np.nanmax(np.abs(u - v)) <= 1e-8 * np.nanmax(np.abs(v))


@pytest.mark.parametrize("domain", DOMAINS)
def test_identities_hold_and_velocities_tend_to_their_limit(domain: str) -> None:
    """Like sqrt(gap): from one gap to a hundredth of it the difference becomes a tenth; measured to 7 %.

    As differences of numbers of surfaces pressures at 1e-4 were known to 1e-6, and at 1e-6 not at all.
    """
    turning, lost = list[Array](), list[float]()
    for gap in (1e-4, 1e-6, 1e-8):
        found = solved(cluster(domain, gap, pores={"modes": 4}))
        assert max(found.checks[name] for name in CHECKS) <= 1e-10
        turning.append(found.U[:, 2])
        lost.append(float(found.necks.dissipation[found.necks.gap < 2.0 * gap].sum()))
    first, second = np.diff(turning, axis=0)
    assert second == pytest.approx(0.1 * first, rel=0.08)
    assert lost[1] - lost[2] == pytest.approx(0.1 * (lost[0] - lost[1]), rel=0.08)


@pytest.mark.parametrize("gap", [1e-6, 1e-8])
def test_the_stresslet_of_a_free_disc_that_nearly_touches_a_wall_is_known(gap: float) -> None:
    """In a sheared channel S_xy = (mu_app / mu - 1) mu |Omega| shear, to 1e-9 of it (measured 1e-9, 1e-10).

    As a difference of columns of numbers of surfaces it was known at 1e-8 to 4e-5, with bars of 1e-8.
    """
    walls = {"top": [4.0, 0.0]}
    channel = {"lower": [-2.0, 0.0], "upper": [2.3, 4.0], "periodic": ["x"], "walls": walls}
    disc = {"name": "disc", "radius": 1.0, "position": [0.6, 1.0 + gap]}
    data = {"name": "t", "model": "pores", "fluid": {"viscosity": 2.0}, "domain": channel, "bodies": [disc]}
    found = solved(parse_case(data | {"pores": {"modes": 12}}))
    assert found.bulk is not None
    assert found.apparent_viscosity is not None
    exact = 2.0 * (found.apparent_viscosity - 1.0) * 4.3 * 4.0
    assert found.bulk.stresslets[0, 0, 1] == pytest.approx(exact, rel=5e-9)


def test_three_discs_that_nearly_touch_turn_as_in_the_resolved_model() -> None:
    """At gaps of 1e-6 radii, by elements: 2e-6 and less apart (bars 2e-6), the viscosity 1.03e-5."""
    case = load_case(CASES / "pores" / "nearly_touching.toml", [])
    found = solved(case)
    resolved = case.model_copy(update={"model": "resolved"})
    exact = StokesModel(resolved)(case.configuration(), 0.0)
    assert np.abs(found.U - exact.U).max() <= 5e-6
    assert found.apparent_viscosity == pytest.approx(exact.apparent_viscosity, rel=2e-5)
    assert found.lower_bound is None
