"""Words of sections that are registered: each of one section, unless more keys tell two apart."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal, cast

import pytest

from fsi.case.registry import Registered, Registry
from fsi.case.shapes.shape import BodyShape
from fsi.errors import InputError
from tests.scripts import script


class Built(Registered):
    kind: Literal["round"]
    size: float = 1.0


@pytest.fixture
def registry() -> Registry[Any]:
    found = Registry[Any]("kind", "fsi.case.profiles")
    found.register(Built)
    return found


def test_a_word_that_is_taken_is_refused(registry: Registry[Any]) -> None:
    """The first of two would be taken without a word, whatever else the second one does."""

    class Other(Registered):
        kind: Literal["round"]
        radius: float = 1.0

    with pytest.raises(
        ValueError, match=r'^"round": is the name of tests\.case\.test_registry\.Built already;'
    ):
        registry.register(Other)
    assert registry.all() == [Built]


def test_more_keys_or_another_word_tell_two_apart(registry: Registry[Any]) -> None:
    """As `periodic` does a channel from a box, and `law` two laws of one kind."""

    class More(Built):
        depth: float

    class Lawful(Registered):
        kind: Literal["law"]
        law: Literal["one"]

    class Lawful2(Registered):
        kind: Literal["law"]
        law: Literal["two"]

    for section in (More, Lawful, Lawful2):
        registry.register(section)
    assert registry.section_for({"kind": "round"}) is Built
    assert registry.section_for({"kind": "round", "depth": 1.0}) is More
    assert registry.section_for({"kind": "law", "law": "two"}) is Lawful2


def test_a_word_of_a_file_that_is_not_loaded_yet_is_taken() -> None:
    """Else the file would clash when a case asks for it, in the middle of reading that."""
    done = script("""
        from typing import Literal
        from fsi.case.domains.domain import Walled, register_domain
        try:
            @register_domain
            class Mine(Walled):
                shape: Literal["round"]
        except ValueError as error:
            print(error)
    """)
    assert done.stdout.startswith('"round": is the name of fsi.case.domains.round.RoundDomain already;')


def test_what_is_loaded_anew_takes_its_own_place(registry: Registry[Any]) -> None:
    """A cell of a notebook that is run again, with a change, is no clash, and the change holds."""
    changed = type("Built", (Built,), {"__module__": Built.__module__, "__qualname__": Built.__qualname__})
    registry.register(changed)
    assert registry.all() == [changed]


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        ("def (", "SyntaxError: invalid syntax (mine.py, line 1)"),
        ("import none_of_tests", "ModuleNotFoundError: No module named 'none_of_tests'"),
        ("raise OSError('1\\n2')", "OSError: 1 2"),
    ],
)
def test_a_file_that_cannot_be_loaded_is_named(
    lines: str, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each was a defect of the program, of all commands that list what there is."""
    (tmp_path / tmp_path.name).mkdir()  # a room of its own for each test
    for file, text in (("__init__", ""), ("mine", lines)):
        (tmp_path / tmp_path.name / f"{file}.py").write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    registry = Registry[Any]("kind", tmp_path.name)
    line = f"{tmp_path.name}/mine.py: {said}; mend it, or take it out"
    for load in (registry.all, lambda: registry.section_for({"kind": "mine"})):
        with pytest.raises(InputError) as told:
            load()
        assert str(told.value) == line


def test_what_lacks_a_method_that_all_have_is_refused(registry: Registry[Any]) -> None:
    """It was taken, and failed as a case had it."""

    class Blank(BodyShape):
        kind: Literal["blank-of-tests"]

    with pytest.raises(ValueError, match=r"Blank lacks curve$"):
        registry.register(cast(Any, Blank))
    assert registry.all() == [Built]
