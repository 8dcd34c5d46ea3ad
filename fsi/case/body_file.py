"""Bodies from a file: `bodies_from = "discs.json"` in a case, and `[body_defaults]` for all of its bodies.

A CSV file has a header with the columns

    name, radius, x, y, z, angle

in any order; `name` (disc0001, disc0002, ...), `z` (only in space) and `angle` (0) may be left out. A JSON
file is an object whose list `bodies` has objects with the same keys; there a body may have a table `shape` in
place of its radius, whose path of `points` is seen from the folder of the JSON file. Beside it may stand
`lower` and `upper`, the corners of the bodies' box, and anything that describes them. A JSON object with
`centers` ([[x, y], ...]), one `radius` and the sides `L` and `H` of the box is understood as well.
"""

import csv
import io
import json
import math
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fsi.case.section import toml_text, tuples, words_like
from fsi.errors import InputError
from fsi.files import data_of

COLUMNS = ("name", "radius", "x", "y", "z", "angle")
_NUMBERS = COLUMNS[1:]
_NEEDED = ("radius", "x", "y")
# Boxes of a file and of its case agree to this, relative: their area fraction is what the user is after.
_SAME_SIZE = 1e-9
_LONGEST_NAME = 300  # letters of a path that messages give whole


@dataclass(frozen=True, slots=True)
class BodyFile:
    """The bodies of a file, as entries of [[bodies]], and the sides of their box if the file states them."""

    bodies: tuple[dict[str, Any], ...]
    sides: tuple[float, ...] | None


def with_bodies(data: Mapping[str, Any], known: Sequence[str]) -> dict[str, Any]:
    """The data of a case with the bodies of `bodies_from` after its own, all with `body_defaults` filled in.

    The path is absolute; known: the keys that a body may have. Raises InputError: the file cannot be read,
    its box is not that of the domain, or a default has no meaning.
    """
    listed = data.get("bodies", ())
    defaults = data.get("body_defaults", {})
    path = data.get("bodies_from")
    if not (isinstance(listed, list | tuple) and isinstance(defaults, dict) and isinstance(path, str | None)):
        return dict(data)  # the schema says what is wrong
    _check_defaults(defaults, known)
    found: tuple[dict[str, Any], ...] = ()
    if path is not None:
        file = read_bodies(Path(path))
        _check_sides(Path(path), file.sides, data.get("domain"))
        found = file.bodies
    bodies = tuple(defaults | body if isinstance(body, dict) else body for body in (*listed, *found))
    rest = {key: value for key, value in data.items() if key not in ("bodies_from", "body_defaults")}
    return rest | {"bodies": bodies} if bodies else rest


def read_bodies(path: Path) -> BodyFile:
    """The bodies of a JSON or CSV file. Raises InputError, which names the row and what is wrong in it."""
    readers = {".json": _read_json, ".csv": _read_csv}
    if path.suffix not in readers:
        raise _refusal(path, f"ends in {path.suffix or 'nothing'}; give a .json or a .csv file")
    rows, sides = readers[path.suffix](path)
    if not rows:
        raise _refusal(path, "there are no bodies in it; give a file with at least one")
    return BodyFile(tuple(_body(path, number, row) for number, row in enumerate(rows, 1)), sides)


def _read_csv(path: Path) -> tuple[list[dict[str, Any]], None]:
    reader = csv.DictReader(io.StringIO(_parsed(path, "CSV", str)), skipinitialspace=True)
    rows: list[dict[str, Any]] = []
    try:
        _check_columns(path, "the header", reader.fieldnames or ())
        for number, row in enumerate(reader, 1):
            if None in row or None in row.values():
                raise _refusal(path, f"row {number} has not as many values as the header; correct the file")
            rows.append({key: value if key == "name" else _number(value) for key, value in row.items()})
    except csv.Error as error:
        raise _refusal(path, f"not CSV: {error}; correct the file") from None
    return rows, None


def _parsed(path: Path, kind: str, parse: Callable[[str], Any]) -> Any:
    try:
        return data_of(path, kind, parse, "give the path of a file, seen from the case file's folder")
    except InputError as error:
        raise _refusal(path, str(error.args[0]).removeprefix(f"{path}: ")) from None


def _number(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


def _read_json(path: Path) -> tuple[list[Any], tuple[float, ...] | None]:
    data = _parsed(path, "JSON", json.loads)
    if isinstance(data, dict) and isinstance(data.get("bodies"), list):
        corners = [data.get(key) for key in ("lower", "upper")]
        return data["bodies"], _sides(*corners)
    if isinstance(data, dict) and isinstance(data.get("centers"), list):
        radius = data.get("radius")
        rows = [_centre_row(path, number, c, radius) for number, c in enumerate(data["centers"], 1)]
        return rows, _sides((0.0, 0.0), (data.get("L"), data.get("H")))
    raise _refusal(path, "no list of bodies; give an object with `bodies`, or with `centers` and `radius`")


def _centre_row(path: Path, number: int, centre: Any, radius: Any) -> dict[str, Any]:
    if not (isinstance(centre, list) and len(centre) in (2, 3)):
        raise _refusal(path, f"centre {number} = {toml_text(centre)}: not [x, y]; correct the file")
    return {"radius": radius, **dict(zip("xyz", centre, strict=False))}


def _body(path: Path, number: int, row: Any) -> dict[str, Any]:
    """One row as an entry of [[bodies]]; what is not a number, and a radius that is none, is refused here."""
    here = f"row {number}"
    if not isinstance(row, dict):
        raise _refusal(path, f"{here} = {toml_text(row)}: not an object; give it radius, x and y")
    columns: Sequence[str] = COLUMNS
    needed: Sequence[str] = _NEEDED
    if "shape" in row:
        columns, needed = (*COLUMNS, "shape"), ("x", "y")
        if "radius" in row:
            raise _refusal(path, f"{here}: has a radius and a shape; drop one of them")
    _check_columns(path, here, row, columns, needed)
    for key in _NUMBERS:
        value = row.get(key, 1.0)
        sound = isinstance(value, float | int) and not isinstance(value, bool) and math.isfinite(value)
        if not sound or (key == "radius" and value <= 0.0):
            wanted = "a number > 0" if key == "radius" else "a finite number"
            raise _refusal(path, f"{here}: {key} = {toml_text(value)}: not {wanted}; correct the file")
    position = tuple(float(row[axis]) for axis in "xyz" if axis in row)
    name = row.get("name", f"{'sphere' if 'z' in row else 'disc'}{number:04d}")
    size = {"shape": _shape(path, row["shape"])} if "shape" in row else {"radius": float(row["radius"])}
    body = {"name": name, "position": position} | size
    return body | ({"angle": float(row["angle"])} if "angle" in row else {})


def _shape(path: Path, shape: Any) -> Any:
    """A shape as a case has it, with the path of its points absolute."""
    if isinstance(shape, dict) and isinstance(points := shape.get("points"), str):
        shape = shape | {"points": os.path.realpath(path.parent / points)}
    return tuples(shape)


def _check_columns(
    path: Path,
    where: str,
    given: Iterable[str],
    columns: Sequence[str] = COLUMNS,
    needed: Sequence[str] = _NEEDED,
) -> None:
    given = list(given)
    for key in given:
        if key not in columns:
            alike = ", ".join(map(repr, words_like(key, columns)))
            raise _refusal(path, f"{where}: no such column {key!r}; use {alike} or drop it")
    for key in needed:
        if key not in given:
            raise _refusal(path, f"{where}: no {key!r}; give at least radius, x and y")


def _check_defaults(defaults: Mapping[str, Any], known: Sequence[str]) -> None:
    known = [key for key in known if key not in ("name", "position", "geometry")]
    for key, value in defaults.items():
        if key not in known:
            alike = ", ".join(f"body_defaults.{word}" for word in words_like(key, known))
            remedy = f"use {alike} or drop it"
            raise InputError(f"body_defaults.{key} = {toml_text(value)}: unknown key; {remedy}")


def _sides(lower: Any, upper: Any) -> tuple[float, ...] | None:
    """The sides of a box from its corners; None where they are not corners."""
    corners = (lower, upper)
    if not all(isinstance(c, list | tuple) and all(isinstance(x, float | int) for x in c) for c in corners):
        return None
    return tuple(float(high) - float(low) for low, high in zip(lower, upper, strict=False))


def _check_sides(path: Path, sides: tuple[float, ...] | None, domain: Any) -> None:
    if sides is None or not isinstance(domain, dict):
        return
    if domain.get("vectors") is not None:
        _check_cell(path, sides, domain["vectors"])
        return
    given = _sides(domain.get("lower"), domain.get("upper"))
    if given is None:
        return
    same = (math.isclose(one, other, rel_tol=_SAME_SIZE) for one, other in zip(given, sides, strict=False))
    if len(given) != len(sides) or not all(same):
        has, wants = (" x ".join(f"{side:.12g}" for side in both) for both in (given, sides))
        raise _refusal(path, f"its box is {wants}, but the domain is {has}; make domain.lower and upper fit")


def _check_cell(path: Path, sides: tuple[float, ...], vectors: Any) -> None:
    """The vectors of a cell must span the lattice of the file's box: integer combinations of its sides."""
    zero, given = (0.0,) * len(sides), vectors if isinstance(vectors, list | tuple) else ()
    corners = [_sides(zero, vector) for vector in given]
    if len(corners) != len(sides) or any(corner is None or len(corner) != len(sides) for corner in corners):
        return  # the schema says what is wrong
    counts = np.array(corners) / sides
    off = np.abs(counts - np.rint(counts)).max()
    if off > _SAME_SIZE or abs(np.linalg.det(np.rint(counts))) != 1.0:
        box = " x ".join(f"{side:.12g}" for side in sides)
        fitting = np.diag(sides).tolist()  # with all digits, to be copied
        raise _refusal(path, f"its box is {box}, but domain.vectors span another; give vectors = {fitting}")


def _refusal(path: Path, what: str) -> InputError:
    name = str(path)
    plain = name.isprintable() and len(name) <= _LONGEST_NAME
    return InputError(f"bodies_from = {name if plain else toml_text(name)}: {what}")
