"""What a calibration finds: a law, its coefficients against theory, its error against samples held out."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from fsi.arrays import Array
from fsi.calibration.film import film_length
from fsi.calibration.pair import Pair
from fsi.calibration.samples import Sample, Samples, as_arrays
from fsi.case.law_file import LawFile, SeriesSection, TableSection, not_falling
from fsi.errors import SolveError
from fsi.lubrication.expansions import EXPONENTS, coefficients, is_singular, pair_series
from fsi.lubrication.fitting import Fit, fit_series
from fsi.lubrication.free_exponent import PLANAR, REVOLVED, fit_exponent
from fsi.lubrication.profiles import Term
from fsi.run_folder.provenance import launch

# Over a range, at which the error of a law is looked for.
_GAPS = 1000


@dataclass(frozen=True, slots=True)
class Coefficient:
    """One coefficient c_k of kappa/(mu a_r^n), without dimension.

    Attributes:
        term: phi_k in s = d/a_r.
        value: c_k.
        interval: half of its 95 % interval.
        theory: the exact one, or None: in a container that is not infinite those of singular terms alone.
    """

    term: str
    value: float
    interval: float
    theory: float | None

    @property
    def difference(self) -> float | None:
        """Relative to theory, or to 1 where that is zero."""
        return None if self.theory is None else (self.value - self.theory) / (abs(self.theory) or 1.0)

    @property
    def inside(self) -> bool | None:
        """Whether the theory lies in the interval."""
        return None if self.theory is None else abs(self.value - self.theory) <= self.interval


@dataclass(frozen=True, slots=True)
class HeldOut:
    """The samples that were held out, and the law at their gaps.

    Attributes:
        samples: these.
        law: kappa by the law, (n,).
        band: half of its 95 % interval, (n,); None of a table, whose error is what is found here.
    """

    samples: Samples
    law: Array
    band: Array | None

    @property
    def error(self) -> float:
        """The largest difference of the law from a sample, over that."""
        return float(np.max(np.abs(self.law / self.samples.kappa - 1.0)))

    @property
    def passed(self) -> bool | None:
        """Whether law and samples differ by no more than the errors that both state; None of a table."""
        if self.band is None:
            return None
        return bool(np.all(np.abs(self.law - self.samples.kappa) <= self.band + self.samples.bars))


@dataclass(frozen=True, slots=True)
class LeadingTerm:
    """kappa / mu = coefficient d^-exponent at small gaps d, in the units of the case.

    Attributes:
        coefficient: C.
        coefficient_interval: half of its 95 % interval.
        exponent: m.
        exponent_interval: half of its 95 % interval.
    """

    coefficient: float
    coefficient_interval: float
    exponent: float
    exponent_interval: float


@dataclass(frozen=True, slots=True)
class CalibrationResult:
    """Samples and what has been made of them.

    Attributes:
        pair: what was sampled.
        samples: of it, also those held out.
        law: as its file has it.
        fit, coefficients: of a series; None or empty for a table.
        test: what those say that were held out in the range of the law; None where there are none.
    """

    pair: Pair
    samples: list[Sample]
    law: LawFile
    fit: Fit | None
    coefficients: list[Coefficient]
    test: HeldOut | None

    @property
    def leading(self) -> LeadingTerm | None:
        """Of a law between shapes; None of others, whose exponents are known."""
        if self.fit is None or not self.pair.shaped:
            return None
        m, width = -self.fit.exponent, self.fit.exponent_interval
        a, c = self.pair.reduced_radius, float(self.fit.coefficients[0])
        of_c = float(self.fit.intervals[0]) + abs(c * np.log(a)) * width
        return LeadingTerm(c * a**m, of_c * a**m, m, width)

    @property
    def widest_band(self) -> tuple[float, float] | None:
        """The gap in the range of a series at which half of its 95 % interval is the largest part of it.

        And that part; None of a table, which states no error.
        """
        kappa, a = self.law.law(), self.pair.reduced_radius
        d = a * np.geomspace(*kappa.range, _GAPS)
        band = self.law.error(d, a)
        if band is None:
            return None
        part = band / kappa.kappa(d, a)
        k = int(np.argmax(part))
        return float(d[k]), float(part[k])


def fit_law(pair: Pair, samples: list[Sample], case: str) -> CalibrationResult:
    """The law that a case (file `case`) asks for.

    Raises SolveError: samples, or the series through them, do not decrease with the gap.
    """
    fitted, source = _without_dimension(pair, samples), _source(pair, case, samples)
    if np.any(fitted.kappa <= 0.0) or np.any(np.diff(fitted.kappa) >= 0.0):
        raise _rising(pair)
    if pair.plan.form == "table":
        table = TableSection(s=tuple(fitted.d.tolist()), K=tuple(fitted.kappa.tolist()))
        law = _law_file(pair, source, table=table)
        return CalibrationResult(pair, samples, law, None, [], _tested(pair, samples, law))
    confined = pair.confined
    fit = _fit(pair, fitted, confined=confined)
    source |= {"chi2": fit.chi2, "degrees_of_freedom": fit.dof, "used": int(fit.used.sum())}
    series = _series(fit)
    if wrong := not_falling(series.profile(fit.range)):
        # Those held out tell it where others lie on both sides of a minimum.
        if np.any(np.diff([one.kappa for one in sorted(samples, key=lambda one: one.gap)]) >= 0.0):
            raise _rising(pair)
        remedy = 'give more calibration.samples, or calibration.form = "table"'
        raise SolveError(f"the fitted series {wrong}; {remedy}")
    law = _law_file(pair, source, series=series, range_of_s=fit.range)
    compared = _compared(pair, fit, confined=confined)
    return CalibrationResult(pair, samples, law, fit, compared, _tested(pair, samples, law))


def _rising(pair: Pair) -> SolveError:
    """What is said of resistances that rise with the gap, and what to do about them.

    The opposite couples that roll two spheres turn each other on, the less the farther apart they are.
    """
    where = "before the body comes to other surfaces"
    if pair.plan.mode == "rotation" and pair.second is not None:
        where = "where they still fall (that of rolling spheres has a minimum)"
    remedy = f"end calibration.range {where}, or refine the discretisation"
    return SolveError(f"the sampled resistances do not decrease with the gap; {remedy}")


def _without_dimension(pair: Pair, samples: list[Sample]) -> Samples:
    """s = d/a_r, K = kappa/(mu a_r^n) and its bars, of the samples that make the law."""
    fitted, a = as_arrays(samples, held_out=False), pair.reduced_radius
    unit = pair.case.fluid.viscosity * a ** EXPONENTS[pair.shape, pair.plan.mode]
    return Samples(fitted.d / a, fitted.kappa / unit, fitted.bars / unit)


def _law_file(
    pair: Pair,
    source: dict[str, Any],
    *,
    table: TableSection | None = None,
    series: SeriesSection | None = None,
    range_of_s: tuple[float, float] | None = None,
) -> LawFile:
    """The law of a pair; a table has its range in itself."""
    return LawFile(
        form=pair.plan.form,
        shape=pair.shape,
        mode=pair.plan.mode,
        ratio=None if pair.second is None or pair.shaped else pair.ratio,
        viscosity=pair.case.fluid.viscosity,
        range=range_of_s,
        series=series,
        table=table,
        source=source,
    )


def _fit(pair: Pair, fitted: Samples, *, confined: bool) -> Fit:
    """The series through samples without dimension, of shapes with a free exponent."""
    s, K, bars = fitted.d, fitted.kappa, fitted.bars
    if pair.shape == "shapes":
        series = REVOLVED if pair.case.axisymmetric else PLANAR
        free = series.within(film_length(pair) / pair.reduced_radius)
        return fit_exponent(s, K, bars, free.confined() if confined else free)
    return fit_series(s, K, bars, pair_series(pair.shape, pair.plan.mode, pair.ratio, confined=confined))


def _series(fit: Fit) -> SeriesSection:
    """As a file has it."""
    return SeriesSection(
        powers=tuple(term.power for term in fit.terms),
        logs=tuple(term.log for term in fit.terms),
        coefficients=tuple(fit.coefficients.tolist()),
        slopes=None if fit.slopes is None else tuple(fit.slopes.tolist()),
        root=tuple(map(tuple, fit.root.tolist())),
    )


def _compared(pair: Pair, fit: Fit, *, confined: bool) -> list[Coefficient]:
    """The coefficients beside those that are known."""
    known: dict[Term, float] = {}
    if pair.shape != "shapes":
        exact = coefficients(pair.shape, pair.plan.mode, pair.ratio)
        known = {term: c for term, c in exact.items() if is_singular(term) or not confined}
    values = zip(fit.terms, fit.coefficients.tolist(), fit.intervals.tolist(), strict=True)
    return [Coefficient(str(term), value, width, known.get(term)) for term, value, width in values]


def _source(pair: Pair, case: str, samples: list[Sample]) -> dict[str, Any]:
    here, count = launch(), sum(not one.held_out for one in samples)
    source = {"case": case, "name": pair.case.name, "samples": count, "fitted": here["started"]}
    return source | {"git": here["git"] or "", "packages": here["packages"]}


def _tested(pair: Pair, samples: list[Sample], law: LawFile) -> HeldOut | None:
    held = as_arrays(samples, held_out=True)
    kappa, a = law.law(), pair.reduced_radius
    inside = (held.d / a >= kappa.range[0]) & (held.d / a <= kappa.range[1])
    if not np.any(inside):
        return None
    held = Samples(held.d[inside], held.kappa[inside], held.bars[inside])
    return HeldOut(held, kappa.kappa(held.d, a), law.error(held.d, a))
