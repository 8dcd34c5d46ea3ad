"""The laws of a reduced case: which kappa between bodies, which beside walls, cut off where."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from fsi.bodies.configuration import Array
from fsi.case.case import Case
from fsi.case.law_file import read_law_file
from fsi.errors import InputError, SolveError
from fsi.lubrication.exact_laws import exact_law
from fsi.lubrication.laws import (
    CutLaw,
    LubricationLaw,
    RangeError,
    leading_disc_law,
    leading_sphere_law,
    slides_law,
)

# Below this gap, in reduced radii, a law is continued by its leading term in the logarithm of the gap: exact
# for kappa ~ 1/d, whose gaps underflow, and never reached with kappa ~ d^(-3/2).
_SMALLEST = 1e-150


@dataclass(frozen=True, slots=True)
class GapLaws:
    """kappa and its integral for pairs of bodies and for bodies and walls; arrays are (P,).

    Gaps are given as x = ln D, see `_SMALLEST`; radius: the reduced radius; is_wall: which law. Raises
    SolveError where a law does not hold.
    """

    bodies: LubricationLaw
    walls: LubricationLaw

    def kappa(self, x: Array, radius: Array, is_wall: NDArray[np.bool_]) -> Array:
        """The resistances kappa; infinite where they overflow."""
        edge = np.log(_SMALLEST * radius)
        kappa = self._each("kappa", np.exp(np.maximum(x, edge)), radius, is_wall)
        with np.errstate(over="ignore"):
            return kappa * np.exp(np.maximum(edge - x, 0.0))

    def integral(self, x: Array, radius: Array, is_wall: NDArray[np.bool_]) -> tuple[Array, Array]:
        """K, an antiderivative of kappa in D, and `dK/dx = kappa D`."""
        edge = np.log(_SMALLEST * radius)
        D = np.exp(np.maximum(x, edge))
        slope = self._each("kappa", D, radius, is_wall) * D
        return self._each("integral", D, radius, is_wall) + slope * np.minimum(x - edge, 0.0), slope

    def _each(
        self, method: Literal["kappa", "integral"], D: Array, radius: Array, is_wall: NDArray[np.bool_]
    ) -> Array:
        found = np.empty(len(D))
        for law, here in ((self.bodies, ~is_wall), (self.walls, is_wall)):
            if np.any(here):
                try:
                    found[here] = getattr(law, method)(D[here], radius[here])
                except RangeError as error:
                    raise SolveError(f"reduced.law: {error} with reduced.extrapolate = true") from None
        return found


def make_laws(case: Case) -> GapLaws:
    """The laws that the section [reduced] asks for.

    "exact" is that of a plane for walls and that of equal bodies for pairs, whose leading term holds for all
    radii. Raises InputError.
    """
    given = case.reduced
    return GapLaws(
        _cut(_law(case, "law", given.law, 1.0), given.cutoff),
        _cut(_law(case, "wall_law", given.wall_law or given.law, inf), given.cutoff),
    )


def _law(case: Case, key: str, name: str, ratio: float) -> LubricationLaw:
    mu = case.fluid.viscosity
    if name == "slides":
        return slides_law(mu)
    if name == "leading":
        return leading_sphere_law(mu) if case.spheres else leading_disc_law(mu)
    if name == "exact":
        return exact_law("spheres" if case.spheres else "discs", ratio, mu, extrapolate=True)
    if not Path(name).is_file():
        raise InputError(
            f'reduced.{key} = "{name}": no such file; give "slides", "leading", "exact" or a law file'
        )
    file, shape = read_law_file(Path(name)), "spheres" if case.spheres else "discs"
    if file.mode != "squeeze" or (file.shape != shape and file.form != "slides"):
        raise InputError(
            f'reduced.{key} = "{name}": a law of {file.mode} between {file.shape}; give one of squeeze '
            f"between {shape}"
        )
    # A law is linear in mu: that of the fluid counts, not that at which the law was calibrated.
    return replace(file.law(extrapolate=case.reduced.extrapolate), viscosity=mu)


def _cut(law: LubricationLaw, cutoff: float | None) -> LubricationLaw:
    return law if cutoff is None else CutLaw(law, cutoff)
