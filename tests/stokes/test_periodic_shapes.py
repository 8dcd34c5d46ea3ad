"""Bodies that are no discs in channels and cells: against discs, their images, and meshes made anew."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.case.case import Case
from fsi.case.load import parse_case
from fsi.stokes.model import StokesModel
from fsi.stokes.solution import StokesSolution

CHANNEL = {
    "lower": [0.0, 0.0],
    "upper": [5.0, 4.0],
    "periodic": ["x"],
    "walls": {"bottom": [-2.0, 0.0], "top": [2.0, 0.0]},
}
SHEARED = {"shape": "cell", "vectors": [[5.0, 0.0], [0.0, 4.0]], "shear": 1.0}
STRETCHED = {"shape": "cell", "vectors": [[5.0, 0.0], [0.0, 4.0]], "extension": 1.0}
COARSE = {"degree": 3, "cells_per_circle": 24, "growth": 0.4}
EACH = pytest.mark.parametrize("domain", [CHANNEL, SHEARED, STRETCHED], ids=["channel", "shear", "extension"])


def ellipse(x: float, y: float, angle: float = 0.0, axes: tuple[float, float] = (1.2, 0.6)) -> dict[str, Any]:
    return {"shape": {"kind": "ellipse", "axes": axes}, "position": [x, y], "angle": angle}


def periodic(domain: dict[str, Any], *bodies: dict[str, Any], **sections: Any) -> Case:
    named = [{"name": f"body {i}"} | body for i, body in enumerate(bodies)]
    data = {"name": "periodic", "fluid": {"viscosity": 1.0}, "domain": domain, "bodies": named}
    return parse_case(data | {"discretisation": COARSE} | sections)


def solved(case: Case) -> StokesSolution:
    return StokesModel(case)(case.configuration(), 0.0)


def relative_velocities(solution: StokesSolution, q: Configuration) -> Array:
    """Less the mean flow at the centres, which all images have alike.

    In a cell without walls also less that of the first: how fast all drift depends on the areas of bodies,
    which are meshed to 1e-9, times the mean flow at their images.
    """
    U, container = solution.U.copy(), solution.problem.container
    U[:, :2] -= container.mean_velocity(q.centres)
    if not container.walls:
        U[:, :2] -= U[0, :2].copy()
    return U


@EACH
def test_round_ellipses_are_discs(domain: dict[str, Any]) -> None:
    """The same places of links and nodes: velocities, stresslets and mean stress agree to 1e-9."""
    places = [[0.3, 1.6], [2.7, 1.3], [4.0, 2.7]]
    radii = [0.8, 0.8, 0.8]
    found = []
    for shaped in (False, True):
        bodies = [{"shape": {"kind": "ellipse", "axes": [a, a]}} if shaped else {"radius": a} for a in radii]
        case = periodic(domain, *(b | {"position": x} for b, x in zip(bodies, places, strict=True)))
        found.append(solved(case))
    discs, shapes = found
    assert discs.bulk is not None
    assert shapes.bulk is not None
    np.testing.assert_allclose(shapes.U, discs.U, atol=1e-9 * np.abs(discs.U).max())
    scale = np.abs(discs.bulk.stresslets).max()
    np.testing.assert_allclose(shapes.bulk.stresslets, discs.bulk.stresslets, atol=1e-9 * scale)
    np.testing.assert_allclose(shapes.bulk.mean, discs.bulk.mean, atol=1e-9 * np.abs(discs.bulk.mean).max())


@EACH
def test_images_and_half_turns_are_the_same_body(domain: dict[str, Any]) -> None:
    """An ellipse goes over into itself by half a turn; a cell without walls also by its other period."""
    up = 0.0 if domain is CHANNEL else -4.0
    here = periodic(domain, ellipse(0.25, 1.5, 0.5), ellipse(3.0, 2.5, 2.0))
    there = periodic(domain, ellipse(-9.75, 1.5, 0.5 + np.pi), ellipse(8.0, 2.5 + up, 2.0 - np.pi))
    one, other = solved(here), solved(there)
    assert one.bulk is not None
    assert other.bulk is not None
    U = [relative_velocities(s, c.configuration()) for s, c in ((one, here), (other, there))]
    np.testing.assert_allclose(U[1], U[0], atol=1e-9 * np.abs(U[0]).max())
    np.testing.assert_allclose(other.bulk.stresslets, one.bulk.stresslets, atol=1e-9)
    assert max(one.checks.values()) < 1e-9


def test_a_rod_longer_than_its_period_has_all_its_identities() -> None:
    """Its ends are nearer to the centre of an image: they must not turn around that."""
    rod = {"shape": {"kind": "stadium", "length": 2.6, "radius": 0.3}, "angle": 0.25 * np.pi}
    narrow = CHANNEL | {"upper": [2.0, 4.0]}
    found = [solved(periodic(narrow, rod | {"position": [x, 2.0]})) for x in (0.2, 1.2)]
    for solution in found:
        assert max(solution.checks.values()) < 1e-10
        assert solution.U[0, 2] < 0.0
    # It sees the same wherever it stands along the channel, but for the mesh.
    np.testing.assert_allclose(found[1].U, found[0].U, atol=2e-5)


def test_a_mesh_moved_with_turning_bodies_and_its_lattice_is_as_good_as_a_new_one() -> None:
    bodies = ellipse(0.6, 1.5, 0.5), ellipse(2.9, 2.6, 2.0), {"radius": 0.4, "position": [3.0, 0.8]}
    new = periodic(SHEARED, *bodies)
    moving = periodic(SHEARED, *bodies, time={"end": 1.0, "remesh": "when-needed"})
    model, q = StokesModel(moving), moving.configuration()
    first, dt = model(q, 0.0), 0.08
    after = q.moved(dt * first.U)
    moved, anew = model(after, dt), StokesModel(new)(after, dt)
    assert moved.dofs == first.dofs
    assert np.abs(moved.U - first.U).max() > 1e-2
    np.testing.assert_allclose(moved.U, anew.U, atol=2e-4)
