"""Law files: a lubrication law as TOML, with its range, its error and where it comes from.

    form = "series"            # of s = d/a_r: kappa = mu a_r^n sum_k c_k phi_k(s), phi_k = s^power (ln(1/s))
    shape = "spheres"
    mode = "squeeze"
    ratio = 1.0                # b/a; left out beside a plane
    viscosity = 1.0
    range = [2e-4, 2.0]        # of s; there the sum is positive and falls
    [series]
    powers = [-1.0, 0.0, 0.0]
    logs = [false, true, false]
    coefficients = [18.85, 8.48, 31.24]
    root = [[...], ...]        # A of the covariance A A^T of the coefficients; older files have `covariance`
    slopes = [...]             # d power/dm if an exponent m was fitted; both are then of (m, c_1, ...)
    [source]                   # free: case, samples, chi2, versions ...

The other forms have no range: "table" (section [table] with s and K), and without section each law that has a
name (`fsi.lubrication.named_laws`): "exact", "leading", or "slides", which is viscosity/d.
"""

from __future__ import annotations

from math import inf
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import Field, ValidationInfo, field_validator, model_validator
from pydantic_core import PydanticCustomError

from fsi.arrays import Array
from fsi.case.section import Positive, Section
from fsi.case.section_file import read_section, save_section
from fsi.files import digest_of
from fsi.lubrication.covariances import is_covariance, root_of
from fsi.lubrication.expansions import EXPONENTS, LawShape, Mode, Shape
from fsi.lubrication.fitting import band, design, design_with_exponent
from fsi.lubrication.laws import LubricationLaw, ScaledLaw
from fsi.lubrication.named_laws import LAWS, GapFilm, names_of_laws
from fsi.lubrication.profiles import Profile, Series, TabulatedProfile, Term

# Forms that have a section of their own.
_SAMPLED = ("series", "table")
# Where a series is looked at: so many gaps, the smallest over the largest, and rounding of what is flat.
_POINTS, _NARROWEST, _ROUNDING = 1000, 1e-12, 1e-12


type Rows = tuple[tuple[float, ...], ...]


class SeriesSection(Section):
    """c_k and phi_k."""

    powers: tuple[float, ...] = Field(min_length=1)
    """the power of s of each term"""
    logs: tuple[bool, ...]
    """for each term whether it has the factor ln(1/s)"""
    coefficients: tuple[float, ...]
    """one number for each term"""
    slopes: tuple[float, ...] | None = None
    """of each term d power / dm where an exponent m was fitted"""
    root: Rows | None = None
    """a square A, A A^T the covariance of the coefficients; with slopes that of m and the coefficients"""
    covariance: Rows | None = Field(default=None, min_length=1)
    """in place of root, in older files: the covariance, a square"""

    @field_validator("covariance")
    @classmethod
    def _semidefinite(cls, rows: Rows | None) -> Rows | None:
        square = rows is not None and all(len(row) == len(rows) for row in rows)
        if square and not is_covariance(np.array(rows)):
            raise ValueError("must be symmetric and positive semidefinite")
        return rows

    @model_validator(mode="after")
    def _matching(self) -> SeriesSection:
        n = len(self.powers)
        for name in ("logs", "coefficients", "slopes"):
            given = getattr(self, name)
            if given is not None and len(given) != n:
                raise ValueError(f"has {n} powers but {len(given)} {name}; give one of them for each power")
        size = n if self.slopes is None else n + 1
        square = f"give {size} rows of {size} numbers, or let `fsi calibrate` write the file"
        if (self.root is None) is (self.covariance is None):
            raise ValueError(f"must have a root or, as older files, a covariance; of one of them {square}")
        for name in ("root", "covariance"):
            rows = getattr(self, name) or ((0.0,) * size,) * size
            if any(len(given) != size for given in (rows, *rows)):
                raise ValueError(f"has a {name} that is not of {size} rows and columns; {square}")
        return self

    @property
    def terms(self) -> tuple[Term, ...]:
        """phi_k."""
        return tuple(Term(power, log) for power, log in zip(self.powers, self.logs, strict=True))

    def profile(self, range_of_s: tuple[float, float]) -> Series:
        """K(s)."""
        return Series(self.terms, self.coefficients, range_of_s)

    def band(self, s: Array) -> Array:
        """Half width of the 95 % interval of K(s), shape of s."""
        if self.slopes is None:
            rates = design(self.terms, s)
        else:
            rates = design_with_exponent(self.terms, np.array(self.coefficients), np.array(self.slopes), s)
        root = root_of(np.array(self.covariance)) if self.root is None else np.array(self.root)
        return band(rates, root)


class TableSection(Section):
    """Points of K(s)."""

    s: tuple[float, ...] = Field(min_length=2)
    """gaps over the reduced radius, increasing, > 0"""
    K: tuple[float, ...]
    """one resistance > 0 for each gap, decreasing"""

    @model_validator(mode="after")
    def _monotone(self) -> TableSection:
        if len(self.s) != len(self.K):
            raise ValueError(f"has {len(self.s)} gaps but {len(self.K)} resistances; give as many of both")
        if (
            self.s[0] <= 0.0
            or self.K[-1] <= 0.0
            or np.any(np.diff(self.s) <= 0.0)
            or np.any(np.diff(self.K) >= 0.0)
        ):
            raise ValueError(
                "is not a positive resistance that decreases with the gap; give s that rise, K > 0 that fall"
            )
        return self

    def profile(self) -> Profile:
        """K(s), from the first point to the last."""
        return TabulatedProfile(np.array(self.s), np.array(self.K))


class LawFile(Section):
    """What a law file holds."""

    form: str = Field(description=f'"series", "table" or a name: {names_of_laws()}')
    shape: LawShape = "spheres"
    '"spheres", "discs" or, of surfaces that are neither, "shapes"'
    mode: Mode = Field(default="squeeze", validate_default=True)
    '"squeeze", "shear" or "rotation"'
    ratio: Positive | None = None
    """b/a of the pair, or none beside a plane"""
    viscosity: Positive
    """the viscosity mu, a number > 0"""
    range: tuple[float, float] | None = Field(default=None, validate_default=True)
    """two numbers 0 <= a < b, of a series alone: the smallest and largest d/a_r for which it holds"""
    series: SeriesSection | None = Field(default=None, validate_default=True)
    """a section [series] if that is the form, of a resistance > 0 that decreases with the gap in its range"""
    table: TableSection | None = Field(default=None, validate_default=True)
    """a section [table] if that is the form"""
    source: dict[str, Any] = Field(default={})
    """a section [source]"""

    @field_validator("form")
    @classmethod
    def _known(cls, form: str) -> str:
        if form not in (*_SAMPLED, *LAWS):
            raise PydanticCustomError("literal_error", "not one of the choices")
        return form

    @field_validator("shape")
    @classmethod
    def _of_known_shapes(cls, shape: LawShape, info: ValidationInfo) -> LawShape:
        if shape == "shapes" and (form := info.data.get("form")) in LAWS:
            raise ValueError(f'the form "{form}" is known for spheres and discs only')
        return shape

    @field_validator("mode")
    @classmethod
    def _of_known_mode(cls, mode: Mode, info: ValidationInfo) -> Mode:
        form, shape = info.data.get("form"), info.data.get("shape")
        if shape is not None and (shape, mode) not in EXPONENTS:
            raise ValueError(f'a law between "{shape}" is one of mode = "squeeze"')
        if form in LAWS and mode not in LAWS[form].modes:
            raise ValueError(f'the form "{form}" is not known for it')
        return mode

    @field_validator("range", "series", "table")
    @classmethod
    def _of_form[Given](cls, given: Given | None, info: ValidationInfo) -> Given | None:
        """What the form needs is there, and nothing else."""
        form, wanted = info.data.get("form"), "table" if info.field_name == "table" else "series"
        if given is None and form == wanted:
            raise PydanticCustomError("missing", "missing")
        if given is not None and form not in (wanted, None):
            raise ValueError(f'the form "{form}" takes none, drop it')
        return given

    @field_validator("range")
    @classmethod
    def _increasing(cls, given: tuple[float, float] | None) -> tuple[float, float] | None:
        if given is not None and not 0.0 <= given[0] < given[1]:
            raise ValueError("is no range of gaps")
        return given

    @field_validator("series")
    @classmethod
    def _falling(cls, series: SeriesSection | None, info: ValidationInfo) -> SeriesSection | None:
        given = info.data.get("range")
        if series is not None and given is not None and (wrong := not_falling(series.profile(given))):
            raise ValueError(wrong)
        return series

    def law(
        self, *, viscosity: float | None = None, extrapolate: bool = False, beyond_drag: bool = False
    ) -> LubricationLaw:
        """The law, linear in mu: at this viscosity, or its own; `extrapolate` beyond the range of gaps.

        beyond_drag: whether one that tends to the drag of lone spheres by its form leaves that out.

        Raises ValueError: none is known of such a film.
        """
        mu = self.viscosity if viscosity is None else viscosity
        if self.form in LAWS:
            assert self.shape != "shapes"  # by `_of_known_shapes`
            ratio = self.ratio or inf
            return LAWS[self.form].of(
                GapFilm(self.shape, mu, ratio, extrapolate, self.mode, beyond_drag=beyond_drag)
            )
        return ScaledLaw(self._profile(), mu, EXPONENTS[self.shape, self.mode], extrapolate)

    def _profile(self) -> Profile:
        if self.series is not None and self.range is not None:
            return self.series.profile(self.range)
        assert self.table is not None  # by `_of_form`
        return self.table.profile()

    def suits(self, shape: Shape, mode: Mode) -> bool:
        """Whether it is a law of this relative motion of bodies of this shape."""
        any_shape = self.form in LAWS and LAWS[self.form].any_shape
        return self.mode == mode and (self.shape == shape or any_shape)

    @property
    def any_ratio(self) -> bool:
        """Whether it is the same for all ratios of the radii, and walls."""
        return self.form in LAWS and LAWS[self.form].any_ratio

    @property
    def pair(self) -> str:
        """What it is a law of, for messages."""
        return "a body and a plane wall" if self.ratio is None else f"bodies of radii 1 : {self.ratio:g}"

    def digest(self) -> str:
        """A hash of K(s), of the motion and the pair: the same at any viscosity, from any source."""
        of_errors = {"root", "covariance", "slopes"}
        other: dict[str, Any] = {"source": True, "viscosity": True, "series": of_errors}
        law = self.model_dump(mode="json", exclude_none=True, exclude=other)
        return digest_of(law)

    def error(self, d: Array, radius: float) -> Array | None:
        """Half width of the 95 % interval of kappa(d), shape of d; None for laws that state no error."""
        if self.series is None:
            return None
        width = self.series.band(np.asarray(d) / radius)
        scaled: Array = self.viscosity * radius ** EXPONENTS[self.shape, self.mode] * width
        return scaled


def not_falling(series: Series) -> str | None:
    """Where in its range a series is no number > 0, or rises with the gap: "rises at s = 0.3"."""
    low, high = series.range
    s = np.geomspace(max(low, high * _NARROWEST), high, _POINTS)
    with np.errstate(over="ignore", invalid="ignore"):  # of powers that no law has
        K = series.value(s)
        wrong = ~((K > 0.0) & np.isfinite(K))
        wrong[1:] |= np.diff(K) > _ROUNDING * np.abs(K[1:])
    k = int(np.argmax(wrong))
    if not wrong[k]:
        return None
    return f"rises at s = {s[k]:.4g}" if 0.0 < K[k] < inf else f"is {K[k]:.4g} at s = {s[k]:.4g}"


def read_law_file(path: Path) -> LawFile:
    """The content of a law file. Raises InputError, one line with key, value and remedy."""
    return read_section(LawFile, path, "a law file")


def save_law(path: Path, law: LawFile) -> None:
    """Write a law file, in one go."""
    save_section(path, law)
