"""The velocity nodes on bodies, walls and the axis of a mesh."""

from dataclasses import dataclass

import numpy as np
from dolfinx import fem, la
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.meshes.build import FluidMesh, FunctionSpace

Nodes = NDArray[np.int32]


@dataclass(frozen=True, slots=True)
class BoundaryNodes:
    """Velocity nodes of this rank, owned ones only.

    Attributes:
        body_nodes: nodes on bodies, ascending, (b,).
        body: the body of each, (b,).
        wall_nodes: of each wall by name.
        axis: on the axis of an axisymmetric mesh.
        with_ghosts: coordinates of all velocity nodes of this rank, owned ones first.
        owned: n, how many these are.
    """

    body_nodes: Nodes
    body: NDArray[np.int64]
    wall_nodes: dict[str, Nodes]
    axis: Nodes
    with_ghosts: Array
    owned: int

    @property
    def x(self) -> Array:
        """Coordinates of the owned velocity nodes, (n, d)."""
        return self.with_ghosts[: self.owned]


def facets_with(fluid: FluidMesh, low: int, high: int) -> NDArray[np.int32]:
    """Facets of this rank whose tag lies in [low, high]."""
    tags = fluid.facet_tags.values
    return np.asarray(fluid.facet_tags.indices[(tags >= low) & (tags <= high)])


def locate(fluid: FluidMesh, V: FunctionSpace) -> BoundaryNodes:
    """Find the velocity nodes on bodies and walls; collective.

    A rank may own a node without owning a facet that holds it, so tags are summed over ranks.
    """
    bodies = facets_with(fluid, 1, fluid.bodies)
    tags = fluid.facet_tags.values[np.searchsorted(fluid.facet_tags.indices, bodies)]
    body_tag = _tag_of_nodes(fluid, V, bodies, tags)
    body_nodes = np.flatnonzero(body_tag).astype(np.int32)
    walls = {wall: _nodes_with(fluid, V, fluid.wall_tag(wall)) for wall in fluid.container.walls}
    axis = (
        _nodes_with(fluid, V, fluid.axis_tag) if fluid.container.axisymmetric else np.empty(0, dtype=np.int32)
    )
    x = np.ascontiguousarray(V.tabulate_dof_coordinates()[:, : fluid.dimension])
    return BoundaryNodes(body_nodes, body_tag[body_nodes] - 1, walls, axis, x, V.dofmap.index_map.size_local)


def inner_nodes(space: FunctionSpace) -> NDArray[np.int64]:
    """Which nodes of each cell belong to no other."""
    element = space.element.basix_element
    return np.array(element.entity_dofs[space.mesh.topology.dim][0], dtype=np.int64)


def _nodes_with(fluid: FluidMesh, V: FunctionSpace, tag: int) -> Nodes:
    facets = facets_with(fluid, tag, tag)
    marks = np.ones(len(facets), dtype=np.int32)
    return np.flatnonzero(_tag_of_nodes(fluid, V, facets, marks)).astype(np.int32)


def _tag_of_nodes(fluid: FluidMesh, V: FunctionSpace, facets: Nodes, tags: Nodes) -> NDArray[np.int64]:
    """The tag of each owned node in the closure of tagged facets (0 elsewhere); no node may have two tags."""
    topology = fluid.mesh.topology
    entities = fem.compute_integration_domains(fem.IntegralType.exterior_facet, topology, facets)
    cells, local = entities[::2], entities[1::2]
    closure = np.array(V.element.basix_element.entity_closure_dofs[fluid.dimension - 1])
    nodes = V.dofmap.list[cells[:, None], closure[local]]
    # compute_integration_domains keeps the order of the facets. Each facet adds its tag to its nodes, on all
    # ranks that see it: over the number of such facets the sum is the tag again.
    sums = []
    for values in (tags, np.ones_like(tags)):
        vector = la.vector(V.dofmap.index_map, 1)
        vector.array[:] = 0.0
        vector.array[nodes.ravel()] = np.repeat(values, nodes.shape[1])
        vector.scatter_reverse(la.InsertMode.add)
        sums.append(vector.array[: V.dofmap.index_map.size_local])
    return np.asarray(np.rint(sums[0] / np.maximum(sums[1], 1.0)).astype(np.int64))
