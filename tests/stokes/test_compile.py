"""Forms are compiled again where their cache is in any state, and a compiler that fails is named."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from fsi.stokes.discretisation.jit import blocked_by

ROOT = Path(__file__).parents[2]
SCRIPT = """
import sys
from pathlib import Path
from fsi.stokes.discretisation import jit
import ufl
from fsi.meshes.build import coordinate_element

jit.PATIENCE = 2
omega = ufl.Mesh(coordinate_element(1))
jit.compile_form(ufl.Constant(omega) * ufl.dx(omega))
"""
# What is done to all files of the cache of one kind.
DAMAGE: dict[str, list[tuple[str, float | None]]] = {
    "a killed compilation": [("*.c.cached", None), ("*.so", None)],
    "a lost library": [("*.so", None)],
    "an empty library": [("*.so", 0.0)],
    "a library cut short": [("*.so", 0.5)],
}


def compile_in(cache: Path, script: str = SCRIPT, **more: str) -> subprocess.CompletedProcess[str]:
    environment = os.environ | {"XDG_CACHE_HOME": str(cache)} | more
    return subprocess.run(
        [sys.executable, "-c", script], cwd=ROOT, env=environment, capture_output=True, text=True, check=False
    )


@pytest.fixture(scope="module")
def compiled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A cache with one form."""
    cache = tmp_path_factory.mktemp("cache")
    done = compile_in(cache)
    assert done.returncode == 0, done.stderr
    assert list(cache.rglob("*.c.cached"))
    return cache


@pytest.mark.parametrize("damage", DAMAGE)
def test_a_broken_cache_is_made_again(compiled: Path, damage: str) -> None:
    """A library cut short would end in a bus error, one that never gets ready would be waited for."""
    for pattern, part in DAMAGE[damage]:
        for file in compiled.rglob(pattern):
            if part is None:
                file.unlink()
            else:
                os.truncate(file, int(part * file.stat().st_size))
    done = compile_in(compiled)
    assert done.returncode == 0, done.stderr
    assert len(list(compiled.rglob("*.c.cached"))) == len(list(compiled.rglob("*.so"))) == 1


def test_a_library_that_cannot_be_loaded_is_made_again(compiled: Path) -> None:
    """Whole by its length, but not what was compiled."""
    (library,) = compiled.rglob("*.so")
    content = library.read_bytes()
    library.unlink()  # others may have it open
    library.write_bytes(content[:64] + bytes(len(content) - 64))
    done = compile_in(compiled)
    assert done.returncode == 0, done.stderr


def test_what_is_not_of_the_cache_is_not_removed(tmp_path: Path) -> None:
    """A package's library that finds no memory was taken for a broken entry, and removed for good."""
    failed = ImportError("failed to map segment", path="/usr/lib/python3/_cffi_backend.cpython-312.so")
    assert blocked_by(failed, tmp_path) is None
    own = ImportError("no ELF", path=str(tmp_path / "libffcx_forms_1.cpython-312.so"))
    assert blocked_by(own, tmp_path) == tmp_path / "libffcx_forms_1.c"


def test_where_there_can_be_no_cache_forms_are_compiled_all_the_same(tmp_path: Path) -> None:
    (tmp_path / "fenics").write_text("a file where the folder should be")
    done = compile_in(tmp_path, TMPDIR=str(tmp_path))
    assert done.returncode == 0, done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["fenics"]


def test_a_compiler_that_fails_is_named(tmp_path: Path) -> None:
    script = """if True:
        import sys
        from fsi.cli.main import main
        sys.argv = ["fsi", "solve", "cases/disc_in_box.toml"]
        sys.exit(main())
    """
    done = compile_in(tmp_path, script, CC="false")
    assert done.returncode == 3
    assert done.stderr.startswith("error: the compiler false failed on the forms")
    assert done.stderr.count("\n") == 1
