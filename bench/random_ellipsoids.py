"""Random ellipsoids in space, turned at random, some of them spheres, close to each other and to walls."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy  # its modules load when they are used

from bench.placing import CLOSE, one_after_the_other, put_close, solid, somewhere
from bench.random_walls import KINDS, Data, Random, Walls, round_container
from fsi.bodies.configuration import Configuration
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.ellipsoid import Ellipsoid, PlacedEllipsoid

NARROWEST = 0.02  # of gaps over the smallest half axis; narrower ones are not meshed beside ellipsoids
RATIO = 3.0  # of the largest half axis to the smallest, at most
SPHERES = 0.25  # how often a body is a sphere
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

    def draw(q: Configuration) -> tuple[PlacedEllipsoid, Data]:
        axes = _half_axes(rng, round_=len(q) > 0 and rng.random() < SPHERES)
        body = _placed(rng, walls.container, q, Ellipsoid(axes))
        return body, _table(body)

    return one_after_the_other(rng, walls, draw, _narrowest_gap)


def _narrowest_gap(q: Configuration) -> float:
    return float(NARROWEST * min(form.half_axes.min() for form in q.ellipsoids))


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


def _placed(rng: Random, container: Container, q: Configuration, form: Ellipsoid) -> PlacedEllipsoid:
    """Where another body may go, perhaps too close to something: anywhere, or at a gap to a body or wall."""
    centre = somewhere(rng, container, form.radius, SPAN)
    turned = scipy.spatial.transform.Rotation.random(rng=rng).as_rotvec()
    body = PlacedEllipsoid(form, centre, turned)
    near = solid(container)
    if len(near) + len(q) == 0 or rng.random() > CLOSE:
        return body
    return put_close(rng, q, body, container, near, NARROWEST, float(form.half_axes.min()))
