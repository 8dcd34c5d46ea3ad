"""One more law is one function: entered from outside of the package, it is used by name wherever laws are."""

from __future__ import annotations

from collections.abc import Iterator
from math import inf, pi
from pathlib import Path

import numpy as np
import pytest

from fsi.case.law_file import read_law_file
from fsi.errors import InputError
from fsi.lubrication.laws import ScaledLaw
from fsi.lubrication.named_laws import LAWS, GapFilm, exact_law, named
from fsi.lubrication.profiles import Series, Term
from fsi.models import make_model
from tests.reduced_data import reduced_case

DISC = {"name": "disc", "radius": 1.0, "position": [0.0, 1.1], "force": [0.0, -1.0]}
BALLS = [
    {"name": name, "radius": 2.0, "position": [0.0, z], "force": [0.0, F]}
    for name, z, F in (("low", 10.0, 1.0), ("high", 14.2, -1.0))
]


@pytest.fixture
def asked() -> Iterator[list[GapFilm]]:
    """kappa = mu (a_r/d)^2 of discs, 5 mu a_r (a_r/d)^2 of spheres; yields the films it was asked for."""
    films: list[GapFilm] = []

    @named("quadratic")
    def quadratic_law(film: GapFilm) -> ScaledLaw:
        films.append(film)
        c, n = {"discs": (1.0, 0), "spheres": (5.0, 1)}[film.shape]
        return ScaledLaw(Series((Term(-2.0),), (c,)), film.viscosity, n)

    yield films
    del LAWS["quadratic"]


def test_a_name_that_is_taken_is_refused() -> None:
    """The law of the program stays; the same function, loaded anew, may take its own place."""
    before = LAWS["exact"]
    with pytest.raises(
        ValueError, match=r'^"exact": is the name of fsi\.lubrication\.named_laws\.exact_law already'
    ):
        named("exact")(lambda film: exact_law(film))
    assert LAWS["exact"] is before
    try:
        assert named("exact")(exact_law) is exact_law
    finally:
        LAWS["exact"] = before


def test_a_law_from_outside_moves_a_disc(asked: list[GapFilm]) -> None:
    """Beside a plane a_r = a = 1: kappa = 3 (1/0.1)^2 = 300, so V = -1/(300 + drag)."""
    reduced = {"law": "quadratic", "drag": 2.0}
    case = reduced_case([DISC], reduced, fluid={"viscosity": 3.0})
    U = make_model(case)(case.configuration(), 0.0).U
    assert U[0, 1] == pytest.approx(-1.0 / (300.0 + 6.0), rel=1e-12)
    assert asked == [GapFilm("discs", 3.0, inf, extrapolate=True)]  # there is no other disc


def test_a_law_from_outside_moves_two_spheres(asked: list[GapFilm]) -> None:
    """a_r = 1, d = 0.2: kappa = 5 (1/0.2)^2 = 125; each feels the drag 6 pi 2 and the force 125 (2 V)."""
    reduced, domain = {"law": "quadratic"}, {"shape": "half-plane", "radius": 1000.0}
    case = reduced_case(BALLS, reduced | {"cutoff": 1.0}, domain=domain, geometry="axisymmetric")
    V = make_model(case)(case.configuration(), 0.0).U[0, 1]
    kappa = 125.0 - 5.0 * (1.0 / 1.0) ** 2  # less its value at the cutoff
    assert pytest.approx(1.0 / (12.0 * pi + 2.0 * kappa), rel=1e-12) == V
    assert {film.shape for film in asked} == {"spheres"}


def test_a_law_file_may_name_it(asked: list[GapFilm], tmp_path: Path) -> None:
    path = tmp_path / "law.toml"
    path.write_text('form = "quadratic"\nshape = "discs"\nratio = 2.0\nviscosity = 0.5')
    np.testing.assert_allclose(read_law_file(path).law().kappa([0.1, 0.2], 1.0), [50.0, 12.5])
    assert asked == [GapFilm("discs", 0.5, 2.0)]


@pytest.mark.parametrize("key", ["law", "wall_law"])
def test_the_complaint_names_all_laws_that_there_are(key: str, asked: list[GapFilm]) -> None:
    case = reduced_case([DISC], {key: "quadratik", "drag": 1.0})
    names = ", ".join(f'"{name}"' for name in LAWS) + " or the path of a law file"
    assert '"quadratic"' in names
    with pytest.raises(InputError, match=f'reduced.{key} = "quadratik": there is no such law; give {names}'):
        make_model(case)
    assert asked == []
