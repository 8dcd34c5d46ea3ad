"""Sections of a case file of which one stands at a place: domains, shapes, laws of force.

They are told apart by a word in them, at a key that allows one choice only, like `shape: Literal["box"]`, and
registered by a decorator, also from outside this package.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache
from importlib import import_module
from pkgutil import iter_modules
from typing import Any, ClassVar, Literal, get_args, get_origin, override

from pydantic import ValidationInfo
from pydantic_core import PydanticCustomError

from fsi.case.section import Section, hint_of_own
from fsi.errors import FsiError, InputError, refuse_taken


@cache
def _files(room: str) -> tuple[str, ...]:
    return tuple(module.name for module in iter_modules(import_module(room).__path__))


def _load(room: str, file: str) -> None:
    """A file of a room is loaded. Raises InputError, which names it: it cannot be."""
    try:
        import_module(f"{room}.{file}")
    except (FsiError, MemoryError):
        raise  # the first of another file, which is named
    except Exception as error:
        here = f"{room.replace('.', '/')}/{file}.py"
        raise InputError(f"{here}: {type(error).__name__}: {error}; mend it, or take it out") from error


@contextmanager
def blamed_on(section: Section) -> Iterator[None]:
    """What a mistake in the code of a section raises names its class. Raises ValueError."""
    try:
        yield
    except (FsiError, ValueError, MemoryError):
        raise  # meant for whoever gave the data
    except Exception as error:
        kind = type(section)
        what = f"{kind.__module__}.{kind.__qualname__}: {type(error).__name__}: {error}"
        raise ValueError(f"{what}; mend that class") from error


class Registry[S: Section]:
    """The sections of one place, in the order of their files and, in one, of registration.

    Attributes:
        key: whose words messages list.
        room: a package, each file of which may have some; where one has the name of a word, all sections
            with that word stand in it.
        default: the word that is meant where data have none, if any is.
        sections: the classes that are registered so far.
    """

    def __init__(self, key: str, room: str, default: str | None = None) -> None:
        self.key, self.room, self.default = key, room, default
        self.sections: list[type[S]] = []

    def all(self) -> Sequence[type[S]]:
        """The classes, all files of the room loaded. Raises InputError: one cannot be."""
        for file in _files(self.room):
            _load(self.room, file)
        return self._loaded()

    def _load_file(self, word: Any) -> None:
        """The file with the name of a word is loaded, if there is one. Raises InputError: it cannot be."""
        file = str(word).replace("-", "_")
        if file in _files(self.room):
            _load(self.room, file)

    def _loaded(self) -> Sequence[type[S]]:
        """The classes that are loaded."""
        within, names = f"{self.room}.", [section.__module__ for section in self.sections]
        # By name, whichever file was loaded first; those of other rooms after them.
        order = sorted(range(len(names)), key=lambda k: (not names[k].startswith(within), names[k]))
        return [self.sections[k] for k in order]

    def register[T: Section](self, section: type[T]) -> type[T]:
        """Take a section up, in place of the same one where that is loaded anew; a decorator.

        Two may have one word, like a box and a channel, where the later one has all keys of the other and
        more. Raises ValueError: no key tells it from another one, or it lacks a method that all have.
        """
        if lacking := sorted(section.__abstractmethods__):
            raise ValueError(f"{section.__qualname__} lacks {', '.join(lacking)}")
        known: list[type[Any]] = self.sections
        self._load_file(_words(section).get(self.key))  # which may have the word already
        for k, other in enumerate(known):
            if (other.__module__, other.__qualname__) == (section.__module__, section.__qualname__):
                known[k] = section
                return section
            word = _common_word(section, other)
            if word is not None and not section.model_fields.keys() > other.model_fields.keys():
                refuse_taken(word, other, section)
        known.append(section)
        return section

    @property
    def choices(self) -> str:
        """The words at the key, as messages list them: "one", "two" or "three"."""
        words = [_words(section).get(self.key) for section in self.all()]
        *most, last = dict.fromkeys(f'"{word}"' for word in words if word)
        return f"{', '.join(most)} or {last}" if most else last

    def section_for(self, data: Mapping[str, Any]) -> type[S]:
        """The section whose words the data have; for misspelt or missing ones that which knows most keys.

        That section then refuses the word, or the key that is not its own, by name.
        """

        def fit(section: type[S]) -> tuple[int, int]:
            right = [data[key] == word for key, word in _words(section).items() if key in data]
            return sum(right), sum(key in section.model_fields for key in data) - right.count(False)

        word = data.get(self.key, self.default)
        self._load_file(word)
        named = [section for section in self._loaded() if word and _words(section).get(self.key) == word]
        found = max(named, key=fit, default=None)
        if found is not None and (self.key in data or data.keys() <= found.model_fields.keys()):
            return found
        return max(self.all(), key=fit)

    def _require_known(self, word: Any) -> None:
        """Raise pydantic's error for a word at the key that no section has: it explains unknown keys."""
        self._load_file(word)
        if word in self._words_of(self._loaded()) or word in (words := self._words_of(self.all())):
            return
        context = {"key": self.key, "remedy": f"give {self.choices}{hint_of_own(str(word), words)}"}
        raise PydanticCustomError("unknown_word", "not one of the choices", context)

    def _words_of(self, sections: Sequence[type[S]]) -> list[str]:
        """What may stand at the key, in the order of these sections."""
        fields = [section.model_fields.get(self.key) for section in sections]
        return [known for field in fields if field is not None for known in get_args(field.annotation)]

    def validate(self, value: Any, info: ValidationInfo) -> Any:
        """The section that nested dictionaries describe; what is a section already stays."""
        if isinstance(value, tuple(self.sections)):
            return value
        if isinstance(value, dict) and self.key in value:
            self._require_known(value[self.key])
        section = self.section_for(value) if isinstance(value, dict) else self.all()[0]
        return section.model_validate(value, context=info.context)


class Registered(Section):
    """The base of the sections of one registry."""

    registry: ClassVar[Registry[Any]]

    @classmethod
    @override
    def alternatives(cls) -> Sequence[type[Section]]:
        return cls.registry.all()

    @classmethod
    @override
    def meant_by(cls, data: Any, /) -> type[Section]:
        found: type[Section] = cls.registry.section_for(data) if isinstance(data, dict) else cls
        return found

    @classmethod
    @override
    def describe(cls, key: str) -> str | None:
        return cls.registry.choices if key == cls.registry.key else super().describe(key)


def _common_word(one: type[Section], other: type[Section]) -> str | None:
    """One that both have where no word tells them apart, else None."""
    a, b = _words(one), _words(other)
    shared = [key for key in a if key in b]
    return a[shared[0]] if shared and all(a[key] == b[key] for key in shared) else None


def _words(section: type[Section]) -> dict[str, str]:
    """The keys of a section that allow one choice only, and that."""
    fields = {key: field.annotation for key, field in section.model_fields.items()}
    choices = {key: get_args(kind) for key, kind in fields.items() if get_origin(kind) is Literal}
    return {key: words[0] for key, words in choices.items() if len(words) == 1}
