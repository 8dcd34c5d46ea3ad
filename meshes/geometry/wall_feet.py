"""The gaps between a body and the walls of a container."""

from __future__ import annotations

from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.ellipsoid import PlacedEllipsoid
from fsi.meshes.geometry.feet import Foot, Opposite
from fsi.meshes.geometry.placed import Placed


def feet_in_space(body: PlacedEllipsoid, container: Container) -> list[Foot]:
    """The gaps of an ellipsoid to all walls, which are planes or the sphere around it."""
    here = body.centre[None]
    each = zip(container.spheres, container.distances(here)[0], container.normals(here)[0], strict=True)
    return [
        body.gap_to_plane(float(distance), normal) if sphere is None else body.gap_within(sphere)
        for sphere, distance, normal in each
    ]


def wall_feet(body: Placed, container: Container) -> list[Foot]:
    """The gaps of a body to all walls."""
    waves = enumerate(container.waves)
    return [body.gap_to_surface(_opposite(container, k), wave) for k, wave in waves]


def all_wall_feet(body: Placed, container: Container, reach: float) -> list[list[Foot]]:
    """All gaps of a body to each wall up to `reach`, the narrowest first and whatever its width."""
    waves = enumerate(container.waves)
    return [body.feet_on(_opposite(container, k), reach, wave) for k, wave in waves]


def _opposite(container: Container, wall: int) -> Opposite:
    return lambda x: container.to_wall(wall, x)
