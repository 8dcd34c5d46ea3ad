"""What to do about a solution that is refused: its residual, an identity, or R is off by more than allowed.

That happens in the narrowest gaps alone. Coordinates are rounded to 1e-16 of their distance from the origin,
and fluid that several gaps shut in turns such a rounding into a pressure that is larger by (a/q)^(5/2): with
the corner of a box at (-8, 0) a disc at 1e-7 radii from both walls is refused, with the corner at the origin
it is solved at 1e-8, to 2e-6.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import numpy as np

from fsi.bodies.gaps import find_gaps
from fsi.errors import RefusedError, SolveError
from fsi.stokes.problem import StokesProblem

_NEAR = 0.1  # of a radius: there the origin is already


@contextmanager
def explained(problem: StokesProblem, names: Sequence[str], *, shift: bool = True) -> Iterator[None]:
    """Raise a RefusedError from within as a SolveError that names the narrowest gap, and what to do.

    problem: what is solved, in the user's units. names: of its bodies. shift: whether it would help to have
    the origin elsewhere.
    """
    try:
        yield
    except RefusedError as error:
        raise SolveError(f"{error}; {_remedy(problem, names, shift=shift)}") from error


def _remedy(problem: StokesProblem, names: Sequence[str], *, shift: bool) -> str:
    """The narrowest gap, and what to do about it."""
    q, container = problem.q, problem.container
    gaps = find_gaps(q, container)
    if not np.isfinite(gaps.smallest()):
        return "lower discretisation.growth"
    wall_gaps = gaps.wall_gaps
    if wall_gaps.min(initial=np.inf) <= gaps.pair_gaps.min(initial=np.inf):
        i, k = divmod(int(wall_gaps.argmin()), wall_gaps.shape[1])
        other, gap = container.walls[k], wall_gaps[i, k]
        towards = -container.normals(q.centres[[i]])[0, k]
    else:
        pair = int(gaps.pair_gaps.argmin())
        (i, j), gap = gaps.pairs[pair].tolist(), gaps.pair_gaps[pair]
        other, between = names[j], q.centres[j] + gaps.away[pair] - q.centres[i]
        towards = between / np.linalg.norm(between)
    place = q.centres[i] + q.radii[i] * towards
    what = f"bodies: the narrowest gap, between {names[i]!r} and {other!r}, is {gap:.3g}; widen it"
    if not shift or np.linalg.norm(place) <= _NEAR * q.radii[i]:
        return what
    where = ", ".join(f"{x:.6g}" for x in place)
    return f"{what}, or shift all coordinates so that the origin is there, at ({where})"
