"""The reduced model as a model like any other: motions that are known exactly."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline

from fsi.errors import InputError, SolveError
from fsi.lubrication import exact, spheres
from fsi.models import make_model, make_stepper
from fsi.reduced.gap_laws import Films, make_laws
from tests.reduced_data import INERTIA, heap, reduced_case

SETTLING = json.loads((Path(__file__).parents[1] / "reference" / "settling.json").read_text())
CUT = 1.5


@pytest.mark.parametrize("kind", ["disc", "sphere", "sphere in space"])
def test_settling_with_the_exact_law(kind: str) -> None:
    """Drag of the body at the cutoff, and the law less it: together the exact law, whose times are known.

    The leading law alone would be off by 10 % at gap 0.1.
    """
    is_disc = kind == "disc"
    resistance = exact.normal_resistance if is_disc else spheres.normal_resistance
    unit = 4.0 * math.pi if is_disc else 6.0 * math.pi
    tau = SETTLING[kind.split()[0]]["tau"]
    zero = [0.0] * (2 if kind == "sphere in space" else 1)
    body = {"name": "body", "radius": 1.0, "position": [*zero, 2.0], "force": [*zero, -unit]}
    case = reduced_case(
        [body],
        {"law": "exact", "drag": float(resistance(CUT, 1.0, 1.0)), "cutoff": CUT},
        geometry={"disc": "planar", "sphere": "axisymmetric", "sphere in space": "spatial"}[kind],
        time={"end": 1.01 * tau["0.1"], "tolerance": 1e-5},
    )
    stepper = make_stepper(case, make_model(case))
    step = stepper.start(case.configuration())
    t, gap, speed = [0.0], [1.0], [float(step.instant.U[0, len(zero)])]
    while step.state.t < stepper.schedule.end:
        step = stepper.advance(step.state)
        t.append(step.state.t)
        gap.append(step.state.q.centres[0, -1] - 1.0)
        speed.append(float(step.instant.U[0, len(zero)]))
    for s in ("0.5", "0.1"):
        found = CubicHermiteSpline(t, gap, speed).solve(float(s), extrapolate=False)
        assert found == pytest.approx([tau[s]], rel=1e-3)


def test_a_sphere_settles_in_a_box_as_beside_a_plane_and_drifts_and_turns_with_its_drag() -> None:
    """Walls further than the cutoff do not act. The times to gaps 0.5 and 0.1 are exact."""
    drag = float(spheres.normal_resistance(CUT, 1.0, 1.0))
    body = {"name": "ball", "radius": 1.0, "position": [0.3, -0.2, 1.5], "torque": [0.0, 2.0, 0.0]}
    case = reduced_case(
        [body | {"force": [5.0, 0.0, -6.0 * math.pi]}],
        {"law": "exact", "drag": drag, "cutoff": CUT},
        geometry="spatial",
        domain={"lower": [-5.0, -5.0, 0.0], "upper": [5.0, 5.0, 9.0]},
        time={"end": 10.0, "tolerance": 1e-5},
    )
    stepper = make_stepper(case, make_model(case))
    step = stepper.start(case.configuration())
    t, gap, speed = [0.0], [0.5], [float(step.instant.U[0, 2])]
    while gap[-1] > 0.1:
        step = stepper.advance(step.state)
        t.append(step.state.t)
        gap.append(float(step.state.q.centres[0, 2]) - 1.0)
        speed.append(float(step.instant.U[0, 2]))
    found = CubicHermiteSpline(t, gap, speed).solve(0.1, extrapolate=False)
    tau = SETTLING["sphere"]["tau"]
    assert found == pytest.approx([tau["0.1"] - tau["0.5"]], rel=1e-3)
    assert step.state.q.centres[0, :2] == pytest.approx([0.3 + 5.0 / drag * t[-1], -0.2])
    assert step.state.q.angles[0] == pytest.approx([0.0, 2.0 / (8.0 * math.pi) * t[-1], 0.0])


def test_a_sphere_at_the_cutoff_feels_its_drag_and_a_turning_one_its_own() -> None:
    body = {"name": "ball", "radius": 2.0, "position": [0.0, 0.0, 9.0], "force": [3.0, 0.0, 1.0]}
    case = reduced_case([body | {"torque": [0.0, 5.0, 0.0]}], {"cutoff": 1.0}, geometry="spatial")
    U = make_model(case)(case.configuration(), 0.0).U
    assert U[0, :3] == pytest.approx(np.array([3.0, 0.0, 1.0]) / (6.0 * math.pi * 2.0))
    assert U[0, 4] == pytest.approx(5.0 / (8.0 * math.pi * 8.0))


@pytest.mark.parametrize("law", ["exact", "file"])
@pytest.mark.parametrize("gap", [0.1, 1.0, 50.0, 400.0])
def test_the_drag_of_a_sphere_counts_once(gap: float, law: str, tmp_path: Path) -> None:
    """By default, without a cutoff, a sphere settles as H. Brenner has it, Chem. Eng. Sci. 16 (1961) 242.

    With 6 pi mu a in drag and law it had half the speed far away. Beyond 1e6 radii the rest of it is a
    power of the gap.
    """
    path = tmp_path / "law.toml"
    path.write_text('form = "exact"\nviscosity = 7.0')
    load = -6.0 * math.pi
    ball = {"name": "ball", "radius": 1.0, "position": [0.0, 1.0 + gap], "force": [0.0, load]}
    given = {"law": "exact" if law == "exact" else str(path), "extrapolate": True}
    case = reduced_case([ball], given, geometry="axisymmetric")
    V = make_model(case)(case.configuration(), 0.0).U[0, 1]
    expected = load / float(spheres.normal_resistance(gap, 1.0, 1.0))
    assert pytest.approx(expected, rel=1e-8 if gap < 100.0 else 3e-6) == V
    if gap == 50.0:
        assert pytest.approx(-1.0 / (1.0 + 9.0 / 8.0 / 51.0), rel=1e-3) == V


def test_without_drag_the_exact_law_has_all_of_it() -> None:
    """Brenner's resistance of a sphere with a mass, whose drag is none."""
    ball = {"name": "ball", "radius": 1.0, "position": [0.0, 1.1], "mass": 1.0, "force": [0.0, -1.0]}
    case = reduced_case([ball], {"drag": 0.0}, geometry="axisymmetric")
    films = Films(np.array([1.0]), np.array([0.0]), np.array([True]))
    K = make_laws(case).kappa(np.log([0.1]), films)
    assert pytest.approx(float(spheres.normal_resistance(0.1, 1.0, 1.0)), rel=1e-8) == K


@pytest.mark.parametrize("spin", [0.0, "free"])
def test_a_disc_that_is_moved_needs_neither_drag_nor_mass(spin: object) -> None:
    """Towards a plane: the exact force of its film. One that is free along the plane needs them."""
    body = {"name": "disc", "radius": 1.0, "position": [0.0, 1.1], "velocity": [0.0, -2.0]}
    case = reduced_case([body | {"angular_velocity": spin}], {"drag": 0.0})
    F = make_model(case)(case.configuration(), 0.0).F[0]
    assert pytest.approx([0.0, -2.0 * float(exact.normal_resistance(0.1, 1.0, 1.0)), 0.0], rel=1e-8) == F
    with pytest.raises(InputError, match=r"^reduced\.drag = 0: only lubrication"):
        reduced_case([body | {"velocity": ["free", -2.0]}], {"drag": 0.0})


def test_a_body_alone_moves_and_turns_with_the_background() -> None:
    """Without load, between walls of which one moves: u_x = 3 y / 8 + ..., rotation -1/2 of the rate."""
    body = {"name": "disc", "radius": 1.0, "position": [0.0, 6.0]}
    case = reduced_case(
        [body],
        {"drag": 10.0, "cutoff": 1.0},
        domain={"lower": [-9.0, 4.0], "upper": [9.0, 12.0], "walls": {"top": [3.0, 0.0]}},
    )
    sheared = {"shape": "half-plane", "radius": 99.0, "walls": {"far": {"shear": 0.7}}}
    case_far = reduced_case([body], {"drag": 10.0, "cutoff": 1.0}, domain=sheared)
    assert make_model(case)(case.configuration(), 0.0).U[0] == pytest.approx([0.75, 0.0, -3.0 / 16.0])
    assert make_model(case_far)(case_far.configuration(), 0.0).U[0] == pytest.approx([4.2, 0.0, -0.35])


def test_walls_squeeze_what_is_between_them() -> None:
    """A held disc between walls that close in: the forces are kappa times the speeds of the walls."""
    body = {"name": "disc", "radius": 1.0, "position": [0.0, 1.1], "velocity": [0.0, 0.0]}
    walls = {"bottom": [0.0, 0.5], "left": [0.0, 0.0], "right": "open", "top": [0.0, 0.0]}
    case = reduced_case(
        [body],
        {"law": "leading", "drag": 10.0, "cutoff": 0.2},
        domain={"lower": [-5.0, 0.0], "upper": [5.0, 10.0], "walls": walls},
    )
    found = make_model(case)(case.configuration(), 0.0)
    kappa = 3.0 * math.sqrt(2.0) * math.pi * (0.1**-1.5 - 0.2**-1.5)
    assert found.F[0, 1] == pytest.approx(-0.5 * kappa)
    assert found.record["power"] < 1e-12


def test_overlap_is_refused() -> None:
    case = reduced_case(heap(), {"drag": 12.0})
    q = case.configuration()
    with pytest.raises(SolveError, match="overlap"):
        make_model(case)(q.moved(np.full((5, 3), [0.0, -0.5, 0.0])), 0.0)


BODIES = heap()
HELD = heap()[0] | {"force": [0.0, 0.0], "velocity": [0.0, 0.0], "angular_velocity": 0.0}


@pytest.mark.parametrize(
    ("reduced", "more", "message"),
    [
        ({}, {}, r"^reduced\.drag: missing"),
        ({"drag": 0.0}, {}, r"^reduced\.drag = 0: only lubrication"),
        ({"drag": -1.0}, {}, r"^reduced\.drag = -1\.0: must be greater"),
        ({"drag": 1.0, "law": "exakt"}, {}, r'^reduced\.law = "exakt": there is no such law; .* law file$'),
        ({"drag": 1.0, "law": "sofd"}, {}, 'law = "sofd": .* law file; one of your own must be registered'),
        ({"drag": 1.0, "scheme": "distance"}, {}, r"^time\.step: missing"),
        ({"drag": 1.0, "scheme": "distance", "step": 0.1}, {}, r"^bodies\.0\.mass: missing"),
        (
            {"drag": 1.0, "scheme": "distance", "step": 0.1},  # the first body needs none
            {"bodies": [HELD, *heap()[1:]]},
            r"^bodies\.1\.mass: missing.* not held in all modes",
        ),
        (
            {"drag": 1.0, "scheme": "euler"},
            {},
            r'^time\.scheme = "euler": .*; one of your own must be registered',
        ),
        ({"drag": 1.0, "scheme": "distanze"}, {}, "there is no such scheme; .*, of [a-z, -]+$"),
        ({"drag": 1.0, "cutof": 0.1}, {}, r"use reduced\.cutoff or drop it"),
        (
            {"drag": 1.0, "scheme": "backward-euler", "step": 0.1},
            {"bodies": heap(**INERTIA)},
            r'^reduced\.law = "exact".* use time\.scheme = "distance"$',
        ),
        (
            {"drag": 1.0, "scheme": "backward-euler", "step": 0.1},
            {"bodies": [HELD, *heap()[1:]]},
            r'^reduced\.law = "exact".* use time\.scheme = "distance", which needs bodies\.1\.mass too$',
        ),
        ({"drag": 1.0}, {"output": {"error_estimates": True}}, r"^output\.error_estimates = true"),
    ],
)
def test_mistakes_are_one_line(reduced: dict[str, object], more: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        make_model(reduced_case(more.pop("bodies", BODIES), reduced, **more))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("geometry", "place", "drag"),
    [("planar", [0.0, 500.0], 4.0 * 2.0**2), ("spatial", [0.0, 0.0, 500.0], 8.0 * 2.0**3)],
)
def test_a_torque_turns_a_lone_body_against_its_exact_drag(
    geometry: str, place: list[float], drag: float
) -> None:
    """4 pi mu a^2 of a disc, 8 pi mu a^3 of a sphere, a = 2, mu = 3."""
    torque = 5.0 if geometry == "planar" else [5.0, 0.0, 0.0]
    body = {"name": "one", "radius": 2.0, "position": place, "torque": torque}
    more = {"geometry": geometry, "fluid": {"viscosity": 3.0}}
    case = reduced_case([body], {"law": "leading", "drag": 12.0, "cutoff": 0.5}, **more)
    U = make_model(case)(case.configuration(), 0.0).U[0]
    d = len(place)
    assert U[d] == pytest.approx(5.0 / (np.pi * 3.0 * drag), rel=1e-12)
