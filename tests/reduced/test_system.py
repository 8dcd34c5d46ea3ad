"""Every solution keeps its identities, and a wrong one is noticed."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from fsi.errors import SolveError
from fsi.models import make_model
from fsi.reduced.model import ReducedInstant, ReducedModel
from fsi.reduced.pairs import find_pairs
from fsi.reduced.system import identities, require, solve_system
from tests.reduced_data import heap, reduced_case


@pytest.mark.parametrize("law", ["slides", "leading", "exact"])
def test_every_identity_holds_to_1e12(law: str) -> None:
    case = reduced_case(heap(), {"law": law, "drag": 12.0, "cutoff": 1.0})
    found = make_model(case)(case.configuration(), 0.0)
    assert isinstance(found, ReducedInstant)
    assert len(found.pairs) >= 6
    for name in ("momentum", "angular_momentum", "kernel", "residual", "power", "balance"):
        assert found.record[name] < 1e-12, name


def test_a_wrong_force_is_noticed() -> None:
    """Each identity fails when what it checks is spoiled by 1e-9, or it would prove nothing."""

    case = reduced_case(heap(), {"law": "leading", "drag": 12.0, "cutoff": 1.0})
    model, q = ReducedModel(case), case.configuration()
    around = model.surroundings(q, 0.0)
    pairs = find_pairs(q, around.enclosure, 1.0)
    solved = solve_system(around, pairs, pairs.gap**-1.5, None)
    force = solved.force * (1.0 + 1e-9)
    spoiled = identities(solved.network, q, solved.U, solved.alone, force)
    assert spoiled["residual"] > 1e-11
    pairs.n[np.flatnonzero(pairs.is_wall)] *= 1.0 + 1e-9  # a wall that is not where its normal says
    bent = identities(solved.network, q, solved.U, solved.alone, solved.force)
    assert max(bent["momentum"], bent["angular_momentum"]) > 1e-12
    solved.network.G.data[-1] *= 1.0 + 1e-9
    assert identities(solved.network, q, solved.U, solved.alone, solved.force)["kernel"] > 1e-12


def test_more_dissipation_than_work_is_noticed() -> None:
    """A steady motion, so that nothing is gained: forces 1e-9 too large dissipate 2e-9 more than is done."""
    model = ReducedModel(reduced_case(heap(), {"law": "leading", "drag": 12.0, "cutoff": 1.0}))
    q = model.case.configuration()
    around = model.surroundings(q, 0.0)
    pairs = find_pairs(q, around.enclosure, 1.0)
    solved = solve_system(around, pairs, pairs.gap**-1.5, None)
    masses = np.ones_like(solved.U)
    assert solved.energy(masses, solved.U, 0.1) < 1e-13
    spoiled = replace(solved, force=solved.force * (1.0 + 1e-9))
    assert spoiled.energy(masses, solved.U, 0.1) > 1e-11


@pytest.mark.parametrize("defect", [2e-12, math.nan, math.inf])
def test_a_defect_above_the_bound_is_refused(defect: float) -> None:
    """1e-12, as the documentation says."""
    require({"power": 5e-13}, 1.0)
    with pytest.raises(SolveError, match="reduced model at t = 1: power is violated by"):
        require({"power": defect}, 1.0)
