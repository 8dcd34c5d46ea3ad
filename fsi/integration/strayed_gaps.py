"""How far the smallest gap of a run has strayed from that of the exact motion.

At distances e of the exact places from those of the run a gap s strays by grad s . e, and the time at which
the run has it by that over the rate s'. The signs of what steps miss are chosen for each component of e by
itself, and elements miss of each body another part of its bar. So in grad s . e may cancel what does not
cancel in truth, as where two bodies pass each other and grad s turns. But the sum without signs,

    sum_k |ds/dq_k e_k|

counts what moves both bodies alike: for two spheres that sink together it is hundreds of times too long. The
bar lies between both; beside a wall, with which nothing moves alike, it is what bars of places allow. In
narrow gaps s' is s times what depends little on s, so that the error of a gap stays about the same part of it
while it closes and opens: a bar is no smaller part of its gap than at the step before. Each step adds to that
part what may hide in what it and the elements miss of both bodies.
"""

from collections.abc import Callable

import numpy as np

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration, rigid_motion
from fsi.bodies.gaps import nearest_gaps
from fsi.bodies.surface_gap import SurfaceGap
from fsi.meshes.geometry.container import Container

SMALLER = 1e-3  # of the smallest gap or radius: how far bodies go where a rate of the gap is differenced


def gap_gradient(q: Configuration, gap: SurfaceGap) -> Array:
    """ds/dq of a gap s, (N, M): what turns a disc or sphere does not change it."""
    gradient, (i, j) = np.zeros_like(q.arms), gap.sides
    gradient[i] -= _along(gap, gap.opposite - gap.width * gap.normal - q.centres[i])
    if gap.away is not None:
        gradient[j] += _along(gap, gap.opposite - gap.away - q.centres[j])
    return gradient


def _along(gap: SurfaceGap, r: Array) -> Array:
    """How fast a point, r from the centre of its body, moves along the normal of a gap in each mode, (M,)."""
    along: Array = gap.normal @ rigid_motion(r)[: len(r)]
    return along


def gap_bar(gradient: Array, e: Array, bars: Array, least: float) -> float:
    """How far a gap has strayed at distances e by cause, (2, N, M): no less than `least`, if that can be.

    bars: of the places, (N, M).
    """
    signed, most = np.abs((gradient * e).sum(axis=(1, 2))).sum(), np.sum(np.abs(gradient) * bars)
    return float(min(max(signed, least), most))


def gap_rate(q: Configuration, U: Array, now: Container, later: Callable[[float], Container]) -> float:
    """s' of the smallest gap s of bodies that move with U, in a container that will be another one later."""
    duration = SMALLER * way_of_gaps(q, U, now)
    if duration == 0.0:
        return 0.0
    after = nearest_gaps(q.moved(duration * U), later(duration)).smallest()
    return float(after - nearest_gaps(q, now).smallest()) / duration


def way_of_gaps(q: Configuration, e: Array, container: Container) -> float:
    """The smallest gap or radius over the length of e; zero if that is."""
    length = float(np.abs(q.arms * e).max(initial=0.0))
    smallest = min(nearest_gaps(q, container).smallest(), float(q.radii.min(initial=np.inf)))
    return smallest / length if length > 0.0 else 0.0
