"""Run a case into a folder, and beside each field file keep the element's own values: `CASE FOLDER`.

`Function.eval` of DOLFINx gives them, in the cells of this rank, by Newton's method to rounding;
VALUES_<step>_<rank>.npz holds x and u.
"""

from __future__ import annotations

import sys
from pathlib import Path

import fsi.meshes.backend  # noqa: F401

import numpy as np
from numpy.typing import NDArray

import fsi.parallel as parallel
from fsi.arrays import Array
from fsi.case.load import load_case
from fsi.runs import run
from fsi.stokes import fields
from fsi.stokes.discretisation.forms import Forms

capture, write = fields.capture, fields.write_flow
# By the number of nodes: which of them are this rank's, u there, and how long the domain is.
evaluated: dict[int, tuple[NDArray[np.intp], Array, float]] = {}


def evaluate(forms: Forms, x: Array) -> fields.Flow:
    """Also evaluate u at the nodes, each in the last of its cells."""
    flow = capture(forms, x)
    cells = forms.V.dofmap.list[: forms.mesh.topology.index_map(2).size_local]
    holder = np.full(len(flow.x), -1, dtype=np.int32)
    holder[cells] = np.arange(len(cells), dtype=np.int32)[:, None]
    own = np.flatnonzero(holder >= 0)
    evaluated.clear()
    u = np.asarray(forms.u.eval(np.pad(x[own], ((0, 0), (0, 1))), holder[own], tol=1e-10), dtype=np.float64)
    evaluated[len(flow.x)] = own, u, float(np.ptp(flow.x))
    return flow


def keep(flow: fields.Flow, folder: Path, step: int) -> list[str]:
    """Also write what was evaluated."""
    own, u, length = evaluated[len(flow.x)]
    unit = np.ptp(flow.x) / length  # of the lengths in the solve
    np.savez(folder.parent / f"VALUES_{step}_{parallel.rank()}.npz", x=flow.x[own], u=unit * u)
    return write(flow, folder, step)


if __name__ == "__main__":
    fields.capture, fields.write_flow = evaluate, keep
    case = load_case(Path(sys.argv[1]))
    run(case, Path(sys.argv[2]))
