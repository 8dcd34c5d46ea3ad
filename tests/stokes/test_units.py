"""The same problem in other units: the same mesh, the same digits."""

import numpy as np
import pytest

import fsi
from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.case.case import Case
from fsi.meshes.errors import MeshError
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.curves import rescaled
from fsi.meshes.geometry.ellipsoid import Ellipsoid, PlacedEllipsoid
from fsi.meshes.geometry.stretched import Stretched
from fsi.stokes.meshes import CaseMeshes
from fsi.stokes.model import StokesModel
from fsi.stokes.resistance import case_resistance
from fsi.stokes.units import Units
from tests.units import ONE, SYSTEMS, System, arms, axisymmetric, cell, channel, planar, spatial

CASES = {one.__name__: one for one in (planar, axisymmetric, spatial, cell, channel)}
# Rounding of the solve: 3e-11 of a pressure in a gap. Another mesh of the same sizes changes 1e-5.
SAME = 1e-10
_known: dict[str, dict[str, Array]] = {}

pytestmark = pytest.mark.filterwarnings("error")


def solved(kind: str, s: System) -> dict[str, Array]:
    """Everything that a solve gives, over its unit."""
    case = fsi.make_case(**CASES[kind](s))
    solution = StokesModel(case)(case.configuration(), 0.0)
    d, F, M = case.dimension, s.force(case.geometry), solution.U.shape[1]
    V, flow, surface, arm = s.velocity, solution.flow, solution.surface, arms(M, case.dimension, s.length)
    found = {
        "U": solution.U * arm / V,
        "F": solution.F / arm / F,
        "traction_F": solution.traction_F / arm / F,
        "dissipation": np.array(solution.dissipation) / (F * V),
        "x": flow.x / s.length,
        "u": flow.u / V,
        "p": flow.p / s.stress,
        "reaction": surface.reaction / F,
        "traction": solution.traction / s.stress,
    }
    u, p = solution.evaluate(s.length * np.array([[0.3, 1.9, 0.4][:d]]))
    found |= {"u at a point": u / V, "p at a point": p / s.stress}
    if solution.bulk is not None:
        S = solution.bulk.stresslets / (F * s.length)
        found |= {"stress": solution.bulk.mean / s.stress, "stresslets": S}
        found["viscosity"] = np.array(solution.apparent_viscosity)
    return found


@pytest.mark.parametrize("s", SYSTEMS, ids=str)
@pytest.mark.parametrize("kind", CASES)
def test_all_that_a_solve_gives_scales_with_its_units(kind: str, s: System) -> None:
    expected = _known.setdefault(kind, solved(kind, ONE))
    found = solved(kind, s)
    # Loads of free bodies are the given ones; of force-free ones they are rounding, beside tractions of one.
    for name, value in expected.items():
        largest = max(1.0, float(np.abs(value).max())) if name in ("F", "traction_F") else np.abs(value).max()
        np.testing.assert_allclose(found[name], value, rtol=0.0, atol=SAME * largest, err_msg=name)


@pytest.mark.parametrize("s", SYSTEMS[2:5], ids=str)
def test_error_bars_and_resistances_scale_with_their_units(s: System) -> None:
    bars, R, mobility = [], [], []
    for one in (ONE, s):
        case = fsi.make_case(**planar(one))
        q, model = case.configuration(), StokesModel(case)
        errors = model.errors(q, 0.0, model(q, 0.0)).errors
        arm = arms(3, 2, one.length)
        bars.append(errors.U * arm / one.velocity)
        found = case_resistance(case)
        arm = np.tile(arm, 2)
        R.append(found.R / np.outer(arm, arm) / one.viscosity)
        assert found.mobility is not None
        mobility.append(found.mobility * np.outer(arm, arm) * one.viscosity)
    # A bar is a difference of two solutions; beside the velocities of one it has their rounding.
    np.testing.assert_allclose(bars[1], bars[0], rtol=0.0, atol=SAME)
    np.testing.assert_allclose(R[1], R[0], rtol=0.0, atol=SAME * np.abs(R[0]).max())
    np.testing.assert_allclose(mobility[1], mobility[0], rtol=0.0, atol=SAME * np.abs(mobility[0]).max())


def test_lengths_of_other_units_are_the_same_numbers() -> None:
    x = np.array([[2.1, -0.7], [1.1, 1.00000001]])
    for unit in (1e3, 1e-9, 0.0254, 3.7):
        assert np.array_equal(rescaled(unit * x, 1.0 / unit), x)
    assert rescaled(0.1 + 0.2, 1.0) == 0.3 != 0.1 + 0.2


@pytest.mark.parametrize("unit", [1e-9, 0.0254, 3.7])
def test_ellipsoids_of_other_units_are_the_same_numbers(unit: float) -> None:
    """One whose last bit was another one had another mesh, and velocities that differed by 7e-5."""
    axes, centre = np.array([1.0, 0.6, 0.5]), np.array([1.5, 0.3, -0.6])
    body = PlacedEllipsoid(Ellipsoid(unit * axes), unit * centre, np.zeros(3)).rescaled(1.0 / unit)
    np.testing.assert_array_equal(body.form.half_axes, axes)
    np.testing.assert_array_equal(body.centre, centre)


def test_a_place_in_a_message_is_in_the_users_units() -> None:
    error = MeshError("the disc at {} touches; sizes {}", np.array([1.5, -2.0]), 0.25)
    assert str(error) == "the disc at (1.5, -2) touches; sizes 0.25"
    assert str(error.in_units(1000.0)) == "the disc at (1500, -2000) touches; sizes 250"
    assert str(error.in_units(1000.0, np.array([1.0, 2.0]))) == "the disc at (1501, -1998) touches; sizes 250"
    case = fsi.make_case(**planar(SYSTEMS[0]))
    apart = case.configuration()
    touching = Configuration.unturned(apart.centres - np.array([[0.0, 0.0], [400.0, 0.0]]), apart.radii)
    with pytest.raises(MeshError, match=r"the disc at \(-1100, 0\) touches"):
        CaseMeshes(case).scaled_mesh(touching)


def test_a_stretched_container_answers_as_one_that_knows_its_numbers() -> None:
    box, x = Box((-1.0, -2.0), (3.0, 5.0)), np.array([[2.0, 4.0], [-1.0, 6.0]])
    one, other = Stretched(box, 2.0), box.scaled(2.0)
    assert isinstance(other, Box)
    for name in ("distances", "normals"):
        np.testing.assert_array_equal(getattr(one, name)(x), getattr(other, name)(x))
    for name in ("walls", "corner_axes", "volume", "faces", "periods", "middle"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    assert one.size() == other.size()
    for piece, expected in zip(one.outline(), other.outline(), strict=True):
        s = np.linspace(*expected.interval, 5)
        np.testing.assert_array_equal(piece.at(s), expected.at(s))
        assert piece.interval == expected.interval
        assert piece.longest_element == expected.longest_element


def in_corner(x: float, y: float, gap: float, shear: float = 0.0) -> Case:
    """A disc in the lower left corner (x, y) of a box that it leaves, below a lid with u = shear y."""
    body = {"name": "disc", "radius": 1.0, "position": [x + 1.0 + gap, y + 1.0 + gap]}
    box = {"lower": [x, y], "upper": [x + 16.0, y + 16.0], "walls": {"top": {"shear": shear}}}
    moves = {"velocity": [1.0, 1.0], "angular_velocity": 0.5}
    fluid = {"viscosity": 1.0}
    return fsi.make_case(name="in a corner", fluid=fluid, domain=box, bodies=[body | moves])


def test_a_gap_far_from_the_origin_is_solved_as_at_it() -> None:
    """With the user's origin forces at (-8, 3) are 4e-6 off; its doubles know the gap to 1e-15 / gap.

    The lid's velocity is shear times the user's y; fields, meshes and points are in the user's coordinates.
    """
    gap = 1e-7
    at, far = in_corner(0.0, 0.0, gap, 9.5 / 16.0), in_corner(-8.0, 3.0, gap, 9.5 / 19.0)
    corner = np.array([-8.0, 3.0])
    models = StokesModel(at), StokesModel(far)
    np.testing.assert_array_equal(models[0].units.origin, [0.0, 0.0])
    np.testing.assert_array_equal(models[1].units.origin, corner)
    one, other = [model(model.case.configuration(), 0.0) for model in models]
    np.testing.assert_allclose(other.F, one.F, rtol=0.0, atol=3.0 * 1e-15 / gap * np.abs(one.F).max())
    np.testing.assert_allclose(other.flow.x.min(axis=0), corner, atol=1e-14)
    np.testing.assert_allclose(other.surface.x.mean(axis=0), one.surface.x.mean(axis=0) + corner, rtol=1e-7)
    x = np.array([[5.0, 7.0], [11.0, 15.5]])
    np.testing.assert_allclose(other.evaluate(x + corner)[0], one.evaluate(x)[0], rtol=1e-6)
    nodes = models[1].meshes.mesh(far.configuration()).mesh.geometry.x[:, :2]
    np.testing.assert_allclose([nodes.min(axis=0), nodes.max(axis=0)], [corner, corner + 16.0], atol=1e-14)


def beside_an_opening(x: float) -> Case:
    """A disc in a box from (x - 4, 0) on with an open wall: cells are smallest in its corners."""
    box = {"lower": [x - 4.0, 0.0], "upper": [x + 3.0, 6.0], "walls": {"left": {"pressure": 0.7}}}
    body = {"name": "disc", "radius": 1.0, "position": [x - 1.0, 1.3], "force": [0.3, -1.0]}
    sizes = {"degree": 2, "growth": 0.3}
    return fsi.make_case(name="t", fluid={"viscosity": 1.0}, domain=box, bodies=[body], discretisation=sizes)


def test_a_box_far_from_the_origin_is_solved_as_at_it() -> None:
    """With the user's origin gmsh loses a part of the boundary.

    Middles are doubles: x = 2^17 - 1 is known to 1e-11. Another mesh changes 1e-5.
    """
    at, far = (StokesModel(beside_an_opening(x)) for x in (0.0, 131072.0))
    np.testing.assert_array_equal(far.units.origin, [131071.5, 3.0])
    one, other = [model(model.case.configuration(), 0.0).U for model in (at, far)]
    np.testing.assert_allclose(other, one, rtol=0.0, atol=2e-5 * np.abs(one).max())


def test_a_sphere_in_a_narrow_tube_is_solved() -> None:
    """Its gap is beside the axis, on which the origin stays; moved, gmsh would make no triangles.

    Lubrication: what it displaces, V / 2 along the gap h = c + z^2 / 2, needs the pressure 12 mu (V / 2)
    int dz / h^3, so that F = (9 sqrt(2) pi^2 / 4) mu V c^(-5/2) (1 + O(c)).
    """
    tube = {"lower": [0.0, 40.0], "upper": [1.00001, 50.0]}
    body = {"name": "sphere", "radius": 1.0, "position": [0.0, 45.0], "velocity": [0.0, 1.0]}
    fluid, sizes = {"viscosity": 1.0}, {"degree": 2, "growth": 1.0}
    case = fsi.make_case(
        name="t", geometry="axisymmetric", fluid=fluid, domain=tube, bodies=[body], discretisation=sizes
    )
    model = StokesModel(case)
    np.testing.assert_allclose(model.units.origin, [0.0, 45.0])
    expected = 9.0 * np.sqrt(2.0) * np.pi**2 / 4.0 * 1e-5**-2.5
    assert model(case.configuration(), 0.0).F[0, 1] == pytest.approx(expected, rel=1e-3)


def test_the_origin_is_moved_for_narrow_gaps_and_far_away_in_boxes_alone() -> None:
    assert not Units.of(in_corner(-8.0, 3.0, 1e-4)).origin.any()
    np.testing.assert_array_equal(Units.of(in_corner(-800.0, 3.0, 1e-4)).origin, [-792.0, 11.0])
    narrow, between = in_corner(-8.0, 3.0, 1e-7), [-2.0, 9.0]
    pair = [{"name": n, "radius": 1.0, "position": [x, 9.0]} for n, x in (("a", -3.0), ("b", -1.0 + 1e-6))]
    data = narrow.model_dump(exclude_none=True)
    of_pair = fsi.make_case(**data | {"bodies": pair})
    np.testing.assert_allclose(Units.of(of_pair).origin, between, atol=2e-6)
    periodic = data["domain"] | {"periodic": ["x"], "walls": {}}
    assert not Units.of(fsi.make_case(**data | {"domain": periodic})).origin.any()
    for shape in ("half-plane", "round"):
        domain = {"shape": shape, "radius": 99.0}
        assert not Units.of(fsi.make_case(**data | {"domain": domain, "bodies": pair})).origin.any()
