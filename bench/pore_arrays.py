"""Square and hexagonal arrays of discs: drag and the two viscosities, by pores and by elements.

The drag is F / (mu U), U the velocity of the disc where the mean velocity of all is zero; viscosities are
those of extension along the lattice vector x and of shear along it, over that of the fluid. Those of the
hexagonal array are equal.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration, Motion
from fsi.meshes.build import build
from fsi.meshes.geometry.cell import Cell
from fsi.meshes.geometry.container import FluidDomain
from fsi.meshes.resolution import Resolution
from fsi.pores.solve import PoreLoading, solve_pores
from fsi.pores.surfaces import surfaces_of
from fsi.pores.system import PoreSystem
from fsi.stokes.problem import Boundary, SolverOptions, StokesProblem
from fsi.stokes.solve import solve

LATTICES = {"square": np.eye(2), "hexagonal": np.array([[1.0, 0.0], [0.5, 0.75**0.5]])}
FRACTIONS = (0.3, 0.4, 0.5, 0.6, 0.7)
QUANTITIES = ("drag", "extension", "shear")
TABLE = Path(__file__).parents[1] / "tests" / "reference" / "square_array_drag.json"
DEGREE, FINE = 5, Resolution(cells_per_gap=0.5, cells_per_circle=32)
ONE = Configuration.unturned(np.array([[0.1, 0.2]]), np.ones(1))
FLOWS = (np.zeros((2, 2)), np.diag([0.5, -0.5]), np.array([[0.0, 1.0], [0.0, 0.0]]))


def cell_of(lattice: str, c: float, gradient: Array) -> Cell:
    """Of one disc of radius 1 at area fraction c."""
    vectors = LATTICES[lattice]
    (ax, ay), (bx, by) = (vectors * np.sqrt(np.pi / c / np.linalg.det(vectors))).tolist()
    (gxx, gxy), (gyx, gyy) = gradient.tolist()
    return Cell(((ax, ay), (bx, by)), ((gxx, gxy), (gyx, gyy)))


def motion_in(gradient: Array) -> Motion:
    """Towed along x without a mean flow, free in it."""
    towed = not np.any(gradient)
    U = np.array([[float(towed), 0.0, 0.0]])
    return Motion(np.full((1, 3), towed), U, np.zeros((1, 3)))


def array_values(lattice: str, c: float, modes: int) -> Array:
    """Drag and viscosities by pores with so many modes, (3,)."""
    found = []
    for gradient in FLOWS:
        cell = cell_of(lattice, c, gradient)
        system = PoreSystem.make(surfaces_of(ONE, cell), modes, 1.0)
        loading = PoreLoading(motion_in(gradient), np.zeros((0, 3)), gradient)
        found.append(_value(solve_pores(system, loading).dissipation, cell))
    return np.array(found)


def reference_values(lattice: str, c: float) -> Array:
    """The same by elements, (3,); drags of the square array by the literature, where it has them."""
    found = []
    for gradient in FLOWS:
        cell = cell_of(lattice, c, gradient)
        fluid = build(FluidDomain(cell, ONE.centres, ONE.radii), FINE, DEGREE)
        problem = StokesProblem(fluid, cell, ONE, motion_in(gradient), Boundary({}, {}))
        found.append(_value(solve(problem, SolverOptions(DEGREE)).dissipation, cell))
    table = json.loads(TABLE.read_text())
    found[0] = table.get(lattice, {}).get(f"{c:g}", found[0])
    return np.array(found)


def _value(dissipation: float, cell: Cell) -> float:
    """The drag is the dissipation at speed 1; that of a flow of viscosity mu is 2 mu E : E |cell|."""
    G = cell.mean_gradient
    E = 0.5 * (G + G.T)
    return dissipation / (2.0 * float(np.sum(E * E)) * cell.volume if np.any(G) else 1.0)
