"""What compiled loops ask of small arrays: new ones, the median, a sort, a search, the solution of a few equations.

Of numpy's own functions numba compiles a copy for every loop that calls one; these are compiled once and then only
become part of the loop.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.compiled import inlined
from core.model.arrays import Array

Index = NDArray[np.int64]


@inlined()
def new_row(count: int) -> Array:
    """Allocate an array (count,) of float64 whose values are not set."""
    return np.empty(count)


@inlined()
def new_table(rows: int, columns: int) -> Array:
    """Allocate an array (rows, columns) of float64 whose values are not set."""
    return np.empty((rows, columns))


@inlined()
def zero_table(rows: int, columns: int) -> Array:
    """Make an array (rows, columns) of float64 zeros."""
    return np.zeros((rows, columns))


@inlined()
def new_single_table(rows: int, columns: int) -> NDArray[np.float32]:
    """Allocate an array (rows, columns) of float32 whose values are not set."""
    return np.empty((rows, columns), np.float32)


@inlined()
def row_of(count: int, value: float) -> Array:
    """Make an array (count,) of float64 filled with `value`."""
    row = np.empty(count)
    for k in range(count):
        row[k] = value
    return row


@inlined()
def new_indices(count: int) -> Index:
    """Allocate an array (count,) of int64 whose values are not set."""
    return np.empty(count, np.int64)


@inlined()
def new_index_table(rows: int, columns: int) -> Index:
    """Allocate an array (rows, columns) of int64 whose values are not set."""
    return np.empty((rows, columns), np.int64)


@inlined()
def indices_of(count: int, value: int) -> Index:
    """Make an array (count,) of int64 filled with `value`."""
    row = np.empty(count, np.int64)
    for k in range(count):
        row[k] = value
    return row


@inlined()
def new_flags(count: int) -> NDArray[np.bool_]:
    """Make a boolean array (count,) of False."""
    return np.zeros(count, np.bool_)


@inlined()
def doubled_index_table(table: Index) -> Index:
    """Copy `table` (N, C) into the first half of a new array (2N, C); its second half is not set."""
    rows, columns = table.shape
    larger = np.empty((2 * rows, columns), np.int64)
    for i in range(rows):
        for k in range(columns):
            larger[i, k] = table[i, k]
    return larger


@inlined()
def doubled_indices(row: Index) -> Index:
    """Copy `row` (N,) into the first half of a new array (2N,); its second half is not set."""
    larger = np.empty(2 * len(row), np.int64)
    for k in range(len(row)):
        larger[k] = row[k]
    return larger


@inlined()
def first_rows(table: Array, count: int) -> Array:
    """Copy the first `count` rows of a `table` (N, C)."""
    copy = np.empty((count, table.shape[1]))
    for i in range(count):
        for k in range(table.shape[1]):
            copy[i, k] = table[i, k]
    return copy


@inlined()
def column(table: Array, k: int) -> Array:
    """Copy column `k` of a `table` (N, C)."""
    copy = np.empty(len(table))
    for i in range(len(table)):
        copy[i] = table[i, k]
    return copy


@inlined()
def mean_of(table: Array, k: int) -> float:
    """Compute the mean of column `k` of a `table` (N, C)."""
    total = 0.0
    for i in range(len(table)):
        total += table[i, k]
    return total / len(table)


@inlined()
def backwards(row: Array) -> Array:
    """Copy `row` (N,) in reverse order."""
    copy = np.empty(len(row))
    for k in range(len(row)):
        copy[k] = row[len(row) - 1 - k]
    return copy


@inlined()
def smallest(values: Array, k: int) -> float:
    """Find the element with index `k` in ascending order of `values` (N,), which are reordered (Hoare).

    Hoare, C. A. R., Algorithm 65: Find, Communications of the ACM 4 (1961), doi:10.1145/366622.366647.
    """
    low, high = 0, len(values) - 1
    while low < high:
        pivot, i, j = values[k], low, high
        while i <= j:
            while values[i] < pivot:
                i += 1
            while pivot < values[j]:
                j -= 1
            if i <= j:
                values[i], values[j] = values[j], values[i]
                i += 1
                j -= 1
        if j < k:
            low = i
        if k < i:
            high = j
    return float(values[k])


@inlined()
def median_of(values: Array, first: int, behind: int) -> float:
    """Compute the median of `values[first:behind]`, at least one value."""
    count = behind - first
    copy = np.empty(count)
    for k in range(count):
        copy[k] = values[first + k]
    upper = smallest(copy, count // 2)
    if count % 2 == 1:
        return upper
    lower = copy[0]
    for k in range(1, count // 2):
        lower = max(lower, copy[k])
    return float(0.5 * (lower + upper))


@inlined()
def sort(values: Array) -> None:
    """Sort a few `values` (N,) in place, by insertion."""
    for k in range(1, len(values)):
        value, at = values[k], k
        while at > 0 and values[at - 1] > value:
            values[at] = values[at - 1]
            at -= 1
        values[at] = value


@inlined()
def first_not_below(values: Array, limit: float) -> int:
    """Count the values below `limit` in ascending `values` (N,): the index of the first that is not below it."""
    low, high = 0, len(values)
    while low < high:
        middle = (low + high) // 2
        if values[middle] < limit:
            low = middle + 1
        else:
            high = middle
    return low


@inlined()
def first_above(values: Array, limit: float) -> int:
    """Count the values at or below `limit` in ascending `values` (N,): the index of the first above it."""
    low, high = 0, len(values)
    while low < high:
        middle = (low + high) // 2
        if values[middle] <= limit:
            low = middle + 1
        else:
            high = middle
    return low


@inlined()
def invert(matrix: Array, inverse: Array, size: int) -> None:
    """Invert the first `size` rows and columns of a positive definite `matrix` (N, N) into `inverse`.

    The `matrix` is overwritten.

    Gauss and Jordan's elimination, which needs no search for pivots where a matrix is positive definite.
    """
    for i in range(size):
        for k in range(size):
            inverse[i, k] = 1.0 if i == k else 0.0
    for pivot in range(size):
        scale = 1 / matrix[pivot, pivot]
        for k in range(size):
            matrix[pivot, k] *= scale
            inverse[pivot, k] *= scale
        for i in range(size):
            factor = matrix[i, pivot]
            if i != pivot and factor != 0.0:
                for k in range(size):
                    matrix[i, k] -= factor * matrix[pivot, k]
                    inverse[i, k] -= factor * inverse[pivot, k]
