"""The tables of `bench/faults.py` fit the code: what they replace is there, once, and so are their tests."""

from __future__ import annotations

import ast
import re
from functools import cache
from pathlib import Path

import pytest

from bench.faults import ROOT, Fault, read_faults

FAULTS = read_faults()
ROOMS = sorted({fault.room for fault in FAULTS})


@cache
def text_of(path: Path) -> str:
    return path.read_text(encoding="utf-8")


def why_not(fault: Fault) -> str:
    """Why a fault cannot be put into the code, or its tests not be run; empty if they can."""
    try:
        changed = fault.put_into(text_of(ROOT / fault.file))
    except ValueError as error:
        return f"{error}: mend it in bench/fault_tables/{fault.room}.toml"
    if fault.new == fault.old:
        return f"{fault.name}: changes nothing"
    if fault.file.endswith(".py"):
        ast.parse(changed)
    for test in fault.tests:
        file, _, name = test.partition("::")
        if not (ROOT / file).exists() or (
            name and not re.search(rf"^def {name}\(", text_of(ROOT / file), re.M)
        ):
            return f"{fault.name}: there is no {test}: name the tests that notice it now"
    return ""


@pytest.mark.parametrize("room", ROOMS)
def test_every_fault_can_be_put_into_the_code(room: str) -> None:
    assert [why for fault in FAULTS if fault.room == room and (why := why_not(fault))] == []


def test_every_fault_has_a_name_of_its_own_and_tests() -> None:
    names = [(fault.room, fault.name) for fault in FAULTS]
    assert len(set(names)) == len(names) > 200
    assert all(fault.tests for fault in FAULTS)


def test_a_text_that_does_not_stand_once_is_refused() -> None:
    fault = Fault("room", "name", "file.py", "a", "b", ("tests",))
    assert fault.put_into("xax") == "xbx"
    for text in ("x", "aa"):
        with pytest.raises(ValueError, match=r"room: name: file\.py has its old text \d times, not once"):
            fault.put_into(text)
