"""What a solved instant tells, and the identities that it must satisfy."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from fsi.arrays import Array
from fsi.observables.bulk_stress import BulkStress

BOUND = 1e-8  # of each relative defect; a solution beyond it is refused
IDENTITIES = {
    "power": "dissipation + that of slip = power of loads, walls and swimmers",
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
