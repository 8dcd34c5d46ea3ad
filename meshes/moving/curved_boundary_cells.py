"""The curved cells around discs, which turn when the nodes on their discs slip."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from fsi.meshes.build import FluidMesh
from fsi.meshes.cells.curved import reference_points
from fsi.meshes.geometry.containers import Array
from fsi.meshes.geometry.lattice import Lattice


@dataclass(frozen=True, slots=True)
class CurvedBoundaryCells:
    """This rank's cells with an edge on a disc.

    Attributes:
        cells: their numbers, (n,).
        body: whose edge it is, (n,).
        off_straight: how far their nodes are from where a straight cell has them, (n, nodes, 2).
    """

    cells: NDArray[np.intp]
    body: NDArray[np.intp]
    off_straight: Array

    @staticmethod
    def of(fluid: FluidMesh, tags: NDArray[np.int32], x: Array) -> CurvedBoundaryCells:
        """Those of a mesh.

        Args:
            fluid: the mesh.
            tags: of the corners of this rank's cells, (T, d + 1), 0 inside.
            x: its nodes, (n, d).
        """
        ordered = np.sort(tags, axis=1)
        # Corners of one disc alone belong to an edge on it: two discs never share a triangle's three corners.
        twice = np.where(ordered[:, 1:] == ordered[:, :-1], ordered[:, 1:], 0)
        twice[twice > fluid.bodies] = 0
        body = twice.max(axis=1)
        cells = np.flatnonzero(body)
        nodes = x[fluid.mesh.geometry.dofmaps[0][cells]]
        straight = np.einsum(
            "kc,tcd->tkd", linear_weights(fluid.order, fluid.dimension), nodes[:, : fluid.dimension + 1]
        )
        return CurvedBoundaryCells(cells, body[cells] - 1, nodes - straight)


def turned(r: Array, angle: Array) -> Array:
    """What vectors r (n, ..., 2) change by if they turn by angles (n,), counterclockwise: (R - 1) r."""
    angle = angle.reshape(-1, *[1] * (r.ndim - 2))
    # cos - 1 without cancellation.
    lost, s = -2.0 * np.sin(0.5 * angle) ** 2, np.sin(angle)
    return np.stack([lost * r[..., 0] - s * r[..., 1], s * r[..., 0] + lost * r[..., 1]], axis=-1)


def along(lattice: Lattice) -> Array:
    """The direction of the only period, (2,); zero where there is none, or two."""
    if lattice.dimension != 1:
        return np.zeros(2)
    direction: Array = lattice.vectors[0] / lattice.longest()
    return direction


@cache
def linear_weights(order: int, dimension: int) -> Array:
    """Barycentric coordinates of the cell's nodes, (nodes, dimension + 1)."""
    X = reference_points(order, dimension)
    return np.column_stack([1.0 - X.sum(axis=1), X])
