"""How fast bodies without mass relax to a balance of loads in a step, and sums over what decays so.

At rest steps are as long as stability allows, z = -2.5 of the default scheme, and bodies go from one side of
the balance to the other. What they have strayed by stays on one side, as exp(z) > 0.
"""

import numpy as np

from fsi.arrays import Array


def relaxing(arms: Array, change: Array, w: Array) -> tuple[Array, Array]:
    """z of the body of each mode, 0 where it does not relax, and what a step errs by at least, (N, M) each.

    change: h dU, (N, M); w: h J of that.
    """
    size, size_of_w = (np.linalg.norm(arms * of, axis=1, keepdims=True) for of in (change, w))
    relaxes = (arms**2 * change * w).sum(axis=1, keepdims=True) < 0.0
    z = np.divide(-size_of_w, size, out=np.zeros_like(size), where=relaxes)
    # exp(z) - R(z) is at most 1/4 of h dU, less than STEP_SAFETY / 6; at the jump of a force z has no bound.
    part = np.minimum(-z / 30.0, np.divide(1.0 / 6.0, -z, out=np.zeros_like(z), where=relaxes))
    return np.broadcast_to(z, change.shape), part * np.abs(w)


def shrunk(z: Array) -> Array:
    """(exp(z) - 1) / z, for z <= 0."""
    return np.divide(np.expm1(z), z, out=np.ones_like(z), where=z < 0.0)


def kept(z: Array, change: Array, e: Array, later: Array) -> Array:
    """Where distances e have gone in a step: `later`, below z = -1 with their sign and at least what is left.

    Their way is known to an order of the step only, and would there be longer than they are. All (N, M);
    change: h dU times the arms.
    """
    least = left(z, change) * np.abs(e)
    return np.where(z < -1.0, np.copysign(np.maximum(np.abs(later), least), e), later)


def left(z: Array, change: Array) -> Array:
    """The part of a distance that a step leaves, (N, M); change: h dU times the arms.

    Across the way that a body takes to its balance nothing brings it back.
    """
    square = (change**2).sum(axis=1, keepdims=True)
    along = np.divide(change**2, square, out=np.zeros_like(change), where=square > 0.0)
    return 1.0 + along * np.expm1(z)


def mean(d: Array, later: Array) -> Array:
    """Of d over a step to `later`: what decays does so as an exponential, all else changes evenly."""
    ratio = np.divide(later, d, out=np.zeros_like(d), where=d != 0.0)
    decays = (ratio > 0.0) & (ratio < 1.0)
    even = 0.5 * (d + later)
    return np.divide(later - d, np.log(ratio, out=np.ones_like(d), where=decays), out=even, where=decays)


def cancelled(d: Array, later: Array) -> Array:
    """By how much the mean of d over a step to `later` is less than that of |d|, where signs differ."""
    return np.where(d * later < 0.0, np.minimum(np.abs(d), np.abs(later)), 0.0)
