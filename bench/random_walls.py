"""Random walls of all kinds: sliding beside resting, open beside solid, round, periodic, in space."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from fsi.arrangements.arrangement import CELLS, Wanted
from fsi.arrangements.kinds import arrange
from fsi.bodies.configuration import Configuration
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.cell import Cell
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.round import HalfPlane, Round

type Random = np.random.Generator
type Data = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Walls:
    """A container, its section [domain] of a case file, and how many bodies it may have, or those it has.

    narrowest: the narrowest gap that is asked for, over the smaller radius.
    """

    container: Container
    domain: Data
    most: int = 3
    crowd: Configuration | None = None
    least: int = 1
    narrowest: float = 3e-3

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


def round_container(rng: Random, geometry: str, dimension: int = 2) -> Walls:
    """A disc, or a ball."""
    radius = float(10.0 ** rng.uniform(0.5, 1.5))
    walls: Data = {}
    if geometry == "planar" and rng.random() < 0.5:
        shear = {"shear": float(rng.uniform(-2.0, 2.0))}
        walls["far"] = shear if rng.random() < 0.5 else rng.uniform(-1.0, 1.0, 2).tolist()
    container = Round(radius, geometry == "axisymmetric", dimension)
    return Walls(container, {"shape": "round", "radius": radius, "walls": walls})


@kind("round container")
def _in_a_disc(rng: Random) -> Walls:
    return round_container(rng, "planar")


@kind("cylinder")
def _cylinder(rng: Random) -> Walls:
    return (_solid_box, _lids, _open)[rng.integers(3)](rng, "axisymmetric")


@kind("axisymmetric half-plane and ball")
def _around_axis(rng: Random) -> Walls:
    return (_half_plane, round_container)[rng.integers(2)](rng, "axisymmetric")


@kind("space")
def _in_space(rng: Random) -> Walls:
    solid = _solid_box(rng, "spatial") if rng.random() < 0.5 else _half_plane(rng, "spatial", 3)
    return Walls(solid.container, solid.domain, most=1)


@kind("space, sliding lids")
def _lids_in_space(rng: Random) -> Walls:
    lids = _lids(rng, "spatial")
    return Walls(lids.container, lids.domain, most=1)


@kind("spheres in a box")
def _spheres_in_a_box(rng: Random) -> Walls:
    """Two to eight, some walls sliding in every other case."""
    walls = (_solid_box, _lids)[rng.integers(2)](rng, "spatial")
    return Walls(walls.container, walls.domain, most=8, least=2, narrowest=1e-2)


@kind("spheres in a cell")
def _spheres_in_a_cell(rng: Random) -> Walls:
    """Two to eight in an oblique cell, in shear or in extension."""
    sides = np.diag(rng.uniform(3.5, 4.5, 3)) + np.tril(rng.uniform(-1.0, 1.0, (3, 3)), -1)
    vectors = tuple(map(tuple, sides.tolist()))
    flow = {str(rng.choice(["shear", "extension", "uniaxial"])): float(rng.uniform(-2.0, 2.0))}
    domain = {"shape": "cell", "vectors": vectors} | flow
    still = ((0.0, 0.0, 0.0),) * 3
    return Walls(Cell(vectors, still), domain, most=8, least=2, narrowest=1e-2)


@kind("suspension")
def _suspension(rng: Random) -> Walls:
    """Some thirty discs between sliding walls, in a box at rest, or in a sheared or stretched cell."""
    cell, gap = str(rng.choice([*CELLS])), float(10.0 ** rng.uniform(-3.0, -1.0))
    sizes, seed = str(rng.choice(["equal", "bidisperse"])), int(rng.integers(1000))
    wanted = Wanted(
        number=int(rng.integers(21, 40)),
        fraction=float(rng.uniform(0.1, 0.55)),
        gap=gap,
        cell=cell,
        sizes=sizes,
        spread=1.4,
        seed=seed,
    )
    found = arrange("random", wanted)
    q, (width, height) = Configuration.unturned(found.centres, found.radii), found.cell.sides
    if cell == "periodic":
        vectors = ((width, 0.0), (0.0, height))
        flow = {str(rng.choice(["shear", "extension"])): float(rng.uniform(-2.0, 2.0))}
        cell_of = {"shape": "cell", "vectors": vectors} | flow
        return Walls(Cell(vectors, ((0.0, 0.0), (0.0, 0.0))), cell_of, crowd=q)
    domain: Data = {"lower": [0.0, 0.0], "upper": [width, height]}
    if cell == "box":
        return Walls(Box((0.0, 0.0), (width, height)), domain, crowd=q)
    channel = Box((0.0, 0.0), (width, height), periodic=("x",))
    walls = {"bottom": [float(rng.uniform(-2.0, 2.0)), 0.0], "top": [float(rng.uniform(-2.0, 2.0)), 0.0]}
    return Walls(channel, domain | {"periodic": ["x"], "walls": walls}, crowd=q)
