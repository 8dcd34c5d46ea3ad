"""The stress of a suspension: its parts and the apparent viscosity."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import nan
from typing import Self

import numpy as np

from fsi.arrays import Array
from fsi.integration.errors import StressErrors, components


@dataclass(frozen=True, slots=True)
class BulkStress:
    """The mean stress over a periodic domain of the volume |Omega|, in the plane its area, bodies included.

        Sigma = fluid + 1/|Omega| sum_i S_i + forces

    Attributes:
        fluid: int over the fluid of sigma over |Omega|, (d, d), in a pressure of mean zero.
        stresslets: S_i = - sym int r (x) sigma n, n out of the fluid, (N, d, d): what the fluid does to body
            i (Batchelor 1970, J. Fluid Mech. 41:545), where a mean pressure gradient G acts in the pressure
            `G.(x - q_i) + periodic`, with the mean of the periodic part over the fluid zero.
        forces: - 1/|Omega| sum r (x) F, (d, d), what forces between bodies carry, r from the one to the other
            on which F acts (Batchelor 1977, J. Fluid Mech. 83:97).
        volume: |Omega|.
        apparent_viscosity: over that of the fluid, None without a mean strain rate.
        in_gaps: of the stresslets, what laws below a gap leave open, (N, d, d); None without such laws.
        pressure: whether the model has one; else all parts are deviators, symmetric without trace.
        newtonian: 2 mu E of the fluid alone at the mean strain rate, to which the apparent viscosity relates,
            (d, d); None without a mean strain rate.
    """

    fluid: Array
    stresslets: Array
    forces: Array
    volume: float
    apparent_viscosity: float | None
    pressure: bool = True
    in_gaps: Array | None = None
    newtonian: Array | None = None

    @property
    def mean(self) -> Array:
        """Sigma, (d, d)."""
        return np.asarray(self.fluid + self.stresslets.sum(axis=0) / self.volume + self.forces)

    @property
    def normal_stress_difference(self) -> float:
        """N_1 = Sigma_xx - Sigma_yy, in space, where a shear flow varies along z, Sigma_xx - Sigma_zz."""
        return float(self.mean[0, 0] - self.mean[-1, -1])

    @property
    def second_difference(self) -> float | None:
        """N_2 = Sigma_zz - Sigma_yy; None in the plane."""
        return float(self.mean[2, 2] - self.mean[1, 1]) if len(self.mean) == 3 else None

    @property
    def differences(self) -> Mapping[str, float]:
        """The normal stress differences by name."""
        second = self.second_difference
        return {"N_1": self.normal_stress_difference} | ({} if second is None else {"N_2": second})

    def errors(self, other: Self, factor: float, chance: float, rounding: float) -> StressErrors:
        """The factor times the differences from another, at least a part of the largest of its kind.

        Args:
            other: of the same bodies, computed otherwise.
            factor: what makes a difference a bound.
            chance: the part of the largest difference to which each is known: by chance some cancel.
            rounding: the part of the largest value that rounding leaves.
        """

        def least(value: Array, reference: Array) -> float:
            difference = factor * np.abs(value - reference).max(initial=0.0)
            return float(max(chance * difference, rounding * np.abs(value).max(initial=0.0)))

        def bound(value: Array, reference: Array) -> Array:
            return np.asarray(np.maximum(factor * np.abs(value - reference), least(value, reference)))

        fluid, mean = bound(self.fluid, other.fluid), bound(self.mean, other.mean)
        of_bodies = bound(self.stresslets, other.stresslets)
        of_mean, N = least(self.mean, other.mean), self.differences
        between = {name: max(factor * abs(N[name] - other.differences[name]), of_mean) for name in N}
        return StressErrors(fluid, mean, of_bodies, between, self.pressure)

    def viscosity_error(self, other: Self, factor: float, chance: float, rounding: float) -> float:
        """The same of the apparent viscosity, one component of many that the mean stress has.

            mu_app = Sigma : S / S : S,    S = 2 mu E,    |d mu_app| <= max |dev d Sigma| sum |S_ij| / S : S

        Not a number where one of both has none.
        """
        mu, of_other, S = self.apparent_viscosity, other.apparent_viscosity, self.newtonian
        if mu is None or of_other is None:
            return nan
        missed = 0.0
        if S is not None and S.any():
            largest = np.abs(S).max()  # by it: a small square would vanish
            by_stress = np.abs(S / largest).sum() / np.sum((S / largest) ** 2)
            missed = float(by_stress * np.abs(deviator(self.mean - other.mean) / largest).max())
        return max(factor * max(abs(mu - of_other), chance * missed), rounding * abs(mu))

    @property
    def error_in_gaps(self) -> StressErrors:
        """What laws below a gap leave open: they are of loads, and say of stresses what has their power."""
        missed = np.zeros_like(self.stresslets) if self.in_gaps is None else self.in_gaps
        of_bodies = np.abs(missed).max(axis=(1, 2), keepdims=True) * np.ones_like(missed)
        of_all = float(np.abs(missed.sum(axis=0)).max() / self.volume)
        every = np.full_like(self.fluid, of_all)
        return StressErrors(every, every, of_bodies, dict.fromkeys(self.differences, of_all), self.pressure)

    @property
    def record(self) -> Mapping[str, float]:
        """Columns of steps.csv; the apparent viscosity is not a number at instants without a strain rate."""
        mu = nan if self.apparent_viscosity is None else self.apparent_viscosity
        stress = {name: float(part) for name, part in components("stress", self.mean, self.pressure).items()}
        return {"apparent_viscosity": mu, **stress, **self.differences}

    @property
    def body_columns(self) -> Mapping[str, Array]:
        """Columns of bodies.csv; without a pressure the difference of the normal ones, S_N_1, is known."""
        S = self.stresslets
        between = {} if self.pressure else {"S_N_1": S[:, 0, 0] - S[:, 1, 1]}
        return {**components("S", S, self.pressure), **between}


# They apply only at instants with a strain rate and without loads on bodies.
VISCOSITY_CHECKS = ("stress", "viscosity_bound")


def compared_viscosities(mu: float, others: Sequence[float], filled: float) -> dict[str, float]:
    """The largest relative defect of an apparent viscosity, and how far it is below 1 / (1 - phi).

    others: the same by other ways, over the viscosity of the fluid; filled: phi.
    """
    defect = float(np.abs(np.array(others) / mu - 1.0).max())
    return {"stress": defect, "viscosity_bound": max(0.0, 1.0 / (1.0 - filled) / mu - 1.0)}


def deviator(stress: Array) -> Array:
    """Symmetric, without trace."""
    sym = 0.5 * (stress + stress.T)
    return np.asarray(sym - np.trace(sym) / len(sym) * np.eye(len(sym)))


def area_fraction(radii: Array, area: float) -> float:
    """phi of discs."""
    return float(np.pi * np.sum(radii**2) / area)
