"""The stress of discs that slide and roll: its work is dissipated, and closed forms of the viscosity."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from fsi.case.case import Case
from fsi.lubrication.laws import CutLaw
from fsi.lubrication.named_laws import GapFilm, exact_law
from tests.reduced_data import ALL, instant, reduced_case

CHANNEL = {
    "lower": [0.0, 0.0],
    "upper": [5.2, 4.5],
    "periodic": ["x"],
    "walls": {"bottom": [-1.0, 0.0], "top": [3.0, 0.0]},
}
CELL = {"shape": "cell", "vectors": [[5.2, 0.0], [1.1, 4.5]]}
DOMAINS = {"channel": CHANNEL, "sheared": CELL | {"shear": 0.8}, "stretched": CELL | {"extension": -0.5}}
PLACES = [(0.9, 1.3), (3.1, 1.15), (1.7, 3.2), (4.4, 3.4)]
RADII = [1.0, 0.9, 1.05, 0.8]


def periodic(name: str, **more: Any) -> Case:
    bodies = [
        {"name": f"b{k}", "radius": a, "position": list(place)} | more.get("body", {})
        for k, (a, place) in enumerate(zip(RADII, PLACES, strict=True))
    ]
    return reduced_case(bodies, ALL | more.get("reduced", {}), domain=DOMAINS[name])


@pytest.mark.parametrize("name", DOMAINS)
def test_what_the_stress_works_is_what_is_dissipated(name: str) -> None:
    """mu_app 2 mu E:E |Omega| of free bodies, by the bulk stress and by drag, gaps, strain of the fluid."""
    found = instant(periodic(name))
    assert found.bulk is not None
    E = np.diag([-0.5, 0.5])
    if name != "stretched":
        E = 0.5 * (0.8 if name == "sheared" else 4.0 / 4.5) * np.array([[0.0, 1.0], [1.0, 0.0]])
    unit = 2.0 * np.sum(E**2) * found.bulk.volume
    assert found.apparent_viscosity == pytest.approx(found.dissipation / unit, rel=1e-12)
    assert np.sum(found.bulk.mean * E) * found.bulk.volume == pytest.approx(found.dissipation, rel=1e-12)
    phi = np.pi * np.sum(np.square(RADII)) / found.bulk.volume
    assert found.apparent_viscosity > 1.0 + 2.0 * phi + 0.5
    for check in ("power", "stress", "kernel", "momentum", "balance", "residual"):
        assert found.record[check] < 1e-12, check
    assert found.record["angular_momentum"] < 1e-12


def test_loaded_bodies_satisfy_the_identity_of_the_stress_too() -> None:
    """Their loads work by U - u_inf; dissipation is then not that of the viscosity."""
    found = instant(periodic("channel", body={"force": [1.0, -2.0], "torque": 0.7}))
    assert found.bulk is not None
    assert found.record["stress"] < 1e-12
    unit = (4.0 / 4.5) ** 2 * found.bulk.volume
    assert abs(found.dissipation / unit / found.apparent_viscosity - 1.0) > 1e-3  # type: ignore[operator]


@pytest.mark.parametrize("motion", ["shear", "extension"])
def test_a_square_array_has_a_closed_form(motion: str) -> None:
    """1 + 2 phi + kappa/2: of the images along both axes of a square cell one mode is driven, d gamma/2 each.

    In extension they are squeezed and drawn apart by d e; in shear they slide on each other, and turn with
    half the rate.
    """
    d, a = 2.3, 1.0
    body = {"name": "disc", "radius": a, "position": [0.3, 0.7]}
    domain = {"shape": "cell", "vectors": [[d, 0.0], [0.0, d]], motion: 0.7}
    found = instant(reduced_case([body], ALL, domain=domain))
    mode = "squeeze" if motion == "extension" else "shear"
    law = CutLaw(exact_law(GapFilm("discs", 1.0, 1.0, mode=mode)), 1.0)  # type: ignore[arg-type]
    expected = 1.0 + 2.0 * np.pi * a**2 / d**2 + 0.5 * float(law.kappa(d - 2.0 * a, 0.5 * a))
    assert found.apparent_viscosity == pytest.approx(expected, rel=1e-9)


def test_lone_discs_have_einsteins_viscosity_in_the_plane() -> None:
    """1 + 2 phi, beyond the cutoff of all images."""
    body = {"name": "disc", "radius": 1.0, "position": [0.3, 0.7]}
    domain = {"shape": "cell", "vectors": [[9.0, 0.0], [2.0, 9.0]], "shear": 0.8}
    found = instant(reduced_case([body], ALL, domain=domain))
    assert found.apparent_viscosity == pytest.approx(1.0 + 2.0 * np.pi / 81.0, rel=1e-12)
