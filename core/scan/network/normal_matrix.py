"""Normal matrix of sparse equations: the lower triangle of Aᵀ W A, added row by row."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array

from core.compiled import compiled
from core.model.arrays import Array
from core.scan.features.crossings import Index


def normal_matrix(design: csr_array, weight: Array) -> Array:
    """Compute the lower triangle (N, N) of the normal matrix Aᵀ W A, stored by columns.

    `design` A (M, N) has sorted rows, `weight` W is (M,).
    """
    matrix = np.zeros((design.shape[1], design.shape[1]), order="F")
    _add_rows(design.indptr.astype(np.int64), design.indices.astype(np.int64), design.data, weight, matrix)
    return matrix


@compiled()
def _add_rows(starts: Index, columns: Index, values: Array, weight: Array, matrix: Array) -> None:
    for row in range(len(weight)):
        if weight[row] == 0:
            continue
        for p in range(starts[row], starts[row + 1]):
            scaled = weight[row] * values[p]
            for q in range(starts[row], p + 1):
                matrix[columns[p], columns[q]] += scaled * values[q]
