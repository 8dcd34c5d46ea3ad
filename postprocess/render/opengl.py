"""Whether this machine can draw off screen; asked of a child process, since VTK crashes where it cannot."""

from __future__ import annotations

import os
import subprocess
import sys

from fsi.errors import InputError

_SETTING = "VTK_DEFAULT_OPENGL_WINDOW"
_WINDOWS = ("vtkEGLRenderWindow", "vtkOSOpenGLRenderWindow", "vtkXOpenGLRenderWindow")
_DRAW = """
import vtkmodules.vtkRenderingOpenGL2
from vtkmodules.vtkRenderingCore import vtkRenderWindow
window = vtkRenderWindow()
window.SetOffScreenRendering(True)
window.Render()
raise SystemExit(not window.SupportsOpenGL())
"""


def require_opengl() -> None:
    """Choose the kind of off-screen window that works here, for VTK in this process.

    Raises:
        InputError: none works; the message names the missing package.
    """
    given = os.environ.get(_SETTING)
    for window in (given,) if given else _WINDOWS:
        if _draws(window):
            os.environ[_SETTING] = window
            return
    raise InputError(
        "render: no off-screen OpenGL on this machine; as root: apt-get install -y libegl1 libgl1, "
        "or look at the .pvd files in ParaView"
    )


def _draws(window: str) -> bool:
    """True where a child process can draw into a window of this VTK class."""
    environment = os.environ | {_SETTING: window}
    try:
        child = subprocess.run(
            [sys.executable, "-c", _DRAW], env=environment, capture_output=True, timeout=60, check=False
        )
    except subprocess.TimeoutExpired:
        return False
    return child.returncode == 0
