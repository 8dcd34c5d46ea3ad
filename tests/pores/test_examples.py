"""The examples of docs/examples that need pores run, and give what they say."""

import runpy
from pathlib import Path

import numpy as np
import pytest

EXAMPLES = Path(__file__).parents[2] / "docs" / "examples"


def test_dissipation_blow_up(tmp_path: Path) -> None:
    """Films of another shape or of another number of necks have other limits: each of four is met to 1e-5."""
    example = runpy.run_path(str(EXAMPLES / "dissipation_blow_up.py"))
    found = example["table"]()
    for (lattice, what), values in found.items():
        leading = example["LIMITS"][lattice, what] * example["GAPS"] ** example["RATES"][what]
        ratio = values / leading
        assert np.all(np.diff(np.abs(ratio[:6] - 1.0)) < 0.0)
        assert ratio[-1] == pytest.approx(1.0, abs=1e-5)
    example["draw"](found, tmp_path / "blow_up.png")
    assert (tmp_path / "blow_up.png").stat().st_size > 10_000
