"""What a solved instant tells, how large its errors are against the results, how far its container shows."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import pi

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.case.case import Case
from fsi.case.checks.work import check_work
from fsi.case.load import parse_case
from fsi.errors import InputError
from fsi.integration.errors import ErrorEstimate
from fsi.integration.state import Results
from fsi.observables.bulk_stress import BulkStress
from fsi.parallel import on_root

BOUND = 1e-8  # of each relative defect; a solution beyond it is refused
IDENTITIES = {
    "power": "dissipation = power of the loads and walls",
    "momentum": "forces of bodies and walls sum to zero",
    "angular_momentum": "torques of bodies and walls sum to zero",
    "balance": "computed loads on free bodies = given loads",
    "net_flux": "no net flux through the boundary",
    "residual": "residual of the linear system",
}


@dataclass(frozen=True, slots=True)
class SolvedFlow:
    """What a solved instant tells.

    Attributes:
        U: velocities of the bodies, (N, M).
        F: loads int sigma n, n out of the fluid, by the reactions, (N, M): external; the fluid exerts -F.
        traction_F: the same from the traction integral of sigma_h n, less accurate, a cross-check.
        dissipation: int 2 mu e : e and that of laws below a gap, infinite where the velocities of walls jump.
        checks: the relative defects of the identities.
        dofs: unknowns (u, p) before constraints.
        cells: number of cells over all ranks.
        iterations: of the linear solver, 0 of the direct one.
        seconds: CPU seconds of this process by phase.
        bulk: mean stress of a periodic flow.
        jumps: the walls with different velocities that meet, by their names.
        wall_speeds: along x, of the walls that a stress moves.
        shear_rate: of a cell that a stress shears, else None.
        flux: of fluid and bodies along a channel whose mean pressure gradient is given, else None.
        law_dissipation: what of it the laws below a gap have; None without such laws.
        slip_dissipation: (mu / b) int |slip|^2 over the surfaces along which fluid slides; None without any.
    """

    U: Array
    F: Array
    traction_F: Array
    dissipation: float
    checks: dict[str, float]
    dofs: int
    cells: int
    iterations: int
    seconds: dict[str, float]
    bulk: BulkStress | None
    jumps: tuple[tuple[str, str], ...]
    wall_speeds: Mapping[str, float] = field(default_factory=dict, kw_only=True)
    shear_rate: float | None = field(default=None, kw_only=True)
    flux: float | None = field(default=None, kw_only=True)
    slip_dissipation: float | None = field(default=None, kw_only=True)
    law_dissipation: float | None = field(default=None, kw_only=True)

    @property
    def mesh_instead(self) -> str:
        """The size that was taken as those of the case gave no valid mesh, "" where they did."""
        return ""

    @property
    def dp_dx(self) -> float | None:
        """The mean pressure gradient along a channel whose net flux is given, else None."""
        return None

    @property
    def apparent_viscosity(self) -> float | None:
        """Over the viscosity of the fluid, of a periodic flow with a mean strain rate."""
        return None if self.bulk is None else self.bulk.apparent_viscosity


ROOM = 0.375  # of the radius of a container that stands for infinity, in which all bodies are


def is_infinite(case: Case) -> bool:
    """Whether the container stands for infinity: it has a radius, and no body reaches beyond ROOM of that.

    Else it is real: at half the radius the flow would be another one, and a gap that is narrow there one that
    nobody has.
    """
    q = case.configuration()
    reach = float((np.linalg.norm(q.centres, axis=1) + q.radii).max(initial=0.0))
    return case.domain.halved() is not None and reach <= ROOM * 0.5 * case.container().size()


def halved(case: Case) -> Case | None:
    """The case in a container of half the radius; None where there is no radius, or the container is real."""
    domain = case.domain.halved()
    if domain is None or domain.mesh is not None or not is_infinite(case):
        return None
    data = case.model_dump(exclude_none=True) | {"domain": domain.model_dump(exclude_none=True)}
    try:
        half = parse_case(data)
        on_root(lambda: check_work(half))
    except InputError:
        return None
    return half


def truncation(case: Case, whole: Results, half: Results) -> dict[str, float]:
    """How much the results change when the radius R of the container is halved.

    The effect of R decays like R^-1 or faster (R^-1: a net force in a ball, a plane along which fluid slips
    or that has not the velocity that is given far away), so the error at R is at most about this change;
    with another plane it decays like R^-2 or faster, and the error is at most a third of it. In a disc a
    velocity over a net force grows like log R for ever (Stokes's paradox): this is no error then, but the
    change for each factor of two. Results are the loads on held components and the velocities of free ones;
    torques count over the radius of the body, rotations times it; see `relative_change`.
    """
    change = ErrorEstimate(np.abs(half.U - whole.U), np.abs(half.F - whole.F))
    q = case.configuration()
    return relative_change(whole, change, case.motion(0.0).held, q.arms, flow_scales(case, 0.0))


@dataclass(frozen=True, slots=True)
class FlowScales:
    """Rate of shear times the largest radius; force over velocity, mu in the plane and mu a for spheres.

    Attributes:
        thrust: the pressure outside open walls times the surface of the largest body, on which it cancels.
    """

    velocity: float
    resistance: float
    thrust: float = 0.0

    def largest(self, results: Results, arm: Array) -> tuple[float, float]:
        """The largest velocity and load, of all modes and what drives them; arm: as for `relative_change`."""
        speed = max(float(np.abs(results.U * arm).max(initial=0.0)), self.velocity)
        return speed, max(float(np.abs(results.F / arm).max(initial=0.0)), self.resistance * speed)

    @property
    def rounding(self) -> tuple[float, float]:
        """The velocity and the load that rounding leaves of a pressure all around a body."""
        load = ROUNDING * self.thrust
        return load / self.resistance if load else 0.0, load


def flow_scales(case: Case, t: float) -> FlowScales:
    """What walls, mean flow and swimmers do at time t.

    A wall shears at its speed over the size of the container.
    """
    radius = max((body.radius for body in case.bodies), default=0.0)
    container = case.container()
    size, walls = container.size(), case.wall_velocity(t).values()
    rates = [float(np.linalg.norm(wall.velocity)) / size + abs(wall.shear) for wall in walls]
    rates += [abs(stress) / case.fluid.viscosity for stress in case.wall_stress(t).values()]
    rate = max([*rates, float(np.abs(container.mean_gradient).max())])
    swimming = (abs(mode) for body in case.bodies for mode in body.surface_velocity or ())
    surface = 4.0 * pi * radius**2 if case.spheres else 2.0 * pi * radius
    return FlowScales(
        max(rate * radius, max(swimming, default=0.0)),
        case.fluid.viscosity * (radius if case.spheres else 1.0),
        max(map(abs, case.wall_pressure().values()), default=0.0) * surface,
    )


def rounded_dissipation(case: Case, t: float) -> float:
    """What rounding leaves of that of walls which carry the fluid along, and of pressures alike.

    `ROUNDING^2 (mu U^2 + p^2 L^2 / mu)` with the size L of the container, times L in space and with an axis.
    """
    size, mu = case.container().size(), case.fluid.viscosity
    speed = max(
        (float(np.linalg.norm(wall.velocity)) for wall in case.wall_velocity(t).values()), default=0.0
    )
    pressure = max(map(abs, case.wall_pressure().values()), default=0.0)
    power = mu * speed**2 + (pressure * size) ** 2 / mu
    return ROUNDING**2 * power * (size if case.spheres else 1.0)


# A result that is smaller than this part of what drives the flow may be zero by symmetry.
LEAST = 0.01
# Of the largest result: what the factorisation leaves at gaps of 1e-5 radii, where it is worst.
ROUNDING = 1e-11


def relative_change(
    results: Results, change: Results, held: NDArray[np.bool_], arm: Array, scales: FlowScales
) -> dict[str, float]:
    """A change of the results over the largest result: loads on held components, velocities of free ones.

    Gives "force" and "velocity", largest |change| / largest |result|, each only if there is such a result.
    Where symmetry makes all of a kind zero, what is computed is an error itself: a hundredth of what drives
    the flow is the least that a change counts over. Where nothing drives one, a change may be what rounding
    leaves of a pressure; that is none. arm: 1 for translations, the radius for rotations, (N, M).
    """
    F, V, relative = results.F / arm, results.U * arm, {}
    (speed, force), (slow, weak) = scales.largest(results, arm), scales.rounding
    for name, of_kind, values, changed, scale, rounding in (
        ("force", held, F, change.F / arm, force, weak),
        ("velocity", ~held, V, change.U * arm, speed, slow),
    ):
        if np.any(values[of_kind]):
            largest = max(float(np.abs(values[of_kind]).max()), LEAST * scale)
            off = float(np.abs(changed[of_kind]).max())
            relative[name] = off / largest if off > rounding else 0.0
    return relative
