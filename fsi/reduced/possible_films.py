"""Which films the bodies of a reduced case can have: k of each, and what it is between, for messages."""

from itertools import combinations_with_replacement

import numpy as np

from fsi.case.case import Case
from fsi.reduced.enclosure import make_enclosure, overlap, wall_gaps

# Different radii in a case whose pairs are looked at one by one.
_FEW = 40


def between_bodies(case: Case) -> dict[float, str]:
    """k of all pairs that bodies and images can form; of very many radii some, the extremes among them.

    A round wall that the fluid is around is like a body that is held: its films are among them.
    """
    radii = case.configuration().radii
    a, first, count = np.unique(radii, return_index=True, return_counts=True)
    if len(a) > _FEW:
        some = np.linspace(0, len(a) - 1, _FEW).round().astype(int)
        a, first, count = a[some], first[some], count[some]
    alone = count + len(case.container().periods) < 2
    found = {k: film for k, film in _films_on_walls(case).items() if k > 0.0}
    for i, j in combinations_with_replacement(range(len(a)), 2):
        if i != j or not alone[i]:
            names = f"{case.names[first[i]]!r} and {'its like' if i == j else repr(case.names[first[j]])}"
            reduced = a[i] * a[j] / (a[i] + a[j])
            found[float(overlap(reduced, a[i]))] = f"bodies {names} of radii {a[i]:g} and {a[j]:g}"
    return found


def beside_walls(case: Case) -> dict[float, str]:
    """k of all films beside solid walls, plane ones and round ones with the fluid within."""
    return {k: film for k, film in _films_on_walls(case).items() if k <= 0.0}


def _films_on_walls(case: Case) -> dict[float, str]:
    q, around = case.configuration(), make_enclosure(case, 0.0)
    walls = wall_gaps(around.container, q.centres, q.radii)
    found = {}
    for w in np.flatnonzero(walls.lubricates & around.solid):
        name = around.container.walls[w]
        shape = "a plane wall" if around.container.spheres[w] is None else "a round wall"
        for k in np.unique(overlap(walls.radius[:, w], q.radii)).tolist():
            found[float(k)] = f"{shape}, {name!r}"
    return found
