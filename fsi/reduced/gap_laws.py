"""The laws of a reduced case: which kappa between bodies, which beside walls, cut off where, of which mode.

Besides a_r, a film knows its k = a b/(a + b)^2: from 1/4 of equal bodies to 0 beside a plane, and less inside
a round wall, where b = -R. The leading term of kappa needs a_r alone; all that follows depends on k. A law
that is for one k refuses films of another. Beside a round wall that the fluid is around, b = R, a film is one
between bodies.

Far apart the exact law of squeeze of spheres tends to 6 pi mu a_r, which is their own drag (6 pi mu a of a
sphere far from a plane; of two that are drawn apart 6 pi mu a and 6 pi mu b in series). Here the law is what
it has beyond that, so that drag counts once. That of discs tends to zero.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.case.case import Case
from fsi.case.law_file import read_law_file
from fsi.case.section import hint_of_own
from fsi.errors import InputError, SolveError
from fsi.lubrication.expansions import MODES, Mode, Shape, overlap_of, ratio_of
from fsi.lubrication.laws import CutLaw, LubricationLaw, RangeError
from fsi.lubrication.named_laws import LAWS, GapFilm, names_of_laws
from fsi.lubrication.profiles import distinct
from fsi.reduced.overlaps import nodes, weights
from fsi.reduced.possible_films import beside_walls, between_bodies

# Below this gap, in reduced radii, a law is continued by its leading term in the logarithm of the gap: exact
# for kappa ~ 1/d, whose gaps underflow, and never reached with kappa ~ d^(-3/2).
_SMALLEST = 1e-150
# Of a law's own k: films for which it may be used.
_ALIKE = 1e-6
# Of the cutoff: so near to it kappa, a difference, may round to less than 0.
_AT_END = 1e-6


@dataclass(frozen=True, slots=True)
class Films:
    """What a law must know of P films.

    Attributes:
        radius: the reduced radius a_r, (P,).
        overlap: k, (P,).
        is_wall: whether it is between a body and a wall, (P,).
    """

    radius: Array
    overlap: Array
    is_wall: NDArray[np.bool_]

    @property
    def places(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Which films have the law between bodies, and which that beside walls."""
        beside = self.is_wall & (self.overlap <= 0.0)
        return np.flatnonzero(~beside), np.flatnonzero(beside)

    def of(self, some: NDArray[np.intp] | slice) -> "Films":
        """Some of them."""
        return Films(self.radius[some], self.overlap[some], self.is_wall[some])


@dataclass(frozen=True, slots=True)
class FilmLaw:
    """A law for films of any k: the polynomial in sqrt(k) through laws at some k; a single law is for all.

    Attributes:
        laws: none where there can be no film.
        overlaps: k of each law, (m,).
        key: of the section [reduced], for messages.
        cut: the gap from which on kappa is 0.
    """

    laws: tuple[LubricationLaw, ...]
    overlaps: Array
    key: str
    cut: float = inf

    def each(self, method: Literal["kappa", "integral"], D: Array, films: Films) -> Array:
        """kappa or its integral at gaps D of films, (P,). Raises SolveError: it does not hold there."""
        try:
            values = self._each(method, D, films.radius, films.overlap)
        except RangeError as error:
            raise SolveError(f"reduced.{self.key}: {error} with reduced.extrapolate = true") from None
        return self._not_negative(values, D) if method == "kappa" else values

    def _not_negative(self, kappa: Array, D: Array) -> Array:
        kappa = np.where((1.0 - _AT_END) * self.cut < D, np.maximum(kappa, 0.0), kappa)
        for p in np.flatnonzero(~(kappa >= 0.0))[:1]:
            raise SolveError(
                f"reduced.{self.key}: the law has kappa = {kappa[p]:.6g} at the gap {D[p]:.6g}, and films "
                "only resist; correct it, shorten reduced.cutoff, or drop reduced.extrapolate"
            )
        return kappa

    def _each(self, method: Literal["kappa", "integral"], D: Array, radius: Array, overlap: Array) -> Array:
        if len(self.laws) == 1:
            return np.asarray(getattr(self.laws[0].at(overlap), method)(D, radius))
        total = np.zeros(len(D))
        for law, weight in zip(self.laws, weights(overlap, self.overlaps), strict=True):
            here = np.flatnonzero(weight)
            if len(here):
                total[here] += weight[here] * getattr(law, method)(D[here], radius[here])
        return total


@dataclass(frozen=True, slots=True)
class GapLaws:
    """kappa and its integral for pairs of bodies and for bodies and walls; arrays are (P,).

    Gaps are given as x = ln D, see `_SMALLEST`. Raises SolveError where a law does not hold.

    Attributes:
        bodies: the law between bodies.
        walls: the law between bodies and walls.
    """

    bodies: FilmLaw
    walls: FilmLaw

    def kappa(self, x: Array, films: Films) -> Array:
        """The resistances kappa; infinite where they overflow."""
        kappa = np.empty(len(x))
        for law, here, some in self._each(films):
            at, edge = x[here], np.log(_SMALLEST * distinct(some.radius))
            of_law = law.each("kappa", np.exp(np.maximum(at, edge)), some)
            with np.errstate(over="ignore"):
                kappa[here] = of_law * np.exp(np.maximum(edge - at, 0.0))
        return kappa

    def integral(self, x: Array, films: Films) -> tuple[Array, Array]:
        """K, an antiderivative of kappa in D, and `dK/dx = kappa D`."""
        K, slope = np.empty(len(x)), np.empty(len(x))
        for law, here, some in self._each(films):
            at, edge = x[here], np.log(_SMALLEST * distinct(some.radius))
            D = np.exp(np.maximum(at, edge))
            rise = law.each("kappa", D, some) * D
            slope[here], K[here] = rise, law.each("integral", D, some) + rise * np.minimum(at - edge, 0.0)
        return K, slope

    def _each(self, films: Films) -> Iterator[tuple[FilmLaw, NDArray[np.intp], Films]]:
        """Each law that is asked for, where it holds, and the films there."""
        for law, here in zip((self.bodies, self.walls), films.places, strict=True):
            if len(here):
                yield law, here, films.of(here)


_KEYS: dict[Mode, str] = {"squeeze": "law", "shear": "shear_law", "rotation": "rotation_law"}


def make_laws(case: Case) -> GapLaws:
    """The laws of squeeze that the section [reduced] asks for. Raises InputError: one is not for the case."""
    return _laws(case, "squeeze")


def make_tangential_laws(case: Case) -> dict[Mode, GapLaws]:
    """Those of shear and rotation, as far as it asks for them. Raises InputError as `make_laws` does."""
    return {mode: _laws(case, mode) for mode in _asked_modes(case) if mode != "squeeze"}


def require_laws(case: Case) -> None:
    """Raise InputError as `make_laws` and `make_tangential_laws` do, without the laws that take long."""
    for mode in _asked_modes(case):
        bodies, walls = _asked(case, mode)
        bodies.require(0.25)
        walls.require(0.0)


def _asked_modes(case: Case) -> list[Mode]:
    return [mode for mode in MODES if getattr(case.reduced, _KEYS[mode]) is not None]


def _laws(case: Case, mode: Mode) -> GapLaws:
    bodies, walls = _asked(case, mode)
    return GapLaws(bodies.law(0.25), walls.law(0.0))


def _asked(case: Case, mode: Mode) -> "tuple[_Asked, _Asked]":
    """Between bodies, and beside walls."""
    key, wall_key = _KEYS[mode], f"wall_{_KEYS[mode]}"
    name: str = getattr(case.reduced, key)
    wall_name: str | None = getattr(case.reduced, wall_key)
    bodies = _Asked(case, mode, key, name, between_bodies(case), key)
    given = key if wall_name is None else wall_key
    return bodies, _Asked(case, mode, given, wall_name or name, beside_walls(case), wall_key)


@dataclass(frozen=True, slots=True)
class _Asked:
    """A law that a case asks for, by the key and its value.

    Attributes:
        mode: of which it shall be.
        films: k of all films there can be, and what each is between.
        own: the key of such films alone, to give where the law does not suit.
    """

    case: Case
    mode: Mode
    key: str
    name: str
    films: Mapping[float, str]
    own: str

    def require(self, otherwise: float) -> None:
        """Raise InputError where `law` does: all is made but tables of films whose law is always known."""
        if self.name not in LAWS:
            self._of_file()
            return
        self._require_mode()
        for overlap in self._overlaps(otherwise):
            if not self._is_table(overlap):
                self._named(overlap)

    def law(self, otherwise: float) -> FilmLaw:
        """The law; one of any ratio at k = otherwise. Raises InputError."""
        overlaps = nodes(np.array(list(self.films) or [otherwise]))
        if self.name not in LAWS:
            laws = [self._of_file()]
        else:
            self._require_mode()
            laws = [self._named(overlap) for overlap in self._overlaps(otherwise)]  # some may be refused
            laws = laws[:1] if self._shape in LAWS[self.name].closed else laws
        cut = self.case.reduced.cutoff
        if cut is None:
            return FilmLaw(tuple(laws), overlaps, self.key)
        return FilmLaw(tuple(CutLaw(law, cut) for law in laws), overlaps, self.key, cut)

    def _overlaps(self, otherwise: float) -> list[float]:
        """k of the films of which a named law is made: of all, of some between, or of k = otherwise."""
        entry, films = LAWS[self.name], list(self.films)
        if entry.any_ratio and films:
            return [otherwise]
        if not films or self._shape in entry.closed:  # none will be asked for, and there may be none of such
            return films
        between: list[float] = nodes(np.array(films)).tolist()
        return between

    def _is_table(self, overlap: float) -> bool:
        """Whether its exact law is a table, which takes long: of spheres beside a plane or drawn apart."""
        return self.case.spheres and (overlap == 0.0 or (self.mode == "squeeze" and overlap > 0.0))

    @property
    def _shape(self) -> Shape:
        return "spheres" if self.case.spheres else "discs"

    @property
    def _has_drag(self) -> bool:
        return self.case.spheres and self.case.drag != 0.0

    def _film(self, overlap: float) -> GapFilm:
        mu, ratio = self.case.fluid.viscosity, ratio_of(overlap)
        return GapFilm(self._shape, mu, ratio, extrapolate=True, mode=self.mode, beyond_drag=self._has_drag)

    def _named(self, overlap: float) -> LubricationLaw:
        try:
            return LAWS[self.name].of(self._film(overlap))
        except ValueError as error:
            raise InputError(f'{self._here}: {error}; give reduced.{self.own} = "leading"') from None

    def _require_mode(self) -> None:
        if self.mode not in LAWS[self.name].modes:
            raise InputError(
                f"{self._here}: not known for {self.mode}; give {names_of_laws(self.mode)} or the path of a "
                "law file"
            )

    def _of_file(self) -> LubricationLaw:
        """The law of a file at the viscosity of the fluid, not at that at which it was calibrated."""
        if not Path(self.name).is_file():
            problem = "is a folder" if Path(self.name).is_dir() else "there is no such law"
            remedy = f"give {names_of_laws(self.mode)} or the path of a law file"
            raise InputError(f"{self._here}: {problem}; {remedy}{hint_of_own(self.name, LAWS)}")
        file = read_law_file(Path(self.name))
        if not file.suits(self._shape, self.mode):
            raise InputError(
                f"{self._here}: a law of {file.mode} between {file.shape}; give one of {self.mode} between "
                f"{self._shape}"
            )
        for k, between in self.films.items():
            if not file.any_ratio and abs(k - overlap_of(file.ratio or inf)) > _ALIKE:
                raise InputError(
                    f"{self._here}: a law of {file.pair}, but the case has {between}; give "
                    f'reduced.{self.own} = "exact", or a law of such a film'
                )
        mu, extrapolate = self.case.fluid.viscosity, self.case.reduced.extrapolate
        try:
            return file.law(viscosity=mu, extrapolate=extrapolate, beyond_drag=self._has_drag)
        except ValueError as error:
            raise InputError(f'{self._here}: {error}; give "leading"') from None

    @property
    def _here(self) -> str:
        return f'reduced.{self.key} = "{self.name}"'
