"""Random places of bodies: one after the other where there is room, close to each other and to walls."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from bench.random_walls import Data, Random, Walls
from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.bodies.gaps import feet_on_walls, find_gaps, foot_between
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.ellipsoid import PlacedEllipsoid
from fsi.meshes.geometry.feet import Foot
from fsi.meshes.geometry.placed import Placed

TRIES, SLIDES = 60, 30
WIDEST = 1.0  # of gaps over the size of a body, which are equal in the logarithm
CLOSE = 0.75  # how often a body is put close to what is there
SLANTED = 0.1  # component along the axis of a normal, below which no motion along it closes the gap

type Body = Placed | PlacedEllipsoid


def one_after_the_other(
    rng: Random,
    walls: Walls,
    draw: Callable[[Configuration], tuple[Body, Data]],
    narrowest: Callable[[Configuration], float],
) -> list[Data]:
    """Bodies where there is room for them, parts of [[bodies]].

    `draw` gives one more beside those that stand, perhaps too close to something, and its table; `narrowest`
    the narrowest gap that is left between such bodies. Raises ValueError: no body has room.
    """
    q = Configuration.unturned(np.empty((0, walls.container.dimension)), np.empty(0))
    tables: list[Data] = []
    wanted = int(rng.integers(walls.least, walls.most + 1))
    for _ in range(TRIES):
        body, table = draw(q)
        more = _joined(q, body)
        if find_gaps(more, walls.container).smallest() >= narrowest(more):
            q, tables = more, [*tables, table]
        if len(q) == wanted:
            break
    if not tables:
        raise ValueError("no room for a body in these walls")
    return tables


def somewhere(rng: Random, container: Container, radius: float, widest: float) -> Array:
    """A centre (d,) in the middle of a container, of so much of it at most; beside a plane not in it."""
    span = min(container.size(), widest)
    centre: Array = container.middle + rng.uniform(-0.5, 0.5, container.dimension) * span
    if container.far_walls:
        centre[-1] = radius + rng.uniform(0.0, 3.0)
    return centre


def solid(container: Container) -> list[int]:
    """The walls that are not far away."""
    return [k for k, wall in enumerate(container.walls) if wall not in container.far_walls]


def put_close[B: Body](
    rng: Random,
    q: Configuration,
    body: B,
    container: Container,
    near: list[int],
    narrowest: float,
    size: float,
) -> B:
    """The body slid to a gap to one of the walls `near` or of the bodies.

    The gap over the size of the body is `narrowest` to WIDEST. The body goes along the normal where it is
    nearest; on an axis along this, unless it would come no closer.
    """
    k = int(rng.integers(len(near) + len(q)))
    gap = size * narrowest * (WIDEST / narrowest) ** rng.random()
    for _ in range(SLIDES):
        more = _joined(q, body)
        if k < len(near):
            foot = feet_on_walls(more, len(q), container)[near[k]]
        else:
            foot = foot_between(more, len(q), k - len(near))
        slanted = container.axisymmetric and abs(foot.normal[1]) < SLANTED
        if slanted or abs(foot.gap - gap) < 1e-3 * gap:
            break
        body = replace(body, centre=body.centre + _way(foot, gap, container))
    return body


def _way(foot: Foot, gap: float, container: Container) -> Array:
    """What moves a body (d,) until its gap, along one normal, is this one."""
    if container.axisymmetric:
        return np.array([0.0, (gap - foot.gap) / foot.normal[1]])
    return np.asarray((gap - foot.gap) * foot.normal)


def _joined(q: Configuration, body: Body) -> Configuration:
    """The configuration with one body more."""
    centres = np.vstack([q.centres, body.centre])
    angles = np.concatenate([q.angles, [body.angle]])
    if isinstance(body, Placed):
        radii = np.append(q.radii, body.outline.radius)
        return Configuration(centres, angles, radii, outlines=(*q.outlines, body.outline))
    radii = np.append(q.radii, body.form.radius)
    return Configuration(centres, angles, radii, ellipsoids=(*q.ellipsoids, body.form))
