"""Where a periodic domain is opened: along the shortest ways between neighbouring surfaces.

A plane mesh needs a domain without periods. A straight side would cut bodies, and leave slivers where it
grazes them. Instead the cut runs from surface to surface along links, the straight lines that join
neighbours (bodies, their images, walls) where their gap is smallest, and inside the bodies, where there is no
fluid. What opens the domain is a chain of links from wall to wall, or on a torus two loops; the fluid between
them and their images is then a polygon of links and arcs with the other bodies as holes.

The chain is a shortest path with the SQUARES of the gaps as lengths. If a third body reached into the circle
over a link of gap g, the two links to that body would have g1^2 + g2^2 < g^2 and the path would go there. So
every link has its circle to itself, no link meets another or a body, and narrow gaps are preferred, where
a mesh has lines from surface to surface anyway.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

from fsi.meshes.errors import MeshError
from fsi.meshes.geometry.container import Array
from fsi.meshes.geometry.lattice import Integers, positive
from fsi.meshes.planar.sizing import Surfaces

Indices = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class NeighbourLinks:
    """Neighbours and the straight ways between them, n links.

    Attributes:
        first: where each begins: bodies 0 ... N - 1, then walls, (n,).
        second: where it ends, (n,).
        shift: the integers by which the image of `second` that is meant is moved, (n, k).
        step: from the centre of `first` to that of the image, (n, 2); a wall's centre is its nearest point.
        gap: between the two surfaces, (n,).
    """

    first: Indices
    second: Indices
    shift: Integers
    step: Array
    gap: Array

    def __getitem__(self, chosen: NDArray[np.bool_] | Indices) -> NeighbourLinks:
        """Some of them."""
        return NeighbourLinks(*(getattr(self, field.name)[chosen] for field in fields(self)))

    def __len__(self) -> int:
        """How many."""
        return len(self.gap)


def cut(surfaces: Surfaces) -> NeighbourLinks:
    """The links that open a periodic domain. Raises MeshError where a cell without walls has no body."""
    container, bodies = surfaces.container, surfaces.bodies
    if len(container.walls) + bodies == 0:
        raise MeshError("a periodic cell without walls needs a body; give it one")
    open_by = _from_wall_to_wall if container.walls else _two_loops
    reach = float(surfaces.radii.max()) if bodies else container.size()
    while True:
        links = neighbours(surfaces, reach)
        chosen, length = open_by(links, bodies)
        # A link that was not looked at is longer than all of the way found.
        if length <= reach**2 or reach > container.size():
            return links[chosen]
        reach *= 2.0


def neighbours(surfaces: Surfaces, reach: float) -> NeighbourLinks:
    """All links with gaps up to `reach` between bodies, and those of all bodies to the walls."""
    n, m, lattice = surfaces.bodies, surfaces.lattice.near(), surfaces.lattice
    centres, radii = surfaces.centres[:n], surfaces.radii[:n]
    farthest = 2.0 * radii.max(initial=0.0) + reach
    pairs = cKDTree(centres).sparse_distance_matrix(surfaces.tree, farthest, output_type="ndarray")
    first, (which, second) = pairs["i"], np.divmod(pairs["j"], max(n, 1))
    # Each link once: to a later body, or to the body's own image by the first of two opposite shifts.
    once = (second > first) | ((second == first) & positive(m[which]))
    first, second, shift = first[once], second[once], m[which[once]]
    step = centres[second] + lattice.shift(shift) - centres[first]
    gap = np.hypot(*step.T) - radii[first] - radii[second]
    between = NeighbourLinks(first, second, shift, step, gap)[gap <= reach]
    return joined(between, _to_walls(surfaces))


def _to_walls(surfaces: Surfaces) -> NeighbourLinks:
    """From each body straight to each wall; without bodies from the first wall to the second."""
    n, container = surfaces.bodies, surfaces.container
    centres, walls = surfaces.centres[:n] if n else np.zeros((1, 2)), len(container.walls)
    distances, normals = container.distances(centres), container.normals(centres)
    if n == 0:
        first, second, gap = np.array([0]), np.array([1]), distances.sum(axis=1)
        step = gap[:, None] * normals[0, :1]
    else:
        first, wall = np.divmod(np.arange(n * walls), max(walls, 1))
        step = distances[first, wall, None] * -normals[first, wall]
        second, gap = n + wall, distances[first, wall] - surfaces.radii[first]
    shift = np.zeros((len(first), surfaces.lattice.dimension), dtype=np.int64)
    return NeighbourLinks(first, second, shift, step, gap)


def joined(*parts: NeighbourLinks) -> NeighbourLinks:
    """All links of the parts."""
    names = [field.name for field in fields(NeighbourLinks)]
    return NeighbourLinks(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))


@dataclass(frozen=True, slots=True)
class Tree:
    """Shortest ways from one node to all.

    Attributes:
        length: of each way, infinite where there is none, (nodes,).
        link: that ends it, -1 at the root and where there is none, (nodes,).
        parent: the node before, (nodes,).
    """

    length: Array
    link: Indices
    parent: Indices

    def way(self, node: int) -> list[int]:
        """The links from a node back to the root."""
        links = []
        while self.link[node] >= 0:
            links.append(int(self.link[node]))
            node = int(self.parent[node])
        return links


def shortest_tree(links: NeighbourLinks, root: int, nodes: int) -> Tree:
    """The shortest ways from `root` with the squares of the gaps as lengths."""
    low, high = np.minimum(links.first, links.second), np.maximum(links.first, links.second)
    order = np.lexsort((links.gap, low * nodes + high))
    keys = (low * nodes + high)[order]
    best = order[np.append(True, keys[1:] != keys[:-1])] if len(keys) else order
    best = best[low[best] != high[best]]
    weights = np.maximum(links.gap[best], np.finfo(float).tiny) ** 2
    graph = csr_array((weights, (low[best], high[best])), shape=(nodes, nodes))
    length, parent = dijkstra(graph, directed=False, indices=root, return_predecessors=True)
    of_pair = dict(zip((low * nodes + high)[best].tolist(), best.tolist(), strict=True))
    reached = np.flatnonzero(parent >= 0)
    link = np.full(nodes, -1, dtype=np.int64)
    before = parent[reached]
    of_way = np.minimum(reached, before) * nodes + np.maximum(reached, before)
    link[reached] = [of_pair[key] for key in of_way.tolist()]
    return Tree(length, link, parent.astype(np.int64))


def _from_wall_to_wall(links: NeighbourLinks, bodies: int) -> tuple[Indices, float]:
    """The shortest chain of links from the bottom to the top, and its length (infinite without any)."""
    bottom, top = bodies, bodies + 1
    tree = shortest_tree(links, bottom, bodies + 2)
    return np.array(tree.way(top)), float(tree.length[top])


def _two_loops(links: NeighbourLinks, bodies: int) -> tuple[Indices, float]:
    """The shortest two loops through body 0 that together open a torus, and the length of the longer.

    They are the two shortest of those that a tree of shortest ways and one more link close, with independent
    translations (Erickson and Whittlesey 2005, Proc. SODA 16:1038).
    """
    tree = shortest_tree(links, 0, bodies)
    place = np.zeros((bodies, 2), dtype=np.int64)
    for node in np.argsort(tree.length, kind="stable")[1:]:
        link, parent = tree.link[node], tree.parent[node]
        if link >= 0:
            forward = links.first[link] == parent
            place[node] = place[parent] + (links.shift[link] if forward else -links.shift[link])
    # By how many periods the loop that each link closes goes round.
    turns = place[links.first] + links.shift - place[links.second]
    length = tree.length[links.first] + links.gap**2 + tree.length[links.second]
    chosen: list[int] = []
    for link in np.argsort(length, kind="stable"):
        independent = np.linalg.matrix_rank(turns[[*chosen, int(link)]]) == len(chosen) + 1
        if independent and np.isfinite(length[link]):
            chosen.append(int(link))
        if len(chosen) == 2:
            ends = [int(node) for c in chosen for node in (links.first[c], links.second[c])]
            both = np.unique([*chosen, *(step for node in ends for step in tree.way(node))])
            return _without_leaves(links, both, bodies), float(length[chosen[1]])
    return np.empty(0, dtype=np.int64), np.inf


def _without_leaves(links: NeighbourLinks, chosen: Indices, nodes: int) -> Indices:
    """The same without links that lead nowhere."""
    while True:
        degree = np.bincount(np.concatenate([links.first[chosen], links.second[chosen]]), minlength=nodes)
        inner = chosen[(degree[links.first[chosen]] > 1) & (degree[links.second[chosen]] > 1)]
        if len(inner) == len(chosen):
            return chosen
        chosen = inner
