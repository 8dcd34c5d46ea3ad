"""The lubrication stress of the reduced model: what the forces of its gaps add to the bulk stress.

    Sigma_L = 1/|Omega| sum_i S_i,    S_i = sum over the gaps of i of lambda l n (x) n

l is the distance from the centre to the middle of a gap of two bodies, or to a wall. For bodies without
loads, and walls that move along themselves, `|Omega| Sigma_L:E` is the dissipation of drag and gaps at the
strain rate E of the background. It is a contribution only, and not called the apparent viscosity: how a lone
body resists strain, 2 phi of discs and 5/2 phi of spheres in the viscosity, and what sliding pairs add, are
not in the model.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import nan

import numpy as np

from fsi.bodies.configuration import Array
from fsi.reduced.enclosure import Enclosure
from fsi.reduced.pairs import Pairs

_COMPONENTS = {"xx": (0, 0), "xy": (0, 1), "yy": (1, 1)}


@dataclass(frozen=True, slots=True)
class LubricationStress:
    """The lubrication stress over a periodic domain of the area |Omega|.

    Attributes:
        stresslets: S_i, (N, 2, 2).
        area: |Omega|.
        viscosity: `Sigma_L:E / (2 mu E:E)`, what lubrication along the lines of centres adds to the viscosity
            over that of the fluid, None without a mean strain rate.
    """

    stresslets: Array
    area: float
    viscosity: float | None

    @property
    def mean(self) -> Array:
        """Sigma_L, (2, 2)."""
        total: Array = self.stresslets.sum(axis=0) / self.area
        return total

    @property
    def record(self) -> Mapping[str, float]:
        """Columns of steps.csv; the viscosity is not a number at instants without a strain rate."""
        mu, mean = nan if self.viscosity is None else self.viscosity, self.mean
        return {"lubrication_viscosity": mu} | {
            f"lubrication_stress_{name}": float(mean[at]) for name, at in _COMPONENTS.items()
        }

    @property
    def body_columns(self) -> Mapping[str, Array]:
        """Columns of bodies.csv."""
        return {f"lubrication_S_{name}": self.stresslets[:, *at] for name, at in _COMPONENTS.items()}


def lubrication_stress(
    enclosure: Enclosure, pairs: Pairs, force: Array, radii: Array, viscosity: float
) -> LubricationStress | None:
    """Sigma_L in a periodic domain, with forces (P,) of the gaps, positive where they open; else None."""
    if not len(enclosure.container.periods):
        return None
    E = 0.5 * (enclosure.gradient + enclosure.gradient.T)
    stress = LubricationStress(_stresslets(pairs, force, radii), enclosure.container.volume, None)
    rate = float(np.sum(E**2))
    if rate == 0.0:
        return stress
    return replace(stress, viscosity=float(np.sum(stress.mean * E)) / (2.0 * viscosity * rate))


def _stresslets(pairs: Pairs, force: Array, radii: Array) -> Array:
    """S_i, (N, d, d)."""
    between, N = ~pairs.is_wall, len(radii)
    i, j = pairs.i, pairs.j[between]
    middle = np.where(between, 0.5, 1.0) * pairs.gap
    moment = np.concatenate([(radii[i] + middle) * force, (radii[j] + middle[between]) * force[between]])
    body, n = np.concatenate([i, j]), np.concatenate([pairs.n, pairs.n[between]])
    sums = [[np.bincount(body, moment * x * y, minlength=N) for y in n.T] for x in n.T]
    return np.moveaxis(np.array(sums), 2, 0)
