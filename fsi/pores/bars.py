"""How many modes tell the error of how many others.

The same bodies are solved with more modes, with the most there are with fewer, and the difference of the two
times a factor bounds the error. Measured on four suspensions of area fraction 0.4 with gaps from 0.02 radii
(cases/pores, cases/suspensions/columns and random) against the most modes, the true error of the apparent
viscosity is 1.00 to 1.07 times the difference, that of the velocities at most 1.05 times; with one mode or
none on the sixty packings of `bench.pores` at most 1.25 and 1.27 times. With the next modes alone it would be
up to 10 times: many come in pairs. With the most modes the difference is some 25 times the error.
"""

import numpy as np

from fsi.case.sections import EDGE_MODES
from fsi.pores.adapt import REFINED, more
from fsi.pores.pattern import Index
from fsi.pores.system import PoreSystem

SAFETY = 1.5
_MOST = EDGE_MODES[-1]


def reference_modes(modes: int) -> int:
    """The modes of the other solve."""
    return REFINED.get(modes, EDGE_MODES[-2])


def bar_factor(modes: int) -> float:
    """What makes the difference from it a bound of the error."""
    return SAFETY if modes < _MOST else 1.0


def other_modes(system: PoreSystem) -> tuple[Index, float]:
    """Other modes, (K,), and what makes the difference from a flow with them a bound of the error."""
    modes = system.assembly.numbering.modes
    others = more(modes)
    if np.any(others > modes):
        return others, SAFETY
    return np.full_like(modes, EDGE_MODES[-2]), 1.0


def finer(modes: int) -> int | None:
    """The next number of modes; None with the most there are."""
    return min((more for more in EDGE_MODES if more > modes), default=None)
