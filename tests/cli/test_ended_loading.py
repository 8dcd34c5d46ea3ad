"""Signals while a case is loaded: only imports hold them back."""

from __future__ import annotations

import gc
import signal
from pathlib import Path
from typing import NoReturn

import pytest

import fsi.case.load
from fsi.cli.arguments import load
from fsi.machine.signals import Ended, heard


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_a_signal_ends_the_checks_of_a_case_at_once(
    number: signal.Signals, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It came after all checks, which may take minutes."""
    went_on = []

    def checks(*_: object) -> NoReturn:
        signal.raise_signal(number)
        went_on.append("to its end")
        raise AssertionError

    monkeypatch.setattr(fsi.case.load, "load_case", checks)
    with heard(), pytest.raises(Ended):
        load(Path("case.toml"), None)
    assert went_on == []
    assert gc.isenabled()
