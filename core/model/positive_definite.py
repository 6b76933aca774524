"""Inverse of a symmetric matrix that is positive definite: by its Cholesky factor, in half the time of any other."""

from __future__ import annotations

import numpy as np
from scipy.linalg import cho_factor
from scipy.linalg.lapack import dpotri

from core.model.arrays import Array


def inverse_of(matrix: Array) -> Array:
    """Invert a positive definite `matrix` (N, N).

    Raises
    ------
    numpy.linalg.LinAlgError
        If it is not positive definite.
    """
    return inverse_by(cho_factor(matrix, lower=True, check_finite=False)[0])


def inverse_by(lower: Array) -> Array:
    """Invert a matrix (N, N) by its `lower` (N, N) Cholesky factor; values above the diagonal are ignored."""
    inverse = np.tril(dpotri(lower, lower=1)[0])
    return np.asarray(inverse + np.tril(inverse, -1).T)
