"""The same numbers on 1, 2 and 3 ranks, through the command a user types."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from tests.ranks import json_of_each, json_on

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
cells_per_circle = 16
growth = 1.0
"""


def numbers(result: Any) -> NDArray[np.float64]:
    """Velocities with spins, forces with torques of all bodies, over the largest where that is not 0."""
    motion = [[*b["velocity"], b["angular_velocity"]] for b in result["bodies"]]
    loads = [[*b["force"], b["torque"]] for b in result["bodies"]]
    return np.stack([np.array(rows) / max(np.abs(rows).max(), 0.1) for rows in (motion, loads)])


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

ROW = """
name = "row"
fluid.viscosity = 0.7
domain = { lower = [0.0, 0.0], upper = [15.0, 3.0] }
discretisation = { cells_per_circle = 16, growth = 1.0 }
""" + "".join(
    f'[[bodies]]\nname = "{k}"\nradius = 1.0\nposition = [{3 * k + 1.5}, 1.6]\nforce = [0.5, {k - 2.0}]\n'
    for k in range(5)
)
RESTING = CASE.replace("walls.top = [1.0, 0.0]\n", "")
OPEN = CASE.replace("walls.top", "walls.left = 'open'\nwalls.top")


def periodic(kind: str) -> str:
    return f'name = "periodic"\n[fluid]\nviscosity = 0.7\n[domain]\n{PERIODIC[kind]}\n{SHARED}'


# What would fail where: a node that one rank forgot to constrain shows at 1e-3; of ROW each rank eliminates
# velocities that rank 0 has, else zero; of flows across periods a slave's master lies on another rank, and a
# node of SHAPES taken for one of another image turns around a centre a period away, where of degree 6 each
# side has five nodes, whose order two cells must see alike.
class Asked(NamedTuple):
    """A command, its case, and what of its answer is compared besides all bodies."""

    command: str
    case: str
    keys: tuple[str, ...]


MATRICES = ("resistance", "mobility")
STRESS = ("mean_stress", "apparent_viscosity", "dissipation")
COMMANDS = {
    "three discs": Asked("solve", f'{CASE}formulation = "eliminated"\n', ()),
    "resistance": Asked("resistance", OPEN, MATRICES),
    "row": Asked("solve", ROW, ("dissipation",)),
    "channel": Asked("solve", periodic("channel"), STRESS),
    "cell": Asked("solve", periodic("cell"), STRESS),
    "shapes": Asked("solve", SHAPES, STRESS),
}
# Ranks of their own between two others, and masters of slaves on a third; three turn round and round on two
# processors while they wait, for twice as long as two.
ON_THREE = ("row", "channel")
LONGER = {
    "multipliers": Asked("solve", f'{RESTING}formulation = "multiplier"\n', ("dissipation",)),
    "shapes, degree 6": Asked("solve", SHAPES.replace("degree = 3", "degree = 6"), STRESS),
}


@pytest.mark.mpi
@pytest.mark.parametrize(
    ("asked", "numbers_of_ranks"),
    [
        pytest.param(COMMANDS, (2,), id="short"),
        pytest.param({name: COMMANDS[name] for name in ON_THREE}, (3,), id="on three"),
        pytest.param(COMMANDS, (3,), id="all on three", marks=pytest.mark.slow),
        pytest.param(LONGER, (2, 3), id="longer", marks=pytest.mark.slow),
    ],
)
def test_ranks_agree(asked: dict[str, Asked], numbers_of_ranks: tuple[int, ...], tmp_path: Path) -> None:
    """Forces and velocities of all bodies, viscosities, stresses and resistances, to 1e-9."""
    commands = []
    for name, one in asked.items():
        case = tmp_path / f"{name}.toml"
        case.write_text(one.case)
        commands.append((one.command, case))
    serial, *others = (json_of_each(ranks, commands) for ranks in (1, *numbers_of_ranks))
    for other in others:
        for name, expected, found in zip(asked, serial, other, strict=True):
            same(name, asked[name].keys, found, expected)


def same(name: str, keys: tuple[str, ...], found: Any, expected: Any) -> None:
    """Assert that two results are the same but for rounding, each relative to the largest of its kind."""
    assert (found["dofs"], found["cells"]) == (expected["dofs"], expected["cells"]), name
    assert found.get("dissipation_infinite") == expected.get("dissipation_infinite"), name  # a lid slides
    assert max(found["checks"].values()) < (1e-9 if "resistance" in keys else 1e-8), name
    for key in keys:
        value = np.array(expected[key], dtype=float)
        assert_allclose(found[key], value, rtol=0, atol=1e-9 * np.abs(value).max(), err_msg=f"{name}: {key}")
    if "resistance" not in keys:
        assert_allclose(numbers(found), numbers(expected), rtol=0, atol=1e-9, err_msg=name)


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
