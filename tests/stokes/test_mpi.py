"""The same numbers on 1, 2 and 3 ranks, through the command a user types."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from tests.ranks import json_on

CASE = """
name = "three discs"
[fluid]
viscosity = 0.7
[domain]
lower = [-4.0, 0.0]
upper = [4.0, 6.0]
walls.top = [1.0, 0.0]
[[bodies]]
name = "free"
radius = 1.0
position = [-1.2, 1.05]
force = [0.0, -1.0]
[[bodies]]
name = "mixed"
radius = 1.0
position = [0.9, 1.5]
velocity = [0.5, "free"]
torque = 0.3
[[bodies]]
name = "small"
radius = 0.3
position = [0.0, 4.0]
velocity = [0.0, -1.0]
angular_velocity = 1.0
[discretisation]
cells_per_circle = 24
growth = 0.4
"""


def numbers(result: Any) -> NDArray[np.float64]:
    """Velocities, forces and torques of all bodies, relative to their largest of each kind."""
    rows = [[*b["velocity"], b["angular_velocity"], *b["force"], b["torque"]] for b in result["bodies"]]
    relative: NDArray[np.float64] = np.array(rows) / np.abs(rows).max(axis=0)
    return relative


@pytest.mark.mpi
@pytest.mark.parametrize("formulation", ["eliminated", pytest.param("multiplier", marks=pytest.mark.slow)])
def test_ranks_agree(formulation: str, tmp_path: Path) -> None:
    """To 1e-9; a node that one rank forgot to constrain would show at 1e-3."""
    case = tmp_path / "case.toml"
    case.write_text(f'{CASE}formulation = "{formulation}"\n')
    serial, two, three = (json_on(ranks, "solve", case) for ranks in (1, 2, 3))
    for other in (two, three):
        assert_allclose(numbers(other), numbers(serial), rtol=0, atol=1e-9)
        assert other["dissipation_infinite"] == serial["dissipation_infinite"]  # the lid slides
        assert (other["dofs"], other["cells"]) == (serial["dofs"], serial["cells"])
        assert max(other["checks"].values()) < 1e-8


def velocities(result: Any) -> NDArray[np.float64]:
    """Of all bodies."""
    return np.array([[*b["velocity"], b["angular_velocity"]] for b in result["bodies"]])


@pytest.mark.mpi
def test_ranks_agree_on_bodies_that_one_of_them_meets(tmp_path: Path) -> None:
    """To 1e-9: the rank around them eliminates the velocities that rank 0 has, which else would be zero."""
    row = [
        f'[[bodies]]\nname = "{k}"\nradius = 1.0\nposition = [{3 * k + 1.5}, 1.6]\nforce = [0.5, {k - 2.0}]\n'
        for k in range(5)
    ]
    case = tmp_path / "case.toml"
    case.write_text(
        'name = "row"\n[fluid]\nviscosity = 0.7\n[domain]\nlower = [0.0, 0.0]\nupper = [15.0, 3.0]\n'
        f"[discretisation]\ncells_per_circle = 16\ngrowth = 1.0\n{''.join(row)}"
    )
    serial, two, three = (json_on(ranks, "solve", case) for ranks in (1, 2, 3))
    for other in (two, three):
        assert_allclose(velocities(other), velocities(serial), rtol=0, atol=1e-9)
        assert other["dissipation"] == pytest.approx(serial["dissipation"], rel=1e-9)


SHARED = """
[discretisation]
cells_per_gap = 0.3
cells_per_circle = 16
growth = 1.0
[[bodies]]
name = "one"
radius = 1.0
position = [0.4, -1.3]
[[bodies]]
name = "other"
radius = 0.8
position = [3.1, 0.2]
"""
PERIODIC = {
    "channel": 'periodic = ["x"]\nlower = [0.0, -2.6]\nupper = [5.0, 2.6]\nnet_flux = 1.0\n'
    "walls.top = [1.0, 0.0]",
    "cell": 'shape = "cell"\nvectors = [[5.0, 0.0], [0.0, 5.0]]\nshear = 1.0',
}


@pytest.mark.mpi
@pytest.mark.parametrize("kind", [pytest.param("channel", marks=pytest.mark.slow), "cell"])
def test_ranks_agree_on_periodic_flow(kind: str, tmp_path: Path) -> None:
    """To 1e-9; a slave whose master lies on another rank is where this could fail."""
    case = tmp_path / "case.toml"
    case.write_text(f'name = "periodic"\n[fluid]\nviscosity = 0.7\n[domain]\n{PERIODIC[kind]}\n{SHARED}')
    serial, *others = (json_on(ranks, "solve", case) for ranks in (1, 2, 3))
    for other in others:
        for key in ("mean_stress", "apparent_viscosity", "dissipation"):
            assert_allclose(other[key], serial[key], rtol=1e-9, atol=1e-9)
        assert_allclose(velocities(other), velocities(serial), rtol=0, atol=1e-9)


SHAPES = """
name = "shapes"
fluid.viscosity = 1.0
domain = { shape = "cell", vectors = [[5.0, 0.0], [1.0, 4.0]], shear = 1.0 }
discretisation = { degree = 3, cells_per_circle = 16, growth = 0.6 }
[[bodies]]
name = "ellipse"
shape = { kind = "ellipse", axes = [1.2, 0.6] }
position = [0.6, 1.5]
angle = 0.5
[[bodies]]
name = "rod"
shape = { kind = "stadium", length = 1.4, radius = 0.3 }
position = [3.2, 2.6]
angle = 2.0
slip_length = 0.1
"""


@pytest.mark.mpi
@pytest.mark.slow
@pytest.mark.parametrize("degree", [3, 6])
def test_ranks_agree_on_shapes_across_periods(degree: int, tmp_path: Path) -> None:
    """A node that is taken for one of another image turns around a centre a period away.

    Of degree 6 each side has five nodes, whose order two cells must see alike.
    """
    case = tmp_path / "case.toml"
    case.write_text(SHAPES.replace("degree = 3", f"degree = {degree}"))
    serial, two, three = (json_on(ranks, "solve", case) for ranks in (1, 2, 3))
    for other in (two, three):
        assert_allclose(velocities(other), velocities(serial), rtol=0, atol=1e-9)
        assert other["apparent_viscosity"] == pytest.approx(serial["apparent_viscosity"], rel=1e-9)
        assert max(other["checks"].values()) < 1e-8


LAWS = """
name = "laws below a gap"
geometry = "spatial"
fluid.viscosity = 0.7
lubrication.below = 0.05
domain = { shape = "cell", vectors = [[4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.5]], shear = 1.0 }
discretisation = { degree = 2, cells_per_gap = 0.5, cells_per_circle = 8, growth = 1.0, solver = "iterative" }
[[bodies]]
name = "free"
radius = 1.0
position = [1.0, 1.0, 1.0]
[[bodies]]
name = "other"
radius = 0.9
position = [2.9000001, 1.0, 1.0]
"""


@pytest.mark.mpi
@pytest.mark.slow
def test_ranks_agree_on_laws_below_a_gap(tmp_path: Path) -> None:
    """All modes, and what laws put between them, stand on rank 0; a pair 1e-7 apart has its solves beside."""
    case = tmp_path / "case.toml"
    case.write_text(LAWS)
    serial, *others = (json_on(ranks, "solve", case) for ranks in (1, 2, 3))
    assert serial["law_dissipation"] > 0.1
    for other in others:
        for key in ("mean_stress", "apparent_viscosity", "dissipation", "law_dissipation"):
            assert_allclose(other[key], serial[key], rtol=1e-8, atol=1e-8)
