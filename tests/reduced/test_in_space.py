"""Spheres that slide and roll in space: velocities by dense algebra, stress against dissipation, Einstein."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fsi.arrays import Array
from fsi.case.case import Case
from fsi.case.law_file import LawFile, TableSection, save_law
from fsi.lubrication import spheres
from fsi.models import make_model
from fsi.reduced.model import ReducedInstant
from tests.reduced_data import reduced_case

LEADING = {"law": "leading", "shear_law": "leading", "rotation_law": "leading", "cutoff": 1.0}
EXACT = LEADING | {"law": "exact"}
LARGE = {"shape": "round", "radius": 50.0}
CHANNEL = {
    "lower": [0.0, 0.0, 0.0],
    "upper": [4.4, 4.5, 4.6],
    "periodic": ["x", "y"],
    "walls": {"bottom": [-1.0, 0.5, 0.0], "top": [3.0, -0.7, 0.0]},
}
CELL = {"shape": "cell", "vectors": [[4.4, 0.0, 0.0], [1.1, 4.5, 0.0], [0.3, -0.4, 4.6]]}
SHEAR = {"channel": (4.0 / 4.6, -1.2 / 4.6), "sheared": (0.8, 0.0)}
DOMAINS = {
    "channel": CHANNEL,
    "sheared": CELL | {"shear": 0.8},
    "stretched": CELL | {"extension": -0.5},
    "uniaxial": CELL | {"uniaxial": 0.4},
}
PLACES = [(0.9, 1.3, 1.25), (3.0, 1.1, 1.35), (1.7, 3.2, 3.3), (3.9, 3.4, 3.35)]
RADII = [1.0, 0.9, 1.05, 0.8]


def in_space(bodies: list[dict[str, Any]], reduced: dict[str, Any], **sections: Any) -> ReducedInstant:
    case: Case = reduced_case(bodies, reduced, geometry="spatial", **sections)
    found = make_model(case)(case.configuration(), 0.0)
    assert isinstance(found, ReducedInstant)
    return found


def periodic(name: str, **body: Any) -> ReducedInstant:
    bodies = [
        {"name": f"b{k}", "radius": a, "position": list(place)} | body
        for k, (a, place) in enumerate(zip(RADII, PLACES, strict=True))
    ]
    return in_space(bodies, LEADING, domain=DOMAINS[name])


def strain_rate(name: str) -> Array:
    """E of the mean flow, by hand."""
    if name in SHEAR:
        x, y = SHEAR[name]
        return 0.5 * np.array([[0.0, 0.0, x], [0.0, 0.0, y], [x, y, 0.0]])
    return np.diag([-0.5, 0.0, 0.5] if name == "stretched" else [0.4, -0.2, -0.2])


def cross(n: Array) -> Array:
    """The matrix of w -> w x n."""
    x, y, z = n
    return np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]])


def pair_resistance(a: float, b: float, apart: Array, cut: float) -> Array:
    """R of both, (12, 12), by vectors: the slip s of both surfaces, and rolling (w_i - w_j) x n + g s.

    Per mode kappa at the gap less that at the cutoff: 6 pi a_r^2/D, 2 pi a_r ln and 24/5 pi a_r^3 ln.
    """
    d = float(np.linalg.norm(apart))
    n, gap, a_r = apart / d, d - a - b, a * b / (a + b)
    zero, across, turn = np.zeros((3, 3)), np.eye(3) - np.outer(n, n), cross(n)
    arm, other = a * d / (a + b), b * d / (a + b)
    approach = np.concatenate([n, np.zeros(3), -n, np.zeros(3)])[None]
    slide = np.hstack([across, -arm * turn, -across, -other * turn])
    roll = np.hstack([zero, turn, zero, -turn]) + 0.5 * (1.0 / a - 1.0 / b) * slide
    log = np.log(cut / gap)
    R = 6.0 * np.pi * a_r**2 * (1.0 / gap - 1.0 / cut) * approach.T @ approach
    R += 2.0 * np.pi * a_r * log * slide.T @ slide
    return np.asarray(R + 4.8 * np.pi * a_r**3 * log * roll.T @ roll)


@pytest.mark.parametrize("b", [1.0, 0.6])
def test_two_spheres_move_as_by_dense_algebra(b: float) -> None:
    a, cut, mu = 1.0, 0.4, 2.5
    direction = np.array([2.0, -1.0, 2.0]) / 3.0
    apart, F = (a + b + 0.05) * direction, np.array([1.0, -0.3, 0.2, 0.5, 0.1, -0.4])
    bodies = [
        {
            "name": "a",
            "radius": a,
            "position": apart.tolist(),
            "force": F[:3].tolist(),
            "torque": F[3:].tolist(),
        },
        {"name": "b", "radius": b, "position": [0.0, 0.0, 0.0]},
    ]
    found = in_space(bodies, LEADING | {"cutoff": cut}, domain=LARGE, fluid={"viscosity": mu})
    drag = np.repeat(np.pi * np.array([6.0 * a, 8.0 * a**3, 6.0 * b, 8.0 * b**3]), 3)
    R = mu * (np.diag(drag) + pair_resistance(a, b, apart, cut))
    U = np.linalg.solve(R, np.concatenate([F, np.zeros(6)])).reshape(2, 6)
    np.testing.assert_allclose(found.U, U, atol=1e-12)
    assert np.abs(U[1]).min() > 1e-4  # the other one is dragged along in all modes


def test_a_sphere_beside_a_plane_moves_by_the_logarithms() -> None:
    """16/5 pi ln on the diagonal, -4/5 pi ln off it (Goldman, Cox and Brenner 1967), and Stokes' drags."""
    gap, cut = 0.02, 0.7
    ball = {"name": "ball", "radius": 1.0, "position": [0.0, 0.0, 1.0 + gap], "force": [1.0, 0.0, 0.0]}
    U = in_space([ball], LEADING | {"cutoff": cut}).U[0]
    film = 0.8 * np.pi * np.log(cut / gap)  # rolling forwards, about +y, is easy
    R = np.array([[4.0 * film + 6.0 * np.pi, -film], [-film, 4.0 * film + 8.0 * np.pi]])
    assert U[[0, 4]] == pytest.approx(np.linalg.solve(R, [1.0, 0.0]), rel=1e-12)
    assert U[[1, 2, 3, 5]] == pytest.approx(0.0, abs=1e-15)


def test_a_calibrated_law_along_a_plane_is_taken(tmp_path: Path) -> None:
    """K from 40 to 5 in a straight line of logarithms: F over mu a (K - K_cut + 6 pi)."""
    table = TableSection(s=(1e-3, 1.0), K=(40.0, 5.0))
    path = tmp_path / "along.toml"
    save_law(path, LawFile(form="table", shape="spheres", mode="shear", viscosity=1.0, table=table))
    a, gap = 2.0, 0.02
    ball = {"name": "ball", "radius": a, "position": [0.0, 0.0, a + gap], "force": [0.0, 3.0, 0.0]}
    given = {"shear_law": "leading", "wall_shear_law": str(path), "cutoff": 2.0}
    K = 5.0 * 8.0 ** (np.log(gap / a) / np.log(1e-3))
    assert in_space([ball], given).U[0, 1] == pytest.approx(3.0 / (a * (K - 5.0 + 6.0 * np.pi)), rel=1e-9)


@pytest.mark.parametrize("name", DOMAINS)
def test_what_the_stress_works_is_what_is_dissipated(name: str) -> None:
    """mu_app 2 mu E:E |Omega| of free spheres, by the bulk stress and by drag, gaps, strain of the fluid."""
    found, E = periodic(name), strain_rate(name)
    assert found.bulk is not None
    assert found.bulk.volume == pytest.approx(4.4 * 4.5 * 4.6)
    unit = 2.0 * np.sum(E**2) * found.bulk.volume
    assert found.apparent_viscosity == pytest.approx(found.dissipation / unit, rel=1e-12)
    assert np.sum(found.bulk.mean * E) * found.bulk.volume == pytest.approx(found.dissipation, rel=1e-12)
    for check in ("power", "stress", "kernel", "momentum", "balance", "residual", "angular_momentum"):
        assert found.record[check] < 1e-12, check
    S = found.bulk.stresslets
    np.testing.assert_allclose(S, S.swapaxes(1, 2), atol=1e-12)
    assert {"stress_xz", "lubrication_stress_xz", "N_2"} <= set(found.record)
    assert {"S_xz", "lubrication_S_xz"} <= set(found.body_columns)


@pytest.mark.parametrize("motion", ["shear", "extension", "uniaxial"])
def test_a_cubic_array_has_a_closed_form(motion: str) -> None:
    """1 + 5/2 phi + kappa/(2 d), with kappa of shear pi ln(cut/gap), of squeeze the exact one.

    Of the images along the axes of a cubic cell two slide at d gamma/2 as they turn with half the rate; in
    extension two are squeezed and drawn apart by d e, in uniaxial flow one by d e, two by d e/2.
    """
    d, a = 2.3, 1.0
    body = {"name": "ball", "radius": a, "position": [0.3, 0.7, 0.1]}
    domain = {"shape": "cell", "vectors": (d * np.eye(3)).tolist(), motion: 0.7}
    found = in_space([body], EXACT, domain=domain)
    at, cut = (float(spheres.relative_resistance(gap, a, a, 1.0)) for gap in (d - 2.0 * a, 1.0))
    kappa = np.pi * np.log(1.0 / (d - 2.0 * a)) if motion == "shear" else at - cut
    phi = 4.0 / 3.0 * np.pi * a**3 / d**3
    assert found.apparent_viscosity == pytest.approx(1.0 + 2.5 * phi + kappa / (2.0 * d), rel=1e-9)


def test_lone_spheres_have_einsteins_viscosity() -> None:
    """1 + 5/2 phi beyond the cutoff of all images, and the stresslet 20/3 pi mu a^3 E (Einstein 1911)."""
    a, mu = 1.2, 3.0
    body = {"name": "ball", "radius": a, "position": [0.3, 0.7, 0.1]}
    domain = {"shape": "cell", "vectors": [[9.0, 0.0, 0.0], [2.0, 9.0, 0.0], [0.0, 1.0, 9.0]], "shear": 0.8}
    found = in_space([body], EXACT, domain=domain, fluid={"viscosity": mu})
    assert found.bulk is not None
    phi = 4.0 / 3.0 * np.pi * a**3 / 729.0
    assert found.apparent_viscosity == pytest.approx(1.0 + 2.5 * phi, rel=1e-12)
    assert found.bulk.stresslets[0, 0, 2] == pytest.approx(20.0 / 3.0 * np.pi * mu * a**3 * 0.4, rel=1e-12)


def test_loaded_spheres_satisfy_the_identity_of_the_stress_too() -> None:
    found = periodic("channel", force=[1.0, -2.0, 0.5], torque=[0.7, -0.2, 0.4])
    assert found.record["stress"] < 1e-12
    unit = 2.0 * np.sum(strain_rate("channel") ** 2) * 4.4 * 4.5 * 4.6
    assert found.apparent_viscosity is not None
    assert abs(found.dissipation / unit / found.apparent_viscosity - 1.0) > 1e-3
