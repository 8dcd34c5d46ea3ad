"""The examples of docs/examples run, and give what they say."""

import runpy
from pathlib import Path

import numpy as np
import pytest

EXAMPLES = Path(__file__).parents[2] / "docs" / "examples"


def test_lubrication_force(capsys: pytest.CaptureFixture[str]) -> None:
    """Resolved forces within 1e-5 of the exact ones; the leading term is 10.5 % off at q/a = 0.1."""
    example = runpy.run_path(str(EXAMPLES / "lubrication_force.py"))
    gap, resolved, exact, leading = example["table"]().T
    np.testing.assert_allclose(resolved, exact, rtol=1e-5)
    ratio = dict(zip(gap, resolved / leading, strict=True))
    # sinh and cosh of al, cosh al = 1 + q/a: 4 pi / (al - tanh al) over 3 sqrt2 pi (q/a)^(-3/2) at 0.1.
    al = np.arccosh(1.1)
    assert ratio[0.1] == pytest.approx(4.0 / (al - np.tanh(al)) / (3.0 * np.sqrt(2.0) * 0.1**-1.5), rel=1e-5)
    example["main"]()
    assert len(capsys.readouterr().out.splitlines()) == 6
