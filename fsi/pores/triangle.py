"""Points and weights in a triangle, as those of its thirds: from its middle to each of its sides.

They are alike from all three sides, so that no vertex of a pore is before another.
"""

from math import isclose

import numpy as np
from scipy.special import roots_jacobi

from fsi.bodies.configuration import Array


def third(degree: int) -> Array:
    """Points of a third, u from the middle outwards, t along the side, and weights whose sum is 1/2, (3, n).

    Together the thirds integrate polynomials up to a degree exactly: few points up to degree 14, Gauss points
    beyond.
    """
    return _symmetric(degree) if degree in _ORBITS else _collapsed((degree + 4) // 2)


def _symmetric(degree: int) -> Array:
    """Those of _ORBITS. Of three points that are in two thirds each has one, of the middle a third."""
    points = []
    for weight, least, middle in _ORBITS[degree]:
        most, u = 1.0 - least - middle, 1.0 - 3.0 * least
        if isclose(least, most):
            points.append((0.0, 0.5, weight))
            continue
        t = (most - least) / u
        alone = isclose(least, middle) or isclose(middle, most)
        points += [(u, s, 3.0 * weight) for s in ([t] if alone else [t, 1.0 - t])]
    return np.array(points).T.copy()


def _collapsed(n: int) -> Array:
    """Gauss points: n - 1 with the weight u du, n along the side."""
    (u, du), (t, dt) = roots_jacobi(n - 1, 0.0, 1.0), np.polynomial.legendre.leggauss(n)
    outwards, around = np.meshgrid((u + 1.0) / 2.0, (t + 1.0) / 2.0, indexing="ij")
    return np.stack([outwards, around, np.outer(du / 4.0, dt / 2.0)]).reshape(3, -1)


# By degree: weight, least and middle barycentric coordinate of a point; all its permutations are points, and
# the sum of all weights is 1/2. Xiao and Gimbutas 2010, Comput. Math. Appl. 59:663, as Basix 0.11 has them.
_ORBITS = {
    8: (
        (0.0721578038388936, 0.3333333333333333, 0.3333333333333333),
        (0.05160868526735912, 0.17056930775176027, 0.17056930775176027),
        (0.04754581713364232, 0.08141482341455375, 0.4592925882927231),
        (0.01622924881159904, 0.05054722831703107, 0.05054722831703107),
        (0.013615157087217498, 0.008394777409957675, 0.26311282963463806),
    ),
    10: (
        (0.041807437186986963, 0.3333333333333333, 0.3333333333333333),
        (0.004896295249209152, 0.009653080397658942, 0.4951734598011705),
        (0.003192679615059327, 0.019139415242841296, 0.019139415242841296),
        (0.039316884873188636, 0.18448501268524653, 0.18448501268524653),
        (0.03762366398427199, 0.14353035811256237, 0.42823482094371884),
        (0.014481140731628171, 0.03472362048232748, 0.13373475510086913),
        (0.019369524543009452, 0.03758272734119169, 0.3266931362813369),
    ),
    12: (
        (0.03127060659795138, 0.27146250701492614, 0.27146250701492614),
        (0.014243026034438775, 0.10925782765935432, 0.10925782765935432),
        (0.024959167464030475, 0.11977670268281382, 0.4401116486585931),
        (0.012133419040726017, 0.023592498108917004, 0.4882037509455415),
        (0.0039658212549868194, 0.02464636343633564, 0.02464636343633564),
        (0.021613681829707104, 0.1162960196779266, 0.25545422863851736),
        (0.007541838788255721, 0.021382490256170623, 0.12727971723358936),
        (0.01089179251930378, 0.023034156355267166, 0.29165567973834094),
    ),
    14: (
        (0.016394176772062678, 0.16471056131909206, 0.41764471934045394),
        (0.007216849834888334, 0.0617998830908727, 0.0617998830908727),
        (0.025887052253645793, 0.2734775283088387, 0.2734775283088387),
        (0.02108129436849651, 0.1772055324125435, 0.1772055324125435),
        (0.002461701801200041, 0.0193909612487011, 0.0193909612487011),
        (0.010941790684714446, 0.02207217927564281, 0.4889639103621786),
        (0.007218154056766921, 0.014646950055654471, 0.29837288213625773),
        (0.019285755393530342, 0.09291624935697185, 0.336861459796345),
        (0.012332876606281839, 0.05712475740364799, 0.17226668782135557),
        (0.002505114419250336, 0.001268330932872076, 0.11897449769695682),
    ),
}
