"""The flow without bodies, and the walls that drive it."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import fsi
from fsi.postprocess.render.mean_flow import UndisturbedFlow, is_sheared, sliding_walls, undisturbed

BODY = '[[bodies]]\nname = "disc"\nradius = 0.2\nposition = [1.0, 0.5]\n'
CHANNEL = 'domain.lower = [0.0, 0.0]\ndomain.upper = [4.0, 2.0]\ndomain.periodic = ["x"]\n'
number = st.floats(-5.0, 5.0)


def run_of(folder: Path, domain: str) -> fsi.Run:
    """A run of which only the case and the time of a step with fields are there."""
    (folder / "case.toml").write_text(f'name = "flow"\nfluid.viscosity = 1.0\n{domain}{BODY}')
    entry = '<DataSet timestep="0.5" part="0" file="fields/fluid_000003.vtu"/>'
    (folder / "fluid.pvd").write_text(f"<VTKFile><Collection>{entry}</Collection></VTKFile>")
    return fsi.open_run(folder)


@given(st.tuples(number, number), st.tuples(number, number, number), st.tuples(number, number))
def test_the_stream_function_is_that_of_the_flow(
    u_0: tuple[float, ...], E: tuple[float, ...], x: tuple[float, ...]
) -> None:
    """u = (d psi / dy, -d psi / dx), by differences, which are exact for a quadratic."""
    flow = UndisturbedFlow(np.array(u_0), np.array([[E[0], E[1]], [E[2], -E[0]]]))
    at, step = np.array([[*x, 0.0]]), np.eye(3)[:, None]
    d = [(flow.stream_function(at + step[k]) - flow.stream_function(at - step[k])) / 2.0 for k in (0, 1)]
    np.testing.assert_allclose(flow.at(at)[0, :2], [d[1][0], -d[0][0]], atol=1e-9)


def test_a_channel(tmp_path: Path) -> None:
    """Walls at y = 0 and 2 with the speeds -1 and 3: u = (2 y - 1, 0)."""
    run = run_of(tmp_path, CHANNEL + "domain.walls.bottom = [-1.0, 0.0]\ndomain.walls.top = [3.0, 0.0]\n")
    flow = undisturbed(run, 3)
    assert flow is not None
    np.testing.assert_allclose(flow.at(np.array([[7.0, 0.25, 0.0]])), [[-0.5, 0.0, 0.0]])
    assert is_sheared(run)
    walls = [(wall.axis, wall.place, wall.outward, wall.speed) for wall in sliding_walls(run, 3)]
    assert walls == [(1, 0.0, -1.0, -1.0), (1, 2.0, 1.0, 3.0)]


def test_a_sheared_cell(tmp_path: Path) -> None:
    cell = 'domain.shape = "cell"\ndomain.vectors = [[4.0, 0.0], [0.0, 4.0]]\ndomain.shear = 2.0\n'
    run = run_of(tmp_path, cell)
    flow = undisturbed(run, 3)
    assert flow is not None
    np.testing.assert_allclose(flow.gradient, [[0.0, 2.0], [0.0, 0.0]])
    assert sliding_walls(run, 3) == []


@pytest.mark.parametrize(
    "domain",
    [
        "domain.lower = [0.0, 0.0]\ndomain.upper = [4.0, 2.0]\ndomain.walls.top = [3.0, 0.0]\n",
        CHANNEL,
        CHANNEL + "domain.pressure_gradient = -1.0\n",
    ],
)
def test_flows_of_which_there_is_no_part_to_subtract(domain: str, tmp_path: Path) -> None:
    assert not is_sheared(run_of(tmp_path, domain))
