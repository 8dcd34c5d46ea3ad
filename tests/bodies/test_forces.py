"""External forces as laws of the gap."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.case.case import Case
from fsi.case.load import parse_case
from fsi.errors import InputError
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.round import HalfPlane, Round
from fsi.runs import run
from tests.case_data import changed
from tests.exact_model import DiscsBesidePlane, by, plane_case

EXPONENTIAL = {"kind": "repulsion", "law": "exponential", "strength": 3.0, "length": 0.2, "cutoff": 5.0}
POWER = {"kind": "attraction", "law": "power", "strength": 3.0, "length": 0.2, "exponent": 2.0, "cutoff": 5.0}
TABLE = {"kind": "repulsion", "law": "table", "gaps": [0.1, 1.0, 2.0], "values": [4.0, 1.0, -1.0]}


def two_discs(gap: float, *forces: dict[str, Any], **second: Any) -> Case:
    """Discs of radii 1 and 0.5 in a box, `gap` apart along the direction (3, 4)/5, far from its walls."""
    across = 1.5 + gap
    bodies = [
        {"name": "one", "radius": 1.0, "position": [0.0, 0.0]},
        {"name": "two", "radius": 0.5, "position": [0.6 * across, 0.8 * across]} | second,
    ]
    domain = {"lower": [-50.0, -50.0], "upper": [50.0, 50.0]}
    return parse_case(
        {"name": "t", "fluid": {"viscosity": 1.0}, "domain": domain, "bodies": bodies, "forces": list(forces)}
    )


def loads(case: Case) -> Array:
    return case.motion_at(case.configuration(), 0.0).F


@pytest.mark.parametrize(
    ("force", "gap", "repulsion"),
    [
        (EXPONENTIAL, 0.3, 3.0 * math.exp(-1.5)),
        (EXPONENTIAL | {"kind": "attraction"}, 0.3, -3.0 * math.exp(-1.5)),
        (EXPONENTIAL | {"cutoff": 0.29}, 0.3, 0.0),
        (POWER, 0.3, -3.0 * (0.2 / 0.3) ** 2),
        (TABLE, 0.05, 4.0),
        (TABLE, 0.4, 3.0),
        (TABLE, 1.5, 0.0),
        (TABLE, 1.8, -0.6),
        (TABLE, 2.1, 0.0),
    ],
)
def test_laws(force: dict[str, Any], gap: float, repulsion: float) -> None:
    """By hand, along the line of centres."""
    expected = repulsion * np.array([[-0.6, -0.8, 0.0], [0.6, 0.8, 0.0]])
    np.testing.assert_allclose(loads(two_discs(gap, force)), expected, rtol=1e-12, atol=1e-14)


def test_forces_add_to_each_other_and_to_own_loads_but_not_on_held_components() -> None:
    case = two_discs(0.3, EXPONENTIAL, TABLE, force=[7.0, 0.0], velocity=["free", 0.0])
    f = 3.0 * math.exp(-1.5) + (4.0 - 3.0 * 0.2 / 0.9)
    np.testing.assert_allclose(
        loads(case), [[-0.6 * f, -0.8 * f, 0.0], [7.0 + 0.6 * f, 0.0, 0.0]], rtol=1e-12
    )
    np.testing.assert_array_equal(case.motion(0.0).F, [[0.0, 0.0, 0.0], [7.0, 0.0, 0.0]])


def test_gravity_acts_on_masses_or_on_areas() -> None:
    heavy = {"mass": 2.0, "moment_of_inertia": 1.0}
    by_mass = two_discs(0.3, {"kind": "gravity", "acceleration": [0.0, -9.81]}, **heavy)
    np.testing.assert_allclose(loads(by_mass)[:, 1], [0.0, -2.0 * 9.81])
    of_area = {"kind": "gravity", "acceleration": [0.0, -9.81], "density_difference": 0.1}
    np.testing.assert_allclose(loads(two_discs(0.3, of_area))[:, 1], [-0.981 * math.pi, -0.981 * math.pi / 4])


def test_on_an_axis_bodies_are_spheres() -> None:
    gravity = {"kind": "gravity", "acceleration": [0.0, -1.0], "density_difference": 0.5}
    case = parse_case(
        {
            "name": "t",
            "geometry": "axisymmetric",
            "fluid": {"viscosity": 1.0},
            "domain": {"shape": "half-plane", "radius": 100.0},
            "bodies": [{"name": "ball", "radius": 2.0, "position": [0.0, 3.0]}],
            "forces": [gravity, {**EXPONENTIAL, "walls": True}],
        }
    )
    weight = 0.5 * 4.0 / 3.0 * math.pi * 8.0
    np.testing.assert_allclose(loads(case), [[0.0, 3.0 * math.exp(-5.0) - weight, 0.0]])


@settings(max_examples=60)
@given(
    seed=st.integers(0, 10**6), number=st.integers(2, 12), law=st.sampled_from([EXPONENTIAL, POWER, TABLE])
)
def test_action_is_reaction_and_nothing_turns(seed: int, number: int, law: dict[str, Any]) -> None:
    """Sum of forces and of torques about the origin vanish to rounding, whatever the arrangement."""
    rng = np.random.default_rng(seed)
    places = [
        (4.0 * k + rng.uniform(-0.9, 0.9), 4.0 * m + rng.uniform(-0.9, 0.9))
        for k in range(4)
        for m in range(3)
    ]
    bodies = [
        {"name": f"b{k}", "radius": float(rng.uniform(0.2, 1.05)), "position": list(places[k])}
        for k in range(number)
    ]
    data = changed("bodies", bodies) | {
        "forces": [law],
        "domain": {"lower": [-50.0] * 2, "upper": [50.0] * 2},
    }
    case = parse_case(data)
    F = loads(case)[:, :2]
    size = np.abs(F).max(initial=1e-300)
    x = case.configuration().centres
    assert np.abs(F.sum(axis=0)).max() <= 1e-14 * number * size
    assert abs(np.sum(x[:, 0] * F[:, 1] - x[:, 1] * F[:, 0])) <= 1e-12 * number * size


@settings(max_examples=30)
@given(turn=st.floats(0.0, 6.3))
def test_forces_turn_with_the_bodies(turn: float) -> None:
    case = two_discs(0.3, EXPONENTIAL, POWER)
    q = case.configuration()
    R = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
    turned = case.motion_at(Configuration(q.centres @ R.T, q.angles, q.radii), 0.0).F[:, :2]
    np.testing.assert_allclose(turned, loads(case)[:, :2] @ R.T, atol=1e-13)


@pytest.mark.parametrize(
    "container",
    [Box((-3.0, -2.0), (4.0, 5.0)), Box((0.0, -2.0), (4.0, 5.0), True), HalfPlane(6.0), Round(6.0)],
)
def test_normals_are_gradients_of_the_distances(container: Container) -> None:
    x, h = np.array([[1.0, 2.0], [0.3, 0.7]]), 1e-6
    steps = h * np.eye(2)
    slopes = [(container.distances(x + step) - container.distances(x - step)) / (2 * h) for step in steps]
    np.testing.assert_allclose(container.normals(x), np.stack(slopes, axis=2), atol=1e-9)


def test_a_disc_floats_where_repulsion_carries_its_weight(tmp_path: Path) -> None:
    """At rest f(d) = weight, so d = l ln(F0 / weight), at which it arrives from above."""
    forces = [
        {**EXPONENTIAL, "walls": True},
        {"kind": "gravity", "acceleration": [0.0, -1.0], "density_difference": 1.0},
    ]
    body = {"name": "disc", "radius": 0.5, "position": [0.0, 1.2]}
    start = plane_case([body], 200.0)
    case = parse_case(start.model_dump(exclude_none=True) | {"forces": forces})
    outcome = run(case, tmp_path / "run", make=by(DiscsBesidePlane))
    expected = 0.2 * math.log(3.0 / (math.pi / 4))
    assert outcome.state.q.centres[0, 1] - 0.5 == pytest.approx(expected, rel=1e-3)


def test_across_a_periodic_side_the_nearest_image_acts() -> None:
    bodies = [
        {"name": "a", "radius": 1.0, "position": [0.5, 5.0]},
        {"name": "b", "radius": 1.0, "position": [9.0, 5.0]},
    ]
    domain = {"lower": [0.0, 0.0], "upper": [10.8, 10.0], "periodic": ["x"]}
    case = parse_case(
        changed("bodies", bodies) | {"domain": domain, "forces": [{**EXPONENTIAL, "cutoff": 1.0}]}
    )
    f = 3.0 * math.exp(-(10.8 - 8.5 - 2.0) / 0.2)
    np.testing.assert_allclose(loads(case)[:, 0], [f, -f])


@pytest.mark.parametrize(
    ("force", "parts"),
    [
        ({"kind": "repulsion"}, ["forces.0.law", "missing"]),
        ({"kind": "repulsed", "law": "power"}, ["forces.0.kind"]),
        ({**EXPONENTIAL, "law": "exponental"}, ["forces.0.law", '"exponental"']),
        ({**EXPONENTIAL, "length": 0.0}, ["forces.0.length = 0.0", "greater than 0"]),
        ({**EXPONENTIAL, "lenght": 1.0}, ["forces.0.lenght", "use forces.0.length"]),
        ({k: v for k, v in POWER.items() if k != "cutoff"}, ["forces.0.cutoff", "missing"]),
        ({**TABLE, "gaps": [0.1, 1.0, 0.5]}, ["forces.0.gaps", "must increase"]),
        ({**TABLE, "values": [1.0]}, ["3 gaps but 1 values"]),
        ({"kind": "gravity"}, ["forces.0.acceleration", "missing"]),
        ({"kind": "gravity", "acceleration": [0.0, -1.0]}, ["no body has a mass", "density_difference"]),
        ({"kind": "gravity", "acceleration": [0.0, 0.0, -1.0], "density_difference": 1.0}, ["give 2"]),
    ],
)
def test_mistakes(force: dict[str, Any], parts: list[str]) -> None:
    with pytest.raises(InputError) as caught:
        two_discs(0.3, force)
    assert "\n" not in str(caught.value)
    for part in parts:
        assert part in str(caught.value)


def test_forces_are_kept_in_the_resolved_case() -> None:
    case = two_discs(0.3, EXPONENTIAL, POWER, TABLE)
    assert parse_case(tomllib.loads(case.as_toml())) == case


@pytest.mark.parametrize(("cutoff", "force"), [(0.5, 3.0 * math.exp(-2.0)), (0.39, 0.0)])
@pytest.mark.parametrize("kind", ["repulsion", "attraction"])
def test_the_force_of_a_wall_ends_at_the_cutoff_too(kind: str, cutoff: float, force: float) -> None:
    """Gap 0.4, length 0.2, by hand; and what it carries: from the wall to the centre, 1 + 0.4 away."""
    sign = 1.0 if kind == "repulsion" else -1.0
    law = EXPONENTIAL | {"kind": kind, "cutoff": cutoff, "walls": True}
    case = two_discs(30.0, law)
    q = Configuration.unturned(np.array([[0.0, -50.0 + 1.4], [0.0, 20.0]]), case.configuration().radii)
    F = case.motion_at(q, 0.0).F
    np.testing.assert_allclose(F, [[0.0, sign * force, 0.0], [0.0, 0.0, 0.0]], atol=1e-15)
    moment = case.interaction_moment(q, 0.0)
    np.testing.assert_allclose(moment, [[0.0, 0.0], [0.0, sign * force * 1.4]], atol=1e-15)
