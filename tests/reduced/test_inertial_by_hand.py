"""Single steps of the distance scheme against hand calculations, with kappa = mu/D."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from fsi.case.case import Case
from fsi.integration.state import Step
from fsi.models import make_model, make_stepper
from fsi.reduced.distance_model import DistanceModel, PairMemory
from fsi.reduced.model import ReducedInstant
from tests.reduced_data import INERTIA, reduced_case

MU, H = 0.3, 0.1


def first_step(case: Case) -> ReducedInstant:
    """The instant at the end of the first step."""
    stepper = make_stepper(case, make_model(case))
    return reduced_instant(stepper.advance(stepper.start(case.configuration()).state))


def reduced_instant(step: Step) -> ReducedInstant:
    """The instant at the end of a step."""
    assert isinstance(step.instant, ReducedInstant)
    return step.instant


@pytest.mark.parametrize("scheme", ["distance", "backward-euler"])
def test_the_first_row_is_of_the_initial_velocity(scheme: str) -> None:
    """Relative to the plane and the fluid, which go upwards: F = (mu/D + zeta) v, and F v is dissipated."""
    D0, V0, v0 = 0.4, -1.5, 0.5
    body = {"name": "disc", "radius": 1.0, "position": [0.0, 1.0 + D0], "initial_velocity": [0.0, V0]}
    case = reduced_case(
        [body | INERTIA],
        {"law": "slides", "drag": 0.5, "scheme": scheme, "step": H},
        fluid={"viscosity": MU},
        domain={"shape": "half-plane", "radius": 1e3, "walls": {"plane": [0.0, v0], "far": [0.0, v0]}},
    )
    found = make_stepper(case, make_model(case)).start(case.configuration()).instant
    F = (MU / D0 + 0.5 * MU) * (V0 - v0)
    np.testing.assert_allclose(found.F[0], [0.0, F, 0.0], rtol=1e-14)
    assert found.record["dissipation"] == pytest.approx(F * (V0 - v0), rel=1e-14)
    assert found.record["pairs"] == 1.0
    # Powers of load, plane and fluid are told from the dissipation, and loads from what drag and gap take.
    assert 0.0 <= max(found.record["power"], found.record["balance"]) <= 1e-15


def gap_after(D0: float, rate: float, f: float, g: float) -> float:
    """The root of `(D1 - D0)/h + g mu ln D1 = D0' + g mu ln D0 + h f`."""
    w = rate + g * MU * np.log(D0) + H * f
    return float(brentq(lambda D: (D - D0) / H + g * MU * np.log(D) - w, 1e-9, 10.0, xtol=1e-15))


def test_a_disc_above_a_plane_under_a_linear_load_in_a_stream_that_starts() -> None:
    """Plane and fluid go upwards with v = 1/2 + 2 t; the force -5 - 20 t counts at the middle of the step.

    Positions at the end of the step are free of the force that the gap itself exerts: g K stores it.
    """
    m, zeta, D0, V0, F = 2.0, 0.5 * MU, 0.4, -1.5, -5.0 - 20.0 * 0.5 * H
    v0, v1 = 0.5, 0.5 + 2.0 * H
    stream = [0.0, {"times": [0.0, 1.0], "values": [0.5, 2.5]}]
    body = {
        "name": "disc", "radius": 1.0, "position": [0.0, 1.0 + D0], "initial_velocity": [0.0, V0],
        "force": [0.0, {"times": [0.0, 1.0], "values": [-5.0, -25.0]}], "mass": m, "moment_of_inertia": 1.0,
    }  # fmt: skip
    case = reduced_case(
        [body],
        {"law": "slides", "drag": 0.5, "scheme": "distance", "step": H},
        fluid={"viscosity": MU},
        domain={"shape": "half-plane", "radius": 1000.0, "walls": {"plane": stream, "far": stream}},
    )
    found = first_step(case)
    D1 = gap_after(D0, V0 - v0, (F - zeta * (V0 - v0)) / m - (v1 - v0) / H, 1.0 / m)
    assert np.exp(found.x) == pytest.approx([D1], rel=1e-12)
    # (m/h + zeta + kappa(D1)) u1 = m/h u0 + F + (zeta + kappa(D1)) v1: the gap at the end, not at the start.
    kappa = MU / D1
    u1 = (m / H * V0 + F + (zeta + kappa) * v1) / (m / H + zeta + kappa)
    assert found.U[0] == pytest.approx([0.0, u1, 0.0], rel=1e-12)
    assert found.force == pytest.approx([kappa * (u1 - v1)], rel=1e-12)
    assert kappa / (MU / D0) > 1.2  # the two gaps differ enough to be told apart


def test_held_discs_move_by_the_integral_of_their_velocity_and_push_with_its_mean() -> None:
    """They need no mass. v = -1 + t/4 to T: -T + T^2/8; at the ends of steps it gave h T/8 more, 0.0025 here.

    The stored gap of the two, G being constant, is that of the places. A free disc behind the first, with
    m/h u1 + kappa (u1 - v) = m/h u0, feels v = -1 + h/8 in the first step.
    """
    m, T, D0 = 2.0, 2.0 * H, 0.4
    moving = {"times": [0.0, 1.0], "values": [-1.0, -0.75]}
    bodies = [
        {
            "name": f"b{k}",
            "radius": 1.0,
            "position": [x, 500.0],
            "angular_velocity": 0.0,
            "velocity": [v, 0.0],
        }
        for k, (x, v) in enumerate([(0.0, "free"), (2.0 + D0, moving), (4.0 + 3.0 * D0, 0.0)])
    ]
    bodies[0] |= {"mass": m, "moment_of_inertia": 1.0}
    reduced = {"law": "slides", "drag": 0.0, "cutoff": 1.5, "scheme": "distance", "step": H}
    case = reduced_case(bodies, reduced, fluid={"viscosity": MU})
    stepper = make_stepper(case, make_model(case))
    one = stepper.advance(stepper.start(case.configuration()).state)
    kappa = MU * (1.0 / np.exp(reduced_instant(one).x[0]) - 1.0 / 1.5)  # less that at the cutoff
    assert one.state.U[0, 0] == pytest.approx(kappa * (-1.0 + H / 8.0) / (m / H + kappa), rel=1e-12)
    two = stepper.advance(one.state)
    way = -T + T**2 / 8.0
    assert two.state.q.centres[1, 0] == pytest.approx(2.0 + D0 + way, rel=1e-14)
    assert np.exp(reduced_instant(two).x[1]) == pytest.approx(2.0 * D0 - way, rel=1e-14)


def test_two_discs_that_collide_off_the_middle_of_their_masses() -> None:
    """Masses 1 and 3 and a push against each other: g = 1 + 1/3, and equal, opposite impulses."""
    D0, V, push = 0.5, np.array([2.0, -1.0]), 6.0
    bodies = [
        {"name": "light", "radius": 1.0, "position": [0.0, 500.0], "mass": 1.0, "force": [push, 0.0]},
        {"name": "heavy", "radius": 0.5, "position": [1.5 + D0, 500.0], "mass": 3.0, "force": [-push, 0.0]},
    ]
    for body, speed in zip(bodies, V, strict=True):
        body |= {"initial_velocity": [speed, 0.0], "moment_of_inertia": 1.0}
    reduced = {"law": "slides", "drag": 0.0, "scheme": "distance", "step": H}
    found = first_step(reduced_case(bodies, reduced, fluid={"viscosity": MU}))
    D1 = gap_after(D0, V[1] - V[0], -push * (1.0 + 1.0 / 3.0), 1.0 + 1.0 / 3.0)
    (pair,) = np.flatnonzero(~found.pairs.is_wall)
    assert np.exp(found.x[pair]) == pytest.approx(D1, rel=1e-12)
    kappa = MU / D1
    matrix = np.diag([1.0, 3.0]) / H + kappa * np.array([[1.0, -1.0], [-1.0, 1.0]])
    right = np.array([1.0, 3.0]) / H * V + [push, -push]
    assert found.U[:, 0] == pytest.approx(np.linalg.solve(matrix, right), rel=1e-12)


def test_discs_that_pass_each_other_part_faster_as_their_line_of_centres_turns() -> None:
    """D'' = |du|^2 / distance at closest approach, where D' = 0."""
    D0, bodies = 0.5, []
    for k, (x, speed, mass) in enumerate([(0.0, 2.0, 1.0), (2.0 + D0, -1.0, 3.0)]):
        start = {"initial_velocity": [0.0, speed], "position": [x, 500.0]}
        bodies.append({"name": f"b{k}", "radius": 1.0} | INERTIA | start | {"mass": mass})
    reduced = {"law": "slides", "drag": 0.0, "scheme": "distance", "step": H}
    found = first_step(reduced_case(bodies, reduced, fluid={"viscosity": MU}))
    (pair,) = np.flatnonzero(~found.pairs.is_wall)
    g = 1.0 + 1.0 / 3.0
    assert np.exp(found.x[pair]) == pytest.approx(gap_after(D0, 0.0, 9.0 / (2.0 + D0), g), rel=1e-12)


def test_a_pair_that_sticks_is_kept_beyond_the_cutoff_until_its_stored_gap_opens() -> None:
    """Drift has carried the bodies 1.2 cutoffs apart, where the stored gap is 1e-3: it is what counts."""
    bodies = [
        {"name": f"b{k}", "radius": 1.0, "position": [x, 500.0]} | INERTIA for k, x in enumerate((0.0, 2.3))
    ]
    case = reduced_case(
        bodies, {"law": "slides", "drag": 1.0, "cutoff": 0.5, "scheme": "distance", "step": H}
    )
    model = make_model(case)
    assert isinstance(model, DistanceModel)
    stepper, q = make_stepper(case, model), case.configuration()
    start = stepper.start(q)
    begun = model.state()
    assert len(begun["key"]) == 1
    for stored, kept in ((1e-3, 1), (0.6, 0)):
        memory = PairMemory(**(begun | {"x": np.log([stored])}))
        apart = q.moved(np.array([[0.0, 0.0, 0.0], [0.3, 0.0, 0.0]]))
        model._meet(apart, start.state.U, memory, np.array([0.6]), 0.0)
        assert len(model.state()["key"]) == kept


def test_a_step_begins_with_the_pairs_of_the_last_one_as_if_they_were_found_again() -> None:
    """Of walls that speed up, too: a model that has the memory alone gives the same, to the last bit."""
    stream = [0.0, {"times": [0.0, 1.0], "values": [0.5, 2.5]}]
    bodies = [
        {"name": f"b{k}", "radius": 1.0, "position": [x, 1.4], "force": [-3.0 * x, -5.0]} | INERTIA
        for k, x in enumerate((-1.1, 1.2))
    ]
    case = reduced_case(
        bodies,
        {"law": "slides", "drag": 0.5, "scheme": "distance", "step": H},
        domain={"shape": "half-plane", "radius": 1000.0, "walls": {"plane": stream, "far": stream}},
    )
    model, again = make_model(case), make_model(case)
    stepper = make_stepper(case, model)
    state = stepper.advance(stepper.start(case.configuration()).state).state
    make_stepper(case, again).start(case.configuration())
    again.restore({name: value.copy() for name, value in model.state().items()})
    ends = [reduced_instant(make_stepper(case, each).advance(state)) for each in (model, again)]
    assert np.array_equal(ends[0].x, ends[1].x)
    assert np.array_equal(ends[0].U, ends[1].U)
