"""Random ellipsoids in space, turned at random, some of them spheres, close to each other and to walls."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy  # its modules load when they are used

from bench.random_walls import KINDS, Data, Random, Walls, round_container
from fsi.bodies.configuration import Configuration
from fsi.bodies.gaps import find_gaps
from fsi.meshes.geometry.ellipsoid import Ellipsoid, PlacedEllipsoid
from fsi.meshes.geometry.wall_feet import feet_in_space

TRIES, SLIDES = 60, 30
# Gaps over the smallest half axis, equal in the logarithm; narrower ones are not meshed beside ellipsoids.
NARROWEST, WIDEST = 0.02, 1.0
RATIO = 3.0  # of the largest half axis to the smallest, at most
SPHERES, CLOSE = 0.25, 0.75  # how often a body is a sphere, and is put close to what is there
SPAN = 5.0  # of the places in containers that are larger


def one_in_space(rng: Random) -> Walls:
    """A box with walls at rest or sliding, a half-space, or a ball."""
    choice = int(rng.integers(3))
    if choice == 2:
        return replace(round_container(rng, "spatial", 3), most=1)
    return KINDS[("space", "space, sliding lids")[choice]](rng)


def several_in_space(rng: Random) -> Walls:
    """A box for two or three, some walls sliding in every other case."""
    return replace(KINDS["spheres in a box"](rng), most=3)


def ellipsoids(rng: Random, walls: Walls) -> list[Data]:
    """Where bodies stand and what they look like, the first no sphere: parts of [[bodies]]."""
    q, bodies = Configuration.unturned(np.empty((0, 3)), np.empty(0)), list[Data]()
    wanted = int(rng.integers(walls.least, walls.most + 1))
    for _ in range(TRIES):
        axes = _half_axes(rng, round_=bool(bodies) and rng.random() < SPHERES)
        body = _placed(rng, walls, q, Ellipsoid(axes))
        more = Configuration(
            np.vstack([q.centres, body.centre]),
            np.vstack([q.angles, body.angle]),
            np.append(q.radii, body.form.radius),
            ellipsoids=(*q.ellipsoids, body.form),
        )
        narrowest = NARROWEST * min(form.half_axes.min() for form in more.ellipsoids)
        if find_gaps(more, walls.container).smallest() >= narrowest:
            q, bodies = more, [*bodies, _table(body)]
        if len(q) == wanted:
            break
    if len(q) == 0:
        raise ValueError("no room for a body in these walls")
    return bodies


def _half_axes(rng: Random, *, round_: bool) -> np.ndarray:
    """Of a sphere, or of an oblate, a prolate or a triaxial ellipsoid, the largest 0.4 to 0.9."""
    ratio = float(rng.uniform(1.2, RATIO))
    between = float(rng.uniform(1.0, ratio))
    ratios = [(ratio, ratio, 1.0), (ratio, 1.0, 1.0), (ratio, between, 1.0)][int(rng.integers(3))]
    axes = np.ones(3) if round_ else np.array(ratios)
    return np.asarray(float(rng.uniform(0.4, 0.9)) * axes / axes.max())


def _table(body: PlacedEllipsoid) -> Data:
    axes, position = body.form.half_axes, {"position": body.centre.tolist()}
    if np.ptp(axes) == 0.0:
        return position | {"radius": float(axes[0])}
    return position | {"shape": {"kind": "ellipsoid", "axes": axes.tolist()}, "angle": body.angle.tolist()}


def _placed(rng: Random, walls: Walls, q: Configuration, form: Ellipsoid) -> PlacedEllipsoid:
    """Where another body may go, perhaps too close to something: anywhere, or at a gap to a body or wall."""
    container = walls.container
    span = min(container.size(), SPAN)
    centre = container.middle + rng.uniform(-0.5, 0.5, 3) * span
    if len(container.far_walls):
        centre[-1] = form.radius + rng.uniform(0.0, 3.0)
    turned = scipy.spatial.transform.Rotation.random(rng=rng).as_rotvec()
    body = PlacedEllipsoid(form, centre, turned)
    near = [k for k, wall in enumerate(container.walls) if wall not in container.far_walls]
    if len(near) + len(q) == 0 or rng.random() > CLOSE:
        return body
    k = int(rng.integers(len(near) + len(q)))
    gap = float(form.half_axes.min()) * NARROWEST * (WIDEST / NARROWEST) ** rng.random()
    for _ in range(SLIDES):
        foot = (
            feet_in_space(body, container)[near[k]]
            if k < len(near)
            else body.gap_to(q.standing[k - len(near)])
        )
        if abs(foot.gap - gap) < 1e-3 * gap:
            break
        body = replace(body, centre=body.centre + (gap - foot.gap) * foot.normal)
    return body
