"""The examples of docs/examples run, and give what they say."""

import runpy
from pathlib import Path

import numpy as np
import pytest

EXAMPLES = Path(__file__).parents[2] / "docs" / "examples"


def test_lubrication_force(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Resolved forces within 1e-5 of the exact ones; the leading term is 10.5 % off at q/a = 0.1."""
    example = runpy.run_path(str(EXAMPLES / "lubrication_force.py"))
    gap, resolved, exact, leading = example["table"]().T
    np.testing.assert_allclose(resolved, exact, rtol=1e-5)
    ratio = dict(zip(gap, resolved / leading, strict=True))
    # sinh and cosh of al, cosh al = 1 + q/a: 4 pi / (al - tanh al) over 3 sqrt2 pi (q/a)^(-3/2) at 0.1.
    al = np.arccosh(1.1)
    assert ratio[0.1] == pytest.approx(4.0 / (al - np.tanh(al)) / (3.0 * np.sqrt(2.0) * 0.1**-1.5), rel=1e-5)
    example["main"](tmp_path / "picture.png")
    assert len(capsys.readouterr().out.splitlines()) == 6


def test_apparent_viscosity(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The finer, the nearer to the reference of cases/couette_N10.toml; at one cell a gap within 1e-5."""
    example = runpy.run_path(str(EXAMPLES / "apparent_viscosity.py"))
    example["main"](tmp_path / "picture.png")
    rows = [line.split() for line in capsys.readouterr().out.splitlines()[1:]]
    errors = [abs(float(row[3])) for row in rows]
    assert errors == sorted(errors, reverse=True)
    assert errors[-1] < 1e-5 < errors[0]
    assert all(float(row[4]) < 1e-9 for row in rows)


@pytest.mark.slow
def test_calibrated_settling() -> None:
    """The gap follows the exact one to 1e-3 over its fall by a factor of 40; a leading term is 10 % off."""
    example = runpy.run_path(str(EXAMPLES / "calibrated_settling.py"))
    _, gap, exact = example["table"]().T
    np.testing.assert_allclose(gap, exact, rtol=1e-3)
    assert gap[0] > 40.0 * gap[-1]
