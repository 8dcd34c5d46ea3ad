"""Element sizes towards edges of a box or tube where the flow is singular.

As towards corners in the plane (`fsi.meshes.planar.grading`), cells must be small against the distance r from
such an edge:

    h(r) = max(h_edge, GROWTH g r),    h_edge = g / 2 distance,    g = min(growth, COARSEST),

where `distance` is that of the edge from the nearest body or other wall. With g above COARSEST no cell is
small against r, and finer ones change forces by chance: they have no order yet. An edge of length L costs
some 13 L / (GROWTH g h_edge) cells, in proportion to 1 / h_edge where a corner costs its logarithm: so this
is no deeper than what keeps the error of the edge beside those of gaps and bodies.

Beside a round wall cells have another bound H, 2 pi R / cells_per_circle, which may be below those sizes; the
edge, and what its error bar compares, would then be as coarse as all else. There h_edge is g H at most.
"""

import numpy as np

from fsi.meshes.geometry.container import HERE, FluidDomain
from fsi.meshes.planar.grading import GROWTH

COARSEST = 0.5


def edge_sizes(domain: FluidDomain, growth: float, largest: float) -> list[str]:
    """The largest element size towards each of the edges of a domain, as formulas in x, y, z.

    largest: what no element exceeds, H beside round walls.
    """
    container, formulas = domain.container, domain.container.distance_formulas()
    to_bodies, meetings, size = container.distances(domain.centres), container.meetings(), container.size()
    sizes, g = [], min(growth, COARSEST)
    for one, other in domain.edges:
        to_walls = container.distances(meetings[one, other])
        clear = float(to_walls[to_walls > HERE * size].min(initial=size))
        from_edge = (to_bodies[:, one] ** 2 + to_bodies[:, other] ** 2) ** 0.5 - domain.radii
        is_round = any(container.spheres[wall] is not None for wall in (one, other))
        bound = largest if is_round else np.inf
        smallest = g * float(min(0.5 * from_edge.min(initial=clear), bound))
        away = f"sqrt(({formulas[one]})^2+({formulas[other]})^2)"
        sizes.append(f"max({smallest!r},{GROWTH * g!r}*{away})")
    return sizes
