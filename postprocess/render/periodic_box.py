"""One period of a flow in space, as pictures show it: a box, images of spheres, the flow at all places.

A run has the fluid of one cell, opened where that suits its mesh; a picture has an upright box around the
middle of the domain: its edges are the periods e_k, each without its parts along those before it, and images
of that box fill the space as those of the cell do. Periods that the mean flow leaves alone come first, so
that the box of a cell that is sheared along one of them stands still. A place is a lattice vector e away from
one in the mesh, where

    u(x + e) = u(x) + E e,      p(x + e) = p(x) + G.e   (`probe`).
"""

from dataclasses import dataclass

import numpy as np
import pyvista as pv

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.lattice import Lattice
from fsi.meshes.spatial.sides import frame
from fsi.postprocess.render.view import View
from fsi.postprocess.run.grids import nodes

_MARGIN = 1.08  # of the window around the box
_BITS = (np.arange(8)[:, None] >> np.arange(3)) & 1
_EDGES = np.array([(i, i + 2**k) for i in range(8) for k in range(3) if not i & 2**k])


@dataclass(frozen=True, slots=True)
class PeriodicBox:
    """One period of a container.

    Attributes:
        container: what is periodic.
        periods: its periods in their order here, (k, 3).
        sides: the edges of the box, orthogonal, (3, 3); those beyond the periods go from wall to wall.
        middle: of the box, (3,).
    """

    container: Container
    periods: Array
    sides: Array
    middle: Array

    @classmethod
    def of(cls, container: Container, middle: Array | None = None) -> "PeriodicBox":
        """That of a container with periods, around that point or its own middle."""
        _, edges = frame(container)
        k = len(container.periods)
        moved = np.linalg.norm(container.mean_velocity(edges[:k]), axis=1)
        order = [*np.argsort(moved, kind="stable"), *range(k, 3)]
        Q, R = np.linalg.qr(edges[order].T)
        return cls(
            container, edges[order][:k], (Q * np.diag(R)).T, container.middle if middle is None else middle
        )

    @property
    def _lattice(self) -> Lattice:
        return Lattice(self.container.periods)

    @property
    def corners(self) -> Array:
        """(8, 3)."""
        corners: Array = self.middle + (_BITS - 0.5) @ self.sides
        return corners

    @property
    def edges(self) -> Array:
        """Its edges, (12, 2, 3)."""
        return np.asarray(self.corners[_EDGES])

    def view(self) -> View:
        """The window that just shows it."""
        return View(self.middle, 0.5 * _MARGIN * float(np.ptp(self.corners, axis=0).max()))

    def home(self, x: Array) -> Array:
        """The images in the box, (n, 3), of points (n, 3)."""
        x = x.copy()
        for e, side in reversed(list(zip(self.periods, self.sides, strict=False))):
            x -= np.floor((x - self.middle) @ side / (side @ side) + 0.5)[:, None] * e
        return x

    def bodies(self, q: Configuration, view: View) -> Configuration:
        """All images of the bodies that reach into a window; how they have turned is not told."""
        lattice = self._lattice
        home = q.centres - lattice.shift(lattice.nearest(q.centres - view.centre))
        reach = np.sqrt(3.0) * (view.half + float(q.radii.max(initial=0.0))) + lattice.longest()
        centres = (home + lattice.shift(lattice.near(reach))[:, None]).reshape(-1, 3)
        radii = np.tile(q.radii, len(centres) // max(len(home), 1))
        seen = np.all(np.abs(centres - view.centre) < view.half + radii[:, None], axis=1)
        return Configuration.unturned(centres[seen], radii[seen])

    def whole(self, spheres: pv.UnstructuredGrid, q: Configuration) -> pv.UnstructuredGrid:
        """The surfaces of bodies, which sides of the mesh may cut, around the centres that lie in the box."""
        body = np.asarray(spheres.cell_data["body"])
        middles, moved = np.asarray(spheres.cell_centers().points, dtype=float), spheres.copy()
        to_image = self._lattice.nearest(middles - q.centres[body])
        shift = self._lattice.shift(to_image) + (q.centres - self.home(q.centres))[body]
        # A node belongs to the facets of one image alone.
        of_nodes, facets = np.zeros((moved.n_points, 3)), nodes(spheres)
        of_nodes[facets] = shift[:, None]
        moved.points = np.asarray(spheres.points, dtype=float) - of_nodes
        return moved
