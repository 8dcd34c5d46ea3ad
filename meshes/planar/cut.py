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

from dataclasses import dataclass

import numpy as np
import scipy  # its modules load when they are used

from fsi.arrays import Array, Indices
from fsi.meshes.errors import MeshError
from fsi.meshes.planar.links import NeighbourLinks, neighbours
from fsi.meshes.planar.sizing import Surfaces


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
    graph = scipy.sparse.csr_array((weights, (low[best], high[best])), shape=(nodes, nodes))
    dijkstra = scipy.sparse.csgraph.dijkstra
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
