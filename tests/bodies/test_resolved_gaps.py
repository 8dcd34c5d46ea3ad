"""Gaps below 1e-8 radii are told by name, of the smaller radius where there are two."""

import numpy as np
import pytest

from fsi.bodies.configuration import Configuration
from fsi.bodies.resolved_gaps import require_resolved, too_narrow
from fsi.errors import SolveError
from fsi.meshes.geometry.box import Box

BOX, NAMES = Box((-8.0, 0.0), (8.0, 8.0)), ("large", "small")


def two(gap: float, to_wall: float) -> Configuration:
    """Discs of radii 1 and 0.5, the second so far from the first and from the plane below."""
    below = np.array([0.0, 0.5 + to_wall])
    return Configuration.unturned(np.array([[0.0, 2.0 + to_wall + gap], below]), np.array([1.0, 0.5]))


@pytest.mark.parametrize(
    ("gap", "to_wall", "words"),
    [
        (1e-8, 1e-8, None),
        (4.8e-9, 1.0, None),  # 0.96e-8 of the smaller one: what rounding may leave of 1e-8
        (4e-9, 1.0, "'large' and 'small' is 4e-09, 8e-09 radii"),
        (4e-9, 2e-9, "'small' and 'bottom' is 2e-09, 4e-09 radii"),
    ],
)
def test_the_narrowest_gap_is_told(gap: float, to_wall: float, words: str | None) -> None:
    q = two(gap, to_wall)
    found = too_narrow(q, BOX, NAMES)
    if words is None:
        assert found is None
        require_resolved(q, 0.0, BOX, NAMES)
        return
    assert found == f"the gap between {words}, below the 1e-08 that are resolved"
    with pytest.raises(
        SolveError, match=r"^bodies: at t = 0\.25 the gap .* by time\.contact_gap or time\.end"
    ):
        require_resolved(q, 0.25, BOX, NAMES)
