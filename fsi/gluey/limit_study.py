"""The case file of one body above a wall as the viscosity vanishes, and its convergence to the limit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from fsi.bodies.configuration import Array
from fsi.case.section import Section
from fsi.gluey.history import History, polynomial
from fsi.gluey.limit import Limit, slides_scheme
from fsi.gluey.one_body import Path, solve

SAMPLES = 400


class LimitCase(Section):
    """`q'' = -eps q'/q + f`."""

    name: str = Field(min_length=1, description="a few words that name the case")
    model: Literal["limit"] = Field(description='"limit"')
    q0: float = Field(gt=0.0, description="the distance at time 0, a number > 0")
    u0: float = Field(default=0.0, description="the velocity at time 0, a number")
    force: History = Field(
        default=0.0, description="per mass, a number or a table {times = [...], values = [...]}"
    )
    end: float = Field(gt=0.0, description="the time at which it ends, a number > 0")
    eps: tuple[Annotated[float, Field(gt=0.0)], ...] = Field(
        default=(1e-1, 1e-2, 1e-4, 1e-6, 1e-8), min_length=1, description="viscosities, numbers > 0"
    )
    steps: tuple[Annotated[int, Field(ge=1)], ...] = Field(
        default=(100, 200, 400, 800), min_length=1, description="numbers of steps of the scheme, at least 1"
    )


@dataclass(frozen=True, slots=True)
class Study:
    """Solutions at t, (n,), for each eps, the limit there, and the scheme's errors for each number of steps.

    errors_q: `sup |q_eps - q|`; errors_gamma: the mean of `|gamma_eps - gamma|` (gamma jumps on contact);
    scheme: `max |q_h - q|` over the steps.
    """

    t: Array
    q: Array
    gamma: Array
    paths: tuple[Path, ...]
    errors_q: Array
    errors_gamma: Array
    scheme: Array
    contacts: list[tuple[float, float]]


def study(case: LimitCase) -> Study:
    """Solve a case for each eps and each number of steps."""
    f = polynomial(case.force, case.end)
    limit = Limit.of(case.q0, case.u0, f)
    contacts = limit.contacts()
    events = [time for pair in contacts for time in pair if np.isfinite(time)]
    t = np.unique(np.concatenate([np.linspace(0.0, case.end, SAMPLES + 1), events]))
    q, gamma = limit.q(t), limit.gamma(t)
    paths = tuple(solve(case.q0, case.u0, f, eps, t) for eps in case.eps)
    arrivals = [begin for begin, _ in contacts]  # there gamma jumps
    width = np.where(np.isin(t, arrivals), 0.0, np.gradient(t)) / case.end
    return Study(
        t, q, gamma, paths,
        np.array([np.abs(path.q - q).max() for path in paths]),
        np.array([(width * np.abs(path.gamma - gamma)).sum() for path in paths]),
        np.array([_scheme_error(case, limit, steps) for steps in case.steps]),
        contacts,
    )  # fmt: skip


def _scheme_error(case: LimitCase, limit: Limit, steps: int) -> float:
    t = np.linspace(0.0, case.end, steps + 1)
    impulses = np.diff(limit.utilde(t))
    q, _, _ = slides_scheme(case.q0, case.u0, impulses, np.diff(t))
    return float(np.abs(q - limit.q(t)).max())
