"""The mean stress of a periodic flow: of any pressure, from both walls; and the bound of its viscosity."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fsi.errors import SolveError
from fsi.meshes.geometry.box import Box
from fsi.meshes.resolution import Resolution
from fsi.observables.bulk_stress import BulkStress
from fsi.stokes.identities import require
from fsi.stokes.problem import Boundary, StokesProblem
from fsi.stokes.solve import FORMULATIONS
from fsi.stokes.solvers.elimination import solve_eliminated
from fsi.stokes.solvers.reduced import Added
from fsi.stokes.solvers.system import NodalSolution, StokesSystem
from fsi.stokes.stress import viscosity_checks
from tests.flows import discs, free, solved
from tests.periodic import LIGHT, THREE, force_free, in_cell, square

SHEARED: Any = square(5.0, 1.0)


def under_pressure(system: StokesSystem) -> list[NodalSolution]:
    """The same flow with the pressure raised by 7 everywhere, and the reactions that go with it."""
    (good,) = solve_eliminated(system)
    x, reaction = good.x.copy(), np.zeros_like(good.reaction)
    x[system.layout.velocities :] += 7.0
    none = Added(np.zeros(system.layout.modes))
    M = system.workspace.elimination(system.layout, system.rigid, system.unknown_modes, none).constrained
    reaction[M.rows] = M.times(x) - system.b[M.rows]
    return [dataclasses.replace(good, x=x, reaction=reaction)]


def test_the_stress_does_not_know_the_level_of_the_pressure(monkeypatch: pytest.MonkeyPatch) -> None:
    """Stresslets without the mean pressure would be off by 7 pi a^2 on their diagonals, 22 here.

    On these cells the area of a disc is that of a circle to 4e-8.
    """
    before = in_cell(SHEARED, THREE, resolution=LIGHT).bulk
    monkeypatch.setitem(FORMULATIONS, "eliminated", under_pressure)
    after = in_cell(SHEARED, THREE, resolution=LIGHT).bulk
    assert before is not None
    assert after is not None
    assert_allclose(after.stresslets, before.stresslets, rtol=0, atol=2e-6)
    assert_allclose(after.mean, before.mean, rtol=0, atol=2e-6)
    assert_allclose(np.trace(before.fluid), 0.0, atol=1e-9)


def test_the_wall_stress_is_that_of_both_walls() -> None:
    """Turned by 180 degrees the shear is the same, heights and forces are opposite: so is no viscosity.

    Most of the force goes to the wall that is nearer: the stress on one alone is larger by 0.3 and smaller.
    """
    channel = Box((0.0, -2.0), (5.0, 2.0), periodic=("x",))
    walls = {"bottom": lambda x: -2.0 + 0.0 * x, "top": lambda x: 2.0 + 0.0 * x}
    moving = Boundary({name: _along_x(u) for name, u in walls.items()}, {})
    mu = []
    for side in (1.0, -1.0):
        q = discs([(1.0, 0.6 * side)], [1.0])
        found = solved(channel, q, free((3.0 * side, 0.0, 0.0)), moving, Resolution(0.5, 24, 0.5))
        assert found.apparent_viscosity is not None
        mu.append(found.apparent_viscosity)
    assert mu[1] == pytest.approx(mu[0], rel=1e-4)


def _along_x(u: Any) -> Any:
    return lambda x: u(x) * np.array([1.0, 0.0])


@pytest.mark.parametrize(("mu", "defect"), [(1.25, 0.0), (1.3, 0.0), (1.2, 1.25 / 1.2 - 1.0), (1.0, 0.25)])
def test_a_viscosity_below_the_bound_is_noticed(mu: float, defect: float) -> None:
    """mu_app >= mu/(1 - phi): a disc that fills a fifth makes at least 1.25 of 1."""
    area = 5.0 * np.pi
    E = np.array([[0.0, 0.5], [0.5, 0.0]])
    stresslet = (mu - 1.0) * 2.0 * E * area
    bulk = BulkStress(2.0 * E, stresslet[None], np.zeros((2, 2)), area, mu)
    q = discs([(0.0, 0.0)], [1.0])
    cell = square(np.sqrt(area), 1.0)
    problem = StokesProblem(None, cell, q, force_free(q), Boundary({}, {}))  # type: ignore[arg-type]
    checks = viscosity_checks(problem, bulk, mu * area)
    assert checks["stress"] == pytest.approx(0.0, abs=1e-14)
    assert checks["viscosity_bound"] == pytest.approx(defect, abs=1e-14)
    if defect > 0.0:
        with pytest.raises(SolveError, match="violates the identity `viscosity_bound`"):
            require(dict(checks))
