"""How many modes tell the error of how many others.

The same bodies are solved with more modes, with the most there are with fewer, and the difference of the two
times a factor bounds the error: what those miss that tell it is a small part. What is small by chance is
known to the part CHANCE of the largest difference. In the sixty packings of `bench.pores` no velocity is off
by more than its bar. Told by the next modes but one some are, by twice as much (tests/pores/test_bars.py):
many modes come in pairs, and narrow necks gain little from some. With the most modes the difference is some
25 times the error in packings, but between bodies far apart the last modes take off a half of it: in
hexagonal arrays of a twentieth of the area (tests/pores/test_bars.py) 12 modes need a factor of 2.8, 16 one
of 1.8.
"""

import numpy as np

from fsi.arrays import Indices
from fsi.case.sections import EDGE_MODES
from fsi.pores.adapt import TELLING, more
from fsi.pores.system import PoreSystem

SAFETY, CHANCE = 1.5, 0.1
# Dissipation, fluxes and speeds of walls by chance differ a hundred times less than velocities, and err by
# up to 0.18 of what these do, as parts of themselves (fifty flows against resolved ones).
CHANCE_OF_FLOW = 0.2
_MOST = EDGE_MODES[-1]
_LAST = {EDGE_MODES[-2]: 3.0, _MOST: 2.0}


def reference_modes(modes: int) -> int:
    """The modes of the other solve."""
    return TELLING.get(modes, EDGE_MODES[-2])


def bar_factor(modes: int) -> float:
    """What makes the difference from it a bound of the error."""
    return _LAST.get(modes, SAFETY)


def other_modes(system: PoreSystem) -> tuple[Indices, float]:
    """Other modes, (K,), and what makes the difference from a flow with them a bound of the error."""
    modes = system.assembly.numbering.modes
    least = int(modes.min(initial=_MOST))
    others = more(modes) if least < _MOST else np.full_like(modes, reference_modes(least))
    return others, bar_factor(least)
