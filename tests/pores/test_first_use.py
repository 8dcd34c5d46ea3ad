"""Loops that are not compiled yet: said before they are."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest

from fsi.pores import first_use
from fsi.pores.model import PoreModel
from tests.pore_cases import BOX, PULLED, case_of


@pytest.mark.parametrize(("kept", "notes"), [([], 1), (["power.insert-135.py312.nbi"], 0)])
def test_it_is_said_once_where_nothing_is_kept(
    kept: list[str],
    notes: int,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    """A first solve was silent for up to two minutes."""
    for name in kept:
        (tmp_path / name).touch()
    monkeypatch.setattr(first_use, "insert", SimpleNamespace(stats=SimpleNamespace(cache_path=str(tmp_path))))
    first_use.tell_of_compilation.cache_clear()
    case = case_of(domain=BOX, bodies=PULLED, time=None)
    for _ in range(2):
        PoreModel(case)(case.configuration(), 0.0)
    assert [record.getMessage() for record in caplog.records] == [first_use.NOTE] * notes
    assert "\n" not in first_use.NOTE
