"""Random cases of all kinds of walls, their bodies held, free or both, their meshes from coarse to usual.

Walls that slide beside walls at rest, and open walls beside solid ones, make the data jump at corners.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from fsi.bodies.configuration import Array, Configuration
from fsi.bodies.gaps import find_gaps
from fsi.case.case import Case
from fsi.case.load import parse_case
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.containers import Box, HalfPlane, Round
from fsi.meshes.geometry.lattice import Cell

# Gaps over the smaller radius, equal in the logarithm.
NARROWEST, WIDEST = 3e-3, 1.0
TRIES = 200
CLOSE = 0.7  # how often a body is put close to another, or to a wall

type Random = np.random.Generator
type Data = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Walls:
    """A container, its section [domain] of a case file, and how many bodies it may have."""

    container: Container
    domain: Data
    most: int = 3

    @property
    def geometry(self) -> str:
        """As the case file says it."""
        if self.container.axisymmetric:
            return "axisymmetric"
        return "planar" if self.container.dimension == 2 else "spatial"


KINDS: dict[str, Callable[[Random], Walls]] = {}


def kind(name: str) -> Callable[[Callable[[Random], Walls]], Callable[[Random], Walls]]:
    """Register a kind of walls."""

    def register(make: Callable[[Random], Walls]) -> Callable[[Random], Walls]:
        KINDS[name] = make
        return make

    return register


def _box(rng: Random, geometry: str = "planar") -> tuple[Box, Data]:
    """A box of sides 3 to 7, an axisymmetric one from its axis."""
    d, axisymmetric = (3 if geometry == "spatial" else 2), geometry == "axisymmetric"
    upper = rng.uniform(3.0, 7.0 if d == 2 else 4.5, d)
    if axisymmetric:
        upper[0] = rng.uniform(1.5, 4.0)
    low, high = (0.0,) * d, tuple(upper.tolist())
    return Box(low, high, axisymmetric), {"lower": low, "upper": high}


def _sliding(rng: Random, container: Container, wall: str) -> list[float]:
    """A velocity along a wall of a box; along the axis in an axisymmetric one."""
    velocity = rng.uniform(-2.0, 2.0, container.dimension)
    velocity[container.faces[wall][0]] = 0.0
    return list(velocity.tolist())


def _some(rng: Random, names: list[str], most: int) -> list[str]:
    return [str(name) for name in rng.permutation(names)[: rng.integers(1, most + 1)]]


def _solid_box(rng: Random, geometry: str) -> Walls:
    box, domain = _box(rng, geometry)
    return Walls(box, domain)


def _lids(rng: Random, geometry: str) -> Walls:
    """One or more walls slide; across an axis none does."""
    box, domain = _box(rng, geometry)
    names = ["right"] if geometry == "axisymmetric" else list(box.walls)
    some = _some(rng, names, min(2, len(names)))
    return Walls(box, domain | {"walls": {wall: _sliding(rng, box, wall) for wall in some}})


def _open(rng: Random, geometry: str) -> Walls:
    """Some walls open, perhaps under pressure, the others at rest."""
    box, domain = _box(rng, geometry)
    some = _some(rng, list(box.walls), len(box.walls) - 1)
    return Walls(box, domain | {"walls": {wall: _opening(rng) for wall in some}})


def _opening(rng: Random) -> str | Data:
    return "open" if rng.random() < 0.5 else {"pressure": float(rng.uniform(-3.0, 3.0))}


@kind("box, walls at rest")
def _resting(rng: Random) -> Walls:
    return _solid_box(rng, "planar")


@kind("box, sliding lids")
def _sliding_lids(rng: Random) -> Walls:
    return _lids(rng, "planar")


@kind("box, open walls")
def _open_walls(rng: Random) -> Walls:
    return _open(rng, "planar")


@kind("box, mixed walls")
def _mixed(rng: Random) -> Walls:
    """At rest, sliding, with the fluid that comes in or goes out, open: one open at least, and one solid."""
    box, domain = _box(rng)
    wet, solid, *others = (str(wall) for wall in rng.permutation(box.walls))
    walls: Data = {wet: _opening(rng), solid: _sliding(rng, box, solid)}
    for wall in others:
        walls[wall] = (
            [0.0, 0.0],
            _sliding(rng, box, wall),
            rng.uniform(-1.0, 1.0, 2).tolist(),
            _opening(rng),
        )[rng.integers(4)]
    return Walls(box, domain | {"walls": walls})


def _channel(rng: Random, drive: Data) -> Walls:
    """Sliding or resting walls."""
    box, domain = _box(rng)
    walls: Data = {}
    for wall in ("bottom", "top"):
        if rng.random() < 0.6:
            walls[wall] = [float(rng.uniform(-2.0, 2.0)), 0.0]
    return Walls(
        Box(box.lower, box.upper, periodic=("x",)), domain | {"periodic": ["x"], "walls": walls} | drive
    )


@kind("channel, sheared")
def _sheared_channel(rng: Random) -> Walls:
    return _channel(rng, {})


@kind("channel, driven")
def _driven_channel(rng: Random) -> Walls:
    return _channel(rng, {str(rng.choice(["pressure_gradient", "net_flux"])): float(rng.uniform(-2.0, 2.0))})


@kind("cell")
def _cell(rng: Random) -> Walls:
    """A tilted cell, in shear or in extension."""
    side, tilt, height = rng.uniform(3.5, 6.0), rng.uniform(-1.0, 1.0), rng.uniform(3.5, 6.0)
    vectors = ((float(side), 0.0), (float(tilt), float(height)))
    flow = {str(rng.choice(["shear", "extension"])): float(rng.uniform(-2.0, 2.0))}
    return Walls(Cell(vectors, ((0.0, 0.0), (0.0, 0.0))), {"shape": "cell", "vectors": vectors} | flow)


def _half_plane(rng: Random, geometry: str, dimension: int = 2) -> Walls:
    radius = float(10.0 ** rng.uniform(1.0, 2.0))
    walls: Data = {}
    if geometry != "axisymmetric" and rng.random() < 0.5:
        walls["far"] = {"shear": float(rng.uniform(-2.0, 2.0))}
    elif rng.random() < 0.3:
        walls["far"] = "open"
    container = HalfPlane(radius, geometry == "axisymmetric", dimension)
    return Walls(container, {"shape": "half-plane", "radius": radius, "walls": walls})


@kind("half-plane")
def _beside_plane(rng: Random) -> Walls:
    return _half_plane(rng, "planar")


def _round(rng: Random, geometry: str, dimension: int = 2) -> Walls:
    radius = float(10.0 ** rng.uniform(0.5, 1.5))
    walls: Data = {}
    if geometry == "planar" and rng.random() < 0.5:
        shear = {"shear": float(rng.uniform(-2.0, 2.0))}
        walls["far"] = shear if rng.random() < 0.5 else rng.uniform(-1.0, 1.0, 2).tolist()
    container = Round(radius, geometry == "axisymmetric", dimension)
    return Walls(container, {"shape": "round", "radius": radius, "walls": walls})


@kind("round container")
def _round_container(rng: Random) -> Walls:
    return _round(rng, "planar")


@kind("cylinder")
def _cylinder(rng: Random) -> Walls:
    return (_solid_box, _lids, _open)[rng.integers(3)](rng, "axisymmetric")


@kind("axisymmetric half-plane and ball")
def _around_axis(rng: Random) -> Walls:
    return (_half_plane, _round)[rng.integers(2)](rng, "axisymmetric")


@kind("space")
def _in_space(rng: Random) -> Walls:
    solid = _solid_box(rng, "spatial") if rng.random() < 0.5 else _half_plane(rng, "spatial", 3)
    return Walls(solid.container, solid.domain, most=1)


@kind("space, sliding lids")
def _lids_in_space(rng: Random) -> Walls:
    lids = _lids(rng, "spatial")
    return Walls(lids.container, lids.domain, most=1)


def random_case(kind: str, seed: int) -> Case:
    """The case of a kind with this seed."""
    rng = np.random.default_rng([seed, *kind.encode()])
    walls = KINDS[kind](rng)
    q = _bodies(rng, walls)
    bodies = [
        {"name": f"body {i}", "radius": float(a), "position": x.tolist()} | _motion(rng, walls)
        for i, (x, a) in enumerate(zip(q.centres, q.radii, strict=True))
    ]
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


def _sizes(rng: Random, walls: Walls) -> Data:
    if walls.geometry == "spatial":
        return {
            "degree": int(rng.choice([2, 3])),
            "cells_per_gap": float(rng.uniform(0.3, 0.6)),
            "cells_per_circle": int(rng.integers(6, 10)),
            "growth": float(rng.uniform(0.6, 1.0)),
        }
    return {
        "degree": int(rng.choice([2, 3, 3, 4])),
        "cells_per_gap": float(10.0 ** rng.uniform(-0.6, 0.0)),
        "cells_per_circle": int(rng.integers(10, 40)),
        "growth": float(10.0 ** rng.uniform(-0.6, 0.0)),
    }


def _motion(rng: Random, walls: Walls) -> Data:
    """Each component held at a velocity or free under a load; with an axis those along it alone."""
    d, axisymmetric = walls.container.dimension, walls.geometry == "axisymmetric"
    turning = 3 if d == 3 else 1
    held = rng.random(d + turning) < rng.choice([0.0, 0.5, 1.0])
    given = rng.uniform(-2.0, 2.0, d + turning)
    if walls.container.dimension == 2 and not len(walls.container.walls):
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
    wanted = int(rng.integers(1, walls.most + 1))
    for _ in range(TRIES):
        radius = float(rng.uniform(0.3, 0.9))
        centre = _place(rng, walls, q, radius)
        more = Configuration.unturned(np.vstack([q.centres, centre]), np.append(q.radii, radius))
        if find_gaps(more, container).smallest() >= 0.9 * NARROWEST * more.radii.min():
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
    gap = radius * NARROWEST * (WIDEST / NARROWEST) ** rng.random()
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
