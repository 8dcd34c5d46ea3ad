"""The flow without bodies of a case, `u_inf = u_0 + E x`, where walls make one that is linear."""

from collections.abc import Mapping

import numpy as np

from fsi.arrays import Array
from fsi.case.wall_velocity import WallVelocity
from fsi.errors import InputError
from fsi.meshes.geometry.container import Container

# Of the fastest wall: velocities nearer than this are the same.
_SAME = 1e-12


def background(container: Container, walls: Mapping[str, WallVelocity]) -> tuple[Array, Array]:
    """u_0 (d,) and E (d, d), rows of du_i/dx_j, of the flow that walls of given velocities drive.

    It is the mean flow of a cell, the linear flow that is given at walls, uniform where all walls move alike,
    or of a box the linear flow between two opposite walls that move along themselves, wherever the sides are;
    with one of the two open it is uniform. Walls that move along their normals squeeze and drive no flow.
    Raises InputError: the walls drive another flow.
    """
    d = container.dimension
    if not container.walls:
        return np.zeros(d), container.mean_gradient
    velocity = {name: u for name, wall in walls.items() if (u := uniform(container, name, wall)) is not None}
    given = next((wall for name, wall in walls.items() if name not in velocity), None)
    if given is None or (container.faces and velocity):
        flow = WallVelocity(*_of_uniform(container, velocity))
    else:
        flow = given
    for name, wall in walls.items():
        if (given is flow or name not in velocity) and not _follows(container, name, wall, flow):
            raise _other_flow(name, wall)
    return flow.velocity.copy(), flow.gradient.copy()


def uniform(container: Container, name: str, wall: WallVelocity) -> Array | None:
    """The velocity of a wall that has one all over it, (d,); else None."""
    if name in container.faces:
        axis, place = container.faces[name]
        return wall.at(place * np.eye(container.dimension)[axis]) if wall.is_uniform_across(axis) else None
    return None if wall.gradient.any() else wall.velocity


def _follows(container: Container, name: str, wall: WallVelocity, flow: WallVelocity) -> bool:
    """Whether a flow has on a wall what is given there; walls with a shape are not looked at."""
    k, x = container.walls.index(name), container.middle[None]
    u, G, size = wall.velocity - flow.velocity, wall.gradient - flow.gradient, container.size()
    if container.plane[k]:  # G x counts at one point of it, and G along it
        n = container.normals(x)[0, k]
        u = u + G @ (x[0] - container.distances(x)[0, k] * n)
        G = G - np.outer(G @ n, n)
    elif container.spheres[k] is None:
        return True
    fastest = max(
        float(np.abs(one.velocity).max() + size * np.abs(one.gradient).max()) for one in (wall, flow)
    )
    return float(np.abs(u).max() + size * np.abs(G).max()) <= _SAME * fastest


def _of_uniform(container: Container, velocity: Mapping[str, Array]) -> tuple[Array, Array]:
    """u_0 and E of the flow between walls each of which has one velocity (d,)."""
    d = container.dimension
    moves = np.array(list(velocity.values())).reshape(-1, d)
    same = _SAME * float(np.abs(moves).max(initial=0.0))
    if not len(moves) or np.ptp(moves, axis=0).max() <= same:
        return (moves[0].copy() if len(moves) else np.zeros(d)), np.zeros((d, d))
    if not container.faces:
        raise _unknown_flow(velocity)
    return _between_walls(container, velocity, same)


def _between_walls(container: Container, velocity: Mapping[str, Array], same: float) -> tuple[Array, Array]:
    """The linear flow between the one pair of opposite faces of a box that move along themselves."""
    d = container.dimension
    driving = []
    for axis in range(d):
        sides = {name: at for name, (across, at) in container.faces.items() if across == axis}
        moves = np.array([velocity[name] for name in sides if name in velocity]).reshape(-1, d)
        across, along = moves[:, axis], np.where(np.arange(d) == axis, 0.0, moves)
        if len(across) == 2 and np.all(np.abs(across) > same) and abs(np.diff(across)[0]) <= same:
            raise _unknown_flow(velocity)
        if np.abs(along).max(initial=0.0) > same:
            driving.append((axis, tuple(sides.values()), along[0], along[-1]))
    if not driving:
        return np.zeros(d), np.zeros((d, d))
    if len(driving) > 1 or container.axisymmetric:
        raise _unknown_flow(velocity)
    axis, (start, end), low, high = driving[0]
    E = np.zeros((d, d))
    E[:, axis] = (high - low) / (end - start)
    return low - E[:, axis] * start, E


def _unknown_flow(velocity: Mapping[str, Array]) -> InputError:
    name = max(velocity, key=lambda name: float(np.abs(velocity[name]).max()))
    return _other_flow(name, WallVelocity.uniform(velocity[name].tolist()))


def _other_flow(name: str, wall: WallVelocity) -> InputError:
    return InputError(
        f"domain.walls.{name} = {wall}: with the others it drives a flow that the reduced "
        "model does not know; give all walls one velocity, or slide two opposite walls alone"
    )
