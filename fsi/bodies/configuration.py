"""Rigid bodies: where they are, what moves or holds them.

Bodies are discs in the plane (d = 2), spheres on an axis (also d = 2, points (r, z)) or spheres in space
(d = 3). Their modes, the columns of every array over modes, are

    d = 2   (V_x, V_y, omega)                              with loads (F_x, F_y, T)
    d = 3   (V_x, V_y, V_z, omega_x, omega_y, omega_z)     with loads (F_x, F_y, F_z, T_x, T_y, T_z)

d translations and d (d - 1) / 2 rotations, together M. In the plane omega and T are positive
counterclockwise. F and T are the EXTERNAL force and torque (in the plane per unit length).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.meshes.geometry.images import to_images
from fsi.meshes.geometry.lattice import Lattice
from fsi.meshes.geometry.rotations import turn_between, turning_rate

if TYPE_CHECKING:  # shapes take long to load, and discs and spheres have none
    from fsi.meshes.geometry.ellipsoid import Ellipsoid, PlacedEllipsoid
    from fsi.meshes.geometry.outline import Outline
    from fsi.meshes.geometry.placed import Placed

MODES = {2: ("V_x", "V_y", "omega"), 3: ("V_x", "V_y", "V_z", "omega_x", "omega_y", "omega_z")}
LOADS = {2: ("F_x", "F_y", "T"), 3: ("F_x", "F_y", "F_z", "T_x", "T_y", "T_z")}
PLACES = {2: ("x", "y", "angle"), 3: ("x", "y", "z", "angle_x", "angle_y", "angle_z")}


def volumes(radii: Array, *, spheres: bool) -> Array:
    """Of spheres, on an axis or in space, or areas of discs, (N,)."""
    return np.asarray(4.0 / 3.0 * np.pi * radii**3 if spheres else np.pi * radii**2)


def arms(radii: Array, dimension: int) -> Array:
    """1 for translations, a for rotations, (N, M): torques count over it, rotations times it."""
    rotations = len(MODES[dimension]) - dimension
    return np.repeat(np.column_stack([np.ones_like(radii), radii]), [dimension, rotations], axis=1)


def rigid_motion(r: Array) -> Array:
    """The velocity `V + omega x r` at points r (..., d), and omega, for each unit motion: (..., M, M).

    Rows are components of (velocity, rotation), columns the modes about the origin.
    """
    d = r.shape[-1]
    M = len(MODES[d])
    rows = np.zeros((*r.shape[:-1], M, M))
    rows[..., range(M), range(M)] = 1.0
    if d == 2:
        rows[..., 0, 2], rows[..., 1, 2] = -r[..., 1], r[..., 0]
        return rows
    for i in range(3):  # omega x r, component i: omega_j r_k - omega_k r_j
        j, k = (i + 1) % 3, (i + 2) % 3
        rows[..., i, 3 + j], rows[..., i, 3 + k] = r[..., k], -r[..., j]
    return rows


def turned(angles: Array, more: Array) -> Array:
    """Angles after further rotations, (N, r): in the plane their sum, in space composed as vectors."""
    if angles.shape[1] != 3 or len(angles) == 0:
        return angles + more
    import scipy  # late: `fsi check` does without

    from_rotvec = scipy.spatial.transform.Rotation.from_rotvec
    return np.asarray((from_rotvec(more) * from_rotvec(angles)).as_rotvec())


@dataclass(frozen=True, eq=False)
class Configuration:
    """Where the bodies are; one is equal to itself alone, and its arrays are never changed.

    centres: q_i, shape (N, d); angles: rotation of each body since the start, in the plane radians,
    shape (N,), in space a rotation vector, its length the angle, shape (N, 3); radii: a_i > 0, shape (N,), of
    a body with an outline that of the smallest circle around its centre that holds it; outlines: of all
    bodies in the plane or on an axis, empty where all are discs or spheres; ellipsoids: the same of bodies in
    space, whose radii are their largest half axes; strain: by which a stress has sheared the lattice around
    them since time 0, zero in all other containers.
    """

    centres: Array
    angles: Array
    radii: Array
    outlines: tuple[Outline, ...] = ()
    ellipsoids: tuple[Ellipsoid, ...] = ()
    strain: float = 0.0

    @classmethod
    def unturned(cls, centres: Array, radii: Array) -> Configuration:
        """Bodies that have not turned yet."""
        return cls(centres, np.zeros(len(radii) if centres.shape[1] == 2 else (len(radii), 3)), radii)

    def __len__(self) -> int:
        """Number of bodies N."""
        return len(self.radii)

    @property
    def dimension(self) -> int:
        """d, 2 or 3."""
        return int(self.centres.shape[1])

    @cached_property
    def placed(self) -> tuple[Placed, ...]:
        """The outlines where they are; empty where all bodies are discs."""
        from fsi.meshes.geometry.placed import Placed

        each = zip(self.outlines, self.centres, self.angles.ravel().tolist(), strict=False)
        return tuple(Placed(outline, centre, angle) for outline, centre, angle in each)

    @cached_property
    def standing(self) -> tuple[PlacedEllipsoid, ...]:
        """The ellipsoids where they are; empty where all bodies are spheres."""
        from fsi.meshes.geometry.ellipsoid import PlacedEllipsoid

        each = zip(self.ellipsoids, self.centres, self.angles, strict=False)
        return tuple(PlacedEllipsoid(form, centre, angle) for form, centre, angle in each)

    @property
    def shaped(self) -> bool:
        """Whether bodies are no discs or spheres, so that what turns them moves their surfaces."""
        return bool(self.outlines or self.ellipsoids)

    def to_images(self, lattice: Lattice, body: NDArray[np.intp], x: Array) -> Array:
        """How far from the bodies their images lie that points x (n, d) on them belong to, (n, d)."""
        return lattice.shift(to_images(lattice, self.centres, self.placed, body, x))

    @property
    def volumes(self) -> Array:
        """Of each body, in the plane the areas, (N,); of spheres on an axis a case has them alone."""
        if self.shaped:
            of_outlines = [outline.volume for outline in self.outlines]
            return np.array(of_outlines + [form.volume for form in self.ellipsoids])
        return volumes(self.radii, spheres=self.dimension == 3)

    @property
    def arms(self) -> Array:
        """1 for translations, a for rotations, (N, M)."""
        return arms(self.radii, self.dimension)

    def ways(self, displacement: Array) -> Array:
        """How far any point of each body goes at most in displacements along the modes (N, M), (N,).

        What turns a disc or sphere moves nothing but itself.
        """
        d = self.dimension
        ways: Array = np.linalg.norm(displacement[:, :d], axis=1)
        return ways + self.radii * np.linalg.norm(displacement[:, d:], axis=1) if self.shaped else ways

    def way_to(self, other: Configuration) -> Array:
        """The displacements (N, d) to another configuration; of shapes along all modes, (N, M)."""
        apart = other.centres - self.centres
        if not self.shaped:
            return apart
        return np.column_stack([apart, turn_between(self.angles, other.angles)])

    def strain_of(self, displacement: Array) -> float:
        """Of the lattice, where displacements or velocities (N + 1, M) have a further row; else zero."""
        return float(displacement[len(self) :, 0].sum())

    def moved(self, displacement: Array) -> Configuration:
        """The configuration after displacements (N, M) along the modes; rotations in space are composed.

        A further row begins with a strain of the lattice.
        """
        if len(displacement) > len(self):
            strained = replace(self, strain=self.strain + self.strain_of(displacement))
            return strained.moved(displacement[: len(self)])
        d = self.dimension
        centres = self.centres + displacement[:, :d]
        if d == 2:
            return replace(self, centres=centres, angles=self.angles + displacement[:, 2])
        return replace(self, centres=centres, angles=turned(self.angles, displacement[:, d:]))

    def rates(self, displacement: Array, U: Array) -> Array:
        """The rates (N, M) of displacements from here, where bodies so displaced move with U (N, M)."""
        d = self.dimension
        if d == 2:
            return U
        return np.column_stack([U[:, :d], turning_rate(displacement[:, d:], U[:, d:])])


@dataclass(frozen=True, slots=True)
class Motion:
    """What drives the bodies at one instant.

    held: which modes are prescribed, bool, shape (N, M);
    U: their prescribed velocities (0 where free); F: the external loads on the free modes
    (0 where held, where the load is a result). Shapes (N, M).
    """

    held: NDArray[np.bool_]
    U: Array
    F: Array

    def under(self, inertia: Inertia | None) -> tuple[Motion, Inertia | None]:
        """The motion with modes of infinite inertia held at their U0, and the inertia of the others."""
        if inertia is None or not (fixed := np.isinf(inertia.D)).any():
            return self, inertia
        U = np.where(fixed & ~self.held, inertia.U0, self.U)
        motion = Motion(self.held | fixed, U, np.where(fixed, 0.0, self.F))
        D = np.where(fixed, 0.0, inertia.D)
        return motion, Inertia(D, inertia.U0) if D.any() else None


@dataclass(frozen=True, slots=True)
class Inertia:
    """Inertia of the bodies in an implicit step: the load on each mode becomes `F - D (U - U0)`.

    D: mass over the step's own time, `m / (gamma h)` and `I / (gamma h)`, shape (N, M), >= 0; infinite where
    the velocity is U0, see `Motion.under`;
    U0: the velocity that inertia alone would give, shape (N, M).
    """

    D: Array
    U0: Array
