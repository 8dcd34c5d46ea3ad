"""Which pair a case calibrates, the case at a gap, and the resistance read from results."""

from __future__ import annotations

from math import inf
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fsi.calibration.finding import pair_of
from fsi.case.load import load_case, parse_case
from fsi.errors import InputError
from fsi.integration.errors import ErrorEstimate

CASES = Path(__file__).parents[2] / "cases" / "calibration"


def case_data(**more: Any) -> dict[str, Any]:
    """A disc beside the left wall of a box."""
    return {
        "name": "disc",
        "fluid": {"viscosity": 1.0},
        "domain": {"shape": "box", "lower": [-5.0, -5.0], "upper": [5.0, 5.0]},
        "bodies": [{"name": "disc", "radius": 0.5, "position": [-4.0, 1.0]}],
        "calibration": {"pair": ["disc", "left"], "range": [1e-3, 0.1]},
    } | more


def two(**more: Any) -> dict[str, Any]:
    """Two discs on an inclined line."""
    bodies = [
        {"name": "small", "radius": 0.5, "position": [0.0, 0.0], "mass": 1.0, "moment_of_inertia": 1.0},
        {"name": "large", "radius": 1.0, "position": [1.2, 1.6], "force": [3.0, 0.0]},
    ]
    return case_data(bodies=bodies, calibration={"pair": ["small", "large"], "range": [1e-3, 0.1]} | more)


@pytest.mark.parametrize(
    ("wall", "place"),
    [("left", (-4.45, 1.0)), ("right", (4.45, 1.0)), ("top", (-4.0, 4.45)), ("bottom", (-4.0, -4.45))],
)
def test_a_body_moves_along_the_normal_of_its_wall(wall: str, place: tuple[float, float]) -> None:
    pair = pair_of(parse_case(case_data(calibration={"pair": ["disc", wall], "range": [1e-3, 0.1]})))
    assert_allclose(pair.at(0.05).configuration().centres[0], place, rtol=1e-14)
    assert (pair.ratio, pair.reduced_radius) == (inf, 0.5)


@pytest.mark.parametrize(
    ("mode", "U"), [("squeeze", (1.0, 0.0, 0.0)), ("shear", (0.0, 1.0, 0.0)), ("rotation", (0.0, 0.0, 1.0))]
)
def test_beside_a_wall_the_motion_is_prescribed(mode: str, U: tuple[float, ...]) -> None:
    """And the resistance is its own load, whatever the others are; the error never cancels."""
    plan = {"pair": ["disc", "left"], "range": [1e-3, 0.1], "mode": mode}
    pair = pair_of(parse_case(case_data(calibration=plan)))
    motion = pair.at(0.05).motion(0.0)
    assert np.all(motion.held)
    assert_allclose(motion.U, [U])
    F = 7.0 * np.array([U]) + 100.0 * (np.array([U]) == 0.0)
    errors = ErrorEstimate(np.zeros((1, 3)), 0.1 * np.abs(F))
    assert pair.resistance(0.05, ErrorEstimate(np.array([U]), F), errors) == pytest.approx((7.0, 0.7))


def test_two_bodies_are_pushed_along_their_line_of_centres() -> None:
    pair = pair_of(parse_case(two()))
    case = pair.at(0.05)
    assert_allclose(
        case.configuration().centres, [[1.2 - 0.6 * 1.55, 1.6 - 0.8 * 1.55], [1.2, 1.6]], rtol=1e-14
    )
    motion = case.motion(0.0)
    assert not np.any(motion.held)
    assert_allclose(motion.F, [[-0.6, -0.8, 0.0], [0.6, 0.8, 0.0]])
    assert case.masses() is None
    assert pair.ratio == 2.0
    assert pair.reduced_radius == pytest.approx(1.0 / 3.0)


def test_the_resistance_of_two_bodies_is_one_over_their_speed() -> None:
    """Speed 2e-3 along the line, errors of 1e-5 each: half a per cent, once for each body."""
    pair = pair_of(parse_case(two()))
    normal = np.array([-0.6, -0.8, 0.0])
    U = np.array([1.5e-3 * normal, -0.5e-3 * normal]) + np.array([0.0, 0.0, 9.0])  # turning does not count
    errors = np.array([1e-5 * np.abs(normal), 1e-5 * np.abs(normal)])
    kappa, error = pair.resistance(0.05, ErrorEstimate(U, 0.0 * U), ErrorEstimate(errors, 0.0 * U))
    assert kappa == pytest.approx(500.0)
    assert error == pytest.approx(2e-5 / (2e-3) ** 2)


def test_two_bodies_slide_under_forces_between_their_surfaces() -> None:
    """Radii 0.5 and 1 at 0.06: arms of 0.52 and 1.04 along the line, across which the forces act.

    A rigid motion is no sliding and is felt in no rate; errors add up, those of rotations times the arms.
    """
    pair = pair_of(parse_case(two(mode="shear")))
    motion = pair.at(0.06).motion(0.0)
    assert not np.any(motion.held)
    assert_allclose(motion.F, [[0.8, -0.6, -0.52], [-0.8, 0.6, -1.04]], rtol=1e-14)
    small, large = pair.at(0.06).configuration().centres
    turned = np.array([[-3.0 * small[1], 3.0 * small[0], 3.0], [-3.0 * large[1], 3.0 * large[0], 3.0]])
    sliding = np.array([[0.8e-2, -0.6e-2, 0.0], [0.0, 0.0, 0.0]])
    U, errors = turned + sliding, np.full((2, 3), 1e-5)
    kappa, error = pair.resistance(0.06, ErrorEstimate(U, 0.0 * U), ErrorEstimate(errors, 0.0 * U))
    assert kappa == pytest.approx(100.0)
    assert error == pytest.approx(1e-5 * (2.8 + 1.56) * 100.0**2)


def test_two_equal_bodies_roll_under_a_couple() -> None:
    bodies = [dict(body, radius=0.9) for body in two()["bodies"]]
    pair = pair_of(parse_case(two(mode="rotation") | {"bodies": bodies}))
    assert_allclose(pair.at(0.05).motion(0.0).F, [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]])
    U = np.array([[5.0, 1.0, 0.03], [-5.0, 2.0, -0.01]])
    kappa, _ = pair.resistance(0.05, ErrorEstimate(U, 0.0 * U), ErrorEstimate(0.0 * U, 0.0 * U))
    assert kappa == pytest.approx(25.0)


@pytest.mark.parametrize("path", sorted(CASES.glob("*.toml")), ids=lambda path: path.stem)
def test_the_shipped_cases_are_sound(path: Path) -> None:
    pair = pair_of(load_case(path))
    shape = "shapes" if "tip" in path.stem else "spheres" if "sphere" in path.stem else "discs"
    assert pair.shape == shape
    assert (pair.ratio == inf) is ("wall" in path.stem)
    q = pair.at(1e-3).configuration()
    if pair.second is not None:
        assert np.linalg.norm(q.centres[0] - q.centres[1]) - q.radii.sum() == pytest.approx(1e-3, rel=1e-12)


CLOSE = {"lower": [-9.0, 0.0], "upper": [9.0, 99.0]}
BESIDE = [{"name": name, "radius": 1.0, "position": place} for name, place in (("s", [0, 2]), ("t", [0, 5]))]


@pytest.mark.parametrize(
    ("domain", "bodies", "pair", "confined"),
    [
        ({"shape": "half-plane", "radius": 1e3}, BESIDE[:1], ["s", "plane"], False),
        ({"shape": "round", "radius": 1e3}, BESIDE, ["s", "t"], False),
        ({"shape": "half-plane", "radius": 1e3}, BESIDE, ["s", "t"], True),
        ({"shape": "half-plane", "radius": 7.0}, BESIDE[:1], ["s", "plane"], True),
        (CLOSE, BESIDE[:1], ["s", "bottom"], True),
    ],
)
def test_what_is_beside_the_pair_confines_it(
    domain: dict[str, Any], bodies: list[dict[str, Any]], pair: list[str], *, confined: bool
) -> None:
    """A radius of 1000 stands for infinity, one of 7 does not (`fsi.observables.truncation`)."""
    plan = {"pair": pair, "range": [1e-3, 1.0]}
    data = case_data(domain=domain, bodies=bodies, calibration=plan)
    assert pair_of(parse_case(data)).confined is confined


def test_forces_between_bodies_do_not_count() -> None:
    """A repulsion that pushes with the unit forces would pass for a smaller resistance."""
    repulsion = {"kind": "repulsion", "law": "exponential", "strength": 1.0, "length": 0.1, "cutoff": 1.0}
    case = pair_of(parse_case(two() | {"forces": [repulsion]})).at(0.05)
    assert_allclose(case.motion_at(case.configuration(), 0.0).F, [[-0.6, -0.8, 0.0], [0.6, 0.8, 0.0]])


PLAN = {"pair": ["disc", "left"], "range": [1e-3, 0.1]}
PAIR: list[dict[str, Any]] = [
    {"name": "small", "radius": 0.5, "position": [0.0, 0.0]},
    {"name": "large", "radius": 1.0, "position": [1.2, 1.6]},
]
CELL = {"shape": "cell", "vectors": [[9.0, 0.0], [0.0, 9.0]]}
DRIVEN = {"lower": [-5.0, -5.0], "upper": [5.0, 5.0], "periodic": ["x"], "pressure_gradient": 2.0}
FLOWING = {"lower": [-5.0, -5.0], "upper": [5.0, 5.0], "periodic": ["x"], "net_flux": 2.0}
SLIDING = {"lower": [-5.0, -5.0], "upper": [5.0, 5.0], "walls": {"left": {"slip_length": 0.1}}}
MOVING = {"shape": "box", "lower": [-5.0, -5.0], "upper": [5.0, 5.0], "walls": {"top": [1.0, 0.0]}}
ROUND = {
    "domain": {"shape": "half-plane", "radius": 9.0},
    "bodies": [{"name": "disc", "radius": 0.5, "position": [0.0, 2.0]}],
}
FAR = {"domain": {"shape": "round", "radius": 99.0}}


def planned(**plan: Any) -> dict[str, Any]:
    return case_data(calibration=PLAN | plan)


@pytest.mark.parametrize(
    ("data", "complaint"),
    [
        (planned(pair=["disk", "left"]), r"no body is named 'disk'; the bodies are \[\"disc\"\]"),
        (planned() | {"domain": SLIDING}, "domain.walls.left.slip_length = 0.1: laws of gaps are those of"),
        (planned(pair=["disc", "disc"]), "'disc' is no other body and no wall; use one of"),
        (planned(range=[0.1, 1e-3]), "calibration.range = .* is not a range of positive gaps"),
        (planned(range=[0.1, 0.1005]), "tells no terms apart; give an upper end 1.01 times the lower"),
        (
            planned(range=[0.5, 2.0], samples=6),  # three of these are below 1
            r"range = \[0\.5, 2\.0\]: a series takes 4 samples .* below the smaller diameter, 1; .*table",
        ),
        (planned(range=[1e-3, 20.0]), "at the gap 20 the case is not sound: .*crosses wall"),
        (
            planned(range=[4e-9, 0.1]),
            r"calibration\.range\.0 = 4e-09: .* 8e-09 radii, below .*; begin at a wider",
        ),
        (planned(range=[1e-12, 0.1]), r"calibration\.range\.0 = 1e-12: .* radii, below the 1e-08 that are"),
        (
            planned(samples=6, held_out=6),
            r"held_out = 6: there are 5 gaps between 6 samples; give .* fewer than",
        ),
        (planned(mode="sheer"), 'calibration.mode = "sheer": not one of the choices'),
        (two(mode="rotation"), 'calibration.mode = "rotation": bodies of two radii slide'),
        (two(pair=["small", "left"]), "the case has 2 bodies; drop those"),
        (planned(pair=["disc", "far"]) | ROUND, r'"far": this wall is not plane; use one of \["plane"\]$'),
        (planned(pair=["disc", "top"]) | ROUND, r"no other body and no wall; use one of \[\"plane\"\]$"),
        (two(pair=["small", "round"]), r"no other body and no wall; use one of \[\"large\"\]$"),
        (two(pair=["small", "far"]) | FAR, r"this wall is not plane; use one of \[\"large\"\]$"),
        (planned(pair=["disc", "far"]) | FAR, "give a second body, or a domain with a plane wall$"),
        (two() | {"domain": DRIVEN}, "domain.pressure_gradient = 2.0: .* needs fluid at rest"),
        (two() | {"domain": FLOWING}, "domain.net_flux = 2.0: .* needs fluid at rest"),
        (two() | {"domain": FLOWING | {"net_flux": 0.0}}, "net_flux = 0.0: .* no pressure drop, not a given"),
        (planned() | {"domain": MOVING}, "domain.walls.top = .* needs walls at rest"),
    ],
)
def test_mistakes(data: dict[str, Any], complaint: str) -> None:
    with pytest.raises(InputError, match=complaint):
        pair_of(parse_case(data))


@pytest.mark.parametrize("key", ["shear", "extension", "stress"])
def test_no_flow_carries_a_pair_of_a_cell(key: str) -> None:
    """A stress 1 would make of this pair's resistance 43.38 at the gap 0.3 one of 4.845 (regressions)."""
    pair_of(parse_case(two() | {"domain": CELL, "bodies": PAIR}))
    with pytest.raises(InputError, match=f"domain.{key} = 0.5: a resistance needs fluid at rest"):
        pair_of(parse_case(two() | {"domain": CELL | {key: 0.5}, "bodies": PAIR}))


def test_no_uniaxial_flow_carries_a_pair_of_a_cell_in_space() -> None:
    cell = {"shape": "cell", "vectors": (9.0 * np.eye(3)).tolist(), "uniaxial": 0.5}
    bodies = [body | {"position": [*body["position"], 0.0]} for body in PAIR]
    data = two() | {"geometry": "spatial", "domain": cell, "bodies": bodies}
    with pytest.raises(InputError, match=r"domain\.uniaxial = 0.5: a resistance needs fluid at rest"):
        pair_of(parse_case(data))


@pytest.mark.parametrize("z", [0.0, 3.0])
@pytest.mark.parametrize(
    ("geometry", "domain", "wall"),
    [
        ("axisymmetric", {"shape": "round", "radius": 100.0}, "far"),
        ("planar", {"shape": "round", "radius": 100.0}, "far"),
        ("axisymmetric", {"lower": [0.0, -9.0], "upper": [9.0, 9.0]}, "right"),
    ],
)
def test_a_wall_that_is_round_is_not_plane_wherever_the_body_is(
    geometry: str, domain: dict[str, Any], wall: str, z: float
) -> None:
    """At the centre, and on the axis of a cylinder, the distance falls as beside a plane."""
    body = {"name": "s", "radius": 1.0, "position": [0.0, z]}
    plan = {"pair": ["s", wall], "range": [0.1, 1.0]}
    data = case_data(geometry=geometry, domain=domain, bodies=[body], calibration=plan)
    with pytest.raises(InputError, match=f'calibration.pair.1 = "{wall}": this wall is not plane'):
        pair_of(parse_case(data))


def test_a_case_without_the_section() -> None:
    data = case_data()
    del data["calibration"]
    with pytest.raises(InputError, match="calibration: missing; give a section"):
        pair_of(parse_case(data))
