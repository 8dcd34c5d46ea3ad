"""Modes pore by pore: necks of pores whose flow changes most with more modes get them (a p-method).

The functions are hierarchical, so the flow with fewer modes is one of those with more, and the excess of its
dissipation over the finer flow is a sum over pores,

    D_coarse - D_fine >= sum_e d_e^T K_e d_e,   d = x_fine - x_coarse.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fsi.arrays import Array, Indices
from fsi.case.sections import EDGE_MODES
from fsi.errors import SolveError
from fsi.pores.assembly import tabulated
from fsi.pores.forms import applied
from fsi.pores.solve import PoreDrive, PoreFlow, solve_pores
from fsi.pores.system import PoreSystem

TELLING = {0: 6, 1: 6, 2: 8, 4: 8, 6: 10, 8: 12, 10: 16, 12: 16}
"""Modes that tell the error of how many: what they miss themselves is small beside it everywhere."""

# A tolerance adds no more: necks with 16 would seem to be exact, as there are no more to tell their error.
MOST_TOLD = max(TELLING)

# The share of the excess whose pores are refined.
_SHARE = 0.9


@dataclass(frozen=True, slots=True)
class ComparedFlows:
    """The same problem with some modes and with more.

    Attributes:
        coarse: the flow whose error is wanted.
        fine: that with which it is compared.
    """

    coarse: PoreFlow
    fine: PoreFlow

    @property
    def excess(self) -> Array:
        """d_e^T K_e d_e of each pore, (E,), of viscosity mu."""
        system = self.fine.system
        d = self.fine.x - padded(self.coarse, system)
        excess = np.zeros(len(system.pores.vertices))
        for batch in system.assembly.batches:
            of_pore = d[batch.unknown]
            excess[batch.pore] = np.sum(of_pore * applied(batch.forms.K, of_pore), axis=1)
        return system.viscosity * excess

    @property
    def error(self) -> float:
        """The largest of the relative differences of the dissipation, velocities, and loads that hold."""
        coarse, fine, held = self.coarse, self.fine, self.coarse.loading.motion.held
        parts = [_apart(np.array([coarse.dissipation]), np.array([fine.dissipation]))]
        parts += [_apart(coarse.U, fine.U), _apart(coarse.F[held], fine.F[held])]
        return max(parts)


def padded(coarse: PoreFlow, finer: PoreSystem) -> Array:
    """The numbers of a flow among those of a system of the same pores with more modes."""
    few, many = coarse.system.assembly.numbering, finer.assembly.numbering
    x = np.zeros(many.unknowns)
    for first, of_more in ((few.surface, many.surface), (few.neck, many.neck)):
        size = np.diff(first)
        place = np.arange(first[0], first[-1]) - np.repeat(first[:-1], size)
        x[np.repeat(of_more[:-1], size) + place] = coarse.x[first[0] : first[-1]]
    return x


def more(modes: Indices) -> Indices:
    """Numbers of modes that tell the error of these; the most there are stay."""
    return tabulated(lambda k: TELLING.get(k, k), modes)


def finer(modes: int) -> int | None:
    """The next number of modes; None with the most there are."""
    return min((more for more in EDGE_MODES if more > modes), default=None)


def refined(modes: Indices) -> Indices:
    """The next numbers of modes, up to MOST_TOLD."""
    return np.minimum(tabulated(lambda k: finer(k) or k, modes), MOST_TOLD)


def compare(system: PoreSystem, drive: PoreDrive) -> ComparedFlows:
    """A flow and that with more modes, which tell its error, under the same loading. Raises SolveError.

    A stress becomes a speed in the first: where the speeds differed, so would the flow in all pores.
    """
    finer, loading = system.with_modes(more(system.assembly.numbering.modes)), drive.on(system)
    return ComparedFlows(solve_pores(system, loading), solve_pores(finer, loading))


def adapt(system: PoreSystem, drive: PoreDrive, tolerance: float) -> ComparedFlows:
    """The flow with as many modes, pore by pore, as bring its error below a tolerance.

    Raises SolveError: with MOST_TOLD where most of the error is it is still above.
    """
    modes = system.assembly.numbering.modes
    while True:
        pair = compare(system, drive)
        if pair.error <= tolerance:
            return pair
        finer_modes = np.where(_marked(pair, system), refined(modes), modes)
        if np.array_equal(finer_modes, modes):
            raise SolveError(
                f"the most modes whose error is known, {MOST_TOLD}, do not bring it below that; raise it"
            )
        modes = finer_modes
        system = system.with_modes(modes)


def _marked(pair: ComparedFlows, system: PoreSystem) -> Indices:
    """Which necks bound the fewest pores that hold most of the excess, (K,)."""
    excess = pair.excess
    order = np.argsort(-excess)
    held = np.cumsum(excess[order])
    chosen = order[: int(np.searchsorted(held, _SHARE * held[-1])) + 1]
    sides = system.pores.sides[chosen]
    marked = np.zeros(len(system.pores.necks), bool)
    marked[sides[sides >= 0]] = True
    return marked


def _apart(value: Array, reference: Array) -> float:
    """The largest difference over the largest value."""
    largest = float(np.abs(reference).max(initial=0.0))
    return float(np.abs(value - reference).max(initial=0.0)) / largest if largest else 0.0
