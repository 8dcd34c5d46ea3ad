"""Laws that come of samples: what they are compared with, and what is said of them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from fsi.calibration.calibrate import summary
from fsi.calibration.finding import pair_of
from fsi.calibration.pair import planned_gaps
from fsi.calibration.result import fit_law
from fsi.case.law_file import LawFile, SeriesSection
from fsi.case.load import load_case
from fsi.errors import SolveError
from fsi.report.studies import lines
from tests.calibration.test_sampling import ExactModel, small_case

EQUAL = Path(__file__).parents[2] / "cases" / "calibration" / "equal_discs_shear.toml"
BOX = ("domain={lower=[-5.0,0.0], upper=[5.0,10.0]}", 'calibration.pair=["disc","bottom"]')


@pytest.mark.parametrize(
    ("changes", "compared"), [((), ["s^-1.5", "s^-0.5", "1"]), (BOX, ["s^-1.5", "s^-0.5"])]
)
def test_theory_is_that_of_the_pair_whatever_is_around_it(
    changes: tuple[str, ...], compared: list[str]
) -> None:
    """In a box only what is singular is known: a constant of 5 is as right as any."""
    pair, model = pair_of(small_case(*changes)), ExactModel()
    samples = [model(pair, gap, held_out=held_out) for gap, held_out in planned_gaps(pair)]
    added = [replace(one, kappa=one.kappa + 5.0 * bool(changes)) for one in samples]
    found = fit_law(pair, added, "disc.toml")
    assert [one.term for one in found.coefficients if one.theory is not None] == compared
    assert all(one.inside for one in found.coefficients if one.theory is not None)


@pytest.mark.parametrize(
    ("mode", "remedy"),
    [
        ("rotation", r"where they still fall \(that of rolling"),
        ("shear", "before the body comes to other surfaces"),
    ],
)
def test_rolling_resistances_that_rise_are_no_other_surfaces(mode: str, remedy: str) -> None:
    """Of two equal spheres it has a minimum at a gap of one radius, 1 % below 4 pi a^3 (`two_spheres`)."""
    pair = pair_of(load_case(EQUAL, (f'calibration.mode="{mode}"',)))
    model = ExactModel()
    samples = [model(pair, gap, held_out=False) for gap in (0.1, 0.2, 0.4)]
    samples[2] = replace(samples[2], kappa=1.01 * samples[1].kappa)
    with pytest.raises(SolveError, match=f"do not decrease with the gap; end calibration.range {remedy}"):
        fit_law(pair, samples, "discs.toml")


def test_what_is_said_of_the_error_of_a_law_is_of_its_whole_range() -> None:
    """K = 1/s, with the errors e of the constant and -e of s: of K they are e (s - s^2), e/4 at s = 1/2.

    At the ends of the range they are a hundredth e and none. A series ends before s = 2: of three samples
    that are held out the last one, at 11.5, tests none.
    """
    changes = ("bodies.0.radius=0.5", "calibration.range=[5e-4, 10.0]", "calibration.samples=10")
    pair, model = pair_of(small_case(*changes, "calibration.held_out=3")), ExactModel()
    found = fit_law(pair, [model(pair, gap, held_out=held) for gap, held in planned_gaps(pair)], "disc.toml")
    said = "\n".join(lines(found))
    assert "\n2 of 3 held out are in its range: law off by at most" in said
    e, zeros = 1e-2, (0.0, 0.0, 0.0)
    root = (zeros, (0.0, e, 0.0), (0.0, -e, 0.0))
    series = SeriesSection(powers=(-1, 0, 1), logs=(False,) * 3, coefficients=(1.0, 0.0, 0.0), root=root)
    law = LawFile(form="series", shape="discs", viscosity=3.0, range=(1e-2, 1.0), series=series)
    worst = replace(found, law=law)
    assert worst.widest_band is not None
    assert worst.widest_band == pytest.approx((0.25, 1.959964 * e / 4.0), rel=5e-3)
    assert "law known to ± 4.9e-03 of itself over its range, 95 % interval, worst at the gap 0.25" in lines(
        worst
    )
    assert summary(worst)["widest_band"]["gap"] == worst.widest_band[0]


def test_the_free_exponent_has_its_95_percent_interval() -> None:
    """1.959964 standard deviations, as the coefficients above it."""
    pair, model = pair_of(small_case()), ExactModel()
    samples = [model(pair, gap, held_out=held_out) for gap, held_out in planned_gaps(pair)]
    found = fit_law(pair, samples, "disc.toml")
    assert found.fit is not None
    width = 1.959964 * found.fit.exponent_error
    assert f"{found.fit.exponent:.6f} ± {width:.1e}, 95 % interval" in "\n".join(lines(found))
    assert summary(found)["exponent_interval"] == pytest.approx(width, rel=1e-6)
