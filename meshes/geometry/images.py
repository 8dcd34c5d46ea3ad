"""To which image of its body a point on it belongs, where a domain has periods."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array, Indices
from fsi.meshes.geometry.lattice import Lattice

if TYPE_CHECKING:
    from fsi.meshes.geometry.placed import Placed


def to_images(
    lattice: Lattice, centres: Array, placed: Sequence[Placed], body: NDArray[np.integer[Any]], x: Array
) -> Indices:
    """The integers m (n, k) of the images at `centres + m @ vectors` that points x (n, d) of bodies are on.

    Of a body no longer than half a period that is the image whose centre is nearest; of others that whose
    outline is.

    Args:
        lattice: of the periods.
        centres: of all bodies, (N, d).
        placed: their outlines there; empty where all are discs or spheres.
        body: on which each point is, (n,).
        x: the points.
    """
    m = lattice.nearest(x - centres[body])
    if not placed or lattice.dimension == 0:
        return m
    shortest = float(np.linalg.norm(lattice.vectors, axis=1).min())
    for i in np.unique(body).tolist():
        if 2.0 * placed[i].outline.radius >= shortest:
            of = np.flatnonzero(body == i)
            trials = m[of][:, None] + lattice.near(2.0 * placed[i].outline.radius)
            moved = x[of][:, None] - lattice.shift(trials.reshape(-1, lattice.dimension)).reshape(
                *trials.shape[:2], 2
            )
            off = np.abs(placed[i].signed_distance(moved.reshape(-1, 2))[0]).reshape(trials.shape[:2])
            m[of] = trials[np.arange(len(of)), off.argmin(axis=1)]
    return m
