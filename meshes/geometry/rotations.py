"""Angles of bodies: numbers in the plane, rotation vectors in space."""

import numpy as np

from fsi.arrays import Array


def turn_between(angles: Array, others: Array) -> Array:
    """What turns bodies from one set of angles to others: in the plane differences (N,), else (N, 3)."""
    if angles.ndim == 1 or len(angles) == 0:
        return others - angles
    import scipy  # late: `fsi check` does without

    from_rotvec = scipy.spatial.transform.Rotation.from_rotvec
    return np.asarray((from_rotvec(others) * from_rotvec(angles).inv()).as_rotvec())


def turning_rate(turn: Array, omega: Array) -> Array:
    """s' of the turns s (n, 3) made so far, where what they have turned goes on with omega (n, 3).

    Turns in space do not commute: with phi = |s|

        s' = omega - 1/2 s x omega + (1 - phi / 2 cot(phi / 2)) / phi^2 s x (s x omega),

    the inverse of the derivative of the exponential map (Iserles et al., Acta Numerica 9 (2000) 215).
    """
    phi = np.linalg.norm(turn, axis=1)[:, None]
    small = phi < 1e-2  # the next term of the series is 1e-11 there
    safe = np.where(small, 1.0, phi)
    bent = np.where(small, 1.0 / 12.0 + phi**2 / 720.0, (1.0 - 0.5 * safe / np.tan(0.5 * safe)) / safe**2)
    across = np.cross(turn, omega)
    rate: Array = omega - 0.5 * across + bent * np.cross(turn, across)
    return rate


def turned(r: Array, angle: Array) -> Array:
    """What vectors r (n, ..., d) change by if they turn by angles: (R - 1) r.

    The angles are (n,) in the plane, counterclockwise, and rotation vectors (n, ..., 3) in space.
    """
    if r.shape[-1] == 3:
        import scipy  # late: `fsi check` does without

        turn = scipy.spatial.transform.Rotation.from_rotvec(angle.reshape(-1, 3)).as_matrix() - np.eye(3)
        return np.asarray(np.einsum("nij,nj->ni", turn, r.reshape(-1, 3)).reshape(r.shape))
    angle = angle.reshape(-1, *[1] * (r.ndim - 2))
    # cos - 1 without cancellation.
    lost, s = -2.0 * np.sin(0.5 * angle) ** 2, np.sin(angle)
    return np.stack([lost * r[..., 0] - s * r[..., 1], s * r[..., 0] + lost * r[..., 1]], axis=-1)
