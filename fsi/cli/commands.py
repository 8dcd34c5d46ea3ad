"""The commands of `fsi` by name, each loaded and made when it is asked for.

All of them together take a tenth of what `fsi check` takes.
"""

from collections.abc import Iterator, Mapping
from functools import cache
from importlib import import_module
from typing import Any, NamedTuple, override

import typer
from typer.core import TyperGroup


class Place(NamedTuple):
    """Where a command stands: a function of its name with _ for - in a module of `fsi.cli`.

    Attributes:
        module: the name of the module.
        example: the name of the example there with which its help ends; "" where it is hidden.
    """

    module: str
    example: str = ""


# In the order in which `fsi --help` lists them.
PLACES = {
    "cases": Place("cases", "EXAMPLE"),
    "new": Place("new", "EXAMPLE"),
    "check": Place("cases", "CHECK_EXAMPLE"),
    "keys": Place("cases", "KEYS_EXAMPLE"),
    "mesh": Place("solve", "MESH_EXAMPLE"),
    "pack": Place("pack", "EXAMPLE"),
    "solve": Place("solve", "EXAMPLE"),
    "run": Place("run", "EXAMPLE"),
    "resume": Place("run", "RESUME_EXAMPLE"),
    "watch": Place("run", "WATCH_EXAMPLE"),
    "render": Place("render", "EXAMPLE"),
    "plot": Place("plot", "EXAMPLE"),
    "probe": Place("report", "PROBE_EXAMPLE"),
    "report": Place("report", "EXAMPLE"),
    "revolve": Place("report", "REVOLVE_EXAMPLE"),
    "export": Place("export", "EXAMPLE"),
    "limit": Place("compare", "LIMIT_EXAMPLE"),
    "resistance": Place("solve", "RESISTANCE_EXAMPLE"),
    "search": Place("search", "EXAMPLE"),
    "sweep": Place("sweep", "EXAMPLE"),
    "sweep-run": Place("sweep"),
    "sample-run": Place("calibrate"),
    "validate-run": Place("calibrate"),
    "validate": Place("calibrate", "VALIDATE_EXAMPLE"),
    "calibrate": Place("calibrate", "EXAMPLE"),
    "compare": Place("compare", "EXAMPLE"),
    "analyse": Place("analyse", "EXAMPLE"),
}


class Commands(Mapping[str, Any]):
    """What typer makes of the commands, by name."""

    @override
    def __getitem__(self, name: str) -> Any:
        return _made(name)

    @override
    def __iter__(self) -> Iterator[str]:
        return iter(PLACES)

    @override
    def __len__(self) -> int:
        return len(PLACES)


@cache
def _made(name: str) -> Any:
    """What typer makes of one command, or of a group of them. Raises KeyError."""
    place = PLACES[name]
    module = import_module(f"fsi.cli.{place.module}")
    found = getattr(module, name.replace("-", "_"))
    if isinstance(found, typer.Typer):
        return typer.main.get_command(found)
    alone = typer.Typer(add_completion=False, rich_markup_mode="markdown", pretty_exceptions_enable=False)
    example = getattr(module, place.example) if place.example else None
    alone.command(name, epilog=example, hidden=not place.example)(found)
    return typer.main.get_command(alone)


class Group(TyperGroup):
    """`fsi` itself."""

    def __init__(self, **attributes: Any) -> None:
        super().__init__(**attributes | {"commands": Commands()})
