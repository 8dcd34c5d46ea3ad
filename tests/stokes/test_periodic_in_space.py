"""Spheres in periodic cells and between sliding walls: arrays, symmetries, viscosities, ranks."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fsi.arrays import Array
from fsi.case.case import Case
from fsi.case.load import parse_case
from fsi.stokes.model import StokesModel
from tests.cubic_arrays import EXTENSION, LATTICES, SHEAR, drag, viscosity
from tests.ranks import json_on, needs_mpi
from tests.stokes.spatial_flows import LIGHT, solved

# Two spheres of unlike size in an oblique cell, one across its sides.
OBLIQUE = {"shape": "cell", "vectors": [[4.0, 0.0, 0.0], [0.8, 4.0, 0.0], [0.3, 0.5, 3.8]]}
TWO = [
    {"name": "a", "radius": 1.0, "position": [0.3, 0.2, 0.1]},
    {"name": "b", "radius": 0.6, "position": [2.4, 2.1, 1.9]},
]


def case(domain: dict[str, Any], bodies: list[dict[str, Any]], **discretisation: Any) -> Case:
    return parse_case(
        {
            "name": "test", "geometry": "spatial", "fluid": {"viscosity": 0.7}, "domain": domain,
            "bodies": bodies, "discretisation": LIGHT | discretisation,
        }
    )  # fmt: skip


def cubic(c: float, **flow: float) -> dict[str, Any]:
    """The simple cubic array of unit spheres."""
    side = (4.0 * np.pi / 3.0 / c) ** (1.0 / 3.0)
    return {"shape": "cell", "vectors": (side * np.eye(3)).tolist(), **flow}


def ball(position: list[float], **motion: Any) -> dict[str, Any]:
    return {"name": "ball", "radius": 1.0, "position": position, **motion}


HELD = {"velocity": [0.0, 1.0, 0.0], "angular_velocity": [0.0, 0.0, 0.0]}


ARRAYS = [
    ("simple cubic", 0.064, 2.8102), ("body-centred", 0.064, 2.8894), ("body-centred", 0.343, 16.3350),
    ("face-centred", 0.064, 2.8888), ("face-centred", 0.343, 16.6390),
]  # fmt: skip
# Zick and Homsy 1982, J. Fluid Mech. 115:13, table 2, simple cubic.
ZICK_HOMSY = {0.027: 2.008, 0.064: 2.810, 0.125: 4.292, 0.216: 7.442, 0.343: 15.4}


@pytest.mark.slow
def test_stokeslets_have_the_drag_of_zick_and_homsy() -> None:
    """All digits printed there, and the first digits of what other tests expect of other lattices."""
    for c, K in ZICK_HOMSY.items():
        assert drag("simple cubic", c, 700) == pytest.approx(K, abs=5e-2 if K > 10.0 else 5.1e-4)
    for kind, c, K in ARRAYS:
        assert drag(kind, c, 700) == pytest.approx(K, rel=3e-5)


@pytest.mark.parametrize(
    ("kind", "A"),
    [
        pytest.param("simple cubic", 1.7601, marks=pytest.mark.slow),
        ("body-centred", 1.7918),
        pytest.param("face-centred", 1.7917, marks=pytest.mark.slow),
    ],
)
def test_stokeslets_have_the_drag_of_hasimoto(kind: str, A: float) -> None:
    """1 / K = 1 - A c^(1/3) + c + O(c^2), Hasimoto 1959; with so few points to 4e-4."""
    c = 1e-4
    assert (1.0 + c - 1.0 / drag(kind, c, 300)) / c ** (1.0 / 3.0) == pytest.approx(A, abs=6e-4)


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "c", "K"), ARRAYS)
def test_drag_of_arrays(kind: str, c: float, K: float) -> None:
    """By Stokeslets of the lattice. On such meshes degree 3 is good to 2e-3; of one sphere alone K = 1."""
    a = (0.75 * c * abs(np.linalg.det(LATTICES[kind])) / np.pi) ** (1.0 / 3.0)
    cell = {"shape": "cell", "vectors": (LATTICES[kind] / a).tolist()}
    sizes = {"degree": 3, "cells_per_circle": 16, "growth": 0.5}
    found = solved(case(cell, [ball([0.0, 0.0, 0.0], **HELD)], **sizes))
    assert found.F[0, 1] / (6.0 * np.pi * 0.7) == pytest.approx(K, rel=2e-3)
    assert found.mean_pressure_gradient is not None
    volume = abs(np.linalg.det(LATTICES[kind] / a))
    assert found.mean_pressure_gradient[1] * volume == pytest.approx(found.F[0, 1], rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("flow", "E", "c", "mu"),
    [
        ("extension", EXTENSION, 0.064, 1.20189), ("shear", SHEAR, 0.064, 1.15515),
        ("extension", EXTENSION, 0.216, 2.23297), ("shear", SHEAR, 0.216, 1.54237),
    ],
)  # fmt: skip
def test_viscosities_of_simple_cubic_arrays(flow: str, E: Array, c: float, mu: float) -> None:
    """By Stokeslets of the lattice; the two moduli differ by 4 % and 45 %."""
    assert viscosity("simple cubic", c, E, 700) == pytest.approx(mu, rel=1e-5)
    found = solved(
        case(cubic(c, **{flow: 1.0}), [ball([0.0, 0.0, 0.0])], degree=3, cells_per_circle=16, growth=0.5)
    )
    assert found.apparent_viscosity == pytest.approx(mu, rel=2e-3)


@pytest.mark.parametrize(
    "flow", ["shear", *(pytest.param(flow, marks=pytest.mark.slow) for flow in ("extension", "uniaxial"))]
)
def test_three_ways_to_one_viscosity(flow: str) -> None:
    """By the mean stress, the stresslets and the dissipation; a lost jump on one side would show at 1e-1."""
    found = solved(case(OBLIQUE | {flow: 1.3}, TWO))
    assert max(found.checks.values()) < 1e-9
    assert found.checks["stress"] < 1e-10
    bulk = found.bulk
    assert bulk is not None
    assert_allclose(np.trace(bulk.fluid), 0.0, atol=1e-10)
    assert bulk.differences.keys() == {"N_1", "N_2"}
    S = bulk.mean
    assert (bulk.differences["N_1"], bulk.differences["N_2"]) == (S[0, 0] - S[2, 2], S[2, 2] - S[1, 1])


@pytest.mark.slow
def test_dilute_suspensions_have_the_viscosity_of_einstein() -> None:
    """(mu_app / mu - 1) / c -> 5/2 (Einstein 1906), within 1e-2, linear in c from two cells.

    Of a cubic array it is the mean over all strain rates, of which two fifths are extensions along the axes.
    At c = 0.016 itself it is 2.55, and 2.48 and 2.66 in shear and extension.
    """
    weights, sizes = {"shear": 0.6, "extension": 0.4}, {"degree": 3, "cells_per_circle": 16, "growth": 0.5}
    bodies, at = [ball([0.0, 0.0, 0.0])], []
    for c in (0.016, 0.032):
        flows = {flow: case(cubic(c, **{flow: 1.0}), bodies, **sizes) for flow in weights}
        mu = {flow: solved(one).apparent_viscosity or 0.0 for flow, one in flows.items()}
        at.append(sum(weight * (mu[flow] - 1.0) / c for flow, weight in weights.items()))
    assert 2.0 * at[0] - at[1] == pytest.approx(2.5, rel=1e-2)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("flow", "modulus"),
    [
        ("extension", lambda c, a, b: 2.5 * c / (1.0 - (1.0 - 60.0 * b) * c + 12.0 * a * c ** (5.0 / 3.0))),
        ("shear", lambda c, a, b: 2.5 * c / (1.0 - (1.0 + 40.0 * b) * c - 8.0 * a * c ** (5.0 / 3.0))),
    ],
)
def test_two_viscosities_of_a_simple_cubic_array(flow: str, modulus: Callable[..., float]) -> None:
    """Zuzovsky, Adler and Brenner 1983, Phys. Fluids 26:1714, as in Nunan and Keller 1984, section 6.

    For extension along the axes and shear across them; what they leave out is O(c^(7/3)), here 1.6e-3.
    """
    sizes = {"degree": 3, "cells_per_circle": 15, "growth": 0.6}
    found = solved(case(cubic(0.064, **{flow: 1.0}), [ball([0.1, 0.2, 0.3])], **sizes))
    assert found.apparent_viscosity == pytest.approx(1.0 + modulus(0.064, 0.2857, -0.04655), rel=1e-3)


@pytest.mark.slow
def test_solvers_and_forms_agree_in_a_cell() -> None:
    """Velocities, the unknown pressure gradients and the stress; images lost in one of them would show."""
    bodies = [TWO[0] | HELD, TWO[1] | {"force": [0.1, 0.0, -0.3], "torque": [0.0, 0.2, 0.0]}]
    direct, iterative, multiplier = (
        solved(case(OBLIQUE | {"shear": 1.0}, bodies, **given))
        for given in ({"solver": "direct"}, {"solver": "iterative"}, {"formulation": "multiplier"})
    )
    assert iterative.iterations > 10
    for other, tolerance in ((iterative, 1e-9), (multiplier, 1e-10)):
        for name in ("U", "F", "mean_pressure_gradient"):
            expected = getattr(direct, name)
            assert_allclose(getattr(other, name), expected, atol=tolerance * np.abs(expected).max())
        assert other.bulk is not None
        assert direct.bulk is not None
        assert_allclose(other.bulk.mean, direct.bulk.mean, atol=tolerance * np.abs(direct.bulk.mean).max())


@pytest.mark.slow
def test_flat_cells_do_not_hold_the_iteration_up() -> None:
    """This array has some: smoothed by the diagonal alone it took 126 iterations, where others take 40."""
    array = case(cubic(0.216, shear=1.0), [ball([0.1, 0.2, 0.3])], degree=3, cells_per_circle=16, growth=0.5)
    assert solved(array).iterations < 50


@pytest.mark.slow
def test_a_cell_in_space_does_not_know_where_it_begins() -> None:
    """u = E x + periodic: a shift by s adds E s. Cut elsewhere, the mesh misses by 1 % and less."""
    s, shear = np.array([1.7, -2.9, 11.3]), 1.0
    moved = [body | {"position": (np.array(body["position"]) + s).tolist()} for body in TWO]
    here, there = (solved(case(OBLIQUE | {"shear": shear}, bodies)) for bodies in (TWO, moved))
    U = here.U.copy()
    U[:, 0] += shear * s[2]
    assert_allclose(there.U, U, rtol=0, atol=2e-2)
    assert there.bulk is not None
    assert here.bulk is not None
    assert there.apparent_viscosity == pytest.approx(here.apparent_viscosity, rel=1e-2)


@pytest.mark.slow
def test_a_sheared_lattice_in_space_returns_at_whole_strains() -> None:
    """Of a cube of side 4 at strain 2 it is that at 0, to the last bit, and so are the mesh and the flow."""
    model = StokesModel(case({"shape": "cell", "vectors": (4.0 * np.eye(3)).tolist(), "shear": 1.0}, TWO))
    container = model.case.container()
    assert container.at(0.5).periods[2].tolist() == [2.0, 0.0, 4.0]
    mu = [model(model.case.configuration(), t).apparent_viscosity for t in (0.0, 2.0)]
    assert mu[1] == pytest.approx(mu[0], rel=1e-12)


def test_between_sliding_walls() -> None:
    """Walls that slide in x and y drag spheres along; the stress on the walls is that of the whole."""
    domain = {
        "lower": [0.0, 0.0, -2.0], "upper": [5.0, 4.0, 2.0], "periodic": ["x", "y"],
        "walls": {"bottom": [-1.0, 0.4, 0.0], "top": [1.0, -0.4, 0.0]},
    }  # fmt: skip
    bodies = [ball([0.2, 3.9, 0.0]), {"name": "small", "radius": 0.7, "position": [2.6, 0.3, 0.8]}]
    found = solved(case(domain, bodies))
    assert max(found.checks.values()) < 1e-9
    assert found.checks["stress"] < 1e-10
    assert 1.2 < (found.apparent_viscosity or 0.0) < 2.0


def test_a_pressure_gradient_between_walls() -> None:
    """A small sphere on the midplane hardly disturbs u = (1 - z^2) U, of the flux 4/3 U L_y."""
    domain = {"lower": [0.0, 0.0, -1.0], "upper": [2.0, 2.0, 1.0], "periodic": ["y", "x"], "net_flux": 4.0}
    small = {"name": "small", "radius": 0.1, "position": [0.0, 1.9, 0.0]}
    found = solved(case(domain, [small]))
    assert found.mean_pressure_gradient is not None
    assert found.mean_pressure_gradient[0] == pytest.approx(-2.0 * 0.7 * 1.5, rel=2e-2)
    assert found.U[0, 0] == pytest.approx(1.5, rel=2e-2)


@pytest.mark.mpi
@pytest.mark.slow
@needs_mpi
@pytest.mark.parametrize("solver", ["direct", "iterative"])
def test_ranks_agree_in_a_cell(tmp_path: Path, solver: str) -> None:
    bodies = [TWO[0] | HELD, TWO[1] | {"force": [0.1, 0.0, -0.3]}]
    path = tmp_path / "case.toml"
    path.write_text(case(OBLIQUE | {"shear": 1.0}, bodies, solver=solver).as_toml())
    found = []
    for ranks in (1, 2, 3):
        shown = json_on(ranks, "solve", path)
        found.append([*np.ravel(shown["mean_stress"]), *shown["bodies"][1]["velocity"]])
    for other in found[1:]:
        assert_allclose(other, found[0], rtol=1e-9, atol=1e-9)
