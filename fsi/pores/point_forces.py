"""The stress of point forces in Stokes flow: in unbounded fluid, and of a row or a lattice of images.

In the plane, z = x + i y, p and the deviator D = (sigma_xx - sigma_yy) / 2 + i sigma_xy of any stress in
equilibrium are those of two analytic functions (Muskhelishvili 1953, Some Basic Problems of the Mathematical
Theory of Elasticity, section 32),

    p = 2 Re A,   conj(D) = conj(z) A' + B,

of a force F = F_x + i F_y and a torque T on the fluid at z = 0

    A = F / (4 pi z),   B = -conj(F) / (4 pi z) + i T / (2 pi z^2).

With c = (pi / L) cot(pi z / L), the sum of 1 / (z - k L) over all k, a row of them along x has

    A = F c / (4 pi),   B = -(F + conj(F)) c / (4 pi) - z F c' / (4 pi) - i T c' / (2 pi),

above and below it uniform: sigma_xy = -+F_x / (2 L), p = +-F_y / (2 L). Of a lattice of rows, h apart, whose
sum of these has steps, sigma_xy = F_x y / (L h) with p = F_x x / (L h) makes D periodic, and p but for its
mean gradient G = F / (L h), which balances the forces. Along a row, between walls, G is given:
sigma_xy = G y, p = G x, as in Poiseuille's flow, with x and y from the middle between the walls.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from fsi.arrays import Array
from fsi.machine.compiled import compiled, internal
from fsi.pores.pore_data import Complex, planar

_DIGITS = 36.0  # rows whose uniform stress is all that is left: exp(-36) is 2e-16

type Functions = tuple[complex, complex, complex]  # A, A' and B


class ImageRows(NamedTuple):
    """Rows of images along x.

    Attributes:
        L: their period, 0 where there are no images.
        up: from one to the next, 0 of a single one.
        number: how many count on each side.
    """

    L: float
    up: complex
    number: int


class Loads(NamedTuple):
    """What compiled loops see of forces, in a frame whose x is along the rows: places, F, T, (N,)."""

    at: Complex
    F: Complex
    T: Array


@dataclass(frozen=True, slots=True, eq=False)
class PointForces:
    """Forces and torques on unbounded fluid at some points, and at their images by P periods.

    Attributes:
        at: the points, (N, 2).
        F: F_x, F_y and T at each, (N, 3).
        periods: rows, (P, 2).
        dp_dx: G along a single row; 0 else.
        middle: where its p and sigma_xy are 0, (2,).
    """

    at: Array
    F: Array
    periods: Array
    dp_dx: float
    middle: Array

    @property
    def gradient(self) -> Array:
        """G, the mean pressure gradient, (2,)."""
        if len(self.periods) == 0:
            return np.zeros(2)
        if len(self.periods) == 1:
            return np.asarray(self.dp_dx * self.periods[0] / np.linalg.norm(self.periods[0]))
        return np.asarray(self.F[:, :2].sum(axis=0) / abs(float(np.linalg.det(self.periods))))

    @property
    def along(self) -> complex:
        """The direction of the rows, those of the shorter period: they are far from each other."""
        if len(self.periods) == 0:
            return 1.0 + 0j
        shorter = complex(planar(self.periods)[self._shorter])
        return shorter / abs(shorter)

    @property
    def loads(self) -> Loads:
        """In the frame of the rows."""
        turn = self.along.conjugate()
        return Loads(turn * planar(self.at), turn * planar(self.F[:, :2]), np.ascontiguousarray(self.F[:, 2]))

    @property
    def rows(self) -> ImageRows:
        """In their frame."""
        if len(self.periods) == 0:
            return ImageRows(0.0, 0j, 0)
        periods, first = planar(self.periods), self._shorter
        L = float(abs(periods[first]))
        if len(periods) == 1:
            return ImageRows(L, 0j, 0)
        up = complex(periods[1 - first]) * self.along.conjugate()
        up = up if up.imag > 0.0 else -up
        return ImageRows(L, up, int(np.ceil(1.0 + _DIGITS * L / (2.0 * np.pi * up.imag))))

    @property
    def _shorter(self) -> int:
        return int(np.argmin(np.linalg.norm(self.periods, axis=1)))

    def stress(self, x: Array) -> tuple[Array, Complex]:
        """p and D, (n,), at points x (n, 2)."""
        z = self.along.conjugate() * planar(x)
        p, D = np.empty(len(z)), np.empty(len(z), complex)
        _fill(z, self.loads, self.rows, p, D)
        return self.with_gradient(z, p, D)

    def with_gradient(self, z: Complex, p: Array, D: Complex) -> tuple[Array, Complex]:
        """p and D at points z in the frame of the rows, with those of G along a single one; D in x and y."""
        r = z - self.along.conjugate() * complex(*self.middle)
        return p + self.dp_dx * r.real, (D + 1j * self.dp_dx * r.imag) * self.along**2


@compiled
def _fill(z: Complex, loads: Loads, rows: ImageRows, p: Array, D: Complex) -> None:
    """p and D at points."""
    r0 = np.empty(len(loads.at), np.complex128)
    for k in range(len(z)):
        level = seen_from(z[k], loads, rows, r0)
        A, B = 0j, 0j
        for i in range(len(r0)):
            made = of_rows(r0[i], loads.F[i], loads.T[i], rows)
            A, B = A + made[0], B + made[2] + r0[i].conjugate() * made[1]
        p[k], D[k] = 2.0 * A.real + level, B.conjugate()


@internal
def seen_from(z: complex, loads: Loads, rows: ImageRows, r0: Complex) -> float:
    """Where a point is seen from the nearest images, and what p has there more than at such images."""
    level = 0.0
    for i in range(len(r0)):
        r0[i] = z - loads.at[i]
        if rows.up != 0j:
            up = np.round(r0[i].imag / rows.up.imag) * rows.up
            r0[i] -= up
            level += (loads.F[i].conjugate() * up).real / (rows.L * rows.up.imag)
        if rows.L > 0.0:
            along = np.round(r0[i].real / rows.L) * rows.L
            r0[i] -= along
            if rows.up != 0j:
                level += loads.F[i].real * along / (rows.L * rows.up.imag)
    return level


@internal
def alone(z: complex, F: complex, T: float) -> Functions:
    """Of a force in unbounded fluid."""
    c = 1.0 / z
    A = F * c / (4.0 * np.pi)
    return A, -A * c, -F.conjugate() * c / (4.0 * np.pi) + 0.5j * T * c * c / np.pi


@internal
def of_rows(z: complex, F: complex, T: float, rows: ImageRows) -> Functions:
    """Of a force and its images; of a lattice with the part that makes D periodic."""
    if rows.L == 0.0:
        return alone(z, F, T)
    c, slope = _cotangent(z, rows.L)
    B = -2.0 * F.real * c - (z * F + 2j * T) * slope
    if rows.up != 0j:
        more = _other_rows(z, F, T, rows)
        c, slope, B = c + more[0], slope + more[1], B + more[2]
    over = 1.0 / (4.0 * np.pi)
    A, slope, B = over * F * c, over * F * slope, over * B
    if rows.up != 0j:
        G = 0.5 * F.real / (rows.L * rows.up.imag)
        A, slope, B = A + G * z, slope + G, B - G * z
    return A, slope, B


@internal
def _other_rows(z: complex, F: complex, T: float, rows: ImageRows) -> Functions:
    """Sums of c and c' over the rows above and below, and what they add to 4 pi B."""
    c, slope, B, turn = 0j, 0j, 0j, 2j * np.pi / rows.L
    shrink = np.exp(turn * rows.up)
    above, below = np.exp(-turn * (z - rows.up)), np.exp(turn * (z + rows.up))
    for m in range(1, rows.number + 1):
        for side in range(2):
            E, up, sign = (above, m * rows.up, -1.0) if side == 0 else (below, -m * rows.up, 1.0)
            over = 1.0 / (1.0 - E)
            own, own_slope = -0.5 * sign * turn * (1.0 + E) * over, -(turn * turn) * E * over * over
            c, slope = c + own, slope + own_slope
            B -= 2.0 * F.real * own + ((z - up + up.conjugate()) * F + 2j * T) * own_slope
        above, below = above * shrink, below * shrink
    return c, slope, B


@internal
def _cotangent(z: complex, L: float) -> tuple[complex, complex]:
    """c and c', by powers of what decays away from the row."""
    side = 1.0 if z.imag >= 0.0 else -1.0
    E = np.exp(2j * np.pi * side * z / L)
    over = 1.0 / (1.0 - E)
    return -1j * np.pi * side / L * (1.0 + E) * over, (np.pi / L) ** 2 * 4.0 * E * over * over
