"""Modes by place: handed on to the nearest necks, across periods too, and kept to a tolerance in a run."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fsi.case.load import load_case, parse_case
from fsi.pores.fineness import Fineness
from fsi.pores.system import PoreSystem
from fsi.pores.topology import triangulate
from fsi.postprocess.run.run import open_run
from fsi.runs import run
from tests.pore_surfaces import cell, channel

COUETTE = Path(__file__).parents[2] / "cases" / "pores" / "couette_N10.toml"
CENTRES, RADII = np.array([[0.3, 0.5], [2.6, 2.9], [2.4, 0.6]]), np.array([1.0, 1.1, 0.8])


def test_even_modes_are_the_same_everywhere() -> None:
    pores = triangulate(channel(CENTRES, RADII * 0.4, 5.0, 4.0))
    assert np.all(Fineness.even(4).at(pores) == 4)


def test_necks_that_have_hardly_moved_keep_their_modes_across_periods() -> None:
    """All discs move on by a third of a period, and a little apart: no neck has another next to it."""
    vectors = np.array([[5.0, 0.0], [1.0, 5.0]])
    pores = triangulate(cell(CENTRES, RADII, vectors))
    modes = np.array([1, 4, 8])[np.arange(len(pores.necks)) % 3]
    fineness = Fineness.of(PoreSystem.of(3, pores, modes, 1.0))
    assert np.all(fineness.at(pores) == modes)
    shaken = CENTRES + 1e-3 * np.array([[1.0, 0.0], [0.0, -1.0], [-1.0, 1.0]])
    for shift in (vectors[0], -3.0 * vectors[1]):
        again = triangulate(cell(shaken + shift, RADII, vectors))
        assert np.all(again.necks == pores.necks)
        assert np.all(fineness.at(again) == modes)


def test_a_run_adds_modes_where_they_matter_until_each_step_keeps_to_its_tolerance(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As many everywhere would take 61 unknowns a disc; bars are in steps.csv, relative to the largest."""
    monkeypatch.setattr("fsi.pores.instant.FEW", 0)  # pressures in files take longer than all else
    data = load_case(COUETTE, ["pores.modes=1", "pores.tolerance=2e-3"]).as_data()
    run(parse_case(data | {"time": {"end": 0.12, "tolerance": 1e-2}}), tmp_path / "run")
    steps = open_run(tmp_path / "run").steps
    assert len(steps) > 2
    assert np.all(steps["err_apparent_viscosity"] <= 2e-3 * steps["apparent_viscosity"])
    assert np.all(steps["err_U"] <= 2e-3)
    assert np.all(steps["modes"] == 4)
    assert np.all(steps["dofs"] < 610)
