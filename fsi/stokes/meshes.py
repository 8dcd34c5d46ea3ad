"""Meshes around the bodies of a case, of its sizes or of others; one of them may be moved with the bodies."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fsi.bodies.configuration import Configuration
from fsi.bodies.gaps import find_gaps
from fsi.case.case import Case
from fsi.meshes.build import FluidMesh, Made, build
from fsi.meshes.errors import MeshError
from fsi.meshes.geometry.container import FluidDomain
from fsi.meshes.moving.move import Mover
from fsi.meshes.resolution import Resolution
from fsi.meshes.spatial.grading import COARSEST
from fsi.stokes.comparisons import Comparison
from fsi.stokes.solvers.workspace import Workspace
from fsi.stokes.units import Units
from fsi.stokes.walls import singular_corners, singular_pairs


class CaseMeshes:
    """Meshes around the bodies of a case at any configuration and time; collective over all ranks.

    Attributes:
        units: those of all meshes but the user's.
        moving: whether one mesh is moved with the bodies as long as it can be.
        opening: the part of the way to where laws below a gap have the bodies that they are moved.
        workspace: what solves on the mesh that is moved share.
    """

    def __init__(self, case: Case, opening: float = 1.0) -> None:
        """Those of the case; nothing is meshed yet."""
        self.case, self.units, self.opening = case, Units.of(case), opening
        sizes = case.discretisation
        along = (sizes.cells_per_gap, sizes.cells_per_circle, sizes.growth, sizes.interior)
        self.resolution = Resolution(*along)
        self.moving = case.time is not None and case.time.remesh == "when-needed"
        self.workspace = Workspace()
        self._mover: Mover | None = None
        self._meshed, self._meshed_time = case.configuration(), 0.0
        self._made: tuple[object, Made] = None, {}  # where straight cells were made, and these
        self._container = self.units.scaled_container(case.container())  # at time 0
        self._corners, self._edges = np.empty((0, 2)), singular_pairs(case)
        if case.dimension == 2:
            self._corners, self._edges = self.units.scaled_places(singular_corners(case)), ()

    def mesh(self, q: Configuration, t: float = 0.0) -> FluidMesh:
        """A new mesh around the bodies at q and t in the user's units, or the user's own."""
        return self.units.user_mesh(self.scaled_mesh(q, t), self.case.container().at(t, q.strain))

    def scaled_mesh(self, q: Configuration, t: float = 0.0, order: int | None = None) -> FluidMesh:
        """The same mesh in the units of the model; of the case's order if not given."""
        case, order = self.case, order or self.case.discretisation.degree
        if case.domain.mesh is None:
            return self._built(q, t, self.resolution, order)
        from fsi.meshes.files.read import read_mesh

        domain = FluidDomain(case.container().at(t, q.strain), q.centres, q.radii)
        fluid = read_mesh(Path(case.domain.mesh), case.names, domain, order)
        return fluid.scaled(1.0 / self.units.length, self._container.at(t, q.strain))

    def compared_mesh(self, comparison: Comparison, q: Configuration, t: float = 0.0) -> FluidMesh:
        """The mesh of a comparison; one of the program's own where it is to be another one."""
        if comparison.finer == 1.0:
            return self.scaled_mesh(q, t, comparison.degree)
        coarsest = COARSEST if q.dimension == 3 else self.resolution.growth
        growth = min(self.resolution.growth, coarsest) / comparison.finer
        return self._built(q, t, replace(self.resolution, growth=growth), comparison.degree)

    def places(self, q: Configuration, t: float) -> Configuration:
        """Where bodies that are at q are meshed. Raises SolveError: there is no room to move them apart."""
        meshed = self.case.meshed_at(q, t)
        return replace(q, centres=q.centres + self.opening * (meshed.centres - q.centres))

    def rounded(self, q: Configuration, t: float) -> float:
        """The part of a gap, at most, by which it is another one as lengths in these units have 15 digits."""
        meshed = self.places(q, t)
        given = find_gaps(meshed, self.case.container().at(t, q.strain)).smallest_of_each()
        here = self.units.scaled_configuration(meshed)
        solved = self.units.length * find_gaps(here, self._container.at(t, q.strain)).smallest_of_each()
        near = np.isfinite(given) & np.isfinite(solved)
        return float(np.max(np.abs(solved[near] / given[near] - 1.0), initial=0.0))

    def mesh_in_use(self, q: Configuration, t: float) -> FluidMesh:
        """The mesh that is moved, moved to q and t, or a new one: none is, or it would be too distorted."""
        self._made = None, {}  # only what follows takes the same straight cells
        if not self.moving:
            return self.scaled_mesh(q, t)
        if self._mover is not None:
            duration, strain = t - self._meshed_time, q.strain - self._meshed.strain
            places = self.units.scaled_places(self.places(q, t).centres)
            angles = q.angles if q.shaped else None
            quality = self._mover.move(places, lambda e: self._container.carried(e, duration, strain), angles)
            if quality is not None:
                return self._mover.fluid.moved(quality, self._container.at(t, q.strain))
        return self._remesh(q, t)

    def state(self) -> dict[str, NDArray[Any]]:
        """Where the bodies were when the mesh in use was made: moved meshes start from it."""
        if self._mover is None:
            return {}
        meshed = {"meshed_centres": self._meshed.centres, "meshed_time": np.array(self._meshed_time)}
        meshed["meshed_strain"] = np.array(self._meshed.strain)
        return meshed | ({"meshed_angles": self._meshed.angles} if self._meshed.shaped else {})

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Mesh again where the mesh in use was made."""
        if self.moving and "meshed_centres" in state:
            q = self.case.configuration()
            angles = state["meshed_angles"] if q.shaped else q.angles
            strain = float(state["meshed_strain"])
            q = replace(q, centres=state["meshed_centres"], angles=angles, strain=strain)
            self._remesh(q, float(state["meshed_time"]))

    def _remesh(self, q: Configuration, t: float) -> FluidMesh:
        self.workspace.close()
        if self._mover is not None:
            self._mover.close()
        here = self.units.scaled_configuration(self.places(q, t))
        self._mover = Mover(self.scaled_mesh(q, t), here.centres, here.placed, here.standing)
        self._meshed, self._meshed_time = q, t
        return self._mover.fluid

    def _built(self, q: Configuration, t: float, resolution: Resolution, order: int) -> FluidMesh:
        """A mesh in the units of the model, whatever the user has.

        Flows of another degree at the same instant have cells that are curved from the same straight ones.
        """
        where = t, q.strain, *(x.tobytes() for x in (q.centres, q.radii, q.angles))
        if where != self._made[0]:
            self._made = where, {}
        here = self.units.scaled_configuration(self.places(q, t))
        container = self._container.at(t, q.strain)
        try:
            domain = FluidDomain(
                container, here.centres, here.radii, self._corners, self._edges, here.placed, here.standing
            )
            return build(domain, resolution, order, self._made[1])
        except MeshError as error:
            raise error.in_units(self.units.length, self.units.origin) from error
