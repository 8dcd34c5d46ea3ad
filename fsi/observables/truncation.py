"""How far the container of a case that stands for infinity shows in its results."""

import numpy as np

from fsi.case.case import Case
from fsi.case.checks.work import check_work
from fsi.case.load import parse_case
from fsi.errors import InputError
from fsi.integration.errors import ErrorEstimate
from fsi.integration.state import Results
from fsi.observables.scales import flow_scales, relative_change
from fsi.parallel import on_root

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
