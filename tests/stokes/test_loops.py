"""Machines with wider registers and without give the same flow."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import fsi.meshes.backend  # noqa: F401

import pytest
from numpy.testing import assert_allclose

from fsi.case.load import load_case
from fsi.stokes.discretisation import loops
from fsi.stokes.discretisation.jit import compile_c
from fsi.stokes.model import StokesModel
from fsi.stokes.solution import StokesSolution

CASE = Path(__file__).parents[2] / "cases" / "two_discs.toml"
WIDE = "#define WITH_512_BITS\n"


def solved() -> StokesSolution:
    case = load_case(CASE)
    return StokesModel(case)(case.configuration(), 0.0)


def without_wide(name: str, sources: list[Path]) -> Any:
    """The loops of a machine that has no registers of 512 bits."""
    with tempfile.TemporaryDirectory() as folder:
        copies = [Path(folder) / source.name for source in sources]
        for source, copy in zip(sources, copies, strict=True):
            text = source.with_suffix(".c").read_text()
            assert (WIDE in text) == (source.name == "cells")
            copy.with_suffix(".c").write_text(text.replace(WIDE, ""))
            copy.with_suffix(".h").write_text(source.with_suffix(".h").read_text())
        return compile_c(name, copies)


def test_wider_registers_change_nothing_but_rounding(monkeypatch: pytest.MonkeyPatch) -> None:
    wide = solved()
    monkeypatch.setattr(loops, "compile_c", without_wide)
    loops.loops.cache_clear()
    try:
        narrow = solved()
    finally:
        loops.loops.cache_clear()
    for found, expected in ((narrow.U, wide.U), (narrow.F, wide.F)):
        assert_allclose(found, expected, atol=1e-11 * abs(expected).max())
    assert abs(wide.U).max() > 0.0
