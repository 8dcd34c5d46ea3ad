"""External forces between bodies, and between bodies and walls, as laws of the gap; and gravity.

    F_i = sum_j f(d_ij) n_ij + sum_walls f(d_iw) n_iw + m_i g

d is the gap, n_ij the unit vector from body j to body i, n_iw the normal of the wall into the fluid, and
f > 0 repels. The forces of a pair are opposite. None makes a torque, as each acts along the line of centres.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

import numpy as np

from fsi.bodies import Array, Configuration
from fsi.forcelaws import Force, Gravity, PairForce
from fsi.gaps import Gaps, find_gaps
from fsi.normals import inward_normals
from meshes.geometry import Container


def separations(q: Configuration, gaps: Gaps) -> Array:
    """From body or image j to body i of the close pairs, the vectors that their gaps belong to, (P, d)."""
    return q.centres[gaps.pairs[:, 0]] - q.centres[gaps.pairs[:, 1]] - gaps.away


def external_forces(
    forces: Sequence[Force], q: Configuration, container: Container, masses: Array, spheres: bool
) -> Array:
    """The sum of all forces on each body, shape (N, d).

    Args:
        forces: what acts.
        q: where the bodies are; their gaps are positive.
        container: what encloses the fluid.
        masses: of the bodies, shape (N,).
        spheres: whether bodies are spheres, on an axis or in space, or else discs.
    """
    total = np.zeros_like(q.centres)
    volumes = 4.0 / 3.0 * pi * q.radii**3 if spheres else pi * q.radii**2
    for force in forces:
        if isinstance(force, Gravity):
            heavy = masses if force.density_difference is None else force.density_difference * volumes
            total += heavy[:, None] * np.array(force.acceleration)
        else:
            total += _between_bodies(force, q, container)
    return total


def _between_bodies(force: PairForce, q: Configuration, container: Container) -> Array:
    """Forces of one law on each body, shape (N, d)."""
    total = np.zeros_like(q.centres)
    gaps = find_gaps(q, container, force.reach)
    between = separations(q, gaps)
    unit = between / np.linalg.norm(between, axis=1, keepdims=True)
    push = force.repulsion(gaps.pair_gaps)[:, None] * unit
    np.add.at(total, gaps.pairs[:, 0], push)
    np.add.at(total, gaps.pairs[:, 1], -push)
    if force.walls:
        push = force.repulsion(gaps.wall_gaps)
        total += np.einsum("nw,nwd->nd", push, inward_normals(container, q.centres))
    return total
