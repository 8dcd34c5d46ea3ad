"""Random cases of all kinds of walls, their bodies held, free or both, their meshes from coarse to usual.

Walls that slide beside walls at rest, and open walls beside solid ones, make the data jump at corners.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from bench.random_ellipsoids import ellipsoids, one_in_space, several_in_space
from bench.random_revolved import bodies_on_axis, filling_bodies, sliding_bodies
from bench.random_shapes import bodies_of_the_plane
from bench.random_walls import KINDS, Data, Random, Walls
from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.bodies.gaps import find_gaps
from fsi.case.case import Case
from fsi.case.load import parse_case

WIDEST = 1.0  # of gaps over the smaller radius, which are equal in the logarithm
TRIES = 200
CLOSE = 0.7  # how often a body is put close to another, or to a wall


@dataclass(frozen=True, slots=True)
class Shaped:
    """Walls, and bodies of all shapes in them: parts of [[bodies]]."""

    walls: Callable[[Random], Walls]
    bodies: Callable[[Random, Walls], list[Data]]


_TUBE, _AROUND_AXIS = KINDS["cylinder"], KINDS["axisymmetric half-plane and ball"]
OF_THE_PLANE = ("box", "channel", "cell", "half-plane", "round container")
SHAPED = {
    f"shapes, {name}": Shaped(walls, bodies_of_the_plane)
    for name, walls in KINDS.items()
    if name.split(",")[0] in OF_THE_PLANE
} | {
    "shapes, cylinder": Shaped(_TUBE, bodies_on_axis),
    "shapes, tight cylinder": Shaped(_TUBE, filling_bodies),
    "shapes, axisymmetric half-plane and ball": Shaped(_AROUND_AXIS, bodies_on_axis),
    "shapes, cylinder, slip": Shaped(_TUBE, sliding_bodies),
    "shapes, axisymmetric half-plane and ball, slip": Shaped(_AROUND_AXIS, sliding_bodies),
    "shapes, one in space": Shaped(one_in_space, ellipsoids),
    "shapes, several in space": Shaped(several_in_space, ellipsoids),
}


def random_case(kind: str, seed: int) -> Case:
    """The case of a kind with this seed."""
    rng = np.random.default_rng([seed, *kind.encode()])
    shaped = SHAPED.get(kind)
    walls = shaped.walls(rng) if shaped else KINDS[kind](rng)
    placed = shaped.bodies(rng, walls) if shaped else _spheres(walls.crowd or _bodies(rng, walls))
    bodies = [{"name": f"body {i}"} | body | _motion(rng, walls) for i, body in enumerate(placed)]
    return parse_case(
        {
            "name": f"{kind}, seed {seed}",
            "geometry": walls.geometry,
            "fluid": {"viscosity": 1.0},
            "domain": walls.domain,
            "discretisation": _sizes(rng, walls),
            "bodies": bodies,
        }
    )


def _spheres(q: Configuration) -> list[Data]:
    return [{"position": x, "radius": a} for x, a in zip(q.centres.tolist(), q.radii.tolist(), strict=True)]


def _sizes(rng: Random, walls: Walls) -> Data:
    if walls.geometry == "spatial":
        return {
            "degree": int(rng.choice([2, 3])),
            "cells_per_gap": float(rng.uniform(0.3, 0.6)),
            "cells_per_circle": int(rng.integers(6, 10)),
            "growth": float(rng.uniform(0.6, 1.0)),
        }
    if walls.crowd is not None:
        return _sizes_of_many(rng)
    return {
        "degree": int(rng.choice([2, 3, 3, 4])),
        "cells_per_gap": float(10.0 ** rng.uniform(-0.6, 0.0)),
        "cells_per_circle": int(rng.integers(10, 40)),
        "growth": float(10.0 ** rng.uniform(-0.6, 0.0)),
    }


def _sizes_of_many(rng: Random) -> Data:
    """In every other case those that the program has for many bodies, else around them."""
    if rng.random() < 0.5:
        return {}
    return {
        "degree": int(rng.choice([3, 4, 4])),
        "cells_per_gap": float(rng.uniform(0.2, 0.45)),
        "cells_per_circle": int(rng.integers(14, 30)),
        "growth": float(rng.uniform(0.2, 0.45)),
        "interior": str(rng.choice(["graded", "sparse"])),
    }


def _motion(rng: Random, walls: Walls) -> Data:
    """Each component held at a velocity or free under a load; with an axis those along it alone."""
    d, axisymmetric = walls.container.dimension, walls.geometry == "axisymmetric"
    turning = 3 if d == 3 else 1
    held = rng.random(d + turning) < rng.choice([0.0, 0.5, 1.0])
    given = rng.uniform(-2.0, 2.0, d + turning)
    if not len(walls.container.walls):
        given[:] = 0.0  # a load on all bodies of a cell together drives fluid through it
    if axisymmetric:
        velocity: list[Any] = [0.0, float(given[1]) if held[1] else "free"]
        return {"velocity": velocity, "force": [0.0, 0.0 if held[1] else float(given[1])]}
    velocity, load = [], []
    for is_held, value in zip(held.tolist(), given.tolist(), strict=True):
        velocity.append(value if is_held else "free")
        load.append(0.0 if is_held else value)
    return {
        "velocity": velocity[:d],
        "angular_velocity": velocity[d:] if d == 3 else velocity[d],
        "force": load[:d],
        "torque": load[d:] if d == 3 else load[d],
    }


def _bodies(rng: Random, walls: Walls) -> Configuration:
    """One or more bodies, one after the other where there is room for it, often close to what is there."""
    container, d = walls.container, walls.container.dimension
    q = Configuration.unturned(np.empty((0, d)), np.empty(0))
    wanted = int(rng.integers(walls.least, walls.most + 1))
    for _ in range(TRIES):
        radius = float(rng.uniform(0.3, 0.9))
        centre = _place(rng, walls, q, radius)
        more = Configuration.unturned(np.vstack([q.centres, centre]), np.append(q.radii, radius))
        if find_gaps(more, container).smallest() >= 0.9 * walls.narrowest * more.radii.min():
            q = more
        if len(q) == wanted:
            return q
    if len(q):
        return q
    raise ValueError("no room for a body in these walls")


def _place(rng: Random, walls: Walls, q: Configuration, radius: float) -> Array:
    """Where another body may go, perhaps too close to something: at random, or at a gap to body or wall."""
    container, d = walls.container, walls.container.dimension
    span = min(container.size(), 12.0)
    middle = np.zeros(d)
    if container.size() == span:
        middle = np.asarray(container.middle)
    centre = middle + rng.uniform(-0.5, 0.5, d) * span
    if len(container.far_walls):
        centre[-1] = radius + rng.uniform(0.0, 3.0)
    if container.axisymmetric:
        centre[0] = 0.0
    if rng.random() > CLOSE:
        return centre
    towards = [k for k, wall in enumerate(container.walls) if wall not in container.far_walls]
    if container.axisymmetric:
        towards = [k for k in towards if abs(container.normals(centre[None])[0, k, 0]) < 0.5]
    k = int(rng.integers(len(towards) + len(q))) if len(towards) + len(q) else 0
    gap = radius * walls.narrowest * (WIDEST / walls.narrowest) ** rng.random()
    if k < len(towards):
        n, away = (
            part[0, towards[k]]
            for part in (container.normals(centre[None]), container.distances(centre[None]))
        )
        return np.asarray(centre - (away - radius - gap) * n)
    if not len(q):
        return centre
    other = k - len(towards)
    direction = rng.normal(size=d)
    if container.axisymmetric:
        direction[0] = 0.0
    direction /= np.linalg.norm(direction)
    return np.asarray(q.centres[other] + (q.radii[other] + radius + gap) * direction)
