"""How long bars are, of how far places, velocities and loads of a run have strayed by elements and by steps.

The signs of what steps miss are chosen: where one carries the other along, they may cancel in the estimate
alone. So each is known to a part of the largest only. A place that passes through zero, as one does that is
carried along by the shear of another, was farther off with other signs: bars of places are no shorter than at
earlier steps, but for what relaxes to a balance of loads. The signs of what elements miss are estimates, and
may turn where elements change from step to step, as pores do that neighbours exchange. So where the rate at
which a place strays by elements turns in a step, what cancels of it is added.
"""

import numpy as np

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration

HIDDEN = 0.1  # of the largest
ROUNDING = 1e-9  # of the largest: what bodies with a given velocity miss in place


def bars(arms: Array, distances: Array) -> Array:
    """Of distances (2, N, M) by cause, (N, M); times their arms they are alike."""
    of_elements, of_steps = np.abs(distances)
    largest = (arms * of_steps).max(initial=0.0) / arms
    hidden = np.where(of_steps > ROUNDING * largest, HIDDEN * largest, 0.0)  # none of what is given
    found: Array = of_elements + np.maximum(of_steps, hidden)
    return found


def bars_of_places(q: Configuration, e: Array, farthest: Array) -> Array:
    """Of places that have strayed by e, of centres once as far as `farthest`, by cause, (2, N, M) each."""
    found, d = bars(q.arms, e), q.dimension
    found[:, :d] = np.maximum(found[:, :d], farthest[:, :, :d].sum(axis=0))
    return found
