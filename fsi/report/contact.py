"""What is said of a run that ended with its smallest gap so narrow that bodies are in contact."""

from collections.abc import Mapping

import numpy as np

from fsi.arrays import Array
from fsi.case.case import Case
from fsi.integration.contact import ContactTime, contact_time

LAW = "while the law of a gap is that of a constant drive"


def told_contact(case: Case, steps: Mapping[str, Array]) -> str:
    """The time of contact, in one line, by the columns t, smallest_gap and, if there, err_t of steps.csv.

    The law of the gap is that of bodies without inertia under constant loads, or of given velocities.
    """
    if _coasts(case):
        return _unknown(f"bodies with mass are slowed down, {LAW}")
    found = contact_time(steps["t"], steps["smallest_gap"])
    if found is None:
        return _unknown("the gap has not closed steadily")
    last = max(case.kinks(), default=found.since)
    if last > found.since:
        return _unknown(f"loads or velocities change until t = {last:g}, {LAW}")
    law = f"the gap closes as -q' ~ q^({found.exponent:.4f} ± {found.exponent_error:.0e})"
    if np.isinf(found.time) and found.exponent - found.exponent_error >= 1.0:
        return f"no contact in finite time: {law}"
    if np.isinf(found.time) or np.isinf(found.error):
        return f"contact in finite time is not decided by q = {found.gap:.3g}: {law}"
    error, held = _error(found, steps)
    told = f"contact at t = {found.time:.8g} ± {error:.0e}, extrapolated from q = {found.gap:.3g}: {law}"
    return f"{told}; {held}"


def _error(found: ContactTime, steps: Mapping[str, Array]) -> tuple[float, str]:
    """Of the time of contact, with that of the time of the last gap where it is known; and what it holds."""
    if "err_t" in steps:
        return found.error + float(steps["err_t"][-1]), "± has the errors of steps and elements"
    return found.error, "± lacks the errors of steps and elements, give output.error_estimates = true"


def _unknown(why: str) -> str:
    return f"contact: its time is not known, as {why}"


def _coasts(case: Case) -> bool:
    """Whether a body with mass moves freely."""
    masses = case.masses()
    return masses is not None and bool((~case.held() & (masses > 0.0)).any())
