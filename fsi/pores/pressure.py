"""The pressure between bodies, by stresses in equilibrium.

A stream function satisfies no momentum equation, but the stress in equilibrium that dissipates least, with
Airy's function phi (`fsi.pores.complement`), has a pressure. With (phi_y, -phi_x) in place of velocity it is
half its vorticity; bodies with loads have that of point forces besides (`fsi.pores.point_forces`):

    p = p_F - (phi_xx + phi_yy) / 2,

up to a constant. As in the resolved model the mean over the fluid of p - G.(x - x_m) is 0, G its mean
gradient.
In the norm of dissipation stresses of psi and of phi are off the truth by at most the root of what upper and
lower bound of the viscosity are apart (Prager and Synge 1947, Q. Appl. Math. 5:241), but in narrow necks a
pressure costs next to nothing in that norm, and small discs change little of it in a large cell. How good p
is its change with the modes tells.
"""

from __future__ import annotations

import numpy as np

from fsi.arrays import Array, Indices
from fsi.observables.kinematics import vorticity
from fsi.pores.complement import AiryStress
from fsi.pores.fields import FlowFields, FluidField, PoreMesh

_ORDER = 2  # of patches on which pressures are compared


class PressureField:
    """The pressure of a stress.

    Attributes:
        gradient: G, by which it differs from period to period, (2,).
    """

    def __init__(self, stress: AiryStress, middle: Array) -> None:
        """Of a stress in equilibrium; middle: x_m, (2,)."""
        self._forces, self._middle = stress.forces, middle
        self.gradient = np.zeros(2) if self._forces is None else self._forces.forces.gradient
        self._fields, self._level = FlowFields(stress), 0.0
        self._level = self._fields.mean(self._at_places)

    def at(self, x: Array) -> Array:
        """p (n,) at points x (n, 2); NaN outside the fluid."""
        p = 0.5 * vorticity(self._fields.at(x).gradient) - self._level
        if self._forces is not None:
            in_fluid = np.isfinite(p)  # in a body there are the points themselves
            p[in_fluid] += self._forces.forces.stress(x[in_fluid])[0]
        return np.asarray(p)

    def on_mesh(self, order: int) -> Array:
        """p (n,) at the points of `FlowFields.mesh(order)` of a flow in the same pores."""
        mesh = self._fields.mesh(order)
        return self._periodic(mesh, order) + (mesh.points - self._middle) @ self.gradient

    def apart(self, other: PressureField) -> float:
        """The root of the mean square of what another one differs by, over that of p, at points of files.

        Neither has the part of G. Of two that are nothing, nothing.
        """
        p, q = (each._periodic(each._fields.mesh(_ORDER), _ORDER) for each in (self, other))
        size, difference = (float(np.linalg.norm(of)) for of in (p, p - q))
        return difference / size if difference else 0.0

    def _periodic(self, mesh: PoreMesh, order: int) -> Array:
        """Without the part of G."""
        of_forces = [self._beside(*part) for part in mesh.parts]
        p = 0.5 * vorticity(mesh.field.gradient) + np.concatenate(of_forces) - self._level
        rows = p.reshape(len(mesh.place), order + 1, order + 1)
        # In a corner of walls derivatives are quotients of zeros; the fluid rests there.
        rows[mesh.corner, 0] = rows[mesh.corner, 1].mean(axis=1, keepdims=True)
        return np.asarray(p)

    def _at_places(self, place: Indices, x: Array, jet: Array) -> Array:
        """The same at points x (n, k, 2) of places (n,), (n k,)."""
        return 0.5 * vorticity(FluidField.of(jet).gradient) + self._beside(place, x)

    def _beside(self, place: Indices, x: Array) -> Array:
        """What point forces add to it."""
        if self._forces is None or x.size == 0:
            return np.zeros(x.size // 2)
        p = self._forces.stress(place, x)[0] - (x - self._middle) @ self.gradient
        return np.asarray(p.ravel())
