"""Cases for those who have no checkout, and what is said of a machine that lacks something."""

from __future__ import annotations

import errno
import itertools
import os
import shutil
from pathlib import Path

import pytest

from fsi.case.checks.expected import check_expected
from fsi.case.load import load_case
from fsi.cli import cases, missing
from fsi.cli.missing import explain
from fsi.errors import InputError
from tests.cli.test_commands import ROOT, fsi
from tests.commands import fsi_command

CASES = ROOT / "cases"


def test_the_cases_are_written_as_they_are(tmp_path: Path) -> None:
    found = fsi("cases", str(tmp_path / "new"))
    assert found.returncode == 0
    wanted = {path.relative_to(CASES): path.read_bytes() for path in CASES.rglob("*") if path.is_file()}
    written = {
        path.relative_to(tmp_path / "new"): path.read_bytes()
        for path in (tmp_path / "new").rglob("*")
        if path.is_file()
    }
    assert written == wanted
    with pytest.raises(InputError, match=r"folder = .*: is there already; give the name of a new one"):
        cases.write_cases(tmp_path / "new")


@pytest.mark.parametrize(
    ("refusal", "code", "words"),
    [
        (errno.ENOSPC, 3, "No space left on device; make room or give another place"),
        (errno.EACCES, 2, "Permission denied; give a path that can be read and written"),
    ],
)
def test_cases_are_written_all_or_none(
    refusal: int, code: int, words: str, tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    """The disk refuses the tenth file; then there is room, and the same command succeeds."""
    copies = itertools.count(1)

    def copy(source: Path, target: Path) -> None:
        if next(copies) == 10:
            raise OSError(refusal, os.strerror(refusal), str(source), None, str(target))
        shutil.copyfile(source, target)

    folder = tmp_path / "new"
    monkeypatch.setattr(shutil, "copy2", copy)
    assert fsi_command("cases", folder) == code
    told = capfd.readouterr()
    assert f"error: {folder}: {words}" in told.err
    assert (told.err.count("\n"), told.out) == (1, "")
    assert list(tmp_path.iterdir()) == []
    assert fsi_command("cases", folder) == 0


def test_every_shipped_case_stands_alone(tmp_path: Path) -> None:
    """Written into an empty folder by `fsi cases`, each one loads and is checked there."""
    cases.write_cases(tmp_path / "cases")
    paths = [path for path in (tmp_path / "cases").rglob("*.toml") if path.parent.name != "laws"]
    assert len(paths) > 60
    for path in paths:
        check_expected(load_case(path))


def test_a_package_without_its_cases_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cases, "_CASES", tmp_path / "cases")
    with pytest.raises(InputError, match="has come without its cases"):
        cases.shipped_cases()
    (tmp_path / "cases" / "validation").mkdir(parents=True)
    assert cases.shipped_cases() == tmp_path / "cases"


@pytest.mark.parametrize(
    ("error", "line"),
    [
        (ModuleNotFoundError("No module named 'dolfinx'", name="dolfinx"), "pip install 'fsi-stokes"),
        (ModuleNotFoundError("No module", name="_cffi_backend"), "_cffi_backend is not installed"),
        (ImportError("a.so: failed to map segment from shared object"), "memory: there is not enough"),
        (
            OSError("libGLU.so.1: cannot open shared object file: No such file or directory"),
            "libGLU.so.1 is missing on this machine; as root: apt-get install -y libgl1 libegl1 libglu1-mesa",
        ),
    ],
)
def test_what_is_missing_has_its_remedy(error: Exception, line: str) -> None:
    assert line in str(explain(error))


def test_what_is_missing_is_known_from_the_first_error() -> None:
    """Numba's llvmlite says of a library that did not fit into memory that it is not there."""
    error = OSError("Could not find/load shared object file 'libllvmlite.so'")
    error.__context__ = OSError("libllvmlite.so: failed to map segment from shared object")
    assert "memory: there is not enough" in str(explain(error))


@pytest.mark.parametrize("error", [ModuleNotFoundError("no", name="fsi.x"), OSError("disk full"), KeyError()])
def test_other_errors_are_not_explained_away(error: Exception) -> None:
    assert explain(error) is None


def test_a_missing_compiler_is_blamed_for_what_came_through_ffcx(monkeypatch: pytest.MonkeyPatch) -> None:
    """FFCx ends in an AttributeError that says nothing of a compiler."""
    compiled = {"__name__": "ffcx.codegeneration.jit"}
    exec("def compile_forms():\n    raise AttributeError('_solver')", compiled)
    with pytest.raises(AttributeError) as caught:
        compiled["compile_forms"]()  # type: ignore[operator]
    assert missing._lacking() or "the compiler gcc failed on the forms" in str(explain(caught.value))
    monkeypatch.setenv("CC", "no-such-compiler")
    assert "a C compiler is missing on this machine" in str(explain(caught.value))
    assert explain(AttributeError("_solver")) is None


def test_the_packages_are_those_of_the_bootstrap() -> None:
    text = (ROOT / "bootstrap.sh").read_text()
    for package in f"{missing.LIBRARIES} {missing.COMPILER}".split():
        assert f" {package}\n" in text or f"{package} " in text or f' {package}"' in text, package
