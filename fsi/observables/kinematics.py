"""Vorticity and strain rate of a velocity gradient."""

import numpy as np

from fsi.arrays import Array

# Of the largest r: nodes on the axis stand there to rounding.
ON_AXIS = 1e-12


def vorticity(G: Array) -> Array:
    """curl u, twice the rate of rotation: in space (..., 3), in the plane its component along z, (...).

    In the plane it is `d u_y / dx - d u_x / dy`, positive counterclockwise. In the plane (r, z), drawn with r
    to the right and z up, it is `d u_z / dr - d u_r / dz`, minus the component of curl u along theta.
    """
    turn = G - np.swapaxes(G, -1, -2)
    if G.shape[-1] == 2:
        return np.asarray(turn[..., 1, 0])
    return np.stack([turn[..., 2, 1], turn[..., 0, 2], turn[..., 1, 0]], axis=-1)


def strain_rate(G: Array, hoop: Array | float = 0.0) -> Array:
    """`sqrt(2 e : e)`, (...), e = (G + G^T) / 2: the shear rate in simple shear.

    The fluid dissipates mu times its square per volume, `2 mu e : e`. hoop: u_r / r.
    """
    e = 0.5 * (G + np.swapaxes(G, -1, -2))
    return np.asarray(np.sqrt(2.0 * (np.einsum("...ij,...ij->...", e, e) + np.square(hoop))))


def hoop_rate(r: Array, u_r: Array, G: Array) -> Array:
    """`u_r / r`, and on the axis its limit `d u_r / dr`."""
    off_axis = r > ON_AXIS * np.max(r, initial=0.0)
    return np.where(off_axis, u_r / np.where(off_axis, r, 1.0), G[..., 0, 0])
