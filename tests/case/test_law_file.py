"""Law files: what is written comes back; mistakes are one line with key, value and remedy."""

from __future__ import annotations

import tomllib
import warnings
from math import inf, pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w
from numpy.testing import assert_allclose, assert_array_equal
from pydantic import ValidationError

from fsi.case.law_file import LawFile, SeriesSection, TableSection, read_law_file, save_law
from fsi.errors import InputError
from fsi.lubrication.covariances import is_covariance
from fsi.lubrication.laws import RangeError
from fsi.lubrication.named_laws import GapFilm, exact_law

SERIES = LawFile(
    form="series",
    shape="spheres",
    ratio=2.0,
    viscosity=0.5,
    range=(1e-4, 1.0),
    series=SeriesSection(
        powers=(-1.0, 0.0),
        logs=(False, True),
        coefficients=(6.0 * pi, 3.7),
        covariance=((1e-8, 0.0), (0.0, 1e-4)),
    ),
    source={"case": "sphere.toml", "chi2": 0.1 + 0.2},
)
GAPS = np.array([1e-3, 1e-2])


def written(path: Path, law: LawFile) -> Path:
    save_law(path, law)
    return path


def test_a_series_comes_back_bit_by_bit(tmp_path: Path) -> None:
    path = written(tmp_path / "law.toml", SERIES)
    assert read_law_file(path) == SERIES
    assert_array_equal(read_law_file(path).law().kappa(GAPS, 0.5), SERIES.law().kappa(GAPS, 0.5))
    assert_allclose(
        read_law_file(path).law().kappa(GAPS, 0.5),
        0.5 * (6.0 * pi * 0.25 / GAPS + 3.7 * 0.5 * np.log(0.5 / GAPS)),
    )
    assert not list(tmp_path.glob("*.tmp"))


def test_the_error_of_a_series_is_that_of_its_covariance() -> None:
    """1.96 standard deviations of mu a_r (c1/s + c2 ln(1/s)), with c1 and c2 independent."""
    error = SERIES.error(GAPS, 0.5)
    assert error is not None
    s = GAPS / 0.5
    assert_allclose(error, 0.25 * 1.959964 * np.hypot(1e-4 / s, 1e-2 * np.log(1.0 / s)), rtol=1e-6)
    assert LawFile(form="slides", viscosity=1.0).error(GAPS, 1.0) is None


def test_errors_that_nearly_cancel_keep_their_digits(tmp_path: Path) -> None:
    """Of c1/s + c2, c1 off by D and c2 by -D and by e: at s = 1 both D cancel, and 1.96 e is left.

    Of the covariance, with D^2 = 1e12 and D^2 + e^2 of 16 digits, 0 would be left of e = 1e-4.
    """
    D, e = 1e6, 1e-4
    series = SeriesSection(
        powers=(-1.0, 0.0), logs=(False, False), coefficients=(20.0, 1.0), root=((D, 0.0), (-D, e))
    )
    law = LawFile(form="series", viscosity=1.0, range=(1e-3, 2.0), series=series)
    error = read_law_file(written(tmp_path / "law.toml", law)).error(np.array([0.5, 1.0]), 1.0)
    assert error is not None
    assert_allclose(error, 1.959964 * np.array([D, e]), rtol=1e-6)


@pytest.mark.parametrize("rows", [{}, {"root": ((1e-4, 0.0),)}, {"covariance": ((1e-8,),)}])
def test_a_law_has_errors_of_all_its_coefficients(rows: dict[str, Any]) -> None:
    with pytest.raises(
        ValidationError,
        match=r"must have a root .*; of one of them give 2 rows|has a (root|covariance) .*; give 2",
    ):
        SeriesSection(powers=(-1.0, 0.0), logs=(False, True), coefficients=(1.0, 1.0), **rows)


def test_errors_of_a_fitted_exponent_and_its_coefficient_may_cancel() -> None:
    """Of K = c s^-m with errors dm and dc = c ln(e) dm no error is left at s = e; c alone would leave 1e-3 K.

    dK = c s^-m (dc/c - ln s dm) = c s^-m ln(e/s) dm: 1.96 deviations of that.
    """
    e, c, m, dm = 1e-3, 3.0, 0.5, 1e-4
    dc = c * np.log(e) * dm
    joint = ((dm**2, dm * dc), (dm * dc, dc**2))
    series = SeriesSection(powers=(-m,), logs=(False,), coefficients=(c,), slopes=(-1.0,), covariance=joint)
    law = LawFile(form="series", shape="shapes", viscosity=1.0, range=(1e-6, 1.0), series=series)
    s = np.array([1e-5, e, 1e-1])
    error = law.error(s, 1.0)
    assert error is not None
    expected = 1.959964 * c * s**-m * np.abs(np.log(e / s)) * dm
    assert_allclose(error, expected, rtol=1e-6, atol=1e-9)
    without = series.model_copy(update={"slopes": None})
    assert law.digest() == law.model_copy(update={"series": without}).digest()  # the same law


def test_a_table_comes_back(tmp_path: Path) -> None:
    table = TableSection(s=(1e-3, 1e-2, 0.1), K=(900.0, 100.0, 20.0))
    law = LawFile(form="table", shape="discs", viscosity=1.0, table=table)
    found = read_law_file(written(tmp_path / "law.toml", law)).law()
    assert_allclose(found.kappa([2e-3, 2e-2], 2.0), [900.0, 100.0])
    with pytest.raises(RangeError, match=r"holds from 0.001 to 0.1"):
        found.kappa(0.3, 2.0)
    beyond = read_law_file(tmp_path / "law.toml").law(extrapolate=True)
    assert 0.0 < float(beyond.kappa(0.3, 2.0)) < 20.0


@pytest.mark.parametrize("ratio", [None, 3.0])
def test_short_forms(tmp_path: Path, ratio: float | None) -> None:
    given = {} if ratio is None else {"ratio": ratio}
    path = tmp_path / "law.toml"
    path.write_text(tomli_w.dumps({"form": "exact", "shape": "discs", "viscosity": 2.0} | given))
    expected = exact_law(GapFilm("discs", 2.0, ratio or inf)).kappa(GAPS, 0.5)
    assert_array_equal(read_law_file(path).law().kappa(GAPS, 0.5), expected)
    path.write_text('form = "slides"\nviscosity = 2.0')
    assert_allclose(read_law_file(path).law().kappa(GAPS, 0.5), 2.0 / GAPS)
    path.write_text('form = "leading"\nshape = "spheres"\nviscosity = 2.0')
    assert_allclose(read_law_file(path).law().kappa(GAPS, 0.5), 12.0 * pi * 0.25 / GAPS)


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ('form = "series"', 'form = "serie"', 'form = "serie": not one of the choices; give'),
        ("viscosity = 0.5", "viscosity = 0.0", r"viscosity = 0\.0: .*greater than 0; give the viscosity mu"),
        ("viscosity = 0.5", "viscositty = 0.5", "viscositty = 0.5: unknown key; use viscosity"),
        ("[series]", "[serious]", "serious = .* unknown key; use series"),
        (
            "logs = [",
            "logs = [ true,",
            r"series = .*: has 2 powers but 3 logs; give one of them for each power$",
        ),
        (
            "covariance = [",
            "root = [[1.0, 0.0], [0.0, 1.0]]\ncovariance = [",
            r"must have a root or, .*; of one of them give 2 rows of 2 numbers, or let",
        ),
        (
            "    0.0001,\n    1.0,\n",
            "    1.0,\n    0.0001,\n",
            r": range = \[1\.0, 0\.0001\]: is .*two numbers 0 <=",
        ),
        (
            "    0.0001,\n",
            "    -0.0001,\n",
            r": range = \[-0\.0001, 1\.0\]: is no range of gaps; give two numbers",
        ),
        (
            "        1e-08,",
            "        -1e-08,",
            r": series\.covariance = \[\[-1e-08, .*: must be symmetric and positive",
        ),
        (
            "logs = [",
            "slopes = [ -1.0, 0.0 ]\nlogs = [",
            r"not of 3 rows and columns; give 3 rows",
        ),
        # 6 pi/s + 3.7 ln(1/s) with other numbers: negative, rising from s = pi/5 on, and 0 at 1
        (f"    {6.0 * pi},", "    -1.0,", r"series = .*: is -\S+ at s = 0\.0001; give a section \[series\]"),
        ("    3.7,", "    -30.0,", r"series = .*: rises at s = 0\.63\d*; give .* decreases with the gap"),
        (f"    {6.0 * pi},", "    0.0,", r"series = .*: is 0 at s = 1; give"),
        ("form", "form = ", "not TOML: "),
    ],
)
def test_mistakes(old: str, new: str, complaint: str, tmp_path: Path) -> None:
    path = written(tmp_path / "law.toml", SERIES)
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(InputError, match=complaint) as caught:
        read_law_file(path).law()
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_covariance_has_rows() -> None:
    """One of no rows has no smallest eigenvalue that could be looked at."""
    with pytest.raises(ValidationError, match="at least 1 item"):
        SeriesSection(powers=(-1.0,), logs=(False,), coefficients=(1.0,), covariance=())


def test_powers_that_no_law_has_are_refused_without_warnings(tmp_path: Path) -> None:
    """s^-300 overflows below s = 0.1, and a difference of what is infinite is no number."""
    path = written(tmp_path / "law.toml", SERIES)
    path.write_text(path.read_text().replace("    -1.0,", "    -300.0,", 1))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(InputError, match=r"series = .*: is inf at s = 0.0001; give a section"):
            read_law_file(path)


def test_a_table_must_decrease(tmp_path: Path) -> None:
    path = tmp_path / "law.toml"
    data = {"form": "table", "viscosity": 1.0, "table": {"s": [1e-3, 1e-2], "K": [1.0, 2.0]}}
    path.write_text(tomli_w.dumps(data))
    with pytest.raises(InputError, match=r"decreases with the gap; give s that rise, K > 0 that fall$"):
        read_law_file(path).law()


@pytest.mark.parametrize("form", ["table", "exact"])
def test_only_a_series_has_a_range(form: str, tmp_path: Path) -> None:
    """It would be left aside: a table holds from its first point to its last."""
    table = {"table": {"s": [1e-3, 1e-2], "K": [2.0, 1.0]}} if form == "table" else {}
    path = tmp_path / "law.toml"
    path.write_text(tomli_w.dumps({"form": form, "viscosity": 1.0, "range": [1e-3, 5e-3], **table}))
    refusal = rf'range = \[0\.001, 0\.005\]: the form "{form}" takes none, drop it; give'
    with pytest.raises(InputError, match=refusal):
        read_law_file(path)


@pytest.mark.parametrize(
    ("changes", "complaint"),
    [
        ({"series": None}, r"law\.toml: series: missing; give a section \[series\] if that is the form"),
        ({"range": None}, r"law\.toml: range: missing; give two numbers 0 <= a < b"),
        (
            {"form": "table", "range": None},
            r'law\.toml: series = .*: the form "table" takes none, drop it; .*1 more',
        ),
        (
            {"form": "table", "range": None, "series": None},
            r"law\.toml: table: missing; give a section \[table\]",
        ),
        (
            {"shape": "shapes", "mode": "shear"},
            r'law\.toml: mode = "shear": a law between "shapes" is one of',
        ),
        ({"form": "exact", "shape": "shapes"}, r'law\.toml: shape = "shapes": the form "exact" is known for'),
        (
            {"form": "slides", "mode": "shear"},
            r'law\.toml: mode = "shear": the form "slides" is not known for it',
        ),
    ],
)
def test_a_law_has_what_goes_with_its_form(changes: dict[str, str], complaint: str, tmp_path: Path) -> None:
    """The complaint begins with the key: once it was called `case`, with the whole file as its value."""
    given = SERIES.model_dump(exclude_none=True) | changes
    data = {key: value for key, value in given.items() if value is not None}
    (tmp_path / "law.toml").write_text(tomli_w.dumps(data))
    with pytest.raises(InputError, match=complaint):
        read_law_file(tmp_path / "law.toml")


@pytest.mark.parametrize(
    ("square", "right"),
    [
        ([[1.0, 2e-3], [2e-3, 4e-6]], True),  # a root of 0, of numbers that are fully correlated
        ([[1.0, 2e-3], [2e-3, 4e-6 * (1.0 - 1e-12)]], True),  # with their rounding
        ([[0.0, 0.0], [0.0, 1.0]], True),
        ([[1.0, 3e-3], [3e-3, 4e-6]], False),  # a correlation of 1.5
        ([[1.0, 1e-3], [2e-3, 4e-6]], False),
        ([[-1.0, 0.0], [0.0, 1.0]], False),
        ([[0.0, 1e-3], [1e-3, 1.0]], False),
        # any two of which may be as correlated, but not all three: the sum has the variance 3 - 6 * 0.6
        ([[1.0, -0.6, -0.6], [-0.6, 1.0, -0.6], [-0.6, -0.6, 1.0]], False),
    ],
)
def test_variances_of_sums_are_not_negative(square: list[list[float]], right: bool) -> None:
    assert is_covariance(np.array(square)) is right


def test_no_such_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="No such file or directory; give the path of a law file"):
        read_law_file(tmp_path / "law.toml").law()


def test_the_file_is_plain_toml(tmp_path: Path) -> None:
    data = tomllib.loads(written(tmp_path / "law.toml", SERIES).read_text())
    assert data["series"]["powers"] == [-1.0, 0.0]
    assert data["source"] == {"case": "sphere.toml", "chi2": 0.1 + 0.2}
