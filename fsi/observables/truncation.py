"""What a solved instant tells of itself, and how far the size of its container shows in it."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from fsi.bodies.configuration import Array
from fsi.case.case import Case
from fsi.case.load import parse_case
from fsi.errors import InputError
from fsi.observables.bulk_stress import BulkStress
from fsi.observables.error_estimate import ErrorEstimate, flow_scales, relative_change

BOUND = 1e-8  # of each relative defect; a solution beyond it is refused
IDENTITIES = {
    "power": "dissipation = power of the loads and walls",
    "momentum": "forces of bodies and walls sum to zero",
    "angular_momentum": "torques of bodies and walls sum to zero",
    "balance": "computed loads on free bodies = given loads",
    "net_flux": "no net flux through the boundary",
    "residual": "residual of the linear system",
}


class Solution(Protocol):
    """What a solved instant must tell."""

    @property
    def U(self) -> Array:
        """Velocities of the bodies, shape (N, M)."""

    @property
    def F(self) -> Array:
        """External loads, `int sigma n`, from the reactions, shape (N, M)."""

    @property
    def traction_F(self) -> Array:
        """The same loads as integrals of the traction of the computed fields, less accurate, shape (N, M)."""

    @property
    def dissipation(self) -> float:
        """`2 mu int e:e`."""

    @property
    def checks(self) -> dict[str, float]:
        """The identities that a solve must satisfy, relative."""

    @property
    def bulk(self) -> BulkStress | None:
        """Mean stress and apparent viscosity of a periodic flow."""

    @property
    def dofs(self) -> int:
        """Number of unknowns."""

    @property
    def cells(self) -> int:
        """Number of cells."""

    @property
    def iterations(self) -> int:
        """Of the linear solver; 0 of the direct one."""

    @property
    def seconds(self) -> dict[str, float]:
        """CPU seconds by phase."""


def halved(case: Case) -> Case | None:
    """The case in a container of half the radius; None where there is no radius or the bodies do not fit."""
    domain = case.domain.halved()
    if domain is None or domain.mesh is not None:
        return None
    data = case.model_dump(exclude_none=True) | {"domain": domain.model_dump(exclude_none=True)}
    try:
        return parse_case(data)
    except InputError:
        return None


def truncation(case: Case, whole: Solution, half: Solution) -> dict[str, float]:
    """How much the results change when the radius R of the container is halved.

    The effect of R decays like R^-1 (a net force in a ball) or faster, so the error at R is at most this
    change; with a plane it decays like R^-2 or faster, and the error is at most a third of it. Results are
    the loads on held components and the velocities of free ones; torques count over the radius of the body,
    rotations times it.

    Returns:
        "force" and "velocity": largest |change| / largest |result|, each only if there is such a result.
    """
    change = ErrorEstimate(np.abs(half.U - whole.U), np.abs(half.F - whole.F))
    q = case.configuration()
    return relative_change(whole, change, case.motion(0.0).held, q.arms, flow_scales(case, 0.0))
