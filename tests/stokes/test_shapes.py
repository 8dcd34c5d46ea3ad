"""Flow around bodies that are no discs: against discs, exact results of ellipses, and itself moved."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy  # its modules load when they are used

from fsi.arrays import Array
from fsi.case.case import Case
from fsi.case.load import parse_case
from fsi.case.shapes.tip import Tip
from fsi.postprocess.run.run import open_run
from fsi.runs import resume, run
from fsi.stokes.adapt import solve_with_errors
from fsi.stokes.model import StokesModel
from tests.stokes.moved_meshes import gives_what_a_new_one_does

# Of a container that stands for infinity: it changes what turns an ellipse by some gamma (a / R)^2.
FAR = 1e3
AXES = (2.0, 1.0)


def in_box(**body: Any) -> Case:
    """A body at a gap of 0.01 from a wall."""
    return parse_case(
        {
            "name": "near a wall",
            "fluid": {"viscosity": 1.0},
            "domain": {"lower": [-4.0, -4.0], "upper": [4.0, 4.0]},
            "bodies": [{"name": "body", "position": [0.3, -2.99], "velocity": [0.5, -1.0]} | body],
        }
    )


def sheared(axes: tuple[float, float] = AXES, **sections: Any) -> Case:
    """A free ellipse in the shear u = y e_x."""
    body = {"name": "ellipse", "shape": {"kind": "ellipse", "axes": axes}, "position": [0.0, 0.0]}
    return parse_case(
        {
            "name": "free ellipse",
            "fluid": {"viscosity": 1.0},
            "domain": {"shape": "round", "radius": FAR, "walls": {"far": {"shear": 1.0}}},
            "bodies": [body],
            # These err by 6e-5 at the tips, quartic ones by default by 1.1e-4.
            "discretisation": {"degree": 3},
        }
        | sections
    )


@pytest.mark.parametrize(
    "shape",
    [
        {"kind": "ellipse", "axes": [1.0, 1.0]},
        {"kind": "fourier", "radius": 1.0, "orders": [7], "cosines": [0.0]},
        {"kind": "superellipse", "axes": [1.0, 1.0], "exponent": 2.0},
    ],
    ids=lambda shape: str(shape["kind"]),
)
def test_round_shapes_are_discs(shape: dict[str, Any]) -> None:
    """To 1e-9 where the nodes are the same; the joints of a superellipse give it other ones: mesh error."""
    found = []
    for body in ({"radius": 1.0}, {"shape": shape}):
        case = in_box(**body)
        found.append(StokesModel(case)(case.configuration(), 0.0).F[0])
    tolerance = 2e-5 if shape["kind"] == "superellipse" else 1e-9
    np.testing.assert_allclose(found[1], found[0], atol=tolerance * np.abs(found[0]).max())


def test_fluid_slides_along_round_shapes_as_along_discs() -> None:
    """Beside a wall, turned: loads and what friction dissipates agree to 1e-9."""
    found = []
    for size in ({"radius": 1.0}, {"shape": {"kind": "ellipse", "axes": [1.0, 1.0]}, "angle": 1.0}):
        case = in_box(slip_length=0.3, angular_velocity=0.3, position=[0.3, -2.5], **size)
        solution = StokesModel(case)(case.configuration(), 0.0)
        assert max(solution.checks.values()) < 1e-10
        found.append(np.append(solution.F[0], solution.slip_dissipation or 0.0))
    np.testing.assert_allclose(found[1], found[0], atol=1e-9 * np.abs(found[0]).max())


def test_an_ellipse_turns_as_jeffery_says_and_resists_as_its_axes_do() -> None:
    """-omega = (a^2 sin^2 + b^2 cos^2) / (a^2 + b^2) (1922); held, T = 2 pi mu (a^2 + b^2) omega."""
    case, (a, b) = sheared(), AXES
    model, q = StokesModel(case), case.configuration()
    for angle in (0.0, 0.7, 0.5 * np.pi):
        omega = model(q.moved(np.array([[0.0, 0.0, angle]])), 0.0).U[0, 2]
        exact = -((a * np.sin(angle)) ** 2 + (b * np.cos(angle)) ** 2) / (a**2 + b**2)
        assert omega == pytest.approx(exact, rel=1e-4)
    held = sheared(bodies=[case.as_data()["bodies"][0] | {"velocity": [0.0, 0.0], "angular_velocity": 0.0}])
    torque = StokesModel(held)(q, 0.0).F[0, 2]
    assert torque == pytest.approx(2.0 * np.pi * b**2, rel=1e-4)


def test_bars_hold_for_an_ellipse() -> None:
    """Of degree 2, by the difference to degree 4 on its own mesh."""
    case = in_box(shape={"kind": "ellipse", "axes": [1.5, 0.8]}, angle=1.2, position=[0.3, -2.4])
    data = case.as_data()
    coarse = solve_with_errors(parse_case(data | {"discretisation": {"degree": 2}}))
    fine = solve_with_errors(parse_case(data | {"discretisation": {"degree": 4}}))
    error, bar = np.abs(coarse.solution.F - fine.solution.F), coarse.errors.F
    assert np.all(error <= bar + fine.errors.F + 1e-12)
    assert np.abs(coarse.solution.F).max() * 1e-2 > bar.max() > error.max()
    assert max(coarse.solution.checks.values()) < 1e-10


def test_a_moved_mesh_gives_what_a_new_one_does() -> None:
    """A body that comes and turns takes its curved cells along."""
    case = in_box(shape={"kind": "stadium", "length": 1.0, "radius": 0.5}, position=[0.0, -2.5])
    gives_what_a_new_one_does(case, np.array([[0.05, -0.05, 0.1]]), changes=1e-2, tolerance=1e-4)


def test_a_run_goes_on_as_if_unbroken(tmp_path: Path) -> None:
    """The outlines come from the case, the places of nodes from the angles of the last mesh."""
    time = {"end": 1.5, "remesh": "when-needed"}
    coarse = {"cells_per_circle": 24, "growth": 0.3}
    case = sheared((1.5, 1.0), time=time, discretisation=coarse, output={"fields": False, "interval": 0.75})
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    run(case, whole)
    run(parse_case(case.as_data() | {"time": time | {"end": 0.75}}), parts)
    resume(parts, overrides=["time.end=1.5"])
    ends = [open_run(folder).bodies.iloc[-1] for folder in (whole, parts)]
    assert ends[0]["angle"] == pytest.approx(ends[1]["angle"], abs=1e-13)
    # tan(angle) = -b/a tan(a b t / (a^2 + b^2)) of an ellipse that begins along the flow
    exact = -np.arctan(np.tan(1.5 * 1.5 / 3.25) / 1.5)
    assert ends[0]["angle"] == pytest.approx(exact, abs=2e-3)


@pytest.mark.slow
@pytest.mark.parametrize("alpha", [1.0, 1.0 / 2.0, 1.0 / 3.0, 1.0 / 4.0])
def test_the_force_on_a_tip_towards_a_plane(alpha: float) -> None:
    """24 / (1 + alpha) B(b, 3 - b) mu U q^(b - 3), b = 3 / (1 + alpha), as lubrication has it.

    What is left out is smaller by q^(2 alpha / (1 + alpha)), the square of the slope where the film ends: the
    exponent and the coefficient are those of a fit with it.
    """
    shape = {"kind": "tip", "radius": 1.0, "alpha": alpha, "length": 1.0}
    tip = Tip.model_validate(shape).outline
    q, b = np.geomspace(1e-4, 1e-6, 5), 3.0 / (1.0 + alpha)
    force = []
    for gap in q:
        body = {"name": "tip", "shape": shape, "position": [0.0, float(tip.shift[1] + gap)]}
        held = {"velocity": [0.0, -1.0], "angular_velocity": 0.0}
        domain = {"shape": "half-plane", "radius": 100.0}
        case = parse_case(
            {"name": "tip", "fluid": {"viscosity": 1.0}, "domain": domain, "bodies": [body | held]}
        )
        force.append(-StokesModel(case)(case.configuration(), 0.0).F[0, 1])
    left_out = q ** (2.0 * alpha / (1.0 + alpha))

    def off(x: Array) -> Array:
        residual: Array = x[0] + x[1] * np.log(q) + np.log1p(x[2] * left_out) - np.log(force)
        return residual

    start = [np.log(force[-1] * q[-1] ** (3.0 - b)), b - 3.0, 0.1]
    found = scipy.optimize.least_squares(off, start, xtol=1e-15, ftol=1e-15)
    assert found.x[1] == pytest.approx(b - 3.0, abs=0.005)
    exact = 24.0 / (1.0 + alpha) * scipy.special.beta(b, 3.0 - b)
    with_exponent = np.linalg.lstsq(
        np.column_stack([np.ones(5), left_out]), force * q ** (3.0 - b), rcond=None
    )[0]
    assert with_exponent[0] == pytest.approx(exact, rel=0.01)


@pytest.mark.slow
@pytest.mark.parametrize(("ratio", "angles", "cells"), [(2.0, 12, 48), (5.0, 32, 128)])
def test_the_period_of_a_free_ellipse_in_shear(ratio: float, angles: int, cells: int) -> None:
    """2 pi (r + 1/r) = int dtheta / |omega|, by the trapezoidal rule, which is exact to 1e-5 here.

    Where the long one lies along the flow it turns at 1/26 of the shear only: errors of omega count 26 times
    there, those of the container too, (5 / 1e4)^2.
    """
    fine = {"discretisation": {"degree": 4, "cells_per_circle": cells, "growth": 0.15}}
    domain = {"shape": "round", "radius": 1e4, "walls": {"far": {"shear": 1.0}}}
    case = sheared((ratio, 1.0), domain=domain, **(fine if cells > 48 else {}))
    model, q = StokesModel(case), case.configuration()
    theta = np.pi * np.arange(angles // 2 + 1) / angles  # omega(-theta) = omega(theta)
    omega = [model(q.moved(np.array([[0.0, 0.0, angle]])), 0.0).U[0, 2] for angle in theta]
    weight = np.full(len(theta), 2.0)
    weight[[0, -1]] = 1.0
    period = 2.0 * np.pi / angles * float(np.sum(weight / np.abs(omega)))
    assert period == pytest.approx(2.0 * np.pi * (ratio + 1.0 / ratio), rel=1e-4)
