"""What groups of cells have alone is eliminated once, and needs no pivoting."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import fsi.meshes.backend  # noqa: F401

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from numpy.typing import NDArray

import fsi.stokes.discretisation.groups as module
from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.meshes.build import FluidMesh
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.round import HalfPlane
from fsi.meshes.resolution import Resolution
from fsi.stokes.discretisation.groups import Groups
from fsi.stokes.discretisation.loops import loops
from fsi.stokes.problem import SolverOptions
from fsi.stokes.resistance import held_at_rest
from fsi.stokes.solve import Clock, assembled
from fsi.stokes.solvers.reduced import Added
from tests.flows import discs, mesh

LIGHT = Resolution(cells_per_gap=0.3, cells_per_circle=12, growth=1.0)
REFERENCE = Path(__file__).parents[1] / "reference"
# Corners of boxes have cells with two sides on walls, an axis has velocities along it, a cut cells across it.
FLOWS = {
    "box": (Box((-2.0, -2.0), (2.0, 2.0)), discs([(0.3, -0.4)], [1.0])),
    "channel": (Box((0.0, -2.6), (5.0, 2.6), periodic=("x",)), discs([(0.4, -1.3), (2.1, 0.2)], [1.0, 0.8])),
    "cell": (Box((0.0, 0.0), (4.0, 4.0), periodic=("x", "y")), discs([(0.4, 1.3), (2.7, 3.1)], [1.0, 0.9])),
    "axis": (HalfPlane(6.0, axisymmetric=True), discs([(0.0, 1.002)], [1.0])),
    "narrow": (HalfPlane(6.0), discs([(0.0, 1.0001)], [1.0])),
}


@pytest.fixture(autouse=True)
def of_few_cells(monkeypatch: pytest.MonkeyPatch) -> None:
    """Merge the cells of these small meshes as those of large ones: at first all of them, then in regions."""
    monkeypatch.setattr(module, "FEWEST", 64)
    monkeypatch.setattr(module, "MOST", 16)


def of_merges(groups: Groups, name: str, kind: type, size: int) -> NDArray[Any]:
    """A copy of the first numbers of a list of `Groups` in merging.h."""
    held = loops().ffi.buffer(getattr(groups.structure, name), size * np.dtype(kind).itemsize)
    return np.frombuffer(held, dtype=kind).copy()


@dataclass(frozen=True, slots=True)
class Eliminated:
    """Of each merge of a flow its unknowns, how many are outer ones, and the pivots of the others."""

    groups: Groups
    lists: list[Array]
    outer: list[int]
    pivots: list[Array]
    pressure: NDArray[np.bool_]


def eliminated(
    container: Container,
    q: Configuration,
    degree: int,
    *,
    moving: bool = False,
    fluid: FluidMesh | None = None,
) -> Eliminated:
    problem = held_at_rest(fluid or mesh(container, q, LIGHT, degree), container, q)
    with assembled(problem, SolverOptions(degree), Clock()) as system:
        unknown = np.full(system.layout.modes, moving)
        added = Added(np.zeros(system.layout.modes))
        elimination = system.workspace.elimination(system.layout, system.rigid, unknown, added)
        assert elimination._sum is not None
        groups = elimination._sum._groups
        free = system.layout.free
        pressure = np.append(np.flatnonzero(free) >= system.layout.velocities, np.zeros(unknown.sum(), bool))
        merges = groups.structure.merges
        start = of_merges(groups, "start", np.int32, merges + 1)
        lists = np.split(of_merges(groups, "list", np.int32, start[-1]), start[1:-1])
        outer, pivots = of_merges(groups, "outer", np.int32, merges).tolist(), []
        begin = of_merges(groups, "factors", np.int64, merges + 1)
        for k, own in enumerate(lists):
            rows = groups.factors[begin[k] : begin[k + 1]].reshape(-1, len(own))
            pivots.append(rows[np.arange(len(rows)), outer[k] + np.arange(len(rows))].copy())
        return Eliminated(groups, lists, outer, pivots, pressure)


# A sphere on an axis has modes that do not move it.
MOVED = [(flow, moving) for flow in FLOWS for moving in (False, True) if not (moving and flow == "axis")]


@pytest.mark.parametrize("degree", [2, 3, 4, 5])
@pytest.mark.parametrize(("flow", "moving"), MOVED)
def test_pivots_of_velocities_are_positive_and_of_pressures_negative(
    flow: str, degree: int, moving: bool
) -> None:
    """As velocities go first, and what is left of the pressures is definite: nothing else needs pivoting."""
    found = eliminated(*FLOWS[flow], degree, moving=moving)
    assert len(found.lists) > 50
    for own, outer, pivots in zip(found.lists, found.outer, found.pivots, strict=True):
        expected = np.where(found.pressure[own[outer:]], -1.0, 1.0)
        assert_array_equal(np.sign(pivots), expected)


def test_each_unknown_is_eliminated_once_or_left() -> None:
    found = eliminated(*FLOWS["channel"], 4)
    inner = np.concatenate([own[outer:] for own, outer in zip(found.lists, found.outer, strict=True)])
    assert len(np.unique(inner)) == len(inner)
    left = np.unique(found.groups.list)
    assert_array_equal(np.sort(np.concatenate([inner, left])), np.arange(len(found.groups.left)))
    assert_array_equal(np.flatnonzero(found.groups.left), left)
    assert len(found.groups.start) - 1 == 2


def test_velocities_of_bodies_are_eliminated_too() -> None:
    """All three of each disc, of at least two: the two groups that remain meet at one of three in a row."""
    q = discs([(2.0, 0.1), (5.0, -0.2), (8.0, 0.0)], [1.0, 1.0, 1.0])
    found = eliminated(Box((0.0, -2.0), (10.0, 2.0)), q, 4, moving=True)
    modes = found.groups.left[-9:].reshape(3, 3)
    assert_array_equal(modes.all(axis=1), modes.any(axis=1))
    assert modes.any(axis=1).sum() <= 1


def test_regions_save_operations_in_long_channels(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of 1000 discs: regression, 0.75 of those that parts take that grow as they come."""
    given = json.loads((REFERENCE / "couette_N200.json").read_text())
    L, H = given["L"], given["H"]
    centres = np.concatenate([np.array(given["centers"]) + np.array([k * L, 0.0]) for k in range(5)])
    flow = Box((0.0, 0.0), (5.0 * L, H), periodic=("x",)), Configuration.unturned(centres, np.ones(1000))
    fluid = mesh(*flow, Resolution(0.15, 14, 0.7, "sparse"), 4)
    monkeypatch.setattr(module, "FEWEST", 512)
    taken = []
    for most in (1000, 1_000_000):
        monkeypatch.setattr(module, "MOST", most)
        found = eliminated(*flow, 4, moving=True, fluid=fluid)
        taken.append(
            sum(
                float((np.arange(outer, len(own)) ** 2).sum())
                for own, outer in zip(found.lists, found.outer, strict=True)
            )
        )
    assert taken[0] < 0.8 * taken[1]


def test_groups_leave_no_more_than_the_widest(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "FEWEST", 10_000)
    monkeypatch.setattr(module, "WIDEST", 60)
    found = eliminated(*FLOWS["channel"], 4)
    assert 2 < len(found.groups.start) - 1 < 64
    assert 50 < max(found.outer) <= 60


def test_what_must_stay_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of cells in a ring, each with two unknowns of its own and one on each side, the marked ones stay."""
    for name, value in (("LEVELS", 1), ("FEWEST", 2), ("WIDEST", 0)):
        monkeypatch.setattr(module, name, value)
    # Unknowns k and 32 + k are those of cell k, 16 + k lies between that and the next.
    cells = 16
    lists = np.array([[k, 16 + k, 16 + (k - 1) % cells, 32 + k] for k in range(cells)], dtype=np.int32)
    start = np.arange(0, 4 * cells + 1, 4, dtype=np.int32)
    stays, pressure = np.zeros((2, 3 * cells), dtype=bool)
    stays[[3, 20]] = True
    groups = Groups((start, lists.ravel()), 4, stays, pressure, merged=True)
    assert groups.left[[3, 20]].all()
    # Cells merge across a side that does not stay, and have that and four more alone, of which one stays.
    merges = cells - (len(groups.start) - 1)
    assert merges == groups.structure.merges > 5
    assert (~groups.left).sum() == 5 * merges - 1
