"""What stands for the Schur complement B A^-1 B^T in the preconditioner of `gmres`.

In fluid that is as wide as long that is the mass matrix M of the pressure, over mu. In a film of width h a
pressure that does not change across it drives the flow of Reynolds' equation, div (h^2 / (12 mu)) grad p for
each unit of volume, which is far less where it changes over lengths beyond h. Both hold together where

    S'^-1 = (M / (2 mu))^-1 + (2 K)^-1,     K = int (h^2 / (12 mu)) grad p . grad q,

with h the distance between the two nearest surfaces: where it is large the second part is small. K knows
nothing of constant pressures, which walls that are open hold: of these M alone decides. (For time
steps J. Cahouet and J.-P. Chabard, Int. J. Numer. Methods Fluids 8 (1988) 869, add such parts.) By the mass
alone the iterations grow as gaps close: among twenty spheres with a gap of 4e-4 radii it took 255, with both
48. Twice K took the fewest.
"""

from collections.abc import Mapping

from fsi.meshes.backend import petsc_forms

import numpy as np
import scipy  # its modules load when they are used
from petsc4py import PETSc

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.lattice import Lattice
from fsi.stokes.discretisation.forms import Forms
from fsi.stokes.problem import StokesProblem

TIMES = 2.0  # K
# Of M: K alone leaves constant pressures out.
REGULAR = 1e-6
NEAREST = 12  # spheres by their centres, of which two surfaces are nearest if sizes do not differ by far
LEAST = 1e-12  # of the widths: on surfaces distances round to less than zero


def pressure_mass(forms: Forms) -> PETSc.Mat:
    """M / (2 mu)."""
    mass = petsc_forms().assemble_matrix(forms.bind("pressure mass"))
    mass.assemble()
    mass.scale(0.5)
    return mass


def film_matrix(problem: StokesProblem, forms: Forms, mass: PETSc.Mat) -> PETSc.Mat:
    """2 K, regular by a part of M; h is that of the middle of each cell; collective."""
    geometry = forms.mesh.geometry
    corners = geometry.x[geometry.dofmaps[0][:, : forms.mesh.topology.dim + 1]]
    h = widths(corners.mean(axis=1), problem.q, problem.container)
    K = forms.films(np.square(h) / 12.0)
    K.scale(TIMES)
    K.axpy(REGULAR, mass, PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
    return K


def widths(x: Array, q: Configuration, container: Container) -> Array:
    """The sum of the distances of points (n, 3) from the two nearest surfaces, (n,)."""
    lattice = Lattice(container.periods)
    distances = [container.distances(x), *(body.off(x)[:, None] for body in q.standing)]
    if not q.standing and len(q.radii):
        images = lattice.shift(lattice.near())
        centres = (lattice.wrapped(q.centres)[:, None] + images).reshape(-1, 3)
        radii = np.repeat(q.radii, len(images))
        nearest = min(NEAREST, len(radii))
        apart, which = scipy.spatial.cKDTree(centres).query(lattice.wrapped(x), nearest)
        distances.append(apart.reshape(len(x), nearest) - radii[which].reshape(len(x), nearest))
    two = np.sort(np.column_stack(distances), axis=1)[:, :2]
    far = 2.0 * container.size() * (two.shape[1] < 2)
    sums: Array = np.maximum(two.sum(axis=1) + far, LEAST * container.size())
    return sums


def _solver(matrix: PETSc.Mat, options: Mapping[str, str | int]) -> PETSc.KSP:
    """What acts as the inverse of a matrix, with these options of PETSc."""
    ksp, prefix, given = PETSc.KSP().create(matrix.comm), "fsi_pressure_", PETSc.Options("fsi_pressure_")
    ksp.setOptionsPrefix(prefix)
    ksp.setOperators(matrix)
    for name, value in options.items():
        given[name] = value
    ksp.setFromOptions()
    ksp.setUp()
    for name in options:
        given.delValue(name)
    return ksp


class SchurComplement:
    """S'^-1, with its sign turned, as PETSc's preconditioner of the pressures calls it."""

    def __init__(self, mass: PETSc.Mat, films: PETSc.Mat, options: Mapping[str, str | int]) -> None:
        """Set up; mass: M / (2 mu), films: 2 K, options: how that is solved, in PETSc's words."""
        self._mass = _solver(mass, {"ksp_type": "chebyshev", "ksp_max_it": 4, "pc_type": "jacobi"})
        self._films = _solver(films, options)
        self._given, self._part, self._one, self._of_one = (mass.createVecRight() for _ in range(4))
        self._one.set(1.0)
        mass.mult(self._one, self._of_one)
        self._of_one.scale(1.0 / self._one.dot(self._of_one))

    def apply(self, _: PETSc.PC, given: PETSc.Vec, found: PETSc.Vec) -> None:
        """found = - S'^-1 given."""
        self._mass.solve(given, found)
        given.copy(self._given)
        self._given.axpy(-given.dot(self._one), self._of_one)
        self._films.solve(self._given, self._part)
        found.axpy(1.0, self._part)
        found.shift(-self._part.dot(self._of_one))
        found.scale(-1.0)

    def destroy(self, _: PETSc.PC | None = None) -> None:
        """Free what it made."""
        vectors = self._given, self._part, self._one, self._of_one
        for used in (self._mass, self._films, *vectors):
            used.destroy()
