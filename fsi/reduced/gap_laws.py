"""The laws of a reduced case: which kappa between bodies, which beside walls, cut off where."""

from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from fsi.bodies.configuration import Array
from fsi.case.case import Case
from fsi.case.law_file import read_law_file
from fsi.errors import InputError, SolveError
from fsi.lubrication.laws import CutLaw, LubricationLaw, RangeError
from fsi.lubrication.named_laws import LAWS, SqueezeFilm, names_of_laws

# Below this gap, in reduced radii, a law is continued by its leading term in the logarithm of the gap: exact
# for kappa ~ 1/d, whose gaps underflow, and never reached with kappa ~ d^(-3/2).
_SMALLEST = 1e-150


@dataclass(frozen=True, slots=True)
class GapLaws:
    """kappa and its integral for pairs of bodies and for bodies and walls; arrays are (P,).

    Gaps are given as x = ln D, see `_SMALLEST`, with the reduced radius of each pair and whether it is one of
    a body and a wall. Raises SolveError where a law does not hold.

    Attributes:
        bodies: the law between bodies.
        walls: the law between bodies and walls.
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
        values = np.empty(len(D))
        for law, here in ((self.bodies, ~is_wall), (self.walls, is_wall)):
            if np.any(here):
                try:
                    values[here] = getattr(law, method)(D[here], radius[here])
                except RangeError as error:
                    raise SolveError(f"reduced.law: {error} with reduced.extrapolate = true") from None
        return values


def make_laws(case: Case) -> GapLaws:
    """The laws that the section [reduced] asks for.

    Laws that depend on the ratio of the radii are those of a plane for walls and those of equal bodies for
    pairs, whose leading term holds for all radii. Raises InputError.
    """
    name = case.reduced.law
    return GapLaws(_law(case, "law", name, 1.0), _law(case, "wall_law", case.reduced.wall_law or name, inf))


def _law(case: Case, key: str, name: str, ratio: float) -> LubricationLaw:
    film = SqueezeFilm("spheres" if case.spheres else "discs", case.fluid.viscosity, ratio, extrapolate=True)
    law = LAWS[name].of(film) if name in LAWS else _of_file(case, f'reduced.{key} = "{name}"', name, film)
    return law if case.reduced.cutoff is None else CutLaw(law, case.reduced.cutoff)


def _of_file(case: Case, here: str, name: str, film: SqueezeFilm) -> LubricationLaw:
    """The law of a file at the viscosity of the fluid, not at that at which it was calibrated."""
    if not Path(name).is_file():
        raise InputError(f"{here}: there is no such law; give {names_of_laws()} or the path of a law file")
    file = read_law_file(Path(name))
    if not file.squeezes(film.shape):
        raise InputError(
            f"{here}: a law of {file.mode} between {file.shape}; give one of squeeze between {film.shape}"
        )
    return file.law(viscosity=film.viscosity, extrapolate=case.reduced.extrapolate)
