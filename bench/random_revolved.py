"""Random bodies of revolution on one axis, close to each other, to walls across it and to the tube around it.

Some of them are spheres. Where fluid slides along bodies, spheres swim too.
"""

from __future__ import annotations

import numpy as np

from bench.placing import CLOSE, SLANTED, TRIES, one_after_the_other, put_close, solid
from bench.random_shapes import NARROWEST, narrowest_gap, scaled, sound_shape
from bench.random_walls import Data, Random, Walls
from fsi.bodies.configuration import Configuration
from fsi.errors import InputError
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.placed import Placed
from fsi.meshes.geometry.revolved import BodyOfRevolution

SPHERES, SLIDING = 0.25, 0.7  # how often a body is a sphere, has a surface along which fluid slides
REACH = 4.0  # how far from a plane a body is put, and half of how far in other containers
LOOSEST = 0.1  # the widest gap to a tube that is nearly filled
DRAWN = 2000  # points, among which is the one farthest from the axis but for 1e-6 of the radius


def bodies_on_axis(rng: Random, walls: Walls) -> list[Data]:
    """Where bodies of the size of 0.3 to 0.9 stand and what they look like: parts of [[bodies]]."""
    return _bodies(rng, walls, tight=False)


def filling_bodies(rng: Random, walls: Walls) -> list[Data]:
    """The same in a tube that they nearly fill: the first one leaves a narrow gap to its wall."""
    return _bodies(rng, walls, tight=True)


def sliding_bodies(rng: Random, walls: Walls) -> list[Data]:
    """The same bodies, of which most slide, and half of the spheres swim."""
    bodies = _bodies(rng, walls, tight=False)
    for body in bodies:
        if rng.random() < SLIDING:
            size = body.get("radius") or _form(body).radius
            body["slip_length"] = float(size * 10.0 ** rng.uniform(-3.0, 0.0))
        if "radius" in body and rng.random() < 0.5:
            body["surface_velocity"] = rng.uniform(-2.0, 2.0, int(rng.integers(1, 4))).tolist()
    return bodies


def _bodies(rng: Random, walls: Walls, *, tight: bool) -> list[Data]:
    """One or more, the first one no sphere."""

    def draw(q: Configuration) -> tuple[Placed, Data]:
        first = len(q) == 0
        table: Data = {"radius": 1.0} if not first and rng.random() < SPHERES else _random_body(rng)
        table = _scaled(table, _factor(rng, walls, table, tight=tight and first))
        body = _placed(rng, walls.container, q, table)
        return body, table | {"position": body.centre.tolist()}

    return one_after_the_other(rng, walls, draw, narrowest_gap)


def _form(table: Data) -> BodyOfRevolution:
    """Raises ValueError, InputError: no body looks so."""
    if "radius" in table:
        return BodyOfRevolution.sphere(table["radius"])
    return sound_shape(table["shape"]).revolved(table["angle"])


def _scaled(table: Data, factor: float) -> Data:
    if "radius" in table:
        return {"radius": factor * table["radius"]}
    return table | {"shape": scaled(table["shape"], factor)}


def _factor(rng: Random, walls: Walls, table: Data, *, tight: bool) -> float:
    """To the radius 0.3 to 0.9, or to one gap to the tube of the smallest to a tenth of its radius."""
    form = _form(table)
    if not tight:
        return float(rng.uniform(0.3, 0.9)) / form.radius
    widest = float(np.abs(_at(form, table, 0.0).drawn(DRAWN)[:, 0]).max())
    gap = NARROWEST * (LOOSEST / NARROWEST) ** rng.random()
    return float(walls.container.faces["right"][1] * (1.0 - gap) / widest)


def _at(form: BodyOfRevolution, table: Data, z: float) -> Placed:
    return Placed(form, np.array([0.0, z]), table.get("angle", 0.0))


def _placed(rng: Random, container: Container, q: Configuration, table: Data) -> Placed:
    """Where another body may go, perhaps too close to something: anywhere, or at a gap to a body or wall."""
    form = _form(table)
    low, high = container.axis()
    high = min(high, low + REACH) if container.far_walls else min(high, low + 2.0 * REACH)
    body = _at(form, table, float(rng.uniform(low, high)))
    across = np.abs(container.normals(np.array([[0.0, high]]))[0, :, 1]) > SLANTED
    near = [k for k in solid(container) if across[k]]
    if len(near) + len(q) == 0 or rng.random() > CLOSE:
        return body
    return put_close(rng, q, body, container, near, NARROWEST, form.radius)


def _random_body(rng: Random) -> Data:
    """A body of any other kind, about as large as 1."""
    kinds = ("ellipse", "stadium", "superellipse", "polygon", "fourier", "profile", "tip")
    kind = str(rng.choice(kinds))
    for _ in range(TRIES):
        table = {"shape": _table(kind, rng), "angle": _angle(kind, rng)}
        try:
            form = _form(table)
        except (ValueError, InputError):  # sides too short for their arcs
            continue
        if form.is_symmetric:
            return table
    raise ValueError(f"no sound {kind} found")


def _angle(kind: str, rng: Random) -> float:
    """At which the curve is symmetric about r = 0: of what is so about both axes four, else two."""
    quarters = int(rng.integers(4))
    return 0.5 * np.pi * (quarters if kind in ("ellipse", "stadium", "superellipse") else quarters // 2 * 2)


def _table(kind: str, rng: Random) -> Data:
    """The table `shape` of a body of revolution about as large as 1."""
    even, odd = 2 * int(rng.integers(1, 6)), 2 * int(rng.integers(1, 5)) + 1
    ends = np.sort(rng.uniform(-1.0, 1.0, int(rng.integers(2, 5))))
    half = np.column_stack([rng.uniform(0.2, 1.0, len(ends)), ends])
    turn = np.pi * np.arange(6) / 5.0
    profile = rng.uniform(0.6, 1.0, 6)[:, None] * np.column_stack([np.sin(turn), -np.cos(turn)])
    profile[-1, 0] = 0.0
    tables: dict[str, Data] = {
        "ellipse": {"axes": [1.0, float(10.0 ** rng.uniform(-0.7, 0.7))]},
        "stadium": {"length": float(rng.uniform(0.3, 6.0)), "radius": 0.5},
        "superellipse": {
            "axes": [1.0, float(10.0 ** rng.uniform(-0.5, 0.5))], "exponent": float(rng.uniform(2.0, 8.0))
        },
        "polygon": {  # of frustums one upon the other
            "corners": [*half.tolist(), *(half[::-1] * [-1.0, 1.0]).tolist()],
            "rounding": float(rng.uniform(0.05, 0.3)),
        },
        "fourier": {
            "radius": 1.0, "orders": [even, odd],
            "cosines": [float(rng.uniform(-0.4, 0.4)) / even, 0.0],
            "sines": [0.0, float(rng.uniform(-0.4, 0.4)) / odd],
        },
        "profile": {"points": profile.tolist()},
        "tip": {"radius": 1.0, "alpha": float(rng.uniform(0.2, 1.0)), "length": float(rng.uniform(0.3, 1.2))},
    }  # fmt: skip
    return {"kind": kind} | tables[kind]
