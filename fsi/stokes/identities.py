"""The identities that every solution must satisfy, as relative defects.

- power: dissipation = U.(F, T) + power of the walls + power of the loads; that of surfaces that swim is on
  the right too, and on the left the friction (mu / b) int |slip|^2. Where walls with different velocities
  meet both sides are infinite, and the balance is that of w u in place of u,

      int 2 mu e(u) : e(w u) - p div(w u) = U.(F, T) + int w u.sigma n + ...,     w = min(1, d / d_bodies),

  with the distance d from such a corner, d_bodies that of the nearest body: finite, since w u vanishes there
- momentum, angular_momentum: reactions of bodies and walls and the loads sum to zero (the latter not in a
  periodic domain, whose sides exert a moment on each other)
- balance: rigid^T lambda = (F, T) on every free mode
- lubrication: the rates of laws below a gap are their forces over their resistances
- net_flux: int u.n over the whole boundary vanishes
- residual: of the linear system
"""

from dataclasses import astuple, dataclass

import numpy as np
from mpi4py import MPI

from fsi.arrays import Array, Indices
from fsi.errors import RefusedError, apart
from fsi.observables.solved_flow import BOUND
from fsi.stokes.corners import distance, jumps
from fsi.stokes.solvers.system import (
    NodalSolution,
    StokesSystem,
    law_loads,
    mode_equations,
    nodal_vector,
    slip_of,
)

ROUNDING_FLOOR = 1e-6


@dataclass(frozen=True, slots=True)
class Scales:
    """What a defect is compared with: of the powers, forces, moments and fluxes of a flow.

    Where a flow is a rigid motion of everything, forces and dissipation are rounding errors themselves; a
    small multiple of mu times the nodal velocities and slips then stands in for them, in space and with an
    axis times the smallest radius. Where fluid rests under a pressure, or nearly so, a small multiple of what
    the loads would drive stands in for the dissipation, and the flux that goes with it for that through the
    boundary.
    """

    power: float
    force: float
    moment: float
    flux: float


@dataclass(frozen=True, slots=True)
class _Tested:
    """Velocities that powers are of, at this rank's nodes, d of each.

    Attributes:
        u, slip: of the fluid, and along surfaces; the latter is empty where nothing slides.
        weighted: w u, (velocities,).
        moved: w (u - slip), with which surfaces move.
        friction: what w slip dissipates, less what tractions along the normals do on it.
        near_jumps: whether w is not 1 everywhere.
    """

    u: Array
    slip: Array
    weighted: Array
    moved: Array
    friction: float
    near_jumps: bool

    @property
    def speed(self) -> Array:
        """|u| + |slip|, (velocities,)."""
        return np.abs(self.u) + (np.abs(self.slip) if self.slip.size else 0.0)


@dataclass(frozen=True, slots=True)
class _Sums:
    """Over the nodes of all ranks.

    Attributes:
        force, moment: nodal loads: both vanish.
        power: of walls and loads, less friction.
        forces, moments: sizes of nodal loads, and of these times |x|.
        squares, speeds, levers: of velocities and slips: squares, sizes, and these times |x|.
        loads: squares of what is given, b.b.
    """

    force: Array
    moment: Array
    power: float
    forces: float
    moments: float
    squares: float
    speeds: float
    levers: float
    loads: float


def identities(system: StokesSystem, nodal: NodalSolution, F: Array, dissipation: float) -> dict[str, float]:
    """All relative defects; u and p of the forms are set to the solution, F = rigid^T lambda; collective.

    dissipation: of the discrete flow, finite.
    """
    tested = _tested(system, nodal)
    sums = _sums(system, nodal, tested)
    scale = dissipation
    if tested.near_jumps:
        dissipation, scale = _finite_power(system, tested.weighted)
    sizes = (scale, sums.forces, sums.moments, system.forms.integrate("speed on boundary"))
    scales = Scales(*map(max, sizes, astuple(_floor(system, sums))))
    power = float((nodal.U * F).sum()) + sums.power
    defects = {
        "power": _relative(dissipation - power, scales.power),
        "momentum": _relative(float(np.linalg.norm(sums.force)), scales.force),
        "angular_momentum": _relative(float(np.linalg.norm(sums.moment)), scales.moment),
        "balance": _balance(system, nodal.U, F + law_loads(system, nodal), scales.force),
        "net_flux": _relative(system.forms.integrate("flux"), scales.flux),
        "residual": nodal.residual,
    }
    if (laws := system.problem.laws) is not None:
        defects["lubrication"] = laws.defect(nodal.law_forces, nodal.U)
    if system.problem.periodic:  # the traction on the two sides has no force, but a moment
        del defects["angular_momentum"]
    return defects


def _tested(system: StokesSystem, nodal: NodalSolution) -> _Tested:
    u, w = nodal.x[: system.layout.velocities], _away_from_jumps(system)
    weight = 1.0 if w is None else np.repeat(w, system.layout.dimension)
    if system.facets is None:
        return _Tested(u, np.zeros(0), weight * u, weight * u, 0.0, w is not None)
    # What slides does no work on the surface, but against the friction there.
    every_slip = slip_of(system, nodal)
    slip, forces = every_slip[: len(u)], system.facets.forces(every_slip)[0][: len(u)]
    slid = weight * slip
    friction = float(forces @ slid)
    # int phi n . s = 0, not that of w s: on curved walls tractions along n work on it.
    if w is not None:
        friction -= float((nodal.reaction[: len(u)] + forces)[system.layout.slip] @ slid[system.layout.slip])
    return _Tested(u, slip, weight * u, weight * u - slid, friction, w is not None)


def _sums(system: StokesSystem, nodal: NodalSolution, tested: _Tested) -> _Sums:
    """Collective."""
    x, d = system.nodes.x, system.layout.dimension
    force, moment = _nodal_loads(system, nodal)
    lever, b, speed = _lengths(x), system.b[: len(tested.u)], tested.speed
    of_rank = [
        _power_of_walls_and_loads(system, nodal, tested),
        np.abs(force).sum(),
        (lever * _lengths(force)).sum(),
        tested.u @ tested.u + tested.slip @ tested.slip,
        speed.sum(),
        lever @ speed.reshape(-1, d).sum(axis=1),
        b @ b,
    ]
    sums = np.array([*of_rank, *force.sum(axis=0), *moment.sum(axis=0)])
    system.layout.comm.Allreduce(MPI.IN_PLACE, sums)
    sizes, force_sum, moment_sum = np.split(sums, [len(of_rank), len(of_rank) + d])
    return _Sums(force_sum, moment_sum, *sizes.tolist())


def _nodal_loads(system: StokesSystem, nodal: NodalSolution) -> tuple[Array, Array]:
    """Loads and reactions, (n, d), and their moments, (n, 1 or 3), at this rank's nodes."""
    layout, x, d = system.layout, system.nodes.x, system.layout.dimension
    boundary = np.concatenate([_at_walls(system), layout.on_body])
    load = system.b.copy()
    load[boundary] += nodal.reaction[boundary]
    force = load[: layout.velocities].reshape(-1, d)
    moment = np.cross(x, force) if d == 3 else x[:, :1] * force[:, 1:] - x[:, 1:] * force[:, :1]
    if layout.axisymmetric:
        force[:, 0] = moment[:] = 0.0  # these balance by symmetry around the axis
    return force, moment


def _power_of_walls_and_loads(system: StokesSystem, nodal: NodalSolution, tested: _Tested) -> float:
    """Of this rank's nodes, and of the mean flow and the mean pressure gradient on periodic sides."""
    layout, at_walls = system.layout, _at_walls(system)
    b = system.b[: layout.velocities]
    power = float(nodal.reaction[at_walls] @ tested.moved[at_walls] + b @ tested.weighted) - tested.friction
    is_flow = layout.slave < layout.velocities
    jumping, of_pressure = np.concatenate([layout.slave[is_flow], layout.on_body]), layout.slave[~is_flow]
    power += float(nodal.reaction[jumping] @ system.g[jumping])
    return power - float(nodal.reaction[of_pressure] @ system.g[of_pressure])


def _at_walls(system: StokesSystem) -> Indices:
    """Which velocities walls fix."""
    fixed = system.layout.fixed
    return fixed[fixed < system.layout.velocities]


def _lengths(v: Array) -> Array:
    """Of vectors (n, d), (n,)."""
    lengths: Array = np.sqrt(np.einsum("ni,ni->n", v, v))
    return lengths


def _away_from_jumps(system: StokesSystem) -> Array | None:
    """w at this rank's velocity nodes, (n,); None where no walls that meet have different velocities."""
    container = system.problem.container
    pairs = jumps(container, system.problem.boundary)
    if not pairs:
        return None
    d = distance(container, pairs, system.nodes.x)
    nearest_here = float(d[system.nodes.body_nodes].min(initial=container.size()))
    w: Array = np.minimum(1.0, d / system.layout.comm.allreduce(nearest_here, op=MPI.MIN))
    return w


def _finite_power(system: StokesSystem, tested: Array) -> tuple[float, float]:
    """`int 2 mu e(u) : e(v) - p div v` for the nodal values v tested, and the sum of |parts|; collective."""
    stress = nodal_vector(system.forms.bind("stress"))
    parts = np.array([tested @ stress, np.abs(tested * stress).sum()])
    power, scale = system.layout.comm.allreduce(parts)
    return float(power), float(scale)


def _floor(system: StokesSystem, sums: _Sums) -> Scales:
    """The least that defects are compared with; collective. Rounding far from the origin has long levers."""
    layout, problem = system.layout, system.problem
    farthest_here = float(_lengths(system.nodes.x).max(initial=0.0))
    farthest = layout.comm.allreduce(farthest_here, op=MPI.MAX)
    length = float(problem.q.radii.min(initial=farthest))
    spheres = layout.dimension == 3 or layout.axisymmetric
    drag = problem.viscosity * (length if spheres else 1.0)
    power, force, moment = max(drag * sums.squares, sums.loads / drag), drag * sums.speeds, drag * sums.levers
    flux = float(np.sqrt(sums.loads)) / drag * length ** (2 if spheres else 1)
    return Scales(*(ROUNDING_FLOOR * scale for scale in (power, force, moment, flux)))


def require(defects: dict[str, float]) -> None:
    """Raise SolveError if the defect of an identity exceeds 1e-8, or is not a number."""
    for name, defect in defects.items():
        if not defect <= BOUND:
            size = f"relative defect {apart(defect, BOUND)}, bound {BOUND:g}"
            raise RefusedError(f"the solution violates the identity `{name}`: {size}")


def _balance(system: StokesSystem, U: Array, F: Array, force: float) -> float:
    """Largest defect of rigid^T lambda + D U = F + D U0 over the free modes, torques divided by the radius.

    With inertia, D U and D U0 may cancel far above the reactions, so that the load counts as a scale too.
    """
    free = ~system.problem.motion.held
    D, load = mode_equations(system)
    defect = np.zeros_like(F)
    D, load = D.reshape(F.shape), load.reshape(F.shape)
    defect[free] = (F + D * U - load)[free]
    defect /= system.problem.q.arms
    return _relative(float(np.abs(defect).max(initial=0.0)), max(force, float(np.abs(load).max(initial=0.0))))


def _relative(defect: float, scale: float) -> float:
    """|defect| / scale, and zero where there is nothing to compare."""
    return 0.0 if defect == 0.0 else abs(defect) / max(scale, float(np.finfo(float).tiny))
