"""Mutations: how case files, options and files of run folders go wrong."""

from __future__ import annotations

import os
import random
import shutil
from collections.abc import Callable, Iterator
from contextlib import suppress
from datetime import date
from functools import partial
from pathlib import Path
from typing import Any

import tomli_w

type Random = random.Random
type Path_ = tuple[str | int, ...]

NUMBERS = (
    0, 1, -1, 2, 7, 1000, 10**9, 10**18, -(10**18), 0.0, -0.0, 0.5, 1.0, 1e-3, 1e-9, 1e-16, 1e-300, 5e-324,
    1e3, 1e9, 1e16, 1e150, 1e300, -1e300, float("nan"), float("inf"), float("-inf"),
)  # fmt: skip
WORDS = (
    "", "free", "open", "x", "disc", "plane", "box", "round", "gluey", "spatial", "squeeze", "a.b", "../..",
    "ä∞😀", "a" * 5000, "line\nbreak", "\t", "%s{}", "-x", "where(t > 1, 2*m, 0)", "1/0*x", "/", ".",
)  # fmt: skip
THINGS: tuple[Any, ...] = (
    True, False, [], {}, [[]], [{}], {"times": [], "values": []}, {"times": [0.0, 0.0], "values": [1.0, 2.0]},
    {"pressure": 1.0}, {"shear": 1e300}, [1.0] * 1000, [[0.0, 1.0]] * 3, date(2026, 1, 1), {"free": "free"},
)  # fmt: skip


def values(rng: Random) -> Any:
    """Anything that TOML can say."""
    return rng.choice(rng.choice((NUMBERS, NUMBERS, WORDS, THINGS)))


def paths(data: Any, here: Path_ = ()) -> Iterator[Path_]:
    """Where there is something in nested data."""
    items = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, item in items:
        yield (*here, key)
        yield from paths(item, (*here, key))


def at(data: Any, path: Path_) -> Any:
    """What stands there."""
    for key in path:
        data = data[key]
    return data


def mutate_data(rng: Random, data: dict[str, Any]) -> None:
    """Change nested data in one place, in place."""
    every = list(paths(data))
    if not every:
        return
    path = rng.choice(every)
    *where, key = path
    inside, value = at(data, tuple(where)), at(data, path)
    match rng.randrange(8):
        case 0:
            del inside[key]
        case 1 if isinstance(key, str):
            inside[rng.choice((key.upper(), key + "s", key[1:] or "k", "ключ", rng.choice(WORDS)))] = (
                inside.pop(key)
            )
        case 2 if isinstance(value, int | float) and not isinstance(value, bool):
            inside[key] = value * rng.choice((-1, 0, 2, 0.5, 1e3, 1e-3, 1e6, 1e-6, 1e12, 1e-12))
        case 3 if isinstance(value, list):
            inside[key] = value * rng.choice((2, 3, 50))
        case 4 if isinstance(value, list):
            inside[key] = value[:-1]
        case 5:
            other = rng.choice(every)
            *there, name = other
            if path[: len(other)] != other and other[: len(path)] != path:
                home = at(data, tuple(there))
                inside[key], home[name] = home[name], inside[key]
        case _:
            inside[key] = values(rng)


def mutate_bytes(rng: Random, text: bytes) -> bytes:
    """Change a file as a disk, a careless editor or a bad transfer does."""
    k, n = rng.randrange(len(text) + 1), rng.randrange(1, 40)
    lines = text.splitlines(keepends=True) or [b""]
    line = rng.randrange(len(lines))
    return rng.choice((
        lambda: text[:k] + bytes([rng.randrange(256)]) + text[k + 1 :],
        lambda: text[:k] + rng.randbytes(n) + text[k + n :],
        lambda: text[:k],
        lambda: text[:k] + text[k + n :],
        lambda: b"",
        lambda: b"\0" * len(text),
        lambda: b"".join([*lines[:line], lines[line], *lines[line:]]),
        lambda: b"".join([*lines[:line], *lines[line + 1 :]]),
        lambda: text.replace(b"1", b"9" * rng.choice((2, 20, 400, 5000)), 1),
        lambda: text.replace(b"0", b"nan", 1),
        lambda: b"\xef\xbb\xbf" + text.replace(b"\n", b"\r\n"),
        lambda: text + b"[" * 3000,
    ))()  # fmt: skip


def mutated_case(rng: Random, data: dict[str, Any]) -> bytes:
    """A case file with one to three faults."""
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        mutate_data(rng, data)
    text = tomli_w.dumps(data).encode()
    return mutate_bytes(rng, text) if rng.random() < 0.15 else text


def damage(rng: Random, folder: Path) -> str:
    """Damage one file of a folder; says how."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    weights = [1 if path.parent.name == "fields" else 4 for path in files]
    path = rng.choices(files, weights)[0]
    ways: dict[str, Callable[[], object]] = {
        "changed": lambda: path.write_bytes(mutate_bytes(rng, path.read_bytes())),
        "changed in one place": lambda: path.write_bytes(_flipped(rng, path.read_bytes())),
        "removed": path.unlink,
        "a folder": lambda: _in_place_of(path, path.mkdir),
        "a pipe": lambda: _in_place_of(path, partial(os.mkfifo, path)),
        "a circle of links": lambda: _in_place_of(path, partial(path.symlink_to, path)),
        "a list": lambda: path.write_bytes(b"[1, 2]"),
        "another file": lambda: shutil.copy(rng.choice(files), path),
    }
    way = rng.choice(("changed", "changed", "changed in one place", *ways))
    with suppress(shutil.SameFileError):
        ways[way]()
    return f"{path.relative_to(folder)} {way}"


def _in_place_of(path: Path, make: Callable[[], object]) -> None:
    path.unlink()
    make()


def _flipped(rng: Random, text: bytes) -> bytes:
    """One number or letter for another."""
    places = [k for k, byte in enumerate(text) if chr(byte).isalnum() and byte < 128] or [0]
    k = rng.choice(places)
    return text[:k] + rng.choice((b"0", b"9", b"-", b"x", b"e", b'"')) + text[k + 1 :]
