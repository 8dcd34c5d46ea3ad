"""A disc or sphere at the centre of a round container, with slip on both surfaces and a swimming one.

The body of radius a moves at V along an axis, from which theta counts, and its surface at B sin theta e_theta
besides; b and c are the slip lengths of body and container, R is the radius of that. The flow is

    discs     u_r = f / r cos theta,  u_theta = -f' sin theta,             f = A r + E r^3 + C r ln r + D / r
    spheres   u_r = g cos theta,      u_theta = -(r^2 g)' / 2r sin theta,  g = A + E r^2 + C / r + D / r^3

and F = -4 pi mu C (discs, per unit length) or 4 pi mu C moves the body. With h sin theta for u_theta and
tau sin theta for sigma_r_theta / mu, tau = r (h / r)' - u_r / (r cos theta), and normals out of the fluid,

    u_r = V,  h = -V + B + b tau   at a,         u_r = 0,  h = -c tau   at R:

four equations for A, E, C, D. A turning body has u = (A r + C / r^n) in circles, n = 1 and 2, with one
equation at each surface. In unbounded fluid these are the drag 6 pi mu a V (1 + 2 b/a)/(1 + 3 b/a) of a
sphere (Basset 1888, "A treatise on hydrodynamics" II), and the velocities B / 2 of a free disc and 2 B / 3 of
a free sphere (Blake 1971, J. Fluid Mech. 46:199); without slip it is Cunningham's sphere (1910, Proc. R. Soc.
A 83:357). F and T are the EXTERNAL loads that the motion needs. Relative error: some 1e-14 up to R = 10 a.
"""

from dataclasses import dataclass

import numpy as np

from fsi.arrays import Array


@dataclass(frozen=True, slots=True)
class Concentric:
    """Body and container.

    Attributes:
        radius: a.
        outer: R > a.
        slip: b >= 0, of the body.
        outer_slip: c >= 0, of the container.
        spheres: or discs.
    """

    radius: float
    outer: float
    slip: float
    outer_slip: float
    spheres: bool

    def force(self, V: float, B: float, viscosity: float) -> float:
        """F at the velocity V with B on the surface."""
        return float(self._force(viscosity, *(self._strength(*unit) for unit in ((1, 0), (0, 1)))) @ (V, B))

    def swimming(self, B: float) -> float:
        """V of a free body with B on its surface."""
        return -B * self._strength(0, 1) / self._strength(1, 0)

    def torque(self, omega: float, viscosity: float) -> float:
        """T at the rate omega.

        4 pi mu a^2 omega / (1 + 2 b/a - (a/R)^2 (1 - 2 c/R)) of a disc,
        8 pi mu a^3 omega / (1 + 3 b/a - (a/R)^3 (1 - 3 c/R)) of a sphere.
        """
        a, R, n = self.radius, self.outer, 3 if self.spheres else 2
        less = 1.0 + n * self.slip / a - (a / R) ** n * (1.0 - n * self.outer_slip / R)
        return (8.0 if self.spheres else 4.0) * np.pi * viscosity * a**n * omega / less

    def _force(self, viscosity: float, *strengths: float) -> Array:
        of_unit = 4.0 * np.pi * viscosity * (self.radius if self.spheres else -1.0)
        return of_unit * np.array(strengths)

    def _strength(self, V: float, B: float) -> float:
        """C, with a as the unit of length."""
        matrix = np.empty((4, 4))
        R = self.outer / self.radius
        for rows, r, slip in ((slice(0, 2), 1.0, -self.slip), (slice(2, 4), R, self.outer_slip)):
            u_r, h, tau = self._modes(r)
            matrix[rows] = u_r, h + slip / self.radius * tau
        return float(np.linalg.solve(matrix, (V, B - V, 0.0, 0.0))[2])

    def _modes(self, r: float) -> tuple[Array, Array, Array]:
        """u_r / cos theta, h and tau of the four functions."""
        if self.spheres:
            u_r = np.array([1.0, r**2, 1.0 / r, r**-3])
            h = np.array([-1.0, -2.0 * r**2, -0.5 / r, 0.5 * r**-3])
            dh = np.array([0.0, -4.0 * r, 0.5 * r**-2, -1.5 * r**-4])
        else:
            u_r = np.array([1.0, r**2, np.log(r), r**-2])
            h = np.array([-1.0, -3.0 * r**2, -np.log(r) - 1.0, r**-2])
            dh = np.array([0.0, -6.0 * r, -1.0 / r, -2.0 * r**-3])
        return u_r, h, dh - h / r - u_r / r
