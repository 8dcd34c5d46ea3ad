"""Rigid bodies moving in Stokes flow, resolved down to the lubrication film."""

from __future__ import annotations

from typing import TYPE_CHECKING

import fsi.meshes as _meshes  # noqa: F401  before NumPy: it sets the number of threads

if TYPE_CHECKING:
    from pathlib import Path

    from fsi.postprocess.run.run import Run


def open_run(path: Path | str) -> Run:
    """The run in a folder: its case, tables (pandas) and fields (pyvista); see `fsi.postprocess.run.run.Run`.

    Raises:
        fsi.errors.InputError: it is not a run folder.
    """
    from fsi.postprocess.run.run import (
        open_run,  # pandas and pyvista are heavy, and whoever computes needs neither
    )

    return open_run(path)
