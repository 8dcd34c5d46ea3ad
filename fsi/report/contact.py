"""What is said of a run that ended with its smallest gap so narrow that bodies are in contact."""

from collections.abc import Mapping

import numpy as np

from fsi.bodies.configuration import Array
from fsi.integration.contact import contact_time


def told_contact(steps: Mapping[str, Array]) -> str:
    """The time of contact, in one line, by the columns t and smallest_gap of steps.csv."""
    found = contact_time(steps["t"], steps["smallest_gap"])
    if found is None:
        return "contact: its time is not known, as the gap has not closed steadily"
    law = f"the gap closes as -q' ~ q^({found.exponent:.4f} ± {found.exponent_error:.0e})"
    if np.isinf(found.time) and found.exponent - found.exponent_error >= 1.0:
        return f"no contact in finite time: {law}"
    if np.isinf(found.error):
        return f"contact in finite time is not decided by q = {found.gap:.3g}: {law}"
    return (
        f"contact at t = {found.time:.8g} ± {found.error:.0e}, extrapolated from q = {found.gap:.3g}: {law}"
    )
