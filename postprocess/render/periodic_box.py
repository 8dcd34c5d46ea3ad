"""One period of a flow in space, as pictures show it: a box, images of spheres, the flow at all places in it.

A run has the fluid of one cell, opened where that suits its mesh; a picture has the box around the middle of
the domain. A place in it is a lattice vector e away from one in the mesh, where

    u(x + e) = u(x) + E e,      p(x + e) = p(x) + G.e.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd
import pyvista as pv
from scipy.spatial import cKDTree

from fsi.bodies.configuration import Array, Configuration
from fsi.meshes.geometry.container import Container, FluidDomain
from fsi.meshes.geometry.lattice import Lattice
from fsi.meshes.spatial.sides import Sides, frame, images
from fsi.postprocess.render.view import View
from fsi.postprocess.run.probe import OUTSIDE, probe
from fsi.postprocess.run.run import Run, nodes

_MARGIN = 1.08  # of the window around the box
_SAME_PLACE = 1e-9  # of the domain: vertices that are images
_BITS = (np.arange(8)[:, None] >> np.arange(3)) & 1
_EDGES = np.array([(i, i + 2**k) for i in range(8) for k in range(3) if not i & 2**k])


@dataclass(frozen=True, slots=True)
class PeriodicBox:
    """One period of a container, around its middle; `sides` are those across which it is periodic."""

    container: Container
    sides: Sides

    @classmethod
    def of(cls, container: Container) -> "PeriodicBox":
        """That of a container with periods."""
        _, edges = frame(container)
        return cls(
            container, Sides(container.middle - 0.5 * edges.sum(axis=0), edges, len(container.periods))
        )

    @property
    def _lattice(self) -> Lattice:
        return Lattice(self.container.periods)

    @property
    def corners(self) -> Array:
        """(8, 3)."""
        corners: Array = self.sides.origin + _BITS @ self.sides.edges
        return corners

    @property
    def edges(self) -> Array:
        """Its edges, (12, 2, 3)."""
        return np.asarray(self.corners[_EDGES])

    def view(self) -> View:
        """The window that just shows it."""
        return View(self.container.middle, 0.5 * _MARGIN * float(np.ptp(self.corners, axis=0).max()))

    def distances(self, x: Array) -> Array:
        """Of points (n, 3) from all its sides, (n, 6); positive inside."""
        return np.hstack([self.sides.distances(x), self.container.distances(x)])

    def bodies(self, q: Configuration) -> Configuration:
        """All images of the bodies that reach into it; how they have turned is not told."""
        inside, _ = images(FluidDomain(self.container, q.centres, q.radii), self.sides, 0.0)
        return Configuration.unturned(inside.centres, inside.radii)

    def whole(self, spheres: pv.UnstructuredGrid, q: Configuration) -> pv.UnstructuredGrid:
        """The surfaces of bodies, which sides of the mesh may cut, around the centres that lie in the box."""
        body = np.asarray(spheres.cell_data["body"])
        middles, moved = np.asarray(spheres.cell_centers().points, dtype=float), spheres.copy()
        to_image = self._lattice.nearest(middles - q.centres[body])
        c = self.sides.coordinates(q.centres)[:, : self.sides.periods]
        shift = self._lattice.shift(to_image + np.floor(c).astype(np.int64)[body])
        # A node belongs to the facets of one image alone.
        of_nodes, facets = np.zeros((moved.n_points, 3)), nodes(spheres)
        of_nodes[facets] = shift[:, None]
        moved.points = np.asarray(spheres.points, dtype=float) - of_nodes
        return moved

    def probed(self, run: Run, x: Array, step: int) -> pd.DataFrame:
        """What `probe` finds at points (n, 3), or at their images in the mesh, for the points themselves."""
        fluid, lattice = run.mesh(step), self._lattice
        low, high = np.array(fluid.bounds).reshape(3, 2).T
        shift = lattice.nearest(x - 0.5 * (low + high))
        found = probe(run, x - lattice.shift(shift), step)
        for m in lattice.near()[1:]:
            missing = np.flatnonzero(found["where"].to_numpy() == OUTSIDE)
            if not len(missing):
                break
            trial = lattice.nearest(x[missing] - 0.5 * (low + high)) + m
            table = probe(run, x[missing] - lattice.shift(trial), step)
            there = table["where"].to_numpy() != OUTSIDE
            found.iloc[missing[there]] = table[there].to_numpy()
            shift[missing[there]] = trial[there]
        found[["x", "y", "z"]] = x
        found[["u_x", "u_y", "u_z"]] += self.container.mean_velocity(lattice.shift(shift))
        if "p" in found:
            found["p"] += shift @ np.array([_rise(fluid, e) for e in lattice.vectors])
        return found


def _rise(fluid: pv.UnstructuredGrid, e: Array) -> float:
    """By how much the pressure rises over a period e: from each vertex of a side to its image."""
    vertices = np.unique(nodes(fluid)[:, :4])
    x, p = np.asarray(fluid.points)[vertices], np.asarray(fluid["pressure"])[vertices]
    distance, image = cKDTree(x).query(x + e, distance_upper_bound=_SAME_PLACE * fluid.length)
    there = np.isfinite(distance)
    return float(np.mean(p[image[there]] - p[there]))
