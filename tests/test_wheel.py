"""The wheel has all that is needed to run from it."""

from __future__ import annotations

import subprocess
import sys
import tarfile
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
    own = (path for kind in ("*.py*", "*.[ch]") for path in (source / "fsi").rglob(kind))
    wanted = {path.relative_to(source).as_posix() for path in own}
    for room in ("meshes", "postprocess", "cases"):  # links in fsi, so that no generic name is installed
        files = (path for path in (source / room).rglob("*") if path.is_file())
        wanted |= {f"fsi/{path.relative_to(source).as_posix()}" for path in files}
    assert held == wanted | {"fsi/py.typed"}
    assert {name.partition("/")[0] for name in held} == {"fsi"}


@pytest.mark.slow
def test_a_source_distribution_builds_the_same_wheel(tmp_path: Path) -> None:
    """Links become folders in it, so that it stands alone."""
    source, unpacked = tmp_path / "source", tmp_path / "unpacked"
    subprocess.run(["git", "clone", "-q", ROOT, source], check=True)
    code = "from setuptools import build_meta; print(build_meta.build_sdist('.'))"
    subprocess.run([sys.executable, "-c", code], cwd=source, check=True, capture_output=True)
    with tarfile.open(next(source.glob("*.tar.gz"))) as archive:
        archive.extractall(unpacked, filter="data")
    (root,) = unpacked.iterdir()
    for room in ("meshes/build.py", "postprocess/report.py", "cases/disc_in_box.toml"):
        assert (root / "fsi" / room).is_file(), room
    for what in ("tests/conftest.py", "docs/index.md", "docs/gallery/ten_gaps.png", "mkdocs.yml", "Makefile"):
        assert (root / what).is_file(), what  # it can be tested, and its site made
