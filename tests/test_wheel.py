"""The wheel has all that is needed to run from it."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


@pytest.mark.slow
def test_the_wheel_has_every_module_and_case_and_nothing_else(tmp_path: Path) -> None:
    """A package that is missing in pyproject.toml would be seen only by those who install."""
    source = tmp_path / "source"
    subprocess.run(["git", "clone", "-q", ROOT, source], check=True)
    command: list[str | Path] = [
        sys.executable,
        "-m",
        "pip",
        "wheel",
        "-q",
        "--no-deps",
        "--no-build-isolation",
        "-w",
        tmp_path,
    ]
    subprocess.run([*command, source], check=True)
    (wheel,) = tmp_path.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        held = {name for name in archive.namelist() if ".dist-info/" not in name}
        about = [name for name in archive.namelist() if name.endswith("entry_points.txt")]
        assert b"fsi = fsi.cli.main:main" in archive.read(about[0])
    packages = ("fsi", "meshes", "postprocess")
    every = (path for package in packages for path in (source / package).rglob("*"))
    wanted = {path.relative_to(source).as_posix() for path in every if path.suffix == ".py"}
    cases = (path for path in (source / "cases").rglob("*") if path.is_file())
    wanted |= {f"fsi/{path.relative_to(source).as_posix()}" for path in cases}
    assert held == wanted | {f"{package}/py.typed" for package in packages}
