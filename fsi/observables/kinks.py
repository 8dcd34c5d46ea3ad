"""The rows of a run at which what is given has kinks."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from fsi.arrays import Array
from fsi.integration.state import SAME_TIME


def between_kinks(t: Array, kinks: Sequence[float]) -> list[slice]:
    """The pieces of times t, increasing, (K,), from kink to kink, both ends in each.

    A step that ends within `Schedule`'s tolerance of a kink is the one that landed on it.
    """
    rows = np.searchsorted(t, np.asarray(kinks, dtype=float) - SAME_TIME * t[-1]).tolist()
    ends = sorted({0, len(t) - 1, *(row for row in rows if row < len(t))})
    return [slice(first, last + 1) for first, last in pairwise(ends)]
