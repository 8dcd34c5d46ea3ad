"""The reduced model in channels and cells: images, forces across periods, and the bulk stress."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fsi.case.case import Case
from fsi.case.load import parse_case
from fsi.errors import InputError
from fsi.models import make_model, make_stepper
from fsi.runs import run
from tests.exact_model import by
from tests.reduced_data import INERTIA, instant, reduced_case
from tests.small_run import rows

PLACES = [(0.9, 1.3), (3.1, 1.15), (1.7, 3.2), (4.4, 3.4)]
CHANNEL = {
    "lower": [0.0, 0.0],
    "upper": [5.2, 4.5],
    "periodic": ["x"],
    "walls": {"bottom": [-1.0, 0.0], "top": [3.0, 0.0]},
}
SHEARED = {"shape": "cell", "vectors": [[5.2, 0.0], [1.1, 4.5]], "shear": 0.8}
STRETCHED = {"shape": "cell", "vectors": [[5.2, 0.0], [1.1, 4.5]], "extension": -0.5}
DOMAINS = {"channel": CHANNEL, "sheared": SHEARED, "stretched": STRETCHED}
LATTICE = {"channel": np.array([[5.2, 0.0]]), "cell": np.array([[5.2, 0.0], [1.1, 4.5]])}
GRADIENT = {"channel": 4.0 / 4.5, "sheared": 0.8}


def periodic(name: str, shift: np.ndarray | float = 0.0, **more: Any) -> Case:
    """Four discs, pairs of which are near through the periods; `shift` moves the bodies."""
    same = {"radius": 1.0} | more.pop("body", {})
    places = (np.array(PLACES) + shift).tolist()
    bodies = [{"name": f"b{k}", "position": place} | same for k, place in enumerate(places)]
    reduced = {"law": "exact", "drag": 12.0, "cutoff": 0.6} | more.pop("reduced", {})
    return reduced_case(bodies, reduced, domain=DOMAINS[name], **more)


@pytest.mark.parametrize("name", DOMAINS)
def test_the_image_of_a_body_moves_with_the_lattice_and_is_the_same_body(name: str) -> None:
    """Shifted by vectors s of the lattice: the same forces, velocities more by E s."""
    lattice = LATTICE["channel" if name == "channel" else "cell"]
    shift = np.random.default_rng(0).integers(-2, 3, (4, len(lattice))) @ lattice
    E = {"channel": [[0.0, 4.0 / 4.5], [0.0, 0.0]], "sheared": [[0.0, 0.8], [0.0, 0.0]]}
    one, other = instant(periodic(name)), instant(periodic(name, shift))
    assert np.any(one.pairs.shift != 0.0)
    more = shift @ np.array(E.get(name, np.diag([-0.5, 0.5]))).T
    assert other.U[:, :2] == pytest.approx(one.U[:, :2] + more, abs=1e-12)
    assert np.sort(other.force) == pytest.approx(np.sort(one.force), abs=1e-11)


@pytest.mark.parametrize("name", DOMAINS)
def test_what_the_stress_works_is_what_is_dissipated(name: str) -> None:
    """|Omega| Sigma_L:E of free bodies: the dissipation of drag and gaps."""
    case = periodic(name)
    found = instant(case)
    assert found.stress is not None
    E = np.diag([-0.5, 0.5])
    if name in GRADIENT:
        E = 0.5 * GRADIENT[name] * np.array([[0.0, 1.0], [1.0, 0.0]])
    background = 2.0 * np.sum(E**2) * found.stress.volume
    lost = found.record["dissipation"]
    assert np.sum(found.stress.mean * E) * found.stress.volume == pytest.approx(lost, rel=1e-12)
    assert found.record["lubrication_viscosity"] == pytest.approx(lost / background, rel=1e-12)
    assert lost > 0.1 * background


def test_the_sheared_cell_returns_to_itself() -> None:
    """A lone disc drifts with the mean flow, x = x0 + gammadot t y0, its gap to its images as it must be."""
    body = {"name": "disc", "radius": 1.0, "position": [0.3, 0.7]}
    domain = {"shape": "cell", "vectors": [[2.6, 0.0], [0.0, 2.6]], "shear": 1.0}
    case = reduced_case([body], {"drag": 12.0, "cutoff": 0.7}, domain=domain, time={"end": 2.0})
    stepper = make_stepper(case, make_model(case))
    step = stepper.start(case.configuration())
    while step.state.t < 2.0:
        step = stepper.advance(step.state)
    assert step.state.q.centres[0] == pytest.approx([1.7, 0.7])
    assert sorted(step.instant.pairs.gap) == pytest.approx([0.6, 0.6])  # type: ignore[attr-defined]


@pytest.mark.parametrize("scheme", ["adaptive", "distance"])
def test_a_run_in_a_channel_writes_the_stress(scheme: str, tmp_path: Path) -> None:
    more: dict[str, Any] = {"reduced": {"scheme": "distance", "step": 0.05}, "body": INERTIA}
    case = periodic("channel", time={"end": 0.5, "tolerance": 1e-3}, **(more if scheme == "distance" else {}))
    run(case, tmp_path / "run", make=by(make_model))
    last = rows(tmp_path / "run" / "steps.csv")[-1]
    assert {"lubrication_viscosity", "lubrication_stress_xy"} <= set(last)
    assert not {"apparent_viscosity", "stress_xy"} & set(last)  # which would miss single bodies and shear
    assert float(last["smallest_gap"]) > 0.0
    S = sum(float(row["lubrication_S_xy"]) for row in rows(tmp_path / "run" / "bodies.csv")[-4:])
    assert float(last["lubrication_stress_xy"]) == pytest.approx(S / (5.2 * 4.5))


def test_forces_act_across_the_period() -> None:
    """Two discs that repel only through the period: alone with drag, V = F / zeta."""
    bodies = [
        {"name": "left", "radius": 1.0, "position": [1.1, 5.0]},
        {"name": "right", "radius": 1.0, "position": [8.9, 5.0]},
    ]
    force = {"kind": "repulsion", "law": "table", "gaps": [0.1, 0.4], "values": [3.0, 3.0]}
    domain = {"lower": [0.0, 0.0], "upper": [10.0, 10.0], "periodic": ["x"]}
    reduced = {"law": "leading", "drag": 10.0, "cutoff": 0.1}
    U = instant(reduced_case(bodies, reduced, domain=domain, forces=[force])).U
    assert U[:, :2] == pytest.approx(np.array([[0.3, 0.0], [-0.3, 0.0]]))


@pytest.mark.parametrize(
    ("domain", "reduced", "message"),
    [
        (CHANNEL, {}, "reduced.cutoff: missing"),
        (CHANNEL | {"pressure_gradient": 1.0}, {"cutoff": 0.5}, "domain.pressure_gradient = 1"),
        (CHANNEL | {"net_flux": 2.0}, {"cutoff": 0.5}, "domain.net_flux = 2"),
        (
            {
                "lower": [-4.0, 0.0],
                "upper": [4.1, 4.0],
                "walls": {"left": {"pressure": 3.0}, "right": "open"},
            },
            {},
            r"domain.walls.left = \{pressure = 3\}",
        ),
    ],
)
def test_what_the_model_does_not_know_is_refused(
    domain: dict[str, Any], reduced: dict[str, Any], message: str
) -> None:
    data = {
        "name": "test",
        "model": "reduced",
        "fluid": {"viscosity": 1.0},
        "domain": domain,
        "bodies": [{"name": "b", "radius": 1.0, "position": [1.0, 2.0]}],
        "reduced": {"drag": 12.0} | reduced,
    }
    with pytest.raises(InputError, match=message):
        parse_case(data)
