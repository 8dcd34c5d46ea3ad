"""The flow without bodies of a case, `u_inf = u_0 + E x`, where walls make one that is uniform or sheared."""

from collections.abc import Mapping

import numpy as np

from fsi.arrays import Array
from fsi.case.walls import WallVelocity
from fsi.errors import InputError
from fsi.meshes.geometry.container import Container

# Of the fastest wall: velocities nearer than this are the same.
_SAME = 1e-12


def background(container: Container, walls: Mapping[str, WallVelocity]) -> tuple[Array, Array]:
    """u_0 (d,) and E (d, d), rows of du_i/dx_j, of the flow that walls of given velocities drive.

    It is the mean flow of a cell, uniform where all walls move alike, the shear flow that is given at a wall,
    or of a box the linear flow between two opposite walls that move along themselves, wherever the sides are;
    with one of the two open it is uniform. Walls that move along their normals squeeze and drive no flow.
    Raises InputError: the walls drive another flow.
    """
    d = container.dimension
    if not container.walls:
        return np.zeros(d), container.mean_gradient
    if container.faces:
        walls = _with_height(container, walls)
    velocity = {name: wall.velocity for name, wall in walls.items()}
    shear = np.zeros((d, d))
    shear[0, -1] = next((wall.shear for wall in walls.values() if wall.shear), 0.0)
    moves = np.array(list(velocity.values())).reshape(-1, d)
    same = _SAME * float(np.abs(moves).max(initial=0.0))
    if not len(moves) or np.ptp(moves, axis=0).max() <= same:
        return (moves[0].copy() if len(moves) else np.zeros(d)), shear
    if shear.any() or not container.faces:
        raise _other_flow(velocity)
    return _between_walls(container, velocity, same)


def _with_height(container: Container, walls: Mapping[str, WallVelocity]) -> dict[str, WallVelocity]:
    """Faces of a box across its height with the velocity of their shear flow; of the sides those without."""
    e_x, last = np.eye(container.dimension)[0], container.dimension - 1
    faces = {name: (wall, *container.faces[name]) for name, wall in walls.items()}
    flat = {
        name: WallVelocity(wall.velocity + wall.shear * height * e_x, 0.0)
        for name, (wall, axis, height) in faces.items()
        if axis == last
    }
    return flat | {name: wall for name, (wall, axis, _) in faces.items() if axis < last and not wall.shear}


def _between_walls(container: Container, velocity: Mapping[str, Array], same: float) -> tuple[Array, Array]:
    """The linear flow between the one pair of opposite faces of a box that move along themselves."""
    d = container.dimension
    driving = []
    for axis in range(d):
        sides = {name: at for name, (across, at) in container.faces.items() if across == axis}
        moves = np.array([velocity[name] for name in sides if name in velocity]).reshape(-1, d)
        across, along = moves[:, axis], np.where(np.arange(d) == axis, 0.0, moves)
        if len(across) == 2 and np.all(np.abs(across) > same) and abs(np.diff(across)[0]) <= same:
            raise _other_flow(velocity)
        if np.abs(along).max(initial=0.0) > same:
            driving.append((axis, tuple(sides.values()), along[0], along[-1]))
    if not driving:
        return np.zeros(d), np.zeros((d, d))
    if len(driving) > 1 or container.axisymmetric:
        raise _other_flow(velocity)
    axis, (start, end), low, high = driving[0]
    E = np.zeros((d, d))
    E[:, axis] = (high - low) / (end - start)
    return low - E[:, axis] * start, E


def _other_flow(velocity: Mapping[str, Array]) -> InputError:
    name = max(velocity, key=lambda name: float(np.abs(velocity[name]).max()))
    return InputError(
        f"domain.walls.{name} = {velocity[name].tolist()}: with the others it drives a flow that the reduced "
        "model does not know; give all walls one velocity, or slide two opposite walls alone"
    )
