"""The case file: read, changed by `--set`, checked before anything is computed.

`load_case` reads a TOML file into a frozen `Case` or raises `InputError` with one line that names
the key, its value and the remedy.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, get_args

from pydantic import ValidationError

from fsi.case.body import Body, with_grids
from fsi.case.body_file import with_bodies
from fsi.case.case import MODELS, Case
from fsi.case.checks.sound import check_case
from fsi.case.overrides import override
from fsi.case.section import CaseContext, Geometry, explain, toml_text, tuples
from fsi.errors import InputError


def load_case(path: Path | str, overrides: Sequence[str] = ()) -> Case:
    """Read a case file.

    Args:
        path: the TOML file.
        overrides: `key=value` with a dotted key (`bodies.0.radius=2`) and a TOML value, applied in order.

    Raises:
        InputError: the file cannot be read or the case is not sound; nothing has been written.
    """
    path = Path(path)
    data = read_toml(path)
    if not data:
        raise InputError(f"{path}: the case is empty; give at least name, [fluid] and [domain]")
    for text in overrides:
        override(data, text)
    _check_model(path, data.get("model", MODELS[0]))
    for section, keys in _PATHS.items():
        _resolve(data.get(section), keys, path.parent)
    if isinstance(data.get("bodies_from"), str):
        data["bodies_from"] = str((path.parent / data["bodies_from"]).resolve())
    return parse_case(data)


def parse_case(data: Mapping[str, Any]) -> Case:
    """The case that nested dictionaries, lists and numbers describe, checked. Raises InputError."""
    geometry = data.get("geometry", "planar")
    if geometry not in get_args(Geometry.__value__):
        geometry = "planar"  # the schema says what is wrong
    listed = with_bodies(with_grids(data, CaseContext(geometry)), tuple(Body.model_fields))
    bodies = listed.get("bodies", ())
    context = CaseContext(geometry, len(bodies) if isinstance(bodies, tuple | list) else 0)
    try:
        case = Case.model_validate({"discretisation": {}} | tuples(listed), context=context)
    except ValidationError as error:
        raise InputError(explain(error, Case)) from None
    check_case(case)
    return case


def read_toml(path: Path) -> dict[str, Any]:
    """The data of a case file. Raises InputError."""
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: not TOML: {error}; correct the file there") from None
    except OSError as error:
        raise InputError(
            f"{path}: {error.strerror or error}; give the path of a case file, `fsi cases` writes some"
        ) from None


def _check_model(path: Path, model: Any) -> None:
    """Raise InputError if there is no such level."""
    if model == "limit":
        raise InputError(
            f'{path}: model = "limit": is now `fsi limit` of a case of one gluey body; give "gluey"'
        )
    if model not in MODELS:
        choices = " or ".join([", ".join(f'"{name}"' for name in MODELS[:-1]), f'"{MODELS[-1]}"'])
        raise InputError(f"{path}: model = {toml_text(model)}: there is no such model; give {choices}")


# Keys that are paths of files, seen from the folder of the case; words without a suffix are none.
_PATHS = {"domain": ("mesh",), "reduced": ("law", "wall_law")}


def _resolve(section: Any, keys: Sequence[str], folder: Path) -> None:
    """Make the paths of files in a section absolute, in place."""
    for key in keys if isinstance(section, dict) else ():
        value = section.get(key)
        if isinstance(value, str) and (key == "mesh" or Path(value).suffix):
            section[key] = str((folder / value).resolve())
