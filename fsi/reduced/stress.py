"""The lubrication stress of the reduced model: what the forces of its gaps add to the bulk stress.

    Sigma_L = 1/|Omega| sum_i S_i,    S_i = sum over the gaps of i of lambda l n (x) n

l is the distance from the centre to the middle of a gap of two bodies, or to a wall. For bodies without
loads, and walls that move along themselves, `|Omega| Sigma_L:E` is the dissipation of drag and gaps at the
strain rate E of the background. It is a contribution only, and not called the apparent viscosity: how a lone
body resists strain, and what sliding pairs add, are not in the model.

Where pairs also resist sliding and rolling (`fsi.reduced.tangential`), each rate of theirs, that by a uniform
gradient W of velocity is S : W, adds lambda S. A rotation of everything changes no rate of two bodies, so
that S is symmetric; of a wall, which does not turn, S is the symmetric tensor of the same S : W. A lone body
held in strain has the stresslet 2 mu v_i E, with v_i = 2 pi a_i^2 of a disc and 10/3 pi a_i^3 of a sphere,
2 and 5/2 times its volume (Einstein 1911). Together that gives a bulk stress and an apparent viscosity

    Sigma = 2 mu E + 1/|Omega| (sum_i 2 mu v_i E + sum over the rates of lambda S) - forces,
    mu_app / mu = Sigma:E / (2 mu E:E) = 1 + sum_i v_i / |Omega| + (Sigma_L - forces):E / (2 mu E:E)

(as R. Mari, R. Seto, J. F. Morris and M. M. Denn, J. Rheol. 58 (2014) 1693, have it of spheres), and for
bodies without loads mu_app 2 E:E |Omega| is what is dissipated. The `apparent_viscosity` of results is
mu_app / mu, and `forces` above is 1/|Omega| sum r (x) F.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import combinations_with_replacement
from math import nan

import numpy as np

from fsi.arrays import Array
from fsi.integration.errors import components
from fsi.observables.bulk_stress import BulkStress
from fsi.reduced.enclosure import Enclosure
from fsi.reduced.pairs import Pairs
from fsi.reduced.tangential import TangentialRows


@dataclass(frozen=True, slots=True)
class LubricationStress:
    """The lubrication stress over a periodic domain of the volume |Omega|, in the plane its area.

    Attributes:
        stresslets: S_i, (N, d, d).
        volume: |Omega|.
        viscosity: `Sigma_L:E / (2 mu E:E)`, what lubrication along the lines of centres adds to the viscosity
            over that of the fluid, None without a mean strain rate.
    """

    stresslets: Array
    volume: float
    viscosity: float | None

    @property
    def mean(self) -> Array:
        """Sigma_L, (d, d)."""
        total: Array = self.stresslets.sum(axis=0) / self.volume
        return total

    @property
    def record(self) -> Mapping[str, float]:
        """Columns of steps.csv; the viscosity is not a number at instants without a strain rate."""
        mu = nan if self.viscosity is None else self.viscosity
        mean = components("lubrication_stress", self.mean, pressure=True)
        return {"lubrication_viscosity": mu} | {name: float(part) for name, part in mean.items()}

    @property
    def body_columns(self) -> Mapping[str, Array]:
        """Columns of bodies.csv."""
        return components("lubrication_S", self.stresslets, pressure=True)


def lubrication_stress(enclosure: Enclosure, stresslets: Array, viscosity: float) -> LubricationStress | None:
    """Sigma_L of the stresslets S_i, (N, d, d), in a periodic domain; else None."""
    if not len(enclosure.container.periods):
        return None
    E = enclosure.strain_rate
    stress = LubricationStress(stresslets, enclosure.container.volume, None)
    rate = float(np.sum(E**2))
    if rate == 0.0:
        return stress
    return replace(stress, viscosity=float(np.sum(stress.mean * E)) / (2.0 * viscosity * rate))


def bulk_stress(
    enclosure: Enclosure, lubrication: LubricationStress, radii: Array, viscosity: float, forces: Array
) -> BulkStress:
    """Sigma of bodies whose pairs resist all their relative motions; forces: sum of r (x) F, (d, d)."""
    E, volume, mu = enclosure.strain_rate, lubrication.volume, lubrication.viscosity
    v = _rigid_volumes(radii, len(E))
    alone = 2.0 * viscosity * v[:, None, None] * E
    carried = 0.0 - forces / volume
    if mu is not None:
        mu += 1.0 + float(v.sum()) / volume
        mu += float(np.sum(carried * E)) / (2.0 * viscosity * float(np.sum(E**2)))
    return BulkStress(2.0 * viscosity * E, alone + lubrication.stresslets, carried, volume, mu)


def dissipation_of_strain(enclosure: Enclosure, radii: Array, viscosity: float) -> float:
    """Of fluid at the mean strain rate with lone bodies in it, `2 mu E:E (|Omega| + sum_i v_i)`."""
    E = enclosure.strain_rate
    volume = enclosure.container.volume + float(_rigid_volumes(radii, len(E)).sum())
    return 2.0 * viscosity * float(np.sum(E**2)) * volume


def _rigid_volumes(radii: Array, dimension: int) -> Array:
    """v_i, twice the area of discs and 5/2 of the volume of spheres, (N,)."""
    return 2.0 * np.pi * radii**2 if dimension == 2 else 10.0 / 3.0 * np.pi * radii**3


def _of_tangential(pairs: Pairs, tangential: TangentialRows, force: Array, radii: Array) -> Array:
    """S_i of what slides and rolls, (N, d, d)."""
    p, between = tangential.pair, tangential.between
    arm, arm_other = (arms[p] for arms in _arms(pairs, radii))
    # The rate S : W of shear along a wall has half of its rotation too.
    moment = force * (tangential.across * arm + np.where(between, 0.0, 0.5 * tangential.turn))
    symmetric = 0.5 * np.einsum("rk,rl->rkl", tangential.tangent, pairs.n[p])
    symmetric = symmetric + np.swapaxes(symmetric, 1, 2)
    S = np.zeros((len(radii), *symmetric.shape[1:]))
    np.add.at(S, pairs.i[p], (np.where(between, 1.0, 2.0) * moment)[:, None, None] * symmetric)
    other = (force * tangential.across * arm_other)[between, None, None] * symmetric[between]
    np.add.at(S, pairs.j[p][between], other)
    return S


def _arms(pairs: Pairs, radii: Array) -> tuple[Array, Array]:
    """From the centres of both sides to the middle of a gap, or from i to a wall and 0, (P,)."""
    between = ~pairs.is_wall
    middle = np.where(between, 0.5, 1.0) * pairs.gap
    other = np.where(between, radii[np.where(between, pairs.j, 0)] + middle, 0.0)
    return radii[pairs.i] + middle, other


def stresslets(pairs: Pairs, force: Array, radii: Array, tangential: TangentialRows | None = None) -> Array:
    """S_i, (N, d, d), of forces (R,): of gaps, positive where they open, then of what slides and rolls."""
    P = len(pairs)
    of_gaps = _of_gaps(pairs, force[:P], radii)
    return of_gaps if tangential is None else of_gaps + _of_tangential(pairs, tangential, force[P:], radii)


def _of_gaps(pairs: Pairs, force: Array, radii: Array) -> Array:
    """Of the gaps alone, (N, d, d)."""
    N, n = len(radii), pairs.n
    other = np.where(pairs.is_wall, 0, pairs.j)  # with no arm there
    moments = [arm * force for arm in _arms(pairs, radii)]
    S = np.empty((N, n.shape[1], n.shape[1]))
    for k, m in combinations_with_replacement(range(n.shape[1]), 2):
        nn = n[:, k] * n[:, m]
        of_i, of_j = (moment * nn for moment in moments)
        S[:, k, m] = S[:, m, k] = np.bincount(pairs.i, of_i, N) + np.bincount(other, of_j, N)
    return S
