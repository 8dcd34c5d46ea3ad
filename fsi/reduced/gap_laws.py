"""The laws of a reduced case: which kappa between bodies, which beside walls, cut off where, of which mode.

Besides a_r, a film knows its k = a b/(a + b)^2: from 1/4 of equal bodies to 0 beside a plane, and less inside
a round wall, where b = -R. The leading term of kappa needs a_r alone; all that follows depends on k. A law
that is for one k refuses films of another.

Far apart the exact law of squeeze of spheres tends to 6 pi mu a_r, which is their own drag (6 pi mu a of a
sphere far from a plane; of two that are drawn apart 6 pi mu a and 6 pi mu b in series). Here the law is what
it has beyond that, so that drag counts once. That of discs tends to zero.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import combinations_with_replacement, permutations
from math import inf, pi
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from fsi.bodies.configuration import Array
from fsi.case.case import Case
from fsi.case.law_file import read_law_file
from fsi.errors import InputError, SolveError
from fsi.lubrication.expansions import Mode, Shape, overlap_of, ratio_of
from fsi.lubrication.laws import CutLaw, LubricationLaw, RangeError, ScaledLaw, TabulatedProfile
from fsi.lubrication.named_laws import LAWS, GapFilm, names_of_laws
from fsi.reduced.enclosure import make_enclosure, overlap, wall_gaps

# Below this gap, in reduced radii, a law is continued by its leading term in the logarithm of the gap: exact
# for kappa ~ 1/d, whose gaps underflow, and never reached with kappa ~ d^(-3/2).
_SMALLEST = 1e-150
# Up to so many different films have a law each; of more, laws at so many k are interpolated (see the tests).
_NODES = 10
# Of k: films whose law is the same; of a law's own k: films for which it may be used.
_SAME, _ALIKE = 1e-12, 1e-6
# Different radii in a case whose pairs are looked at one by one.
_FEW = 40


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
        """Which films are between bodies, and which beside walls."""
        return np.flatnonzero(~self.is_wall), np.flatnonzero(self.is_wall)

    def of(self, some: NDArray[np.intp]) -> "Films":
        """Some of them."""
        return Films(self.radius[some], self.overlap[some], self.is_wall[some])


@dataclass(frozen=True, slots=True)
class FilmLaw:
    """A law for films of any k: the polynomial in k through laws at some k; a single law is for all.

    Attributes:
        laws: none where there can be no film.
        overlaps: k of each law, (m,).
        key: of the section [reduced], for messages.
    """

    laws: tuple[LubricationLaw, ...]
    overlaps: Array
    key: str

    def each(self, method: Literal["kappa", "integral"], D: Array, films: Films) -> Array:
        """kappa or its integral at gaps D of films, (P,). Raises SolveError: it does not hold there."""
        try:
            return self._each(method, D, films.radius, films.overlap)
        except RangeError as error:
            raise SolveError(f"reduced.{self.key}: {error} with reduced.extrapolate = true") from None

    def _each(self, method: Literal["kappa", "integral"], D: Array, radius: Array, overlap: Array) -> Array:
        if len(self.laws) == 1:
            return np.asarray(getattr(self.laws[0], method)(D, radius))
        total = np.zeros(len(D))
        for law, weight in zip(self.laws, self._weights(overlap), strict=True):
            here = np.flatnonzero(weight)
            if len(here):
                total[here] += weight[here] * getattr(law, method)(D[here], radius[here])
        return total

    def _weights(self, overlap: Array) -> Array:
        """Lagrange's, (m, P); at the k of a law it alone has one."""
        away = overlap - self.overlaps[:, None]
        at_law = np.abs(away) <= _SAME
        weights = np.ones_like(away)
        for i, j in permutations(range(len(self.laws)), 2):
            weights[i] *= away[j] / (self.overlaps[i] - self.overlaps[j])
        return np.where(at_law.any(axis=0), at_law, weights)


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
        edge = np.log(_SMALLEST * films.radius)
        kappa = self._each("kappa", np.exp(np.maximum(x, edge)), films)
        with np.errstate(over="ignore"):
            return kappa * np.exp(np.maximum(edge - x, 0.0))

    def integral(self, x: Array, films: Films) -> tuple[Array, Array]:
        """K, an antiderivative of kappa in D, and `dK/dx = kappa D`."""
        edge = np.log(_SMALLEST * films.radius)
        D = np.exp(np.maximum(x, edge))
        slope = self._each("kappa", D, films) * D
        return self._each("integral", D, films) + slope * np.minimum(x - edge, 0.0), slope

    def _each(self, method: Literal["kappa", "integral"], D: Array, films: Films) -> Array:
        values = np.empty(len(D))
        for law, here in zip((self.bodies, self.walls), films.places, strict=True):
            if len(here):
                values[here] = law.each(method, D[here], films.of(here))
        return values


def make_laws(case: Case) -> GapLaws:
    """The laws of squeeze that the section [reduced] asks for. Raises InputError: one is not for the case."""
    return _laws(case, "squeeze", "law", case.reduced.law)


def make_tangential_laws(case: Case) -> dict[Mode, GapLaws]:
    """Those of shear and rotation, as far as it asks for them. Raises InputError as `make_laws` does."""
    asked: dict[Mode, str | None] = {"shear": case.reduced.shear_law, "rotation": case.reduced.rotation_law}
    return {mode: _laws(case, mode, f"{mode}_law", name) for mode, name in asked.items() if name is not None}


def _laws(case: Case, mode: Mode, key: str, name: str) -> GapLaws:
    wall_law: str | None = getattr(case.reduced, f"wall_{key}")
    bodies = _Asked(case, mode, key, name, _between_bodies(case), key)
    wall_key = key if wall_law is None else f"wall_{key}"
    walls = _Asked(case, mode, wall_key, wall_law or name, _beside_walls(case), f"wall_{key}")
    return GapLaws(bodies.law(0.25), walls.law(0.0))


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

    def law(self, otherwise: float) -> FilmLaw:
        """The law; one of any ratio at k = otherwise. Raises InputError."""
        overlaps = _nodes(np.array(list(self.films) or [otherwise]))
        laws: list[LubricationLaw] = []
        if self.name not in LAWS:
            laws = [self._of_file()]
        elif not self.films:  # none will be asked for, and there may be none of such films
            self._require_mode()
        elif LAWS[self.name].any_ratio:
            laws = [self._named(otherwise)]
        else:
            laws = [self._named(overlap) for overlap in overlaps.tolist()]
        cut = self.case.reduced.cutoff
        return FilmLaw(tuple(laws if cut is None else [CutLaw(law, cut) for law in laws]), overlaps, self.key)

    def _film(self, overlap: float) -> GapFilm:
        shape: Shape = "spheres" if self.case.spheres else "discs"
        return GapFilm(shape, self.case.fluid.viscosity, ratio_of(overlap), extrapolate=True, mode=self.mode)

    def _named(self, overlap: float) -> LubricationLaw:
        self._require_mode()
        try:
            return self._beyond_drag(self.name, LAWS[self.name].of(self._film(overlap)))
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
            raise InputError(
                f"{self._here}: there is no such law; give {names_of_laws(self.mode)} or the path of a law "
                "file"
            )
        file, film = read_law_file(Path(self.name)), self._film(0.0)
        if not file.suits(film.shape, self.mode):
            raise InputError(
                f"{self._here}: a law of {file.mode} between {file.shape}; give one of {self.mode} between "
                f"{film.shape}"
            )
        for k, between in self.films.items():
            if not file.any_ratio and abs(k - overlap_of(file.ratio or inf)) > _ALIKE:
                raise InputError(
                    f"{self._here}: a law of {file.pair}, but the case has {between}; give "
                    f'reduced.{self.own} = "exact", or a law of such a film'
                )
        extrapolate = self.case.reduced.extrapolate
        try:
            reach = self._reach if extrapolate else 0.0
            law = file.law(viscosity=film.viscosity, extrapolate=extrapolate, reach=reach)
        except ValueError as error:
            remedy = "drop reduced.extrapolate, or give a reduced.cutoff within its range"
            raise InputError(f"{self._here}: {error}; {remedy}") from None
        return self._beyond_drag(file.form, law)

    def _beyond_drag(self, form: str, law: LubricationLaw) -> LubricationLaw:
        """The exact squeeze of spheres that have drag less what it tends to, which that is; else the law."""
        has_drag = self.case.spheres and self.case.drag != 0.0
        if (form, self.mode) != ("exact", "squeeze") or not has_drag:
            return law
        assert isinstance(law, ScaledLaw)
        assert isinstance(law.profile, TabulatedProfile)  # as exact laws are
        return replace(law, profile=law.profile.less(6.0 * pi))

    @property
    def _reach(self) -> float:
        """At least the largest gap over a_r at which the law is asked for: a_r >= a/2, beside walls a."""
        cutoff, radii = self.case.reduced.cutoff, self.case.configuration().radii
        part = 2.0 if max(self.films, default=0.25) > 0.0 else 1.0
        return inf if cutoff is None else part * cutoff / float(radii.min())

    @property
    def _here(self) -> str:
        return f'reduced.{self.key} = "{self.name}"'


def _nodes(overlaps: Array) -> Array:
    """These k, each once; of many Chebyshev's between the least and the greatest."""
    low, high = overlaps.min(), overlaps.max()
    each = np.sort(overlaps)
    each = each[np.diff(each, prepend=-np.inf) > _SAME]
    if len(each) <= _NODES:
        return each
    return np.asarray(0.5 * (low + high) + 0.5 * (high - low) * np.polynomial.chebyshev.chebpts1(_NODES))


def _between_bodies(case: Case) -> dict[float, str]:
    """k of all pairs that bodies and images can form; of very many radii some, the extremes among them."""
    radii = case.configuration().radii
    a, first, count = np.unique(radii, return_index=True, return_counts=True)
    if len(a) > _FEW:
        some = np.linspace(0, len(a) - 1, _FEW).round().astype(int)
        a, first, count = a[some], first[some], count[some]
    alone = count + len(case.container().periods) < 2
    found = {}
    for i, j in combinations_with_replacement(range(len(a)), 2):
        if i != j or not alone[i]:
            names = f"{case.names[first[i]]!r} and {'its like' if i == j else repr(case.names[first[j]])}"
            reduced = a[i] * a[j] / (a[i] + a[j])
            found[float(overlap(reduced, a[i]))] = f"bodies {names} of radii {a[i]:g} and {a[j]:g}"
    return found


def _beside_walls(case: Case) -> dict[float, str]:
    """k of all films beside solid walls."""
    q, around = case.configuration(), make_enclosure(case, 0.0)
    walls = wall_gaps(around.container, q.centres, q.radii)
    found = {}
    for w in np.flatnonzero(walls.lubricates & around.solid):
        name = around.container.walls[w]
        shape = "a plane wall" if around.container.spheres[w] is None else "a round wall"
        for k in np.unique(overlap(walls.radius[:, w], q.radii)).tolist():
            found[float(k)] = f"{shape}, {name!r}"
    return found
