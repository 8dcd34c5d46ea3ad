"""What contact rows answer to rates, for `augmented_lagrangian`: gaps, bounded and viscous slip."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from fsi.bodies.configuration import Array


@dataclass(frozen=True, slots=True)
class ContactResponse:
    """Rows without viscosity: p >= 0 keeps `r + compliance p >= 0`, or a bound on p takes slip away.

    Attributes:
        least: smallest impulse of the normal rows, 0 or -inf where the gap is held, shape (C,).
        limits: largest friction of each contact, (K,).
        first: where the rows of friction begin.
        compliance: of all rows, (rows,).
    """

    least: Array
    limits: Array
    first: int
    compliance: Array

    @classmethod
    def of_gaps(cls, rows: int) -> ContactResponse:
        """Gaps that may open, nothing else."""
        return cls(np.zeros(rows), np.zeros(0), rows, np.zeros(rows))

    @property
    def only_gaps(self) -> bool:
        """True if every row is a gap that may open: no friction, no film, none held closed."""
        return len(self.compliance) == len(self.least) and bool(np.all(self.least == 0.0))

    def onto(self, p: Array) -> Array:
        """The projection onto the impulses that are allowed."""
        allowed = p.copy()
        C = len(self.least)
        np.maximum(p[:C], self.least, out=allowed[:C])
        if len(self.limits):
            slip = p[self.first :].reshape(len(self.limits), -1)
            size = np.linalg.norm(slip, axis=1)
            shrink = np.minimum(1.0, self.limits / np.where(size > 0.0, size, 1.0))
            allowed[self.first :] = (slip * shrink[:, None]).ravel()
        return allowed

    def impulse(self, r: Array, p_old: Array, sigma: Array) -> tuple[Array, sp.spmatrix]:
        """`P_K(p_old' - s r)` with `s = 1/(compliance + 1/sigma)`, and its derivative."""
        s = 1.0 / (self.compliance + 1.0 / sigma)
        free = s * (p_old / sigma - r)
        p = self.onto(free)
        C, slope = len(self.least), s.copy()
        slope[:C] = np.where(free[:C] > self.least, s[:C], 0.0)
        D = sp.diags(slope).tocsr()
        if len(self.limits):
            D = sp.block_diag([sp.diags(slope[: self.first]), self._bounded(free, s)], format="csr")
        return p, D

    def _bounded(self, free: Array, s: Array) -> sp.spmatrix:
        """s times the derivative of the projection: I inside, `limit/|q| (I - q q/|q|^2)` outside."""
        slip = free[self.first :].reshape(len(self.limits), -1)
        across = slip.shape[1]
        size = np.linalg.norm(slip, axis=1)
        out = size > self.limits
        direction = slip / np.where(size > 0.0, size, 1.0)[:, None]
        blocks = np.tile(np.eye(across), (len(slip), 1, 1))
        tangent = blocks - direction[:, :, None] * direction[:, None, :]
        shrink = self.limits / np.where(size > 0.0, size, 1.0)
        blocks[out] = (shrink[:, None, None] * tangent)[out]
        blocks *= s[self.first :].reshape(-1, across)[:, :1, None]
        count = np.arange(len(slip) + 1)
        return sp.bsr_matrix((blocks, count[:-1], count), shape=(across * len(slip),) * 2)

    def residual(self, r: Array, p: Array, weight: Array) -> float:
        """The natural residual `|p - P_K(p - (r + compliance p)/w)| w`, w: weight + compliance."""
        w = weight + self.compliance
        return float((np.abs(p - self.onto(p - (r + self.compliance * p) / w)) * w).max(initial=0.0))
