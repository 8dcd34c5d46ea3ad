"""The flow of a case by elements of a higher degree on a finer mesh: `bench.bars` holds bars against it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import fields, replace
from itertools import pairwise
from typing import Any

import numpy as np

from fsi.bodies.configuration import Configuration
from fsi.case.case import Case
from fsi.case.sections import MOST_FEW
from fsi.meshes.build import FluidMesh, build
from fsi.meshes.geometry.container import Container, FluidDomain
from fsi.meshes.geometry.curves import WallCurve
from fsi.meshes.spatial.grading import COARSEST
from fsi.stokes.meshes import CaseMeshes
from fsi.stokes.model import StokesModel
from fsi.stokes.solution import StokesSolution
from fsi.stokes.walls import singular_pairs

# How much finer the reference is: in space, where its degree is one more, a refinement costs ten times as
# much, of many bodies 10 GB.
FINER, OF_MANY = {2: 2.0, 3: 1.2}, 1.4
DEGREE_IN_PLANE = 5  # or one more than the case has
HALVINGS = 20
EDGES = 1.5  # how much finer cells beside edges in space are


class Reference(StokesModel):
    """The model of a case with finer sizes, and in the plane graded walls.

    instead: the sizes that the mesh of the case took, where those asked for gave none; these are no coarser.
    """

    def __init__(self, case: Case, instead: str = "") -> None:
        now, finer = case.discretisation, OF_MANY if len(case.bodies) > MOST_FEW else FINER[case.dimension]
        sizes = {
            "cells_per_gap": finer * now.cells_per_gap,
            "cells_per_circle": int(np.ceil(finer * now.cells_per_circle)),
            "growth": now.growth / finer,
        }
        for name, taken in re.findall(r"(\w+) = ([\d.e+-]+)", instead):
            sizes[name] = (min if name == "growth" else max)(sizes[name], type(sizes[name])(taken))
        if case.dimension == 3 and singular_pairs(case):
            sizes["growth"] = min(now.growth, COARSEST) / EDGES
        super().__init__(case.model_copy(update={"discretisation": now.model_copy(update=sizes)}))
        self.meshes = GradedMeshes(self.case)


class GradedMeshes(CaseMeshes):
    """The meshes of a case, in the plane with graded walls."""

    def scaled_mesh(self, q: Configuration, t: float = 0.0, order: int | None = None) -> FluidMesh:
        """A new mesh in the units of the model."""
        container = graded(self._container.at(t))
        here = self.units.scaled_configuration(q)
        shapes, standing = here.placed, here.standing
        domain = FluidDomain(
            container, here.centres, here.radii, edges=self._edges, placed=shapes, ellipsoids=standing
        )
        return build(domain, self.resolution, order or self.case.discretisation.degree)


def reference(case: Case, instead: str = "") -> StokesSolution:
    """The case with elements of a higher degree on a finer mesh than it, or what it took `instead`, has."""
    q = case.configuration()
    degree = max(DEGREE_IN_PLANE if case.dimension == 2 else 0, case.discretisation.degree + 1)
    return Reference(case, instead).of_degree(degree, q, 0.0, case.motion_at(q, 0.0))


def graded(container: Container) -> Container:
    """The same container, in the plane with pieces of walls that halve towards corners."""
    kind: Any = type(container)
    if container.dimension == 3 or len(container.periods):
        return container

    class Graded(kind):  # type: ignore[misc]
        def outline(self) -> tuple[WallCurve, ...]:
            return tuple(piece for curve in kind.outline(self) for piece in halving(curve))

    graded: Container = Graded(*(getattr(container, field.name) for field in fields(kind)))
    return graded


def halving(curve: WallCurve) -> Iterator[WallCurve]:
    """Pieces of a wall that halve towards both its ends, each of them one element at least."""
    start, end = curve.interval
    parts = 0.5 ** np.arange(HALVINGS, 0, -1)
    places = start + (end - start) * np.concatenate([[0.0], parts, 1.0 - parts[-2::-1], [1.0]])
    points = curve.at(places)
    points[[0, -1]] = curve.ends
    for k, (low, high) in enumerate(pairwise(places)):
        longest = min(high - low, curve.longest_element)
        yield replace(
            curve, interval=(low, high), ends=points[k : k + 2], longest_element=longest, fewest_elements=1
        )
