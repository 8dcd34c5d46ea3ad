"""`fsi new`: a case of one's own to begin with, each key with its meaning."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import Annotated

import typer

import fsi.parallel as parallel
from fsi.cli.arguments import option, output_to, tell
from fsi.errors import InputError

EXAMPLE = "Example: fsi new --kind shear -o mine.toml"

# What may be begun with, and the case that comes with the program whose values it has.
KINDS = {
    "settling": "settling_discs.toml",
    "spheres": "spheres_in_space.toml",
    "axis": "settling_spheres.toml",
    "shear": "slides/random.toml",
    "cell": "sheared_cell.toml",
    "pores": "suspensions/fractions.toml",
    "gluey": "gluey/two_discs.toml",
    "macroscopic": "macroscopic/blocks.toml",
    "calibration": "calibration/disc_wall.toml",
}


def new(
    kind: Annotated[str | None, option(f"One of {', '.join(KINDS)}.", "asked for")] = None,
    name: Annotated[str | None, option("A few words that name the case.", "asked for, or its kind")] = None,
    output: Annotated[Path | None, output_to("A new case file.", "asked for, or <kind>.toml")] = None,
) -> None:
    """Write a case to begin with: every key with its meaning behind it. Asks for what is not given."""
    from fsi.case.template import commented
    from fsi.cli.cases import shipped_cases
    from fsi.files import write_whole

    asks = sys.stdin.isatty() and parallel.size() == 1
    if kind is None:
        kind = _kind(asks)
    if kind not in KINDS:
        raise InputError(f"--kind {kind}: there is no such kind; give one of {', '.join(KINDS)}")
    chosen = name or (typer.prompt("name of the case", kind) if asks else kind)
    path = output or Path(typer.prompt("file", f"{kind}.toml") if asks else f"{kind}.toml")
    if path.exists():
        raise InputError(f"output = {path}: is there already; give the name of a new file")
    parallel.on_root(lambda: write_whole(path, commented(shipped_cases() / KINDS[kind], chosen)))
    tell(f"wrote {path}; see what it holds with: {shlex.join(['fsi', 'check', str(path)])}")


def _kind(asks: bool) -> str:
    if not asks:
        raise InputError(f"--kind: missing; give one of {', '.join(KINDS)}")
    return str(typer.prompt(f"kind ({', '.join(KINDS)})", "settling"))
