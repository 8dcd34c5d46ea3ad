"""One section of a case file; `complaints` makes one line for the user of a mistake in it.

Sections are frozen pydantic models that refuse unknown keys and take no number for a word or a
word for a number. Unions are told apart by a tag in angle brackets, so that pydantic reports the
one alternative that was meant; the tags are dropped from the key that the user reads.
"""

from __future__ import annotations

import ast
import difflib
import inspect
import itertools
import json
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path
from textwrap import dedent
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, get_args

from pydantic import BaseModel, ConfigDict, Field, ValidationInfo, model_validator
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from fsi.errors import InputError
from fsi.files import data_of

type Geometry = Literal["planar", "axisymmetric", "spatial"]
Positive = Annotated[float, Field(gt=0.0)]
NotNegative = Annotated[float, Field(ge=0.0)]
Fraction = Annotated[float, Field(gt=0.0, lt=1.0)]
Text = Annotated[str, Field(min_length=1)]
Name = Annotated[str, Field(pattern=r"^\w[\w -]*$")]

_LONGEST_VALUE = 60
_ALIKE = 0.75  # of 1, of a misspelt word and the one that is meant
_DECIMAL = 10_000  # bits of a whole number; of many more Python writes no digits


class CaseContext(NamedTuple):
    """What sections learn of the case that they stand in, as the context of pydantic's validation.

    geometry: decides how many components vectors have; bodies: their number, which decides sizes of the mesh.
    """

    geometry: Geometry = "planar"
    bodies: int = 0

    @property
    def dimension(self) -> int:
        """How many coordinates a point has."""
        return dimension_of(self.geometry)


class Section(BaseModel):
    """A table of the case file: frozen, strict, finite numbers, known keys only.

    renamed: keys of earlier versions, each with the whole key that took its place.
    """

    model_config = ConfigDict(defer_build=True, frozen=True, extra="forbid", strict=True, allow_inf_nan=False)
    renamed: ClassVar[Mapping[str, str]] = {}

    @model_validator(mode="before")
    @classmethod
    def _known_keys(cls, data: Any) -> Any:
        if isinstance(data, dict):
            for key in data:
                if key in cls.renamed and key not in cls.model_fields:
                    context = {"key": key, "now": cls.renamed[key]}
                    raise PydanticCustomError("renamed_key", "renamed key", context)
                refuse_unknown(key, cls.model_fields)
        return data

    def __getstate__(self) -> dict[Any, Any]:
        """The values alone, as they go to other ranks: cached properties, often formulas, are made again."""
        state = super().__getstate__()
        values = {key: state["__dict__"][key] for key in type(self).model_fields if key in state["__dict__"]}
        return state | {"__dict__": values}

    @classmethod
    def alternatives(cls) -> Sequence[type[Section]]:
        """The sections that may stand where this one is asked for: itself."""
        return (cls,)

    @classmethod
    def meant_by(cls, _data: Any, /) -> type[Section]:
        """Which of the alternatives data at this place mean: itself."""
        return cls

    @classmethod
    def describe(cls, key: str) -> str | None:
        """What may stand at one of its keys: the description of the field, or the docstring below it."""
        return cls.model_fields[key].description or _docstrings(cls).get(key)


class Late:
    """`Annotated[S, Late()]`: a section that pydantic looks into where a case has it, not at each start."""

    def __get_pydantic_core_schema__(self, section: type[Section], _handler: object) -> CoreSchema:
        def read(value: Any, info: core_schema.ValidationInfo) -> Section:
            return section.model_validate(value, context=info.context)

        as_it_is = core_schema.wrap_serializer_function_ser_schema(
            lambda value, serialize: serialize(value), schema=core_schema.any_schema()
        )
        return core_schema.with_info_plain_validator_function(read, serialization=as_it_is)


@cache
def _docstrings(section: type[Section]) -> dict[str, str]:
    """Of the fields of a section. They are read when asked for: pydantic would read all at each start."""
    found: dict[str, str] = {}
    for base in reversed(section.mro()[: section.mro().index(Section)]):
        nodes = ast.iter_child_nodes(ast.parse(dedent(inspect.getsource(base))).body[0])
        for field, below in itertools.pairwise(nodes):
            match field, below:
                case ast.AnnAssign(target=ast.Name(id=key)), ast.Expr(value=ast.Constant(value=str(text))):
                    found[key] = inspect.cleandoc(text)
    return found


def dimension_of(geometry: Geometry) -> int:
    """How many coordinates a point has: (x, y), (r, z) or (x, y, z)."""
    return 3 if geometry == "spatial" else 2


def require_components[T](vector: tuple[T, ...], number: int, what: str) -> tuple[T, ...]:
    """The vector, if it has that many components. Raises ValueError."""
    if len(vector) != number:
        components = "component" if len(vector) == 1 else "components"
        raise ValueError(f"{what} has {len(vector)} {components} where this geometry has {number}")
    return vector


def context_of(context: Any) -> CaseContext:
    """What the whole case tells its sections, by the context of a validation, which may have none."""
    return context if isinstance(context, CaseContext) else CaseContext()


def told(info: ValidationInfo) -> CaseContext:
    """The same, of a validator."""
    return context_of(info.context)


def all_components[T](vector: tuple[T, ...] | None, info: ValidationInfo) -> tuple[T, ...] | None:
    """A validator: the vector, if given, has as many components as points of the case have coordinates."""
    return None if vector is None else require_components(vector, told(info).dimension, "a vector")


def refuse_unknown(key: str, known: Iterable[str]) -> None:
    """Raise pydantic's error for a key that is not among the known ones; it names what to use."""
    known = list(known)
    if key not in known:
        raise PydanticCustomError("unknown_key", "unknown key", {"key": key, "known": words_like(key, known)})


def unfit(key: str, what: str, remedy: str) -> PydanticCustomError:
    """Pydantic's error for a key of a section that is wrong beside its others: what is wrong, what to do."""
    return PydanticCustomError("unfit_key", "{what}", {"key": key, "what": what, "remedy": remedy})


def words_like(word: str, known: Iterable[str]) -> list[str]:
    """The known word that looks like `word`, or all of them if none does."""
    known = list(known)
    return difflib.get_close_matches(str(word), known, n=1) or known  # a key in Python may be a number


def hint_of_own(word: str, known: Iterable[str]) -> str:
    """What a remedy ends with where a word looks like no known one, as that of an entry of the user's own."""
    meant = difflib.get_close_matches(word, list(known), n=1, cutoff=_ALIKE)
    return "" if meant else "; one of your own must be registered first (docs/layout.md)"


def nearest_word(word: str, known: Iterable[str]) -> str:
    """The known word that looks most like `word`."""
    return difflib.get_close_matches(word, list(known), n=1, cutoff=0.0)[0]


def toml_data(path: Path, remedy: str) -> dict[str, Any]:
    """The data of a TOML file. Raises InputError."""
    data: dict[str, Any] = data_of(path, "TOML", tomllib.loads, f"give the path of {remedy}")
    return data


def tuples(value: Any) -> Any:
    """The same data with tuples for lists, as frozen sections want it."""
    match value:
        case dict():
            return {key: tuples(item) for key, item in value.items()}
        case list() | tuple():
            return tuple(map(tuples, value))
        case _:
            return value


def refusal(key: str, value: object, what: str) -> InputError:
    """`key = value: what is wrong; what to do`."""
    return InputError(f"{key} = {toml_text(value)}: {what}")


def toml_text(value: object) -> str:
    """The value as TOML would write it, on one line, shortened when long."""
    text = _toml(value)
    return text if len(text) <= _LONGEST_VALUE else text[: _LONGEST_VALUE - 4] + " ..."


def _toml(value: object) -> str:
    match value:
        case bool():
            return str(value).lower()
        case int() if value.bit_length() > _DECIMAL:
            return hex(value)
        case str():
            return json.dumps(value, ensure_ascii=not value.isprintable())
        case list() | tuple():
            return "[" + ", ".join(map(_toml, value)) + "]"
        case BaseModel():
            return _toml(value.model_dump(exclude_none=True))
        case dict():
            return "{" + ", ".join(f"{key} = {_toml(item)}" for key, item in value.items()) + "}"
        case _:
            return str(value)


def sections_in(annotation: Any) -> Iterable[type[Section]]:
    """The section classes that an annotation mentions."""
    if isinstance(annotation, type) and issubclass(annotation, Section):
        yield from annotation.alternatives()
    for inner in get_args(annotation):
        yield from sections_in(inner)
