"""Flow with laws below a gap: resisted rates of pairs beside what is resolved (see `fsi.lubrication.below`).

With the rows G of the rates, their resistances kappa and the rates b of walls and images by themselves, the
balance of the bodies is

    rigid^T lambda + G^T f = (F, T),      f = kappa (G U - b).

U are unknowns of the flow, so that K = G^T kappa G stands in its matrix between the free modes and
G^T kappa b among their loads: one solve, whatever the number of bodies that are moved. The stiffer a law, the
larger these loads, to which residuals are relative: in gaps of 1e-6 powers would miss their bound. So kappa
is cut to kappa_0 <= STIFF in the matrix. What is
left of the few rates that are stiffer, f_1 = (kappa - kappa_0) (G U - b), follows from U = U_0 - M G^T f_1,
linear in the loads, with the mobility M of what has a share in them, each a flow of its own:

    (1 + (kappa - kappa_0) G M G^T) f_1 = (kappa - kappa_0) (G U_0 - b)

whatever the size of kappa. The work of f is

    U.G^T f - b.f = f.(G U - b) = sum_r kappa_r (G U - b)_r^2,

and by a mean gradient W of velocity, in which the rates are S : W, it adds f S to the stress.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.bodies.configuration import Motion
from fsi.stokes.pair_laws import PairLaws
from fsi.stokes.solvers.system import NodalSolution, Solver, StokesSystem

# Of the largest: loads that are combinations of others.
SAME = 1e-12


def with_laws(solver: Solver) -> Solver:
    """The solver with the laws of the problems, which all have the same rates; itself where none has any."""

    def solve(*systems: StokesSystem) -> list[NodalSolution]:
        problem = systems[0].problem
        if problem.laws is None or not len(problem.laws.own):
            return solver(*systems)
        loads = _stiff_loads(problem.laws, ~problem.motion.held.ravel())
        solutions = solver(*systems, *(_pulled(systems[0], load) for load in loads))
        alone, responses = solutions[: len(systems)], solutions[len(systems) :]
        found = []
        for system, flow in zip(systems, alone, strict=True):
            assert system.problem.laws is not None  # all have the same rates
            f = _stiff_forces(system.problem.laws, loads, responses, flow.U)
            together = _combined(flow, responses, -loads @ system.problem.laws.G.T @ f)
            soft = system.problem.laws.in_matrix * system.problem.laws.rates(together.U)
            found.append(replace(together, law_forces=soft + f))
        return found

    return solve


def _stiff_loads(laws: PairLaws, free: NDArray[np.bool_]) -> Array:
    """An orthonormal basis of the loads on free modes of all rates that are stiffer than the matrix has them.

    (k, N M), for k flows.
    """
    G = laws.G[laws.resistance != laws.in_matrix] * free
    _, sizes, directions = np.linalg.svd(G, full_matrices=False)
    return np.asarray(directions[sizes > SAME * sizes.max(initial=0.0)])


def _pulled(system: StokesSystem, load: Array) -> StokesSystem:
    """The system with nothing but a load (N M,) on the free modes."""
    problem, zero = system.problem, np.zeros_like(system.problem.motion.U)
    alone = problem.at_rest(Motion(problem.motion.held, zero, load.reshape(zero.shape)))
    return replace(system, g=np.zeros_like(system.g), b=np.zeros_like(system.b), problem=alone)


def _stiff_forces(laws: PairLaws, loads: Array, responses: list[NodalSolution], U: Array) -> Array:
    """f_1, (R,), where the bodies move by U without it; equations scaled by how stiff each is."""
    f, rest = np.zeros(len(laws.own)), laws.resistance - laws.in_matrix
    stiff = rest != 0.0
    if stiff.any():
        G, kappa = laws.G[stiff], rest[stiff]
        moved = np.array([each.U.ravel() for each in responses]).reshape(len(loads), U.size)
        mobility = G @ moved.T @ loads @ G.T
        scale = 1.0 / (1.0 + np.abs(kappa) * np.abs(np.diag(mobility)))
        matrix = np.diag(scale) + (scale * kappa)[:, None] * mobility
        f[stiff] = np.linalg.solve(matrix, scale * kappa * laws.rates(U)[stiff])
    return f


def _combined(flow: NodalSolution, responses: list[NodalSolution], sizes: Array) -> NodalSolution:
    x, reaction, load, U = flow.x.copy(), flow.reaction.copy(), flow.load.copy(), flow.U.copy()
    for s, response in zip(sizes, responses, strict=True):
        x += s * response.x
        reaction += s * response.reaction
        load += s * response.load
        U += s * response.U
    residual = max(each.residual for each in (flow, *responses))
    iterations = max(each.iterations for each in (flow, *responses))
    return replace(flow, x=x, reaction=reaction, load=load, U=U, residual=residual, iterations=iterations)
