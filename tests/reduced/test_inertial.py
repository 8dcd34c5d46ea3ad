"""The distance scheme in time: one pair against exact values, and what each step satisfies."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fsi.arrays import Array
from fsi.bodies.gaps import nearest_gaps
from fsi.errors import SolveError
from fsi.integration.state import Step
from fsi.meshes.geometry.round import HalfPlane
from fsi.models import make_model, make_stepper
from fsi.reduced.distance_model import DistanceModel, PairMemory, merged
from tests.reduced_data import INERTIA, heap, reduced_case

REFERENCE = json.loads((Path(__file__).parents[1] / "reference" / "gluey_1d.json").read_text())


def fall(name: str, eps: float, h: float, scheme: str = "distance") -> tuple[Array, Array]:
    """A disc of mass 1 above a plane: rows (t, stored gap, gap, gamma), and the exact ones.

    Gamma jumps at t = 1 as eps -> 0, so that values there say nothing.
    """
    given = REFERENCE[name]
    (_, first), (jump, second) = given["f_breaks"]
    force = {"times": [0.0, jump, jump + 1e-11], "values": [first, first, second]}
    body = {
        "name": "disc",
        "radius": 1.0,
        "position": [0.0, 1.0 + given["q0"]],
        "velocity": [0.0, "free"],
        "angular_velocity": 0.0,
        "force": [0.0, force],
    }
    reduced = {"law": "slides", "drag": 0.0, "scheme": scheme, "step": h}
    case = reduced_case([body | INERTIA], reduced, fluid={"viscosity": eps}, time={"end": given["tend"]})
    model = make_model(case)
    assert isinstance(model, DistanceModel)
    stepper = make_stepper(case, model)
    state = stepper.start(case.configuration()).state
    # The case begins at rest; the reference, perhaps, with a velocity.
    state = replace(state, U=np.array([[0.0, given["u0"], 0.0]]))
    begun = model.state()
    kick = {"w": begun["w"] + given["u0"], "force": begun["force"] + eps / given["q0"] * given["u0"]}
    model.restore(begun | kick)
    rows = [(0.0, given["q0"], given["q0"], 0.0)]
    while state.t < given["tend"]:
        step = stepper.advance(state)
        state = step.state
        instant = step.instant
        rows.append((state.t, np.exp(instant.x[0]), state.q.centres[0, 1] - 1.0, instant.gamma[0]))  # type: ignore[attr-defined]
    expected = np.array(given["data"][f"{eps:g}"]["rows"])
    expected = expected[np.abs(expected[:, 0] - 1.0) > 0.15]
    found = np.array(rows)
    return np.column_stack([np.interp(expected[:, 0], found[:, 0], column) for column in found.T]), expected


@pytest.mark.parametrize(
    ("name", "eps"),
    [
        ("I1", 0.1),
        ("I1", 1e-4),
        ("I2", 1e-4),
        *(pytest.param(*rest, marks=pytest.mark.slow) for rest in (("I1", 1e-2), ("I1", 1e-3), ("I2", 0.1))),
    ],
)
def test_the_gap_is_of_first_order_in_h_whatever_eps(name: str, eps: float) -> None:
    """Error up to 2.5 h at speeds about 2, halving with h; position within 7 h; gamma, about 2, 2 h."""
    errors = []
    for h in (0.08, 0.04):
        found, expected = fall(name, eps, h)
        errors.append(np.abs(found[:, 1] - expected[:, 1]).max())
        assert errors[-1] < 2.5 * h
        assert np.abs(found[:, 2] - expected[:, 1]).max() < 7.0 * h
        assert np.abs(found[:, 3] - expected[:, 2]).max() < 2.0 * h
    assert 1.8 < errors[0] / errors[1] < 2.2


def test_backward_euler_loses_the_memory_however_small_the_step() -> None:
    """In I1 it lets go at the first pull: at t = 5 the disc is twice as far as it should be, for any h."""
    for h in (0.08, 0.04):
        found, expected = fall("I1", 1e-3, h, "backward-euler")
        assert found[-1, 1] > 2.0 * expected[-1, 1]


def steps_of_a_heap(law: str, h: float, end: float = 1.5) -> list[Step]:
    reduced = {"law": law, "drag": 5.0, "cutoff": 0.5, "scheme": "distance", "step": h}
    case = reduced_case(heap(**INERTIA), reduced, time={"end": end})
    stepper = make_stepper(case, make_model(case))
    steps = [stepper.start(case.configuration())]
    while steps[-1].state.t < end:
        steps.append(stepper.advance(steps[-1].state))
    return steps


@pytest.mark.parametrize("law", ["slides", "leading", "exact"])
def test_every_step_of_a_falling_heap_satisfies_its_identities(law: str) -> None:
    steps = steps_of_a_heap(law, 0.02)
    checks = ("momentum", "angular_momentum", "kernel", "residual", "power", "balance", "energy", "invariant")
    for step in steps[1:]:
        assert {
            name: step.instant.record[name] for name in checks if not step.instant.record[name] <= 1e-12
        } == {}
    assert max(step.instant.record["pairs"] for step in steps[1:]) >= 4
    assert min(step.instant.record["log10_stored_gap"] for step in steps[1:]) < -1.0
    assert min(float(step.instant.gamma.min(initial=0.0)) for step in steps) < -0.5  # type: ignore[attr-defined]


@pytest.mark.parametrize(("law", "h"), [("slides", 0.02), ("slides", 0.1), ("leading", 0.1)])
def test_bodies_do_not_overlap_however_large_the_step(law: str, h: float) -> None:
    """Stored gaps drift from those of the bodies, which overlapped by 1.1 h in the heap: now they stop."""
    steps = steps_of_a_heap(law, h)
    container = HalfPlane(1000.0)
    assert min(nearest_gaps(step.state.q, container).smallest() for step in steps) > 0.0
    assert max(step.instant.record["stopped"] for step in steps) > 0
    assert max(step.instant.record["energy"] for step in steps) <= 1e-12
    assert max(step.instant.record["momentum"] for step in steps) <= 1e-12


def test_held_bodies_that_meet_cannot_be_stopped() -> None:
    """With the literal scheme, whose stored gap stays positive: the line says by how much they overlap."""
    held = {"angular_velocity": 0.0} | INERTIA
    bodies = [
        {"name": "one", "radius": 1.0, "position": [-1.1, 9.0], "velocity": [1.0, 0.0]} | held,
        {"name": "other", "radius": 1.0, "position": [1.1, 9.0], "velocity": [-1.0, 0.0]} | held,
    ]
    reduced = {"law": "slides", "drag": 5.0, "scheme": "backward-euler", "step": 0.2}
    case = reduced_case(bodies, reduced)
    stepper = make_stepper(case, make_model(case))
    with pytest.raises(SolveError, match=r"time\.step = 0\.2: bodies overlap after it by 0\.2, .*shorten it"):
        stepper.advance(stepper.start(case.configuration()).state)


def test_stored_gaps_drift_at_first_order() -> None:
    coarse, fine = (steps_of_a_heap("leading", h, 0.4)[-1].instant.record["drift"] for h in (0.01, 0.005))
    assert 0.0 < fine < 0.65 * coarse < 0.05


def test_memory_survives_a_change_of_neighbours() -> None:
    """Pairs that stay keep what they store to the last bit; others are new."""
    random = np.random.default_rng(0)
    keys = np.unique(random.integers(0, 40, (200, 3)), axis=0)
    values = random.standard_normal((3, len(keys)))
    old = np.sort(random.permutation(len(keys))[:120])
    memory = PairMemory(keys[old], *values[:, old])
    now = np.sort(random.permutation(len(keys))[:120])
    own, stored = memory.positions(keys[now])
    assert set(now[own]) == set(old) & set(now)
    new = np.setdiff1d(np.arange(len(now)), own)
    fresh = PairMemory(keys[now][new], *(np.full((3, len(new)), 7.0)))
    found = merged(keys[now], (own, stored, memory), (new, np.arange(len(new)), fresh))
    assert np.array_equal(found.x[own], values[0][now[own]])
    assert np.array_equal(found.w[own], values[1][now[own]])
    assert np.all(found.force[new] == 7.0)


def test_a_body_held_in_one_direction_keeps_the_gap_that_its_motion_leaves() -> None:
    """A disc that rises freely in y alone is pressed by 2 against another one that is driven past it.

    `y'' = 2 - kappa(D) D' n_y` with kappa = mu/D; g = n_y^2 turns with n. Without that the stored gap would
    be 2.5 times this one.
    """
    start, speed = np.array([1.2, -1.7233687939614086]), 1.0

    def motion(t: float, y: Array) -> Array:
        apart = np.array([start[0] - speed * t, y[0]])
        distance = np.hypot(*apart)
        rate = (apart @ [-speed, y[1]]) / distance
        return np.array([y[1], 2.0 - rate / (distance - 2.0) * apart[1] / distance])

    found = solve_ivp(motion, (0.0, 1.0), [start[1], 0.0], rtol=1e-10, atol=1e-12, method="Radau")
    gap = np.hypot(start[0] - speed, found.y[0, -1]) - 2.0
    held = {"angular_velocity": 0.0, "radius": 1.0}
    free = {"name": "a", "position": start.tolist(), "velocity": [0.0, "free"], "force": [0.0, 2.0]}
    bodies = [free | held | INERTIA, {"name": "b", "position": [0.0, 0.0], "velocity": [speed, 0.0]} | held]
    drifts = []
    for h in (0.02, 0.01):
        reduced = {"law": "slides", "drag": 0.0, "scheme": "distance", "step": h}
        case = reduced_case(bodies, reduced, domain={"shape": "unbounded"}, time={"end": 1.0})
        stepper = make_stepper(case, make_model(case))
        step = stepper.start(case.configuration())
        while step.state.t < 1.0:
            step = stepper.advance(step.state)
        assert 10.0 ** step.instant.record["log10_stored_gap"] == pytest.approx(gap, rel=0.3 * h)
        drifts.append(step.instant.record["drift"])
    assert drifts[1] == pytest.approx(0.5 * drifts[0], rel=0.05)
