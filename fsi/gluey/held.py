"""Gaps that no impulse keeps open, as what is held closes them: a shorter step does not help.

Of a pair whose gap only held modes change `n.(v_j - v_i)` is given, so that it has no row. Where a free body
stands between held ones, its rows are those of a program without a solution: no u has `b + J u >= 0`.
"""

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from fsi.bodies.gaps import OVERLAP
from fsi.gluey.augmented_lagrangian import Program
from fsi.gluey.contacts import Contacts, find_contacts, gap_rows
from fsi.gluey.system import GlueyState, System

# Of the largest rate: what the linear program's own tolerance, 1e-7, may leave of one that has a solution.
LEFT = 1e-6


def is_given(system: System, contacts: Contacts) -> NDArray[np.bool_]:
    """Whether what is held alone says how the gap of each pair changes, (C,)."""
    if system.held is None:
        return np.zeros(len(contacts), dtype=bool)
    of_free = abs(gap_rows(contacts, *system.mass.shape)) @ (~system.held.modes).ravel().astype(float)
    given: NDArray[np.bool_] = of_free <= np.finfo(float).eps  # normals are as good as that
    return given


def why_no_room(system: System, after: GlueyState, program: Program, gaps: int, t: float) -> str | None:
    """What held bodies have closed in a step to t, and None if they have not.

    after: the state then; gaps: the number of normal rows, the first ones of the program.
    """
    if system.held is None:
        return None
    overlaps = find_contacts(after.centres, system.radii, system.room, -OVERLAP * float(system.radii.min()))
    if is_given(system, overlaps).any():
        what = "a gap between bodies or walls that are all held is closed by their motion"
    elif gaps and _missing(program, gaps) > LEFT:
        what = "a body has no room left between others or walls that are held"
    else:
        return None
    return f"{what} in the step to t = {t:.9g}; change how they move"


def _missing(program: Program, gaps: int) -> float:
    """`min_u max(0, -(b + J u))` of the gaps, over the largest rate."""
    from scipy.optimize import linprog  # takes long to load: not where a step succeeds

    b, J = program.b[:gaps], program.J[:gaps]
    size, modes = float(np.abs(b).max()) or 1.0, J.shape[1]
    rows = -sp.hstack([J, np.ones((gaps, 1))]).tocsr()
    bounds = [(None, None)] * modes + [(0.0, None)]
    found = linprog(np.append(np.zeros(modes), 1.0), rows, b / size, bounds=bounds)
    return float(found.fun) if found.success else 0.0
