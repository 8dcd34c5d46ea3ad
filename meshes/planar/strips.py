"""A channel of many bodies is divided into strips, each of which gmsh fills by itself.

What gmsh takes for a triangle grows with their number (docs/speed.md), and ranks take strips each; strips of
half as many bodies cost as much in triangles as they gain. Chains of links from wall to wall bound them,
shortest paths as the cut is, each in a window of its own and without the bodies of the others. They use only
links whose circle no other surface reaches into. Two such links never cross: of the four angles of their ends
all would be acute.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.meshes.planar.cut import shortest_tree
from fsi.meshes.planar.links import NeighbourLinks, joined, neighbours
from fsi.meshes.planar.sizing import Surfaces

FEWEST = 80  # bodies that are divided
BODIES = 100  # in a strip
REACH = 3.0  # the longest link over the largest radius
WINDOW = 0.5  # half the width of a window over that of a strip
NARROWEST = 3.0  # half the width of a window over the largest radius
CLEAR = 1.0 - 1e-9  # distance from the middle of a link over half its length


def divided(links: NeighbourLinks, surfaces: Surfaces) -> NeighbourLinks:
    """The links that open a domain, and those that divide it between walls where it has many bodies."""
    strips = _strips(surfaces)
    if strips < 2:
        return links
    n, lattice, chains = surfaces.bodies, surfaces.lattice, [links]
    along = lattice.coordinates(surfaces.centres[:n])[:, 0]
    every = neighbours(surfaces, REACH * float(surfaces.radii.max()))
    every = every[_is_clear(every, surfaces)]
    free = ~np.isin(np.arange(n + 2), np.concatenate([links.first, links.second]))
    # The mean place of the bodies of the first chain, which may wander far along the channel.
    first = float(np.angle(np.exp(2j * np.pi * along[~free[:n]]).mean())) / (2.0 * np.pi)
    for k in range(1, strips):
        off = (along - first - k / strips + 0.5) % 1.0 - 0.5
        window = np.append(free[:n] & (np.abs(off) * strips < WINDOW), [True, True])
        near = every[window[every.first] & window[every.second]]
        tree = shortest_tree(near, n, n + 2)
        if np.isfinite(tree.length[n + 1]):
            chains.append(near[np.array(tree.way(n + 1))])
            free[chains[-1].first] = free[chains[-1].second] = False
    return joined(*chains)


def _strips(surfaces: Surfaces) -> int:
    """Into how many strips a domain is worth dividing, which two ranks share: a cell without walls is not."""
    if len(surfaces.container.walls) == 0 or surfaces.bodies < FEWEST:
        return 1
    most = WINDOW * surfaces.lattice.longest() / (NARROWEST * float(surfaces.radii.max()))
    return min(2 * max(1, surfaces.bodies // (2 * BODIES)), int(most))


def _is_clear(links: NeighbourLinks, surfaces: Surfaces) -> NDArray[np.bool_]:
    """Whether no other surface reaches into the circle over each link."""
    begin = surfaces.centres[links.first] + links.feet[:, 0]
    middle = begin + (surfaces.arms[links.first] + 0.5 * links.gap)[:, None] * links.along
    walls: Array = surfaces.container.distances(surfaces.lattice.wrapped(middle)).min(axis=1)
    clear: NDArray[np.bool_] = np.minimum(surfaces.nearest(middle)[0], walls) >= CLEAR * 0.5 * links.gap
    return clear
