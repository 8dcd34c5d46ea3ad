"""Covariances of numbers of any sizes, and their roots: A of a covariance A A^T."""

import numpy as np

from fsi.arrays import Array

# Of a correlation: what rounding may do to it.
_ROUNDED = 1e-9


def is_covariance(square: Array) -> bool:
    """Whether a square matrix is symmetric and positive semidefinite, but for rounding."""
    correlation, deviations = _correlation(square)
    most = np.outer(deviations, deviations)
    correlated = np.all(np.abs(square) <= (1.0 + _ROUNDED) * most)
    if not correlated or np.any(np.abs(square - square.T) > _ROUNDED * most):
        return False
    return bool(np.linalg.eigvalsh(correlation)[0] >= -_ROUNDED)


def root_of(square: Array) -> Array:
    """A of a covariance A A^T, the square; eigenvalues that rounding took below 0 are 0."""
    correlation, deviations = _correlation(square)
    values, vectors = np.linalg.eigh(correlation)
    root: Array = deviations[:, None] * vectors * np.sqrt(np.maximum(values, 0.0))
    return root


def _correlation(square: Array) -> tuple[Array, Array]:
    """A covariance, whose variances span many decades, over the deviations, and these."""
    deviations = np.sqrt(np.maximum(np.diag(square), 0.0))
    most = np.outer(deviations, deviations)
    return square / np.where(most > 0.0, most, 1.0), deviations
