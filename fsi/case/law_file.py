"""Law files: a lubrication law as TOML, with its range, its error and where it comes from.

    form = "series"            # of s = d/a_r: kappa = mu a_r^n sum_k c_k phi_k(s), phi_k = s^power (ln(1/s))
    shape = "spheres"
    mode = "squeeze"
    ratio = 1.0                # b/a; left out beside a plane
    viscosity = 1.0
    range = [2e-4, 2.0]        # of s
    [series]
    powers = [-1.0, 0.0, 0.0]
    logs = [false, true, false]
    coefficients = [18.85, 8.48, 31.24]
    covariance = [[...], ...]  # of the coefficients
    [source]                   # free: case, samples, chi2, versions ...

The other forms are "table" (section [table] with s and K), and without section and range "exact", "leading"
and "slides", which is viscosity/d.
"""

from __future__ import annotations

import tomllib
from math import inf
from pathlib import Path
from typing import Any, Literal

import numpy as np
import tomli_w
from pydantic import Field, ValidationError, model_validator

from fsi.bodies.configuration import Array
from fsi.case.section import Section, explain, tuples
from fsi.errors import InputError
from fsi.lubrication.exact_laws import exact_law
from fsi.lubrication.expansions import EXPONENTS
from fsi.lubrication.fitting import band
from fsi.lubrication.laws import ScaledLaw, Series, Term, leading_disc_law, leading_sphere_law, slides_law
from fsi.lubrication.tables import Table
from fsi.run_folder.checkpoint import replace


class SeriesSection(Section):
    """c_k and phi_k."""

    powers: tuple[float, ...] = Field(min_length=1, description="the power of s of each term")
    logs: tuple[bool, ...] = Field(description="for each term whether it has the factor ln(1/s)")
    coefficients: tuple[float, ...] = Field(description="one number for each term")
    covariance: tuple[tuple[float, ...], ...] = Field(
        description="the covariance of the coefficients, a square"
    )

    @model_validator(mode="after")
    def _matching(self) -> SeriesSection:
        n = len(self.powers)
        lengths = [len(self.logs), len(self.coefficients), len(self.covariance), *map(len, self.covariance)]
        if any(length != n for length in lengths):
            raise ValueError(
                f"has {n} powers, but not as many logs, coefficients, rows or columns of covariance"
            )
        return self

    @property
    def terms(self) -> tuple[Term, ...]:
        """phi_k."""
        return tuple(Term(power, log) for power, log in zip(self.powers, self.logs, strict=True))


class TableSection(Section):
    """Points of K(s)."""

    s: tuple[float, ...] = Field(min_length=2, description="gaps over the reduced radius, increasing, > 0")
    K: tuple[float, ...] = Field(description="one resistance > 0 for each gap, decreasing")

    @model_validator(mode="after")
    def _monotone(self) -> TableSection:
        if len(self.s) != len(self.K):
            raise ValueError(f"has {len(self.s)} gaps but {len(self.K)} resistances")
        if (
            self.s[0] <= 0.0
            or self.K[-1] <= 0.0
            or np.any(np.diff(self.s) <= 0.0)
            or np.any(np.diff(self.K) >= 0.0)
        ):
            raise ValueError("is not a positive resistance that decreases with the gap")
        return self


class LawFile(Section):
    """What a law file holds."""

    form: Literal["series", "table", "exact", "leading", "slides"] = Field(
        description='"series", "table", "exact", "leading" or "slides"'
    )
    shape: Literal["spheres", "discs"] = Field(default="spheres", description='"spheres" or "discs"')
    mode: Literal["squeeze", "shear", "rotation"] = Field(
        default="squeeze", description='"squeeze", "shear" or "rotation"'
    )
    ratio: float | None = Field(default=None, gt=0.0, description="b/a of the pair, or none beside a plane")
    viscosity: float = Field(gt=0.0, description="the viscosity mu, a number > 0")
    range: tuple[float, float] | None = Field(
        default=None, description="the smallest and largest d/a_r for which it holds"
    )
    series: SeriesSection | None = Field(default=None, description="a section [series]")
    table: TableSection | None = Field(default=None, description="a section [table]")
    source: dict[str, Any] = Field(default={}, description="a section [source]")

    @model_validator(mode="after")
    def _complete(self) -> LawFile:
        for form in ("series", "table"):
            if (getattr(self, form) is not None) != (self.form == form):
                raise ValueError(f'a law needs the section [{form}] if and only if its form is "{form}"')
        if self.form == "series" and (self.range is None or not 0.0 <= self.range[0] < self.range[1]):
            raise ValueError("a series needs a range of s")
        if self.form in ("exact", "leading", "slides") and self.mode != "squeeze":
            raise ValueError(f'the form "{self.form}" is known for mode = "squeeze" only')
        return self

    def law(self, *, extrapolate: bool = False) -> ScaledLaw:
        """The law; `extrapolate` allows gaps outside its range."""
        if self.form == "slides":
            return slides_law(self.viscosity)
        if self.form == "leading":
            return (leading_sphere_law if self.shape == "spheres" else leading_disc_law)(self.viscosity)
        if self.form == "exact":
            ratio = inf if self.ratio is None else self.ratio
            return exact_law(self.shape, ratio, self.viscosity, extrapolate=extrapolate)
        exponent = EXPONENTS[self.shape, self.mode]
        return ScaledLaw(self._profile(), self.viscosity, exponent, extrapolate)

    def _profile(self) -> Series | Table:
        if self.series is not None and self.range is not None:
            return Series(self.series.terms, self.series.coefficients, self.range)
        assert self.table is not None  # by `_complete`
        return Table(np.array(self.table.s), np.array(self.table.K))

    def error(self, d: Array, radius: float) -> Array | None:
        """Half width of the 95 % interval of kappa(d), shape of d; None for laws that state no error."""
        if self.series is None:
            return None
        width = band(self.series.terms, np.array(self.series.covariance), np.asarray(d) / radius)
        scaled: Array = self.viscosity * radius ** EXPONENTS[self.shape, self.mode] * width
        return scaled


def read_law_file(path: Path) -> LawFile:
    """The content of a law file. Raises InputError, one line with key, value and remedy."""
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: not TOML: {error}; correct the file there") from None
    except OSError as error:
        raise InputError(f"{path}: {error.strerror or error}; give the path of a law file") from None
    try:
        return LawFile.model_validate(tuples(data))
    except ValidationError as error:
        raise InputError(f"{path}: {explain(error, LawFile)}") from None


def load_law(path: Path, *, extrapolate: bool = False) -> ScaledLaw:
    """The law of a file. Raises InputError."""
    return read_law_file(path).law(extrapolate=extrapolate)


def save_law(path: Path, law: LawFile) -> None:
    """Write a law file, in one go."""
    replace(path, tomli_w.dumps(law.model_dump(exclude_none=True)).encode())
