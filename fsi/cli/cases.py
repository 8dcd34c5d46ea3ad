"""`fsi cases`: the cases of the documentation, to begin with."""

import shutil
from pathlib import Path
from typing import Annotated

import typer

import fsi.parallel as parallel
from fsi.cli.arguments import tell
from fsi.errors import InputError

EXAMPLE = "Example: fsi cases, then fsi run cases/settling_disc.toml"
_CASES = Path(__file__).parents[1] / "cases"


def shipped_cases() -> Path:
    """The folder of the cases. Raises InputError."""
    if (_CASES / "validation").is_dir():
        return _CASES
    raise InputError(f"{_CASES.parent}: the program has come without its cases; install it anew")


def write_cases(folder: Path) -> int:
    """Copy them into a new folder; gives the number of case files. Raises InputError."""
    if folder.exists():
        raise InputError(f"folder = {folder}: is there already; give the name of a new one")
    try:
        shutil.copytree(shipped_cases(), folder)
    except OSError as error:
        raise InputError(f"folder = {folder}: {error.strerror}; give a folder that can be written") from None
    return len(list(folder.rglob("*.toml")))


def cases(
    folder: Annotated[Path, typer.Argument(metavar="FOLDER", help="A new folder.")] = Path("cases"),
) -> None:
    """Write the cases that come with the program into a folder: examples, validation, calibration."""
    count = parallel.on_root(lambda: write_cases(folder))
    tell(f"wrote {count} cases to {folder}; begin with: fsi run {folder}/settling_disc.toml")
