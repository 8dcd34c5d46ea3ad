"""A flow on walls from outside the package: the extension u = rate (x, -y), in space rate (x, 0, -z)."""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar, override

import numpy as np
import pytest

import fsi
from fsi.arrays import Array
from fsi.case import walls
from fsi.case.case import Case
from fsi.case.domains.domain import Walled
from fsi.case.load import parse_case
from fsi.case.wall_velocity import WallVelocity
from fsi.case.walls import WallSection, register_wall
from fsi.errors import InputError
from fsi.models import make_model
from fsi.observables.scales import flow_scales
from fsi.postprocess.render.mean_flow import sliding_walls, undisturbed

RATE = 0.5
SIDES = ("left", "right", "bottom", "top")
PRESSING = {"bottom": [0.0, 4.0], "top": [0.0, -4.0]}  # what comes in there goes out through the sides
PLACE = [3.0, -2.0]
U_INF = [[RATE * PLACE[0], -RATE * PLACE[1], 0.0]]  # an extension does not turn


class Extension(WallSection):
    """A wall on which the fluid has the flow `u = extension (x, -y)`, in space `extension (x, 0, -z)`."""

    form: ClassVar[str] = "{extension = rate}"
    extension: float

    @override
    def velocity_at(self, t: float, dimension: int) -> WallVelocity:
        gradient = np.zeros((dimension, dimension))
        gradient[0, 0], gradient[-1, -1] = self.extension, -self.extension
        return WallVelocity(np.zeros(dimension), gradient)


@pytest.fixture(autouse=True)
def registered(monkeypatch: pytest.MonkeyPatch) -> None:
    """Registered for one test only: messages list all conditions."""
    monkeypatch.setattr(walls, "_SECTIONS", dict(walls._SECTIONS))
    register_wall(Extension)


def given_at(*names: str) -> dict[str, Any]:
    return {name: {"extension": RATE} for name in names}


BOX: dict[str, Any] = {"lower": [-8.0, -8.0], "upper": [8.0, 8.0]}
CHANNEL = BOX | {"periodic": ["x"]}
ROUND: dict[str, Any] = {"shape": "round", "radius": 40.0, "walls": given_at("far")}


def data_in(domain: dict[str, Any], model: str, place: list[float] = PLACE) -> dict[str, Any]:
    return {
        "name": "in an extension",
        "model": model,
        "geometry": "planar" if len(place) == 2 else "spatial",
        "fluid": {"viscosity": 1.0},
        "domain": domain,
        "bodies": [{"name": "one", "radius": 1.0, "position": place}],
        "discretisation": {"cells_per_circle": 16},
        "reduced": {"drag": 12.0, "cutoff": 0.5},
    }


def case_in(domain: dict[str, Any], model: str, place: list[float] = PLACE) -> Case:
    return parse_case(data_in(domain, model, place))


def velocities(case: Case) -> Array:
    return np.asarray(make_model(case)(case.configuration(), 0.0).U)


def test_a_free_disc_goes_with_it_where_it_is_resolved() -> None:
    """By Faxen's law u(q), as the flow is harmonic; the wall at 40 radii changes some (a/R)^2 of it."""
    assert velocities(case_in(ROUND, "resolved")) == pytest.approx(np.array(U_INF), abs=2e-3)


@pytest.mark.parametrize("domain", [ROUND, BOX | {"walls": given_at(*SIDES)}], ids=["round", "box"])
def test_a_free_disc_goes_with_it_where_it_is_reduced(domain: dict[str, Any]) -> None:
    assert velocities(case_in(domain, "reduced")) == pytest.approx(np.array(U_INF), rel=1e-14)


@pytest.mark.parametrize(
    ("domain", "model", "message"),
    [
        (BOX | {"walls": given_at("left", "right") | PRESSING}, "reduced", "left = .* drives a flow that"),
        ({"shape": "half-plane", "radius": 50.0, "walls": given_at("far")}, "reduced", "drives a flow"),
        (BOX | {"walls": given_at(*SIDES)}, "pores", "only walls of a channel slide"),
        (ROUND | {"walls": given_at("far"), "radius": 8.0}, "pores", "only walls of a channel slide"),
        (CHANNEL | {"walls": given_at("top")}, "resolved", "walls.top = .*not periodic"),
        (CHANNEL | {"walls": {"top": {"shear": 1.0}}}, "pores", r"walls slide along themselves; give \[u_x"),
        (BOX | {"walls": given_at("left")}, "resolved", "walls.left = .*the net flux .* is 64 at"),
        (BOX | {"walls": {"top": {"extensoin": 1.0}}}, "resolved", "use domain.walls.top.extension"),
        (BOX | {"walls": {"top": {"turning": 1.0}}}, "resolved", "turning = 1.0: no .*; one of your own"),
        (BOX | {"walls": {"top": "shut"}}, "resolved", r"channel, .* or \{extension = rate\}$"),
    ],
)  # fmt: skip
def test_what_cannot_be_is_refused(domain: dict[str, Any], model: str, message: str) -> None:
    """By its sign; alone it leaves at x = -8 with 0.5 times 8 times 16, and not on a plane at rest."""
    with pytest.raises(InputError, match=message):
        case_in(domain, model, [3.0, 4.0])


def test_it_is_no_rest_and_is_written_and_read_again() -> None:
    case = case_in(ROUND, "resolved")
    assert not case.domain.walls["far"].rests
    assert flow_scales(case, 0.0).velocity == RATE  # times the radius, 1
    assert "{extension = rate}" in (Walled.describe("walls") or "")
    assert parse_case(case.as_data()) == case


def test_pictures_subtract_it(tmp_path: Path) -> None:
    """Walls that stretch do not slide with one speed."""
    (tmp_path / "case.toml").write_text(case_in(BOX | {"walls": given_at(*SIDES)}, "resolved").as_toml())
    entry = '<DataSet timestep="0.5" part="0" file="fields/fluid_000003.vtu"/>'
    (tmp_path / "fluid.pvd").write_text(f"<VTKFile><Collection>{entry}</Collection></VTKFile>")
    run = fsi.open_run(tmp_path)
    flow = undisturbed(run, 3)
    assert flow is not None
    np.testing.assert_allclose(flow.at(np.array([[*PLACE, 0.0]])), U_INF, rtol=1e-14)
    assert sliding_walls(run, 3) == []
