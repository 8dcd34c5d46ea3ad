"""An error bar on every force and velocity: the same problem with elements of another degree.

Forces from the reactions, and the velocities of free bodies, converge like h^(2k) with elements of degree k
in velocity and geometry (they are energies, so their error is the square of the flow's). On the same mesh the
values of degree k + 1 are therefore 10 to 1000 times closer to the exact ones, and the difference of the two
is the error of the first. Measured against exact solutions for a disc and a sphere beside a plane, gaps from
1e-5 to 10 radii and k = 2, 3, 4, it is 0.97 to 1.01 times the true error; 1.10 times once, at an error of
1e-10, where rounding begins. On meshes too coarse far away, where one degree more gains only a factor 10, it
is 0.9 times. The factor SAFETY makes it a bound.

In space one degree more costs some ten times as much as the solution itself. There the same problem is solved
with one degree less, for a tenth of it: its values are the less accurate ones, and the difference is their
error. Measured beside a plane for k = 3, gaps from 0.01 to 1 radii, it is 14 to 50 times that of degree k on
the default meshes and finer ones, and 9 times on a mesh half as fine. The factor FEWER makes it a bound.
Degree 2, which has none below, takes one more.

It sees the mesh and the elements; it does not see how far a container of finite radius is from an infinite
one (`fsi.observables.truncation` does), nor how a user's own curved mesh differs from its circles.
"""

from __future__ import annotations

from math import nan

import numpy as np
from numpy.typing import NDArray

from fsi.bodies.configuration import Array, Configuration, Motion
from fsi.case.case import Case
from fsi.observables.error_estimate import ErrorEstimate, Results, StepErrors, flow_scales, relative_change
from fsi.stokes.solution import StokesSolution

SAFETY = 1.5
FEWER = 0.15
LOWEST = 2
# Of the largest result: what the factorisation leaves at gaps of 1e-5 radii, where it is worst.
ROUNDING = 1e-11


def step_errors(case: Case, t: float, results: Results, other: StokesSolution) -> StepErrors:
    """Estimated errors of results with the degree of the case, from the same problem solved with another one.

    Args:
        case: what they are of.
        t: the time.
        results: U and F.
        other: with `other_degree_of` that of the case.
    """
    q, motion = other.problem.q, other.problem.motion
    _, factor = other_degree_of(case.discretisation.degree, q.dimension)

    def bound(values: Array, reference: Array, arm: Array, computed: NDArray[np.bool_]) -> Array:
        rounding = ROUNDING * arm * np.abs(values / arm).max(initial=0.0)
        error = np.maximum(factor * np.abs(values - reference), rounding)
        return np.where(computed & case.modes, error, 0.0)

    errors = ErrorEstimate(
        bound(results.U, other.U, 1.0 / q.arms, ~motion.held),
        bound(results.F, other.F, q.arms, motion.held),
        factor * abs(getattr(results, "dissipation", nan) - other.dissipation),
        _of_viscosity(results, other),
    )
    relative = relative_change(results, errors, motion.held, q.arms, flow_scales(case, t))
    mu = getattr(results, "apparent_viscosity", None)
    if mu is not None and errors.apparent_viscosity is not None:
        relative["viscosity"] = errors.apparent_viscosity / abs(mu)
    return StepErrors(errors, relative)


def other_degree_of(degree: int, dimension: int) -> tuple[int, float]:
    """The degree with which a problem is solved again, and what makes the difference a bound of the error."""
    return (degree - 1, FEWER) if dimension == 3 and degree > LOWEST else (degree + 1, SAFETY)


def _of_viscosity(results: Results, other: StokesSolution) -> float | None:
    """The same for the apparent viscosity of a periodic flow, not a number at instants without one."""
    if other.bulk is None:
        return None
    mu, mu_other = getattr(results, "apparent_viscosity", None), other.bulk.apparent_viscosity
    return nan if mu is None or mu_other is None else SAFETY * abs(mu - mu_other)


def motion_of(case: Case, q: Configuration, t: float, instant: Results) -> Motion:
    """What held and drove the bodies at an instant.

    Bodies with mass have the velocity that their history gave them: the error is that of the force at this
    velocity.
    """
    motion, masses = case.motion_at(q, t), case.masses()
    if masses is None:
        return motion
    held = motion.held | (masses > 0.0)
    return Motion(held, np.where(held, instant.U, 0.0), np.where(held, 0.0, motion.F))
