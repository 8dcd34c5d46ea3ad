"""The pressure between bodies without loads in sheared cells and channels, by stresses in equilibrium.

A stream function satisfies no momentum equation, but the stress in equilibrium that dissipates least, with
Airy's function phi (`fsi.pores.complement`), has a pressure. With (phi_y, -phi_x) in place of velocity

    p = -(phi_xx + phi_yy) / 2,

half its vorticity, up to a constant: the mean of p over the fluid is 0. In the norm of dissipation stresses
of psi and of phi are off the truth by at most the root of what upper and lower bound of the viscosity are
apart (Prager and Synge 1947, Q. Appl. Math. 5:241), but in narrow necks a pressure costs next to nothing in
that norm, and small discs change little of it in a large cell. How good p is its change with the modes tells.
"""

from __future__ import annotations

import numpy as np

from fsi.bodies.configuration import Array
from fsi.observables.bulk_stress import vorticity
from fsi.pores.complement import AiryStress
from fsi.pores.fields import FlowFields, FluidField

_ORDER = 2  # of patches on which pressures are compared


class PressureField:
    """The pressure of a stress."""

    def __init__(self, stress: AiryStress) -> None:
        """Of a stress in equilibrium."""
        self._fields = FlowFields(stress)
        self._level = 0.5 * self._fields.mean_vorticity()

    def at(self, x: Array) -> Array:
        """p (n,) at points x (n, 2); NaN outside the fluid."""
        return self._of(self._fields.at(x))

    def on_mesh(self, order: int) -> Array:
        """p (n,) at the points of `FlowFields.mesh(order)` of a flow in the same pores."""
        return self._of(self._fields.mesh(order).field)

    def apart(self, other: PressureField) -> float:
        """The root of the mean square of what another one differs by, over that of p, at points of files."""
        p, q = self.on_mesh(_ORDER), other.on_mesh(_ORDER)
        return float(np.linalg.norm(p - q) / np.linalg.norm(p))

    def _of(self, field: FluidField) -> Array:
        return np.asarray(0.5 * vorticity(field.gradient) - self._level)
