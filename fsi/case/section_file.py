"""Files that hold one section, as TOML."""

from pathlib import Path

import tomli_w
from pydantic import ValidationError

from fsi.case.complaints import explain
from fsi.case.section import Section, toml_data, tuples
from fsi.errors import InputError
from fsi.files import replace


def read_section[Held: Section](section: type[Held], path: Path, remedy: str) -> Held:
    """The content of a file. Raises InputError, one line with key, value and remedy."""
    data = toml_data(path, remedy)
    try:
        return section.model_validate(tuples(data))
    except ValidationError as error:
        raise InputError(f"{path}: {explain(error, section, data)}") from None


def save_section(path: Path, held: Section) -> None:
    """Write a file, in one go."""
    replace(path, tomli_w.dumps(held.model_dump(exclude_none=True)).encode())
