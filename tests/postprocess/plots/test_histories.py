"""Histories as curves, and the laws that go with them."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import fsi
from fsi.case.load import parse_case
from fsi.errors import InputError
from fsi.postprocess.analysis.settling import asymptotic_gap, exact_gap
from fsi.postprocess.plots import histories
from fsi.postprocess.plots.histories import of_steps, plot_runs, read_history, register_panel

Fill = Callable[[list[float], list[float]], Path]
BODY = {"name": "body", "radius": 0.5, "position": [0.0, 0.6], "force": [0.0, -3.0]}
IN_SPACE = BODY | {"position": [0.3, 0.0, 0.6], "force": [0.0, 0.0, -3.0]}


def filled(fill: Fill) -> Path:
    """The folder of a disc with its times and heights, and the table of its steps."""
    folder = fill([0.0, 1.0, 2.0], [1.2, 1.1, 1.01])
    (folder / "steps.csv").write_text("step,t,apparent_viscosity\n0,0.0,2.0\n1,1.0,2.5\n2,2.0,3.0\n")
    return folder


def test_curves_of_a_run(settling_run: Fill) -> None:
    history = read_history(fsi.open_run(filled(settling_run)))
    np.testing.assert_allclose(history.panels["gap"]["disc"], [0.2, 0.1, 0.01], rtol=1e-12)
    np.testing.assert_allclose(history.panels["load"]["disc"], 1.0)
    np.testing.assert_allclose(history.panels["apparent viscosity"][""], [2.0, 2.5, 3.0])
    assert history.laws["exact"][0] == pytest.approx(0.2, rel=1e-12)


def test_chosen_gap_and_many_bodies(settling_run: Fill) -> None:
    run = fsi.open_run(filled(settling_run))
    far = read_history(run, "disc,far").panels["gap"]["gap disc,far"]
    np.testing.assert_allclose(far, 6.0 - np.array([1.2, 1.1, 1.01]) - 1.0, rtol=1e-12)
    summed = read_history(run, singly=0).panels["gap"]
    assert list(summed) == [f"{what} of 1 bodies" for what in ("smallest", "median", "largest")]


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("[time]", "slip_length = 0.1\n[time]"),
        ("domain.radius", "domain.walls.plane = {slip_length = 0.2}\ndomain.radius"),
        (
            "[time]",
            '[[forces]]\nkind = "gravity"\nacceleration = [0.0, -9.0]\ndensity_difference = 1.0\n[time]',
        ),
    ],
)
def test_no_curve_is_called_exact_where_the_law_does_not_hold(settling_run: Fill, old: str, new: str) -> None:
    """Slip on the body or on the plane, and a weight beside its force."""
    case = filled(settling_run) / "case.toml"
    assert [*read_history(fsi.open_run(case.parent)).laws] == ["exact", "asymptote"]
    case.write_text(case.read_text().replace(old, new))
    history = read_history(fsi.open_run(case.parent))
    assert "gap" in history.panels
    assert history.laws == {}


@pytest.mark.parametrize(
    ("geometry", "late", "difference"),
    [("planar", 1e4, 2e-3), ("axisymmetric", 40.0, 1e-9), ("spatial", 40.0, 1e-9)],
)
def test_asymptote_is_that_of_the_exact_gap(geometry: str, late: float, difference: float) -> None:
    """Discs: a last term of order t^-1 is left; spheres: only the prefactor was fitted, the rate was not."""
    case = parse_case(
        {
            "name": "settling",
            "geometry": geometry,
            "fluid": {"viscosity": 0.7},
            "domain": {"shape": "half-plane", "radius": 100.0},
            "bodies": [IN_SPACE if geometry == "spatial" else BODY],
        }
    )
    t = np.array([0.9, 1.0]) * late
    np.testing.assert_allclose(asymptotic_gap(case, t), exact_gap(case, t), rtol=difference)


@pytest.mark.parametrize("suffix", [".png", ".svg", ".pdf"])
def test_files_by_suffix(settling_run: Fill, suffix: str) -> None:
    run = fsi.open_run(filled(settling_run))
    output = run.path / f"history{suffix}"
    plot_runs([run, run], output)
    begins = {".png": b"\x89PNG", ".svg": b"<?xml", ".pdf": b"%PDF"}
    assert output.read_bytes().startswith(begins[suffix])


def test_unknown_suffix(settling_run: Fill) -> None:
    run = fsi.open_run(filled(settling_run))
    with pytest.raises(InputError, match=r"history\.jpg: give the path of a \.png, \.svg or \.pdf file"):
        plot_runs([run], run.path / "history.jpg")


def test_a_panel_that_is_registered_is_drawn(settling_run: Fill, monkeypatch: pytest.MonkeyPatch) -> None:
    run = fsi.open_run(filled(settling_run))
    monkeypatch.setattr(histories, "_PANELS", dict(histories._PANELS))
    register_panel("twice", lambda asked: {"": 2.0 * asked.run.steps["apparent_viscosity"].to_numpy()})
    register_panel("none", of_steps("no_such_column"))
    panels = read_history(run).panels
    assert [*panels][-2:] == ["apparent viscosity", "twice"]
    np.testing.assert_allclose(panels["twice"][""], [4.0, 5.0, 6.0])
    plot_runs([run], run.path / "history.png")
