"""Which gaps are wide enough for a flow to be solved in them: those of 1e-8 radii and wider."""

from collections.abc import Sequence

import numpy as np

from fsi.bodies.configuration import Configuration
from fsi.bodies.gaps import find_gaps
from fsi.errors import SolveError
from fsi.meshes.geometry.container import Container

LEAST = 1e-8  # over the radius of a body, of two the smaller one
ROUNDING = 0.1  # of that: as a gap is a difference, one that was meant to be as wide is a little less


def too_narrow(q: Configuration, container: Container, names: Sequence[str]) -> str | None:
    """The gap that is narrowest for its radii, in words, where it is not resolved; None where all are.

    names: of the bodies.
    """
    gaps, sides = find_gaps(q, container), (*names, *container.walls)
    (i, j), (body, wall) = gaps.pairs.T, np.indices(gaps.wall_gaps.shape).reshape(2, -1)
    width = np.concatenate([gaps.pair_gaps, gaps.wall_gaps.ravel()])
    radius = np.concatenate([np.minimum(q.radii[i], q.radii[j]), q.radii[body]])
    relative = width / radius
    if not np.any(relative < (1.0 - ROUNDING) * LEAST):
        return None
    worst = int(np.argmin(relative))
    one, other = np.concatenate([i, body])[worst], np.concatenate([j, len(q) + wall])[worst]
    between = f"between {sides[one]!r} and {sides[other]!r}"
    size = f"{width[worst]:.3g}, {relative[worst]:.2g} radii"
    return f"the gap {between} is {size}, below the {LEAST:g} that are resolved"


def require_resolved(q: Configuration, t: float, container: Container, names: Sequence[str]) -> None:
    """Raise SolveError where a run has come to a gap that is not resolved."""
    if (what := too_narrow(q, container, names)) is not None:
        raise SolveError(
            f"bodies: at t = {t:.9g} {what}; end the run before, by time.contact_gap or time.end, or give "
            'model = "reduced"'
        )
