"""Lubrication of a sphere or disc towards a plane where fluid slides along both with one slip length b.

In a film of thickness H between surfaces with slip the flux is that without slip times 1 + 6 b / H, so that
Reynolds's equation gives, with the gap q, the radius a and H = q + x^2 / 2a,

    spheres   F / U = (2 pi mu a^2 / b) ((1 + q / 6b) ln(1 + 6b / q) - 1)
    discs     F / U = 12 mu int x^2 / (H^2 (H + 6b)) dx
                    = (2 pi mu (2a)^(3/2) / b) (1 / (2 sqrt q) - 1 / (sqrt q + sqrt(q + 6b)))

(Hocking 1973, J. Eng. Math. 7:207; Vinogradova 1995, Langmuir 11:2213, for spheres; that of discs follows in
the same way). Without slip they would grow like 1/q and q^(-3/2); here it is ln(1/q) and q^(-1/2), so that a
push brings the surfaces together in finite time (Gerard-Varet, Hillairet and Wang 2015, J. Math. Pures Appl.
103:1). These are the terms of Reynolds's equation. Where the film is much thinner than b its fluid moves
as a plug, u = U x / 2H of spheres and U x / H of discs, and dissipates (2 mu / b) int u^2 by friction, which
is the law above, and 2 mu int H e : e by stretching, which Reynolds's equation leaves out:

    spheres   2 pi mu a U^2 ln(1 / q)           discs   2 pi mu (2a)^(1/2) U^2 q^(-1/2)

Both grow as the friction does and are b/a times it, so that at small gaps F / U is 1 + b/a times these laws.
"""

import numpy as np
from numpy.typing import ArrayLike

from fsi.arrays import Array


def sphere_resistance(gap: ArrayLike, radius: float, slip: float, viscosity: float) -> Array:
    """F / U of a sphere towards a plane, both with that slip length > 0."""
    s = np.asarray(gap) / (6.0 * slip)
    return np.asarray(2.0 * np.pi * viscosity * radius**2 / slip * ((1.0 + s) * np.log1p(1.0 / s) - 1.0))


def disc_resistance(gap: ArrayLike, radius: float, slip: float, viscosity: float) -> Array:
    """F / U of a disc towards a plane, both with that slip length > 0, per unit length."""
    root = np.sqrt(gap)
    film = 0.5 / root - 1.0 / (root + np.sqrt(np.asarray(gap) + 6.0 * slip))
    return np.asarray(2.0 * np.pi * viscosity * (2.0 * radius) ** 1.5 / slip * film)
