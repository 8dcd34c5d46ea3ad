"""Flow with laws below a gap: resisted rates of pairs beside what is resolved (see `fsi.lubrication.below`).

With the rows G of the rates, their resistances kappa and the rates b of walls and images by themselves, the
balance of the bodies is

    rigid^T lambda + G^T f = (F, T),      f = kappa (G U - b).

U is linear in the loads, U = U_0 - M G^T f with the mobility M of the free modes that have a share in G, each
a flow of its own, so that f solves

    (1 + kappa G M G^T) f = kappa (G U_0 - b)

whatever the size of kappa: nothing stiff enters the matrix of the flow. The work of f is

    U.G^T f - b.f = f.(G U - b) = sum_r kappa_r (G U - b)_r^2,

and by a mean gradient W of velocity, in which the rates are S : W, it adds f S to the stress.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from fsi.bodies.configuration import MODES, Array, Configuration, Motion
from fsi.lubrication.below import PairRates
from fsi.stokes.problem import PairLaws, StokesProblem
from fsi.stokes.solvers.elimination import NodalSolution, StokesSystem

type Solver = Callable[..., list[NodalSolution]]


def with_laws(solver: Solver) -> Solver:
    """The solver with the laws of the problems, which all have the same rates; itself where none has any."""

    def solve(*systems: StokesSystem) -> list[NodalSolution]:
        system = systems[0]
        laws, free = system.problem.laws, ~system.problem.motion.held.ravel()
        if laws is None or not len(laws.own):
            return solver(*systems)
        modes = np.flatnonzero((laws.G != 0.0).any(axis=0) & free)
        solutions = solver(*systems, *(_pulled(system, load) for load in np.eye(free.size)[modes]))
        alone, responses = solutions[: len(systems)], solutions[len(systems) :]
        M = np.array([response.U.ravel() for response in responses]).reshape(len(modes), free.size).T
        mobility = laws.G @ M @ laws.G[:, modes].T
        found = []
        for each, flow in zip(systems, alone, strict=True):
            assert each.problem.laws is not None  # all have the same rates
            f = _forces(each.problem.laws, mobility, flow.U)
            found.append(_combined(flow, responses, -f @ laws.G[:, modes], f))
        return found

    return solve


def _pulled(system: StokesSystem, load: Array) -> StokesSystem:
    """The system with nothing but a load (N M,) on the free modes."""
    problem, zero = system.problem, np.zeros_like(system.problem.motion.U)
    motion = Motion(problem.motion.held, zero, load.reshape(zero.shape))
    inertia = problem.inertia and replace(problem.inertia, U0=np.zeros_like(problem.inertia.U0))
    alone = replace(problem, motion=motion, inertia=inertia, interaction=None)
    return replace(system, g=np.zeros_like(system.g), b=np.zeros_like(system.b), problem=alone)


def _forces(laws: PairLaws, mobility: Array, U: Array) -> Array:
    """f, (R,), where the bodies move by U without it; equations scaled by how stiff each is."""
    kappa = laws.resistance
    scale = 1.0 / (1.0 + np.abs(kappa) * np.abs(np.diag(mobility)))
    matrix = np.diag(scale) + (scale * kappa)[:, None] * mobility
    return np.asarray(np.linalg.solve(matrix, scale * kappa * laws.rates(U)))


def _combined(
    flow: NodalSolution, responses: list[NodalSolution], sizes: Array, forces: Array
) -> NodalSolution:
    x, reaction, load, U = flow.x.copy(), flow.reaction.copy(), flow.load.copy(), flow.U.copy()
    for s, response in zip(sizes, responses, strict=True):
        x += s * response.x
        reaction += s * response.reaction
        load += s * response.load
        U += s * response.U
    residual = max(each.residual for each in (flow, *responses))
    iterations = max(each.iterations for each in (flow, *responses))
    return NodalSolution(x, reaction, load, U, residual, iterations, law_forces=forces)


def pair_laws(rates: PairRates, problem: StokesProblem, q: Configuration) -> PairLaws:
    """The laws of a problem with these rates, of its walls and mean flow at this instant; bodies are at q."""
    names, W = problem.container.walls, problem.flow_gradient
    E = problem.container.mean_gradient
    own = np.einsum("rk,rk->r", rates.along, rates.place @ E.T)
    for k in np.unique(rates.wall[rates.wall >= 0]):
        here = rates.wall == k
        velocity = problem.boundary.velocities[names[k]](rates.place[here])
        own[here] = np.einsum("rk,rk->r", rates.along[here], velocity)
    carried = np.zeros_like(problem.motion.U)
    carried[:, : q.dimension] = (problem.q.centres - q.centres) @ W.T
    own -= np.where(rates.meshed, rates.G @ carried.ravel(), 0.0)
    return PairLaws(
        rates.G, own, rates.resistance, _strains(rates), rates.along, rates.wall, rates.body, rates.meshed,
        carried,
    )  # fmt: skip


def _strains(rates: PairRates) -> Array:
    """S of each rate, the symmetric tensor of its values by the gradients e_k (x) e_l, k <= l, (R, d, d)."""
    R, d = rates.apart.shape
    M = len(MODES[d])
    turns = rates.G.reshape(R, rates.G.shape[1] // M, M)[:, :, d:].sum(axis=1)
    S = np.zeros((R, d, d))
    for k in range(d):
        for m in range(k, d):
            W = np.zeros((d, d))
            W[k, m] = 1.0
            spin = 0.5 * (W.T - W)
            omega = [spin[0, 1]] if d == 2 else [spin[1, 2], spin[2, 0], spin[0, 1]]
            S[:, k, m] = S[:, m, k] = np.einsum("rk,rk->r", rates.along, rates.apart @ W.T) + turns @ omega
    return S
