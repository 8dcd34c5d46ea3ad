"""The stress of point forces at many points of pores and of fluid discs.

Around each of these what is not singular near it is analytic (`fsi.pores.point_forces`), and summed at few
points of a circle, whose discrete Fourier transform has the coefficients of Taylor's series. At the points
themselves few forces are left to be summed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array, Indices
from fsi.machine.compiled import compiled, internal
from fsi.pores.point_forces import Functions, ImageRows, Loads, PointForces, alone, of_rows, seen_from
from fsi.pores.pore_data import Complex, planar
from fsi.pores.regions import PoreShapes
from fsi.pores.surfaces import BoundingSurfaces

# Points on the circle, terms, the radius of the circle over that of the place, and how far in these radii
# what is left out lies at least: (1.3 / 2.6)^40 and (1 / 2.6)^30 are 1e-12 and 4e-13.
_CIRCLE, _TERMS, _WIDER, _FAR = 40, 30, 1.3, 2.6


@dataclass(frozen=True, slots=True, eq=False)
class ForceSeries:
    """The stress of forces by series around places: E pores, then fluid discs, P in all.

    Attributes:
        forces: whose stress.
        middle: of each place, in the frame of the rows, (P,).
        radius: of the circle, (P,); 0 where the place is no smaller than a period, and no series are used.
        a: of (r / radius)^n in A, (P, n).
        b: the same in B.
    """

    forces: PointForces
    middle: Complex
    radius: Array
    a: Complex
    b: Complex

    @classmethod
    def of(cls, forces: PointForces, shapes: PoreShapes, surfaces: BoundingSurfaces) -> ForceSeries:
        """Around these."""
        bounds = np.concatenate([shapes.foot.reshape(len(shapes.gap), -1, 2), shapes.touch], axis=1)
        middle = 0.5 * (bounds.max(axis=1) + bounds.min(axis=1))
        size = np.linalg.norm(bounds - middle[:, None], axis=2).max(axis=1)
        centres = np.concatenate([middle, surfaces.centre[surfaces.fluid]])
        radius = _WIDER * np.concatenate([size, surfaces.radius[surfaces.fluid]])
        rows = forces.rows
        shortest = np.inf if rows.L == 0.0 else min(rows.L, rows.up.imag or np.inf)
        radius[2.0 * _FAR / _WIDER * radius >= shortest] = 0.0
        z = forces.along.conjugate() * planar(centres)
        a, b = (np.zeros((len(z), _TERMS), complex) for _ in range(2))
        _expand((z, radius), forces.loads, rows, a, b)
        return cls(forces, z, radius, a, b)

    def stress(self, place: Indices, x: Array) -> tuple[Array, Complex]:
        """p and D, (n, k), at points x (n, k, 2) of places (n,)."""
        z = self.forces.along.conjugate() * planar(x)
        p, D = np.empty(z.shape), np.empty(z.shape, complex)
        places = self.middle[place], self.radius[place], self.a[place], self.b[place]
        _fill(z, places, self.forces.loads, self.forces.rows, (p, D))
        return self.forces.with_gradient(z, p, D)


@compiled
def _expand(places: tuple[Complex, Array], loads: Loads, rows: ImageRows, a: Complex, b: Complex) -> None:
    """The coefficients around each place that has any."""
    middle, radius = places
    r0, near = np.empty(len(loads.at), np.complex128), np.empty(len(loads.at), np.bool_)
    for e in range(len(middle)):
        if radius[e] == 0.0:
            continue
        seen_from(middle[e], loads, rows, r0)
        near[:] = np.abs(r0) < _FAR / _WIDER * radius[e]
        for k in range(_CIRCLE):
            turn = np.exp(2j * np.pi * k / _CIRCLE)
            A, _, B = _sum(radius[e] * turn, (r0, near), loads, rows)
            back = 1.0 / _CIRCLE + 0j
            for n in range(_TERMS):
                a[e, n] += A * back
                b[e, n] += B * back
                back *= turn.conjugate()


@compiled
def _fill(
    z: Complex,
    places: tuple[Complex, Array, Complex, Complex],
    loads: Loads,
    rows: ImageRows,
    to: tuple[Array, Complex],
) -> None:
    """p and D at points of places, (n, k)."""
    (middle, radius, a, b), (p, D) = places, to
    r0 = np.empty(len(loads.at), np.complex128)
    for e in range(len(z)):
        level, by_series = seen_from(middle[e], loads, rows, r0), radius[e] > 0.0
        none = ImageRows(0.0, 0j, 0) if by_series else rows
        near = np.abs(r0) < _FAR / _WIDER * radius[e] if by_series else np.ones(len(r0), np.bool_)
        for k in range(z.shape[1]):
            r = z[e, k] - middle[e]
            A, slope, B = _series(r, radius[e], a[e], b[e]) if by_series else (0j, 0j, 0j)
            for i in range(len(r0)):
                if near[i]:
                    made = of_rows(r0[i] + r, loads.F[i], loads.T[i], none)
                    A, slope, B = A + made[0], slope + made[1], B + made[2] + r0[i].conjugate() * made[1]
            p[e, k] = 2.0 * A.real + level
            D[e, k] = (r.conjugate() * slope + B).conjugate()


@internal
def _series(r: complex, radius: float, a: Complex, b: Complex) -> Functions:
    """A, A' and B by Horner's scheme."""
    t, A, slope, B = r / radius, 0j, 0j, 0j
    for n in range(_TERMS - 1, -1, -1):
        slope = slope * t + A
        A, B = A * t + a[n], B * t + b[n]
    return A, slope / radius, B


@internal
def _sum(r: complex, seen: tuple[Complex, NDArray[np.bool_]], loads: Loads, rows: ImageRows) -> Functions:
    """A, A' and B at r from the middle, conj(D) = conj(r) A' + B, without what is singular near it."""
    (r0, near), A, slope, B = seen, 0j, 0j, 0j
    for i in range(len(r0)):
        if near[i] and rows.L == 0.0:
            continue
        made = of_rows(r0[i] + r, loads.F[i], loads.T[i], rows)
        A, slope, B = A + made[0], slope + made[1], B + made[2] + r0[i].conjugate() * made[1]
        if near[i]:
            made = alone(r0[i] + r, loads.F[i], loads.T[i])
            A, slope, B = A - made[0], slope - made[1], B - made[2] - r0[i].conjugate() * made[1]
    return A, slope, B
