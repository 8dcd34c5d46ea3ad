"""Bars hold for random walls, bodies and meshes, and are about as long as the errors; see `bench/bars.py`."""

from __future__ import annotations

import numpy as np
import pytest

from bench.bars import holds, measured, reference, values
from bench.random_cases import KINDS, random_case

# Data without jumps: the bar is 1.5 times an estimate that is 0.9 to 1.1 times the error.
SMOOTH = (
    "box, walls at rest", "channel, sheared", "channel, driven", "cell", "half-plane", "round container",
    "axisymmetric half-plane and ball",
)  # fmt: skip
SEED = 1000  # the bench begins at 0


@pytest.mark.parametrize("kind", SMOOTH)
def test_bars_hold_and_half_of_them_would_not(kind: str) -> None:
    found = values(kind, SEED)
    assert found
    assert all(value.inside for value in found)
    assert max(value.ratio for value in found) > 0.5


@pytest.mark.slow
def test_the_finer_solve_has_converged(monkeypatch: pytest.MonkeyPatch) -> None:
    """Between open and solid walls: 6 halvings fewer change it by 5e-8 at most, none at all by 2e-4."""
    case = random_case("box, open walls", 1)
    fine = reference(case)
    monkeypatch.setattr("bench.bars.HALVINGS", 14)
    np.testing.assert_allclose(fine.U, reference(case).U, rtol=0.0, atol=1e-7)


@pytest.mark.slow
def test_bars_of_many_cases() -> None:
    kinds = [kind for kind in KINDS if not kind.startswith("space")]
    found, refused = measured(kinds, 3 * len(kinds), SEED)
    assert len(refused) <= len(kinds) // 4
    assert holds(found, kinds)
