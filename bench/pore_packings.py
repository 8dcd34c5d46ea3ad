"""Random packings in shear, their flows by pores and by elements, and how far apart two flows are."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from fsi.arrangements.arrangement import Wanted
from fsi.arrangements.kinds import arrange
from fsi.arrays import Array
from fsi.bodies.configuration import Configuration, Motion
from fsi.bodies.gaps import find_gaps
from fsi.meshes.build import build
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.cell import Cell
from fsi.meshes.geometry.container import Container, FluidDomain
from fsi.meshes.resolution import Resolution
from fsi.pores.bars import CHANCE, bar_factor, reference_modes
from fsi.pores.complement import LeastStresses
from fsi.pores.fluid_discs import pores_without_wide
from fsi.pores.solve import PoreLoading, solve_pores
from fsi.pores.surfaces import surfaces_of
from fsi.pores.system import PoreSystem
from fsi.stokes.problem import Boundary, SolverOptions, StokesProblem
from fsi.stokes.solve import solve

FRACTIONS = (0.2, 0.3, 0.4, 0.5, 0.6, 0.7)
NUMBERS = (10, 12, 16, 20)
MANY, EVERY = 50, 20  # one packing of so many has as many discs
GAP = 1e-3  # the least
SHEAR, EXTENSION = np.array([[0.0, 1.0], [0.0, 0.0]]), np.diag([0.5, -0.5])


@dataclass(frozen=True, slots=True)
class Packing:
    """Free discs at rate 1: in shear between walls, or in a cell in shear or extension. mu = 1."""

    name: str
    fraction: float
    q: Configuration
    container: Container

    @property
    def gradient(self) -> Array:
        """Of the mean flow, (2, 2)."""
        return self.container.mean_gradient if len(self.container.periods) == 2 else SHEAR

    @property
    def mean_flow(self) -> Array:
        """Velocities of the fluid alone where the discs are, (N, 2); zero in the middle."""
        mean: Array = (self.q.centres - self.container.middle) @ self.gradient.T
        return mean

    @property
    def walls(self) -> dict[str, Array]:
        """Velocities of the walls, (2,) each."""
        names, middle = self.container.walls, self.container.middle
        reach = self.container.distances(np.atleast_2d(middle))[0]
        normal = self.container.normals(np.atleast_2d(middle))[0]
        return dict(zip(names, -reach[:, None] * normal @ self.gradient.T, strict=True))


class SolvedPacking(NamedTuple):
    """Velocities of the discs, (N, 3), the dissipation, and how many unknowns it took."""

    U: Array
    dissipation: float
    unknowns: int


class Deviation(NamedTuple):
    """Of one flow from another, relative to the other; root mean squares but of the viscosity.

    Attributes:
        viscosity: signed; with bodies free of force, that of the dissipation.
        velocities: of those less the mean flow.
        spins: of the spins.
        rates: of the N narrowest gaps, with walls too.
    """

    viscosity: float
    velocities: float
    spins: float
    rates: float


def packings(cases: int, seed: int) -> Iterator[Packing]:
    """All fractions in turn, then both cells, then radii that are equal, of ratio 1.5, equal, of ratio 2."""
    for n in range(cases):
        fraction, turn = FRACTIONS[n % len(FRACTIONS)], n // len(FRACTIONS)
        number = MANY if n % EVERY == EVERY - 1 else NUMBERS[turn % len(NUMBERS)]
        ratio = (1.0, 1.5, 1.0, 2.0)[turn // 2 % 4]
        cell = ("channel", "periodic")[turn % 2]
        wanted = Wanted(number, fraction, GAP, cell=cell, seed=seed + n, sizes="bidisperse", spread=ratio)
        yield packed(wanted, SHEAR if turn % 4 < 2 else EXTENSION)


def packed(wanted: Wanted, gradient: Array = SHEAR) -> Packing:
    """At random; a channel is sheared. Raises InputError: the discs do not fit."""
    made = arrange("random", wanted)
    X, Y = made.cell.sides
    container: Container = Box((0.0, 0.0), (X, Y), periodic=("x",))
    if wanted.cell == "periodic":
        (a, b), (c, d) = gradient.tolist()
        container = Cell(((X, 0.0), (0.0, Y)), ((a, b), (c, d)))
    name = f"{wanted.cell}, N = {wanted.number}, phi = {wanted.fraction:g}, seed {wanted.seed}"
    return Packing(name, wanted.fraction, Configuration.unturned(made.centres, made.radii), container)


def free(packing: Packing) -> Motion:
    """No loads."""
    nothing = np.zeros((len(packing.q), 3))
    return Motion(nothing.astype(bool), nothing, nothing)


def by_pores(packing: Packing, modes: int) -> SolvedPacking:
    """Its flow with so many modes a neck."""
    system = PoreSystem.make(surfaces_of(packing.q, packing.container), modes, 1.0)
    walls = np.array([[*u, 0.0] for u in packing.walls.values()]).reshape(-1, 3)
    loading = PoreLoading(free(packing), walls, packing.container.mean_gradient)
    flow = solve_pores(system, loading)
    return SolvedPacking(flow.U, flow.dissipation, system.unknowns)


def least_dissipation(packing: Packing, modes: int) -> float:
    """A lower bound of its dissipation, by stresses in pores with so many modes a neck."""
    pores = pores_without_wide(surfaces_of(packing.q, packing.container))
    E = 0.5 * (packing.gradient + packing.gradient.T)
    least = LeastStresses.of(pores, np.full(len(pores.necks), modes)).viscosity(E)
    return least * 2.0 * float(np.sum(E**2)) * packing.container.volume


def by_elements(packing: Packing, resolution: Resolution, degree: int) -> SolvedPacking:
    """Its resolved flow."""
    fluid = build(FluidDomain(packing.container, packing.q.centres, packing.q.radii), resolution, degree)
    walls = {name: partial(_everywhere, u) for name, u in packing.walls.items()}
    problem = StokesProblem(fluid, packing.container, packing.q, free(packing), Boundary(walls, {}))
    solution = solve(problem, SolverOptions(degree))
    return SolvedPacking(solution.U, solution.dissipation, solution.dofs)


def _everywhere(u: Array, x: Array) -> Array:
    return np.tile(u, (len(x), 1))


def deviation(packing: Packing, flow: SolvedPacking, reference: SolvedPacking) -> Deviation:
    """Of a flow from a better one."""
    error = flow.U - reference.U
    mean, rates = packing.mean_flow, gap_rates(packing)
    return Deviation(
        flow.dissipation / reference.dissipation - 1.0,
        _norm(error[:, :2]) / _norm(reference.U[:, :2] - mean),
        _norm(error[:, 2]) / _norm(reference.U[:, 2]),
        _norm(rates.of(flow.U) - rates.of(reference.U)) / _norm(rates.of(reference.U)),
    )


def over_bars(packing: Packing, modes: int, flows: dict[int, Array], exact: Array) -> Array:
    """Errors of velocities over bars, (N, 3), of those with so many modes; all (N, 3), by modes and true."""
    scale = np.array([1.0, 1.0, packing.q.radii.mean()])
    difference = np.abs(flows[modes] - flows[reference_modes(modes)]) * scale
    bar = bar_factor(modes) * np.maximum(difference, CHANCE * difference.max())
    found: Array = np.abs(flows[modes] - exact) * scale / bar
    return found


def _norm(x: Array) -> float:
    return float(np.linalg.norm(x))


@dataclass(frozen=True, slots=True)
class GapRates:
    """Rates n . (u_j - u_i) of gaps, and of gaps to walls, which slide along themselves: n . u.

    Attributes:
        pairs: bodies (i, j), i = j for a wall, (P, 2).
        normal: from i to j, from the wall to the body, (P, 2).
        carried: velocity of the image of j less that of j, (P, 2).
    """

    pairs: Array
    normal: Array
    carried: Array

    def of(self, U: Array) -> Array:
        """The rates at velocities (N, 3), (P,)."""
        i, j = self.pairs.T
        u = U[j, :2] + self.carried - np.where(i == j, 0.0, 1.0)[:, None] * U[i, :2]
        rates: Array = np.einsum("pk,pk->p", self.normal, u)
        return rates


def gap_rates(packing: Packing) -> GapRates:
    """Of the N narrowest gaps."""
    q, N = packing.q, len(packing.q)
    gaps = find_gaps(q, packing.container)
    i, j = gaps.pairs.T
    between = q.centres[j] + gaps.away - q.centres[i]
    body, wall = np.indices(gaps.wall_gaps.shape).reshape(2, -1)
    pairs = np.concatenate([gaps.pairs, np.stack([body, body], axis=1)])
    to_walls = packing.container.normals(q.centres)[body, wall]
    normal = np.concatenate([between / np.linalg.norm(between, axis=1)[:, None], to_walls])
    carried = np.concatenate([gaps.away @ packing.gradient.T, np.zeros((len(body), 2))])
    narrow = np.argsort(np.concatenate([gaps.pair_gaps, gaps.wall_gaps.ravel()]), kind="stable")[:N]
    return GapRates(pairs[narrow], normal[narrow], carried[narrow])
