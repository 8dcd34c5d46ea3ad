"""What `fsi solve` shows of the model of pores: bodies, stress, checks, and the necks that cost most.

A force is the one that the FLUID exerts on the body, `-F`, as in `fsi.report.solution`.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import isnan
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.console import Console
from rich.table import Table
from rich.text import Text

from fsi.case.case import Case
from fsi.integration.errors import ErrorEstimate
from fsi.report.console import checks_table, table
from fsi.report.solution import (
    Truncation,
    bodies_json,
    bodies_table,
    driven_json,
    driven_lines,
    truncation_checks,
    turning,
)

if TYPE_CHECKING:
    from fsi.pores.instant import (
        PoreInstant,  # whose loops are compiled, which takes as long to load as a solve
    )

_NECKS = 10  # that are listed


def solution_json(
    case: Case, found: PoreInstant, errors: ErrorEstimate, truncated: Truncation
) -> dict[str, Any]:
    """The object that `fsi solve --json` prints; `truncation` is there where it could be measured.

    Stresslets and their errors are those less the trace, which pores do not tell: S_xx = -S_yy.
    """
    bodies = bodies_json(case, found.U, found.F)
    for body, U, F in zip(bodies, errors.U, errors.F, strict=True):
        body |= {"velocity_error": U[:2].tolist(), "angular_velocity_error": turning(U[2:])}
        body |= {"force_error": F[:2].tolist(), "torque_error": turning(F[2:])}
    if found.bulk is not None and errors.stress is not None:
        for body, S, error in zip(bodies, found.bulk.stresslets, errors.stress.stresslets, strict=True):
            body |= {"stresslet": S.tolist(), "stresslet_error": error.tolist()}
    data: dict[str, Any] = {
        "name": case.name,
        "bodies": bodies,
        "dissipation": float(found.dissipation),
        "dissipation_error": float(errors.dissipation),
        "checks": _checks(found),
        "pores": case.pores.model_dump(exclude_none=True) | {"count": found.pores, "most_modes": found.modes},
        "dofs": found.dofs,
        "necks": _necks(case, found, len(found.necks.gap)),
        "seconds": float(sum(found.seconds.values())),
        "seconds_by_phase": {phase: float(spent) for phase, spent in found.seconds.items()},
    }
    data |= _stress(found, errors) | driven_json(found, errors)
    return data if truncated is None else data | {"truncation": dict(truncated)}


def _checks(found: PoreInstant) -> dict[str, float]:
    """Those that apply, as of the resolved flow: others are nan, which JSON does not have."""
    return {name: float(value) for name, value in found.checks.items() if not isnan(value)}


def _stress(found: PoreInstant, errors: ErrorEstimate) -> dict[str, Any]:
    data: dict[str, Any] = {}
    if found.apparent_viscosity is not None:
        data["apparent_viscosity"] = found.apparent_viscosity
        data["apparent_viscosity_error"] = errors.apparent_viscosity
        data["upper_bound"] = found.force_free
        data["lower_bound"] = _lower_bound(found)
    if found.bulk is None or errors.stress is None:
        return data
    shear, bars = float(found.bulk.mean[0, 1]), errors.stress.columns
    data |= {"mean_shear_stress": shear, "mean_shear_stress_error": bars["err_stress_xy"]}
    data["normal_stress_difference"] = found.bulk.normal_stress_difference
    return data | {"normal_stress_difference_error": bars["err_N_1"]}


def _lower_bound(found: PoreInstant) -> float | None:
    """Of the apparent viscosity where there is one, and bodies are not so many that it takes long."""
    return found.lower_bound if found.few else None


def _necks(case: Case, found: PoreInstant, most: int) -> list[dict[str, Any]]:
    """The necks between bodies, and bodies and walls, those first in which most is dissipated."""
    necks, sides = found.necks, (*case.names, *case.container().walls)
    order = np.argsort(-necks.dissipation, kind="stable")[:most]
    return [
        {
            "between": [sides[k] for k in necks.sides[n]],
            "gap": float(necks.gap[n]),
            "dissipation": float(necks.dissipation[n]),
            "flux": float(necks.flux[n]),
        }
        for n in order
    ]


def print_solution(
    console: Console, case: Case, found: PoreInstant, errors: ErrorEstimate, truncated: Truncation
) -> None:
    """The same for a reader."""
    held = case.motion(0.0).held

    def numbers(i: int, k: int) -> tuple[str, ...]:
        of_U = "" if held[i, k] else f"{errors.U[i, k]:.0e}"
        of_F = f"{errors.F[i, k]:.0e}" if held[i, k] else ""
        return f"{found.U[i, k]:.8g}", of_U, f"{0.0 - found.F[i, k]:.8g}", of_F

    caption = "forces and torques per unit length, rotation counterclockwise"
    console.print(bodies_table(case, ("velocity", "±", "force of the fluid", "±"), numbers, caption))
    if len(found.necks.gap):
        console.print(_necks_table(case, found))
    for line in (*_stress_lines(found, errors), *driven_lines(found, errors)):
        console.print(Text(line))
    console.print(checks_table("check, relative", _checks(found) | truncation_checks(truncated)))
    phases = ", ".join(f"{phase} {spent:.2f}" for phase, spent in found.seconds.items())
    console.print(
        Text(
            f"dissipation {found.dissipation:.8g} ± {errors.dissipation:.0e}; "
            f"at most {found.modes} modes an edge, {found.pores} pores, {found.dofs} unknowns, "
            f"{found.dofs / len(found.U):.1f} a body, "
            f"{sum(found.seconds.values()):.2f} CPU s ({phases})"
        )
    )


def _stress_lines(found: PoreInstant, errors: ErrorEstimate) -> Iterator[str]:
    """Viscosity and stress of a periodic flow, and what they bound."""
    if found.apparent_viscosity is not None:
        bound = ", an upper bound" if found.force_free else ""
        if (least := _lower_bound(found)) is not None:
            bound += f"; at least {least:.8g}, by stresses in equilibrium"
        yield f"apparent viscosity {found.apparent_viscosity:.8g} ± {errors.apparent_viscosity:.0e}{bound}"
    if found.bulk is not None and errors.stress is not None:
        bars, N_1 = errors.stress.columns, found.bulk.normal_stress_difference
        shear = f"mean stress xy {found.bulk.mean[0, 1]:.8g} ± {bars['err_stress_xy']:.0e}"
        yield f"{shear}, N_1 {N_1:.8g} ± {bars['err_N_1']:.0e}; less its trace, which pores do not tell"


def _necks_table(case: Case, found: PoreInstant) -> Table:
    keys = ("gap", "dissipation", "flux")
    rows = ((*row["between"], *(f"{row[key]:.6g}" for key in keys)) for row in _necks(case, found, _NECKS))
    title = f"necks that dissipate most, of {len(found.necks.gap)}"
    return table(("neck between", "and"), keys, rows, title=title)
