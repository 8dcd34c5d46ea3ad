"""Sections that stand at one place of a case file, told apart by a word in them: domains, laws of force.

A section is registered by a decorator, also from outside this package. Its words are the keys that allow one
choice only, like `shape: Literal["box"]`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal, get_args, get_origin, override

from pydantic import ValidationInfo

from fsi.case.section import Section


class Registry[S: Section]:
    """The sections of one place, in the order of registration.

    Attributes:
        key: whose words messages list.
        sections: the classes.
    """

    def __init__(self, key: str) -> None:
        self.key = key
        self.sections: list[type[S]] = []

    def register[T: Section](self, section: type[T]) -> type[T]:
        """Take a section up; a decorator."""
        self.sections.append(section)  # type: ignore[arg-type]
        return section

    @property
    def choices(self) -> str:
        """The words at the key, as messages list them: "one", "two" or "three"."""
        words = [_words(section).get(self.key) for section in self.sections]
        *most, last = dict.fromkeys(f'"{word}"' for word in words if word)
        return f"{', '.join(most)} or {last}" if most else last

    def section_for(self, data: Mapping[str, Any]) -> type[S]:
        """The section whose words the data have; for misspelt or missing ones that which knows most keys.

        That section then refuses the word, or the key that is not its own, by name.
        """

        def fit(section: type[S]) -> tuple[int, int]:
            right = [data[key] == word for key, word in _words(section).items() if key in data]
            return sum(right), sum(key in section.model_fields for key in data) - right.count(False)

        return max(self.sections, key=fit)

    def validate(self, value: Any, info: ValidationInfo) -> Any:
        """The section that nested dictionaries describe; what is a section already stays."""
        if isinstance(value, tuple(self.sections)):
            return value
        section = self.section_for(value) if isinstance(value, dict) else self.sections[0]
        return section.model_validate(value, context=info.context)


class Registered(Section):
    """The base of the sections of one registry."""

    registry: ClassVar[Registry[Any]]

    @classmethod
    @override
    def alternatives(cls) -> Sequence[type[Section]]:
        return cls.registry.sections

    @classmethod
    @override
    def describe(cls, key: str) -> str | None:
        return cls.registry.choices if key == cls.registry.key else super().describe(key)


def _words(section: type[Section]) -> dict[str, str]:
    """The keys of a section that allow one choice only, and that."""
    fields = {key: field.annotation for key, field in section.model_fields.items()}
    choices = {key: get_args(kind) for key, kind in fields.items() if get_origin(kind) is Literal}
    return {key: words[0] for key, words in choices.items() if len(words) == 1}
