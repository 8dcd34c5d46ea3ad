"""What to do about a solution that is refused: its residual, an identity, or R is off by more than allowed.

Where no gap is narrow the cells are too coarse. In the narrowest gaps rounding is to blame: coordinates are
rounded to 1e-16 of their distance from the origin, and fluid that several gaps shut in turns such a rounding
into a pressure that is larger by (a/q)^(5/2): with the corner at the origin a disc at 1e-8 radii from both
walls of a box is solved, to 2e-6, with the corner at (-8, 0) at 1e-7 it would be refused. The origin is put
there where that can be done (see `units`); to the user are left containers that stand at the origin, and gaps
that become narrow in a run.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import numpy as np

from fsi.arrays import Array
from fsi.bodies.surface_gap import narrowest_gap
from fsi.errors import RefusedError, SolveError
from fsi.stokes.problem import StokesProblem
from fsi.stokes.units import place_of

_NEAR = 0.1  # of a radius: there the origin is already
_WIDE = 0.1  # of a radius: such a gap is not to blame


@contextmanager
def explained(problem: StokesProblem, names: Sequence[str], origin: Array | None = None) -> Iterator[None]:
    """Raise a RefusedError from within as a SolveError that names the narrowest gap, and what to do.

    problem: what is solved, in the user's units. names: of its bodies. origin: where it is in the solve,
    (d,); None where another one would not help.
    """
    try:
        yield
    except RefusedError as error:
        raise SolveError(f"{error}; {_remedy(problem, names, origin)}") from error


def _remedy(problem: StokesProblem, names: Sequence[str], origin: Array | None) -> str:
    """The narrowest gap, and what to do about it."""
    q, container = problem.q, problem.container
    found = narrowest_gap(q, container)
    if found is None or found.width > _WIDE * q.radii[found.sides[0]]:
        return "lower discretisation.growth or raise discretisation.cells_per_circle"
    (i, other), sides = found.sides, (*names, *container.walls)
    between = f"{names[i]!r} and {sides[other]!r}"
    what = f"bodies: the narrowest gap, between {between}, is {found.width:.3g}; widen it"
    walls = zip(container.walls, container.plane, strict=True)
    stands = any(not plane and name not in container.far_walls for name, plane in walls)
    place = place_of(found, q, container)
    if stands or origin is None or np.linalg.norm(place - origin) <= _NEAR * q.radii[i]:
        return what
    where = ", ".join(f"{x:.6g}" for x in place)
    return f"{what}, or shift all coordinates so that the origin is there, at ({where})"
