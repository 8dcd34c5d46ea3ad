"""What moves in the gluey model, by hand: masses, loads, what is held; and what solid contact carries."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

import fsi
from fsi.arrays import Array
from fsi.case.case import Case
from fsi.case.gluey import ContactLaw
from fsi.case.load import parse_case
from fsi.errors import InputError
from fsi.gluey.evolution import GlueyEvolution
from fsi.gluey.step import _memory, advance
from fsi.gluey.system import Held, gluey_system
from tests.gluey.test_step import H, bodies, slope

RAMP = {"times": [0.0, 1.0], "values": [0.0, 2.0]}


def case_of(*of_bodies: dict[str, Any], **more: Any) -> Case:
    d = len(of_bodies[0]["position"])
    listed = [{"name": f"b{k}", "radius": 0.5} | body for k, body in enumerate(of_bodies)]
    data = {
        "name": "test", "model": "gluey", "geometry": "planar" if d == 2 else "spatial",
        "domain": {"lower": [-50.0] * d, "upper": [50.0] * d}, "bodies": listed,
        "time": {"end": 1.0, "step": 0.1},
    }  # fmt: skip
    return parse_case(data | more)


def test_masses_and_moments_of_uniform_bodies() -> None:
    """Density 2: a disc has 2 pi a^2 and m a^2/2, a ball 8/3 pi a^3 and 2 m a^2/5."""
    disc, ball = np.pi / 2.0, np.pi / 3.0
    gluey = {"density": 2.0}
    assert_allclose(
        gluey_system(case_of({"position": [0.0, 0.0]}, gluey=gluey)).mass, [[disc, disc, disc / 8.0]]
    )
    mass = gluey_system(case_of({"position": [0.0, 0.0, 0.0]}, gluey=gluey)).mass
    assert_allclose(mass, [[ball] * 3 + [0.1 * ball] * 3])


def test_loads_and_held_velocities_are_integrated_over_the_step() -> None:
    """F = 2 t from 0.2 to 0.6: the impulse 0.32; a held velocity of 2 t is 0.8 in the mean."""
    case = case_of(
        {"position": [0.0, 0.0], "force": [RAMP, 0.0]}, {"position": [5.0, 0.0], "velocity": [RAMP, "free"]}
    )
    system = gluey_system(case)
    assert_allclose(system.load(case.configuration().centres, 0.2, 0.6)[0], [0.32, 0.0, 0.0], rtol=1e-14)
    assert system.held is not None
    assert_allclose(system.held.velocity(0.2, 0.6)[1], [0.8, 0.0, 0.0], rtol=1e-14)


def test_a_held_body_pushes_a_free_one_along() -> None:
    """It moves with 1 and touches the other, which nothing else pushes: they go on together."""
    system, state = bodies([(0.0, 0.0), (1.0, 0.0)], lambda _t: np.zeros(2))
    modes = np.array([[True] * 3, [False] * 3])
    U = np.array([[1.0, 0.0, 0.0], [0.0] * 3])
    system = replace(system, held=Held(modes, lambda _t0, _t1: U))
    after, touching, _ = advance(system, state, 0.0, H)
    assert_allclose(after.U, [[1.0, 0.0, 0.0], [1.0, 0.0, 0.0]], atol=1e-9)
    assert_allclose(touching.p, [1.0], rtol=1e-8)


def on_a_plane(push: Array, law: ContactLaw, steps: int) -> Any:
    """A disc of mass 1 at rest on a plane, with a force: state and contact after some steps."""
    system, state = bodies((0.0, 0.5), lambda _t: push, slope(0.0), law)
    for k in range(steps):
        state, touching, _ = advance(system, state, k * H, H)
    return state, touching


def test_solid_contact_carries_what_memory_does_not_store() -> None:
    """Weight 1 stores 0.01 a step down to gamma_min = -0.05; each later 0.01 is of solid contact."""
    law = ContactLaw("shifted", -0.05)
    _, before = on_a_plane(np.array([0.0, -1.0]), law, 5)
    assert_allclose((before.gamma[0], before.solid[0]), (-0.05, 0.0), atol=1e-12)
    _, after = on_a_plane(np.array([0.0, -1.0]), law, 9)
    assert_allclose((after.gamma[0], after.p[0], after.solid[0]), (-0.05, 0.06, 0.01), rtol=1e-8)


DISCS, SPHERES = 0.02 * (1.0 - 10.0**0.5), -0.01 * np.log(10.0)


@pytest.mark.parametrize(
    ("geometry", "least"), [("planar", DISCS), ("axisymmetric", SPHERES), ("spatial", SPHERES)]
)
def test_the_cut_off_of_roughness_is_what_a_film_of_the_shape_stores(geometry: str, least: float) -> None:
    """eps = 0.01, a tenth of the reference gap: 2 eps (1 - x^(-1/2)) of discs, eps ln x of spheres.

    From kappa ~ d^(-3/2) and 1/d. Discs with the bound of spheres would be solid at the gap 0.22 delta_0.
    """
    d = 3 if geometry == "spatial" else 2
    place = {"geometry": geometry, "domain": {"lower": [0.0] * d, "upper": [9.0] * d}}
    position = [0.0 if geometry == "axisymmetric" else 4.0, *[4.0] * (d - 1)]
    law = {"eps": 0.01, "reference_gap": 0.5}
    rough = case_of({"position": position}, gluey=law | {"roughness": 0.05}, **place)
    assert gluey_system(rough).law.gamma_min == pytest.approx(least, rel=1e-14)
    film = gluey_system(case_of({"position": position}, gluey=law | {"variant": "film"}, **place)).film(1.0)
    assert film is not None
    assert_allclose(film.gamma(np.array([0.05])), least, rtol=1e-14)


def test_friction_is_bounded_by_the_solid_part_alone() -> None:
    """Pulled along with its weight: rolling asks for a third of it, mu_f = 0.2 allows a fifth.

    So 0.01 a step for five steps without solid contact, then 0.008.
    """
    law, pull = ContactLaw("shifted", -0.05, 0.2), np.array([1.0, -1.0])
    assert on_a_plane(pull, law, 5)[0].U[0, 0] == pytest.approx(0.05, rel=1e-8)
    assert on_a_plane(pull, law, 9)[0].U[0, 0] == pytest.approx(0.05 + 4 * 0.008, rel=1e-7)


def test_the_memory_of_a_cone_is_never_a_pull_that_is_owed() -> None:
    """gamma - p, between gamma_min and 0: a pull of 2 pays back a memory of -1 and no more."""
    found = _memory(ContactLaw("cone", -3.0), np.array([-1.0, -1.0, -1.0]), np.array([-2.0, -0.4, 9.0]))
    assert_allclose(found, [0.0, -0.6, -3.0])


def test_a_run_records_the_energy_and_draws_contacts_from_centre_to_centre(tmp_path: Path) -> None:
    """Two touching discs that are pushed together and turn with omega = 3 and 4."""
    body = {"mass": 2.0, "moment_of_inertia": 0.7}
    case = case_of(
        body | {"position": [0.0, 0.0], "force": [1.0, 0.0], "initial_angular_velocity": 3.0},
        body | {"position": [1.0, 0.0], "force": [-1.0, 0.0], "initial_angular_velocity": 4.0},
    )
    run = fsi.run(case, tmp_path / "run")
    assert run.steps["kinetic_energy"][0] == pytest.approx(0.5 * 0.7 * (9.0 + 16.0))
    evolution = GlueyEvolution(case)
    moment = evolution.advance(evolution.start().state)
    assert moment.record.columns["contacts"] == 1
    lines = run.mesh(1, "contacts")
    q = moment.record.q.centres
    ends = np.asarray(lines.points)[:, :2]
    assert_allclose(sorted(ends.tolist()), sorted(q.tolist()), atol=1e-12)
    assert np.linalg.norm(ends[1] - ends[0]) == pytest.approx(1.0, rel=1e-12)


def test_forces_act_from_the_walls_of_gluey_too() -> None:
    """|F| = 2 exp(-d / 3) towards a plane that stands askew: 0.8 in front of it, over a step of 0.1.

    Its normal is given ten times as long; without `walls = true` there is none.
    """
    n = np.array([0.6, 0.8])
    walls = [{"name": "askew", "point": [1.0, 2.0], "normal": (10.0 * n).tolist()}]
    law = {"kind": "attraction", "law": "exponential", "strength": 2.0, "length": 3.0, "cutoff": 5.0}
    body = {"position": (np.array([1.0, 2.0]) + 1.3 * n + 4.0 * np.array([-0.8, 0.6])).tolist()}
    for acts in (True, False):
        case = case_of(body, gluey={"walls": walls}, forces=[law | {"walls": acts}])
        load = gluey_system(case).load(case.configuration().centres, 0.0, 0.1)
        assert_allclose(load[0, :2], -0.1 * 2.0 * np.exp(-0.8 / 3.0) * acts * n, rtol=1e-12)


@pytest.mark.parametrize("size", [1e-200, 1e-320, 1.0, 1e200])
def test_a_wall_has_the_direction_of_its_normal_of_any_length(size: float) -> None:
    """Of (0, 1): a disc of radius 1/2 at y = 1 is 0.5 above; at y = 0.4 it overlaps by 0.1."""
    walls = [{"name": "floor", "point": [0.0, 0.0], "normal": [0.0, size]}]
    case = case_of({"position": [0.0, 1.0]}, gluey={"walls": walls})
    assert_allclose(gluey_system(case).room.normals[-1], [0.0, 1.0], rtol=0.0)
    with pytest.raises(InputError, match=r"^bodies: b0 and wall floor overlap by 0\.1; move them apart$"):
        case_of({"position": [0.0, 0.4]}, gluey={"walls": walls})


@pytest.mark.parametrize(("variant", "after"), [("shifted", 0.0), ("cone", -3.0)])
def test_what_an_impulse_pulls_is_overpaid_by_the_cone_alone(variant: str, after: float) -> None:
    """A held disc turns from 1 to -3 at once, with a disc of mass 3 that it has brought to 1: gamma = -3.

    To follow at -3 takes an impulse of -12, but -3 were stored, which bring 3 to rest. The cone keeps the gap
    at 0 for the whole step, so that it follows, for any step.
    """
    turns = {"times": [0.0, 0.5, 0.5], "values": [1.0, 1.0, -3.0]}
    pushed = {"position": [1.25, 0.0], "mass": 3.0}
    held = {"position": [0.0, 0.0], "velocity": [turns, 0.0], "angular_velocity": 0.0}
    evolution = GlueyEvolution(case_of(held, pushed, gluey={"variant": variant}))
    state = evolution.start().state
    for _ in range(5):
        state = evolution.advance(state).state
    assert_allclose(evolution.memory()["gamma"], [-3.0], rtol=1e-8)
    assert_allclose(evolution.advance(state).state.U[1, 0], after, atol=1e-7)
