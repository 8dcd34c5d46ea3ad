"""Bodies of the reduced model without a container."""

from __future__ import annotations

import math
from typing import Any

import pytest

from fsi.errors import InputError
from fsi.lubrication import spheres
from fsi.models import make_model, make_stepper
from tests.reduced_data import INERTIA, heap, reduced_case


def test_two_spheres_drawn_apart_have_their_drag_once() -> None:
    """By the exact resistance of the pair over the rate of the gap (Brenner 1961), of radii 1 and 3."""
    gap, b, mu = 2.0, 3.0, 0.5
    bodies = [
        {"name": "a", "radius": 1.0, "position": [0.0, 0.0], "force": [0.0, -1.0]},
        {"name": "b", "radius": b, "position": [0.0, 1.0 + b + gap], "force": [0.0, 1.0]},
    ]
    case = reduced_case(
        bodies, {}, geometry="axisymmetric", domain={"shape": "unbounded"}, fluid={"viscosity": mu}
    )
    U = make_model(case)(case.configuration(), 0.0).U
    exact_rate = 1.0 / float(spheres.relative_resistance(gap, 1.0, b, mu))
    assert U[1, 1] - U[0, 1] == pytest.approx(exact_rate, rel=1e-8)


@pytest.mark.parametrize("geometry", ["planar", "axisymmetric", "spatial"])
def test_a_pair_settles_without_a_container(geometry: str) -> None:
    """One falls onto the other, by leading laws: `zeta (V + v) = F` and `(zeta + 2 kappa) D' = F`.

    With kappa = 3/2 pi D^-n, n = 1 of spheres and 3/2 of discs, zeta D + 2 int kappa grows by F t.
    """
    down = [0.0] * (2 if geometry == "spatial" else 1)
    zeta, load, start = 10.0, -20.0, 0.3
    bodies = [
        {"name": "low", "radius": 1.0, "position": [*down, 0.0]},
        {"name": "high", "radius": 1.0, "position": [*down, 2.0 + start], "force": [*down, load]},
    ]
    case = reduced_case(
        bodies,
        {"law": "leading", "drag": zeta},
        geometry=geometry,
        domain={"shape": "unbounded"},
        time={"end": 2.0, "tolerance": 1e-6},
    )
    stepper = make_stepper(case, make_model(case))
    step = stepper.start(case.configuration())
    while step.state.t < stepper.schedule.end:
        step = stepper.advance(step.state)
    z, t = step.state.q.centres[:, len(down)], step.state.t
    assert z.sum() == pytest.approx(2.0 + start + load / zeta * t, rel=1e-9)

    def potential(D: float) -> float:
        films = -2.0 * D**-0.5 if geometry == "planar" else math.log(D)
        return zeta * D + 3.0 * math.pi * films

    D = float(z[1] - z[0]) - 2.0
    assert 0.6 * start > D
    assert potential(D) - potential(start) == pytest.approx(load * t, rel=1e-4)


def test_inertia_needs_no_container_either() -> None:
    """A lone disc that coasts, 1 kg against zeta = 4: what is left of its speed is 1/(1 + 4 h) a step."""
    body = {"name": "disc", "radius": 1.0, "position": [0.0, 0.0], "initial_velocity": [1.0, 0.0]} | INERTIA
    case = reduced_case(
        [body], {"drag": 4.0, "scheme": "distance", "step": 0.1}, domain={"shape": "unbounded"}
    )
    stepper = make_stepper(case, make_model(case))
    step = stepper.advance(stepper.start(case.configuration()).state)
    assert step.instant.U[0, 0] == pytest.approx(1.0 / 1.4)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"model": "resolved"}, r'^domain\.shape = "unbounded": a flow is solved for in a container'),
        ({"model": "pores"}, r'^domain\.shape = "unbounded": a flow is solved for in a container'),
        ({"bodies": heap()[:1] + heap()[:1]}, "has the same name"),
        (
            {
                "bodies": [
                    {"name": name, "radius": 1.0, "position": [x, 0.0]}
                    for name, x in (("a", 0.0), ("b", 2.0))
                ]
            },
            r"overlap or touch \(gap 0\); move them apart",
        ),
        ({"bodies": []}, r"^bodies: missing; give \[\[bodies\]\]"),
    ],
)
def test_what_is_no_case_without_a_container_is_refused(change: dict[str, Any], message: str) -> None:
    given = {"bodies": heap(), "domain": {"shape": "unbounded"}} | change
    with pytest.raises(InputError, match=message):
        reduced_case(given.pop("bodies"), {"drag": 10.0}, **given)
