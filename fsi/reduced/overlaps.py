"""Films of many k = a b/(a + b)^2: the few whose laws are made, and the polynomial through them."""

from itertools import permutations

import numpy as np

from fsi.arrays import Array

# Up to so many different films have a law each; of more, laws at so many k are interpolated: of spheres good
# to 1e-10 with radii up to ten times as large as others, to 1e-8 up to fifty times (see the tests).
_NODES = 14
# Of k: films whose law is the same.
_SAME = 1e-12


def nodes(overlaps: Array) -> Array:
    """These k, each once; of many the squares of Chebyshev's between the least and the greatest root."""
    each = np.sort(overlaps)
    each = each[np.diff(each, prepend=-np.inf) > _SAME]
    if len(each) <= _NODES:
        return each
    low, high = _root(each[[0, -1]])
    roots = 0.5 * (low + high) + 0.5 * (high - low) * np.polynomial.chebyshev.chebpts1(_NODES)
    return np.asarray(roots * np.abs(roots))


def weights(overlap: Array, at: Array) -> Array:
    """Lagrange's in sqrt(k) of the m nodes `at` at these k, (m, P); at the k of a node it alone has one."""
    is_node = np.abs(overlap - at[:, None]) <= _SAME
    roots = _root(at)
    away = _root(overlap) - roots[:, None]
    of_all = np.ones_like(away)
    for i, j in permutations(range(len(at)), 2):
        of_all[i] *= away[j] / (roots[i] - roots[j])
    return np.where(is_node.any(axis=0), is_node, of_all)


def _root(overlap: Array) -> Array:
    """sqrt(k), in which laws of narrow and of wide films are alike smooth; negative inside a round wall."""
    return np.copysign(np.sqrt(np.abs(overlap)), overlap)
