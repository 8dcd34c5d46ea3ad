"""Forms are compiled again after a compilation that was killed."""

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
SCRIPT = """
from pathlib import Path
from fsi.stokes.discretisation import forms
import ufl
from fsi.meshes.build import coordinate_element

forms.PATIENCE = 2
omega = ufl.Mesh(coordinate_element(1))
form = ufl.Constant(omega) * ufl.dx(omega)
forms.compile_form(form)
cache = Path(CACHE)
ready = sorted(cache.rglob("*.c.cached"))
assert ready
for file in [*ready, *cache.rglob("*.so")]:
    file.unlink()  # as a killed compiler leaves it
assert list(cache.rglob("*.c"))
forms.compile_form(form)
assert sorted(cache.rglob("*.c.cached")) == ready
"""


def test_a_killed_compilation_is_done_again(tmp_path: Path) -> None:
    code = SCRIPT.replace("CACHE", repr(str(tmp_path)))
    environment = os.environ | {"XDG_CACHE_HOME": str(tmp_path)}
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
