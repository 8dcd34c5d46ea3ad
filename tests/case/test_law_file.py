"""Law files: what is written comes back; mistakes are one line with key, value and remedy."""

from __future__ import annotations

import tomllib
import warnings
from math import inf, pi
from pathlib import Path

import numpy as np
import pytest
import tomli_w
from numpy.testing import assert_allclose, assert_array_equal

from fsi.case.law_file import LawFile, SeriesSection, TableSection, read_law_file, save_law
from fsi.errors import InputError
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
        ("logs = [", "logs = [ true,", r"has 2 powers, but not as many logs"),
        ("    0.0001,\n    1.0,\n", "    1.0,\n    0.0001,\n", "a range of s, two numbers that increase"),
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
    with pytest.raises(InputError, match="is not a positive resistance that decreases with the gap"):
        read_law_file(path).law()


@pytest.mark.parametrize("form", ["table", "exact"])
def test_only_a_series_has_a_range(form: str, tmp_path: Path) -> None:
    """It would be left aside: a table holds from its first point to its last."""
    table = {"table": {"s": [1e-3, 1e-2], "K": [2.0, 1.0]}} if form == "table" else {}
    path = tmp_path / "law.toml"
    path.write_text(tomli_w.dumps({"form": form, "viscosity": 1.0, "range": [1e-3, 5e-3], **table}))
    refusal = rf'range = \[0\.001, 0\.005\]: the form "{form}" has a range of its own, drop the key'
    with pytest.raises(InputError, match=refusal):
        read_law_file(path)


@pytest.mark.parametrize(("form", "left_out"), [("table", {"range"}), ("series", {"series"})])
def test_a_form_has_its_section(form: str, left_out: set[str], tmp_path: Path) -> None:
    data = SERIES.model_dump(exclude_none=True, exclude=left_out) | {"form": form}
    (tmp_path / "law.toml").write_text(tomli_w.dumps(data))
    with pytest.raises(InputError, match=r"needs the section \[series\] if and only if its form is"):
        read_law_file(tmp_path / "law.toml")


def test_no_such_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="No such file or directory; give the path of a law file"):
        read_law_file(tmp_path / "law.toml").law()


def test_the_file_is_plain_toml(tmp_path: Path) -> None:
    data = tomllib.loads(written(tmp_path / "law.toml", SERIES).read_text())
    assert data["series"]["powers"] == [-1.0, 0.0]
    assert data["source"] == {"case": "sphere.toml", "chi2": 0.1 + 0.2}
