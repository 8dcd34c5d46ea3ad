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

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.bodies.configuration import MODES, Configuration, Motion
from fsi.errors import SolveError
from fsi.stokes.problem import Field, PairLaws, StokesProblem
from fsi.stokes.solvers.system import NodalSolution, StokesSystem

if TYPE_CHECKING:  # laws take long to load, and most flows have none
    from fsi.lubrication.below import PairRates

# Of the largest: loads that are combinations of others, and what velocities that are alike may differ by.
SAME = 1e-12

type Solver = Callable[..., list[NodalSolution]]


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
    motion = Motion(problem.motion.held, zero, load.reshape(zero.shape))
    inertia = problem.inertia and replace(problem.inertia, U0=np.zeros_like(problem.inertia.U0))
    laws = problem.laws and problem.laws.at_rest()
    alone = replace(problem, motion=motion, inertia=inertia, interaction=None, laws=laws)
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


def pair_laws(rates: "PairRates", problem: StokesProblem, q: Configuration) -> PairLaws:
    """The laws of a problem with these rates, of its walls and mean flow at this instant; bodies are at q."""
    names, W = problem.container.walls, problem.flow_gradient
    E = problem.container.mean_gradient
    own = np.einsum("rk,rk->r", rates.along, rates.place @ E.T)
    for k in np.unique(rates.wall[rates.wall >= 0]):
        here = rates.wall == k
        velocity = problem.boundary.velocities[names[k]]
        _require_rigid(velocity, rates.place[here], rates.apart[here], names[k])
        own[here] = np.einsum("rk,rk->r", rates.along[here], velocity(rates.place[here]))
    carried = np.zeros_like(problem.motion.U)
    carried[:, : q.dimension] = (problem.q.centres - q.centres) @ W.T
    a, apart = q.radii[rates.body], np.linalg.norm(rates.apart, axis=1)
    own -= np.where(rates.meshed, rates.G @ carried.ravel(), 0.0)
    return PairLaws(
        rates.G, own, rates.resistance, _strains(rates), rates.along, rates.wall, rates.body, rates.meshed,
        carried, a / a.sum(axis=1)[:, None], 1.0 - np.where(rates.wall < 0, a.sum(axis=1), a[:, 0]) / apart,
    )  # fmt: skip


def _require_rigid(velocity: Field, place: Array, apart: Array, wall: str) -> None:
    """Raise SolveError unless the linear velocity of a wall is the same all around points on it, (n, d).

    apart: from there along the normals. A wall that turns or stretches drives fluid into a gap or out of it.
    """
    at, size = velocity(place), np.linalg.norm(apart, axis=1)[:, None]
    for axis in np.eye(place.shape[1]):
        along = axis - (apart @ axis)[:, None] * apart / size**2
        if np.abs(velocity(place + size * along) - at).max() > SAME * np.abs(at).max():
            raise SolveError(
                f"lubrication.below: no law is known beside wall {wall!r}, whose velocity varies along it; "
                "drop it, or give the wall one velocity"
            )


def _strains(rates: "PairRates") -> Array:
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
