"""The reduced model without memory: `zeta (U - u_inf) + A(q) U = F`, configuration and time in, U out."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from time import process_time
from typing import Any, ClassVar

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration, Inertia, Motion
from fsi.case.case import Case
from fsi.errors import SolveError
from fsi.integration.state import Instant
from fsi.observables.bulk_stress import BulkStress
from fsi.parallel import on_root
from fsi.reduced.enclosure import drag, make_enclosure
from fsi.reduced.gap_laws import GapLaws, make_laws, make_tangential_laws
from fsi.reduced.network import resistance_matrix
from fsi.reduced.pairs import Pairs, find_pairs
from fsi.reduced.stress import (
    LubricationStress,
    bulk_stress,
    dissipation_of_strain,
    lubrication_stress,
    stresslets,
)
from fsi.reduced.system import Surroundings, identities, require, solve_system
from fsi.reduced.tangential import TangentialRows, make_coupling, tangential_rows
from fsi.run_folder.paraview import in_space, write_lines, write_points


@dataclass(frozen=True, slots=True)
class ReducedInstant:
    """One solved instant.

    Attributes:
        q: where the bodies are.
        U: velocities, (N, modes).
        F: external loads, (N, modes).
        pairs: P of them.
        x: ln D, the gaps with which the laws were taken, (P,).
        rates: D' of the gaps, (P,); without memory lambda / kappa, precise where G U rounds.
        force: lambda, (P,).
        laws: kappa and its integral K.
        g: `G.M^-1 G` of the gaps, zero for a model without memory, (P,).
        record: columns of steps.csv.
        stress: that of lubrication, in a periodic domain.
        bulk: the mean stress there, where pairs resist sliding and rolling too.
        wall_speeds, shear_rate, dp_dx, flux: nothing, as no stress and no pressure drives this model.
    """

    q: Configuration
    U: Array
    F: Array
    pairs: Pairs
    x: Array
    rates: Array
    force: Array
    laws: GapLaws
    g: Array
    record: Mapping[str, float]
    stress: LubricationStress | None = None
    bulk: BulkStress | None = None
    wall_speeds: ClassVar[Mapping[str, float]] = {}
    shear_rate: ClassVar[None] = None
    dp_dx: ClassVar[None] = None
    flux: ClassVar[None] = None

    @property
    def gamma(self) -> Array:
        """g K(D), the stored pushes, (P,)."""
        if not self.g.any():
            return np.zeros(len(self.x))
        K, _ = self.laws.integral(self.x, self.pairs.films)
        return self.g * K

    @property
    def apparent_viscosity(self) -> float | None:
        """Over the viscosity of the fluid, where there is a bulk stress and a mean strain rate."""
        return None if self.bulk is None else self.bulk.apparent_viscosity

    @property
    def dissipation(self) -> float:
        """By drag and gaps; where there is a bulk stress, also that of the fluid and of lone bodies in it."""
        return float(self.record["dissipation"])

    @property
    def body_columns(self) -> Mapping[str, Array]:
        """More columns of bodies.csv."""
        of_gaps = {} if self.stress is None else self.stress.body_columns
        return of_gaps if self.bulk is None else {**of_gaps, **self.bulk.body_columns}

    def write(self, folder: Path, step: int) -> dict[str, list[str]]:
        """Write "bodies" and "contacts": the gap, maybe stored, lambda, positive where it opens, gamma."""
        return on_root(lambda: self._write(folder, step))

    def _write(self, folder: Path, step: int) -> dict[str, list[str]]:
        q, pairs, d = self.q, self.pairs, self.q.dimension
        bodies, contacts = f"bodies_{step:06d}.vtu", f"contacts_{step:06d}.vtu"
        vectors = {"velocity": in_space(self.U[:, :d]), "force": in_space(self.F[:, :d])}
        write_points(folder / bodies, q.centres, {"radius": q.radii} | vectors)
        # A line for each pair from centre to centre, or to the wall.
        start, other = q.centres[pairs.i], np.where(pairs.is_wall, 0, pairs.j)
        length = q.radii[pairs.i] + pairs.gap + np.where(pairs.is_wall, 0.0, q.radii[other])
        films = {"gap": np.exp(self.x), "force": self.force, "gamma": self.gamma}
        write_lines(folder / contacts, start, start - length[:, None] * pairs.n, films)
        return {"bodies": [bodies], "contacts": [contacts]}


class ReducedModel:
    """Drag and lubrication of the gaps; NumPy and SciPy only. All ranks compute the same."""

    def __init__(self, case: Case) -> None:
        """A model of the case; law files are read. Raises InputError."""
        self.case = case
        self.laws = make_laws(case)
        self.tangential = make_tangential_laws(case)
        self.coupling = make_coupling(case)
        self.reach = np.inf if case.reduced.cutoff is None else case.reduced.cutoff
        self.zeta = drag(case)
        self._steady = None if case.kinks() else case.motion(0.0)  # with many bodies worth keeping

    def __call__(self, q: Configuration, t: float, inertia: Inertia | None = None) -> ReducedInstant:
        """The velocities at q and t. Raises SolveError: overlap, undetermined motion, a violated identity."""
        return self.under(self.surroundings(q, t), q, t, inertia)

    def under(
        self, ambient: Surroundings, q: Configuration, t: float, inertia: Inertia | None = None
    ) -> ReducedInstant:
        """The velocities in given ambient, with the loads that are in them; raises as a call does."""
        began = process_time()
        motion, inertia = ambient.motion.under(inertia)
        ambient = replace(ambient, motion=motion)
        pairs = find_pairs(q, ambient.enclosure, self.reach)
        if np.any(pairs.gap <= 0.0):
            raise SolveError(f"reduced model at t = {t:.9g}: bodies overlap (gap {pairs.gap.min():.3g})")
        x = np.log(pairs.gap)
        kappa = self.laws.kappa(x, pairs.films)
        tangential = self._tangential(pairs, ambient, q)
        paired = process_time()
        solved = solve_system(ambient, pairs, kappa, inertia, tangential)
        checks = identities(solved.network, q, solved.U, solved.alone, solved.force) | solved.balances()
        viscosity = self.case.fluid.viscosity
        stress = lubrication_stress(
            ambient.enclosure, stresslets(pairs, solved.force, q.radii, tangential), viscosity
        )
        columns, bulk, lost = {} if stress is None else dict(stress.record), None, solved.dissipation
        if stress is not None and tangential is not None:
            forces = self.case.interaction_moment(q, t)
            bulk = bulk_stress(ambient.enclosure, stress, q.radii, viscosity, forces)
            columns |= bulk.record
            checks |= {"stress": solved.stress_defect(stress)}
            lost += dissipation_of_strain(ambient.enclosure, q.radii, viscosity)
        require(checks, t)
        spent = {"cpu_pairs": paired - began, "cpu_solve": process_time() - paired}
        record = {"pairs": len(pairs), "dissipation": lost, **columns, **checks, **spent}
        rates, force = solved.rates[: len(pairs)], solved.force[: len(pairs)]
        nothing = np.zeros(len(pairs))
        return ReducedInstant(
            q, solved.U, solved.F, pairs, x, rates, force, self.laws, nothing, record, stress, bulk
        )

    def resistance(self, q: Configuration, t: float) -> sp.csr_matrix:
        """R of the pairs alone, without drag, at q and time t, (N M, N M): symmetric, not negative."""
        ambient = self.surroundings(q, t)
        pairs = find_pairs(q, ambient.enclosure, self.reach)
        kappa = self.laws.kappa(np.log(pairs.gap), pairs.films)
        return resistance_matrix(pairs, kappa, self.zeta.shape, self._tangential(pairs, ambient, q))

    def _tangential(self, pairs: Pairs, ambient: Surroundings, q: Configuration) -> TangentialRows | None:
        """How the pairs resist sliding and rolling, if they do."""
        if not self.tangential:
            return None
        return tangential_rows(pairs, q.radii, self.tangential, self.coupling, ambient.enclosure)

    def surroundings(self, q: Configuration, t: float) -> Surroundings:
        """Walls, periods, background flow, motion and drag at time t."""
        enclosure = make_enclosure(self.case, t)
        return Surroundings(enclosure, self.motion(q, t), self.zeta, enclosure.background(q.centres))

    def motion(self, q: Configuration, t: float) -> Motion:
        """What holds and what drives the bodies at q and time t."""
        return self.case.with_forces(self._steady or self.case.motion(t), q, t)

    def errors(self, q: Configuration, t: float, instant: Instant) -> None:
        """None: there is no mesh whose error could be estimated."""

    def state(self) -> dict[str, NDArray[Any]]:
        """Nothing is remembered."""
        return {}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Nothing to take back."""
