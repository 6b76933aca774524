"""Steger's line point: Gaussian derivatives, Hessian eigenvector and sub-pixel offset at one place of a picture.

The derivatives are taken at any place, not only at pixel centres: there is a set of kernels for every 1/32 px. A point
is then found by stepping onto the ridge and looking again from there, so the error of the Taylor step (the phase bias
of up to 0.01 px) vanishes with the step itself.

References
----------
Steger, C., An unbiased detector of curvilinear structures, IEEE PAMI 20 (1998), doi:10.1109/34.659930, §3.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.compiled import inlined

KERNEL_REACH = 4.0
"""Half width of the kernels in filter σ; cut earlier, the pixels that enter and leave shift the point by 0.001 px."""
PHASES = 32
"""Sets of kernels to a pixel: their spacing, 1/32 px, is accounted for, see `ridge_at`."""
COLUMNS_AT_ONCE = 32
"""Kernels are as long as a multiple of it, for loops of so many rounds are turned into a few instructions."""


class Detector(NamedTuple):
    """Line detector: `kernel_radius` and `kernel_table` of a filter, and (3 · COLUMNS_AT_ONCE,) numbers to work in."""

    radius: int
    kernels: NDArray[np.float32]
    columns: NDArray[np.float32]


def kernel_radius(filter_px: float) -> int:
    """Compute the half width in px of the derivative kernels of a Gaussian filter of σ `filter_px`."""
    return math.ceil(KERNEL_REACH * filter_px)


def ridge_response(amplitude: float, stripe_px: float, filter_px: float) -> float:
    """Compute the second derivative (sign reversed) at the crest of a Gaussian stripe of σ `stripe_px`, filtered."""
    return float(amplitude * stripe_px / math.hypot(stripe_px, filter_px) ** 3)


@lru_cache(maxsize=32)
def kernel_table(filter_px: float) -> NDArray[np.float32]:
    """Make the filter kernels (PHASES + 1, 3, ≥ 2·radius + 1) of a Gaussian and its first two derivatives.

    They are for points −½ … ½ px beside a pixel's centre.
    Behind the kernels' 2·radius + 1 weights there are zeros.
    """
    radius = kernel_radius(filter_px)
    shift = np.arange(PHASES + 1)[:, None] / PHASES - 0.5
    x = np.arange(-radius, radius + 1) - shift
    weight = np.exp(-0.5 * (x / filter_px) ** 2)
    weight /= weight.sum(axis=1, keepdims=True)
    table = np.zeros((PHASES + 1, 3, -(-x.shape[1] // COLUMNS_AT_ONCE) * COLUMNS_AT_ONCE), dtype=np.float32)
    slope, bend = x / filter_px**2 * weight, (x**2 / filter_px**2 - 1) / filter_px**2 * weight
    for k, kernel in enumerate((weight, slope, bend)):
        if k:  # blind to a constant background in spite of the cut tails
            kernel = kernel - kernel.sum(axis=1, keepdims=True) * weight
        table[:, k, : x.shape[1]] = kernel
    table.flags.writeable = False
    return table


@inlined(fastmath=True)
def ridge_at(
    picture: NDArray[np.float32] | NDArray[np.int16],
    width: int,
    u: float,
    v: float,
    detector: Detector,
) -> tuple[float, float, float, float]:
    """Find the crest of the line at (u, v), radius + 1 px inside the picture: second derivative, normal, distance.

    Parameters
    ----------
    picture, width
        The picture's rows one after another, (≥ H·W,), and the length of a row. Where a row is shorter than
        COLUMNS_AT_ONCE, so many numbers must follow.

    Returns
    -------
    The second derivative across the line (negative on a bright one), the unit normal (n_u, n_v), and the signed
    distance along it from (u, v) to the crest, in pixels.
    """
    column, row = math.floor(u + 0.5), math.floor(v + 0.5)
    phase_u, phase_v = int((u - column + 0.5) * PHASES + 0.5), int((v - row + 0.5) * PHASES + 0.5)
    radius, kernels, columns = detector
    smoothing, sloping, bending = kernels[phase_u, 0], kernels[phase_u, 1], kernels[phase_u, 2]
    ru, rv, ruu, ruv, rvv = np.float32(0), np.float32(0), np.float32(0), np.float32(0), np.float32(0)
    first, block = (row - radius) * width + column - radius, 0
    while True:  # once, but for the widest filters: compilers do not see that of a for
        _filter_columns(picture, first + block, width, 2 * radius + 1, kernels[phase_v], columns)
        for i in range(COLUMNS_AT_ONCE):
            smooth, slope, bend = columns[i], columns[COLUMNS_AT_ONCE + i], columns[2 * COLUMNS_AT_ONCE + i]
            ru += sloping[block + i] * smooth
            ruu += bending[block + i] * smooth
            rv += smoothing[block + i] * slope
            ruv += sloping[block + i] * slope
            rvv += smoothing[block + i] * bend
        block += COLUMNS_AT_ONCE
        if block >= len(smoothing):
            break
    half_difference = 0.5 * (ruu - rvv)
    across = 0.5 * (ruu + rvv) - math.sqrt(half_difference * half_difference + ruv * ruv)
    nu, nv = ruv, across - ruu  # eigenvector of the most negative eigenvalue, from the better conditioned row
    if abs(across - rvv) > abs(across - ruu):
        nu, nv = across - rvv, ruv
    norm = math.sqrt(nu * nu + nv * nv)
    if norm == 0.0 or across == 0.0:
        return 0.0, 1.0, 0.0, 0.0
    nu /= norm
    nv /= norm
    beside = (column + phase_u / PHASES - 0.5 - u) * nu + (row + phase_v / PHASES - 0.5 - v) * nv
    return float(across), float(nu), float(nv), float(beside - (ru * nu + rv * nv) / across)


@inlined(fastmath=True)
def _filter_columns(
    picture: NDArray[np.float32] | NDArray[np.int16],
    first: int,
    width: int,
    rows: int,
    kernel: NDArray[np.float32],
    columns: NDArray[np.float32],
) -> None:
    """Filter columns from the pixel `first` on by a `kernel` (3, ≥ `rows`): smoothed, slope, bend, into `columns`.

    Four rows at once, and columns counted without a sign, which could not count from the array's end: so the compiler
    makes of each row two instructions.
    """
    columns[:] = np.float32(0)
    smoothing, sloping, bending = kernel[0], kernel[1], kernel[2]
    step = np.uintp(width)
    for j in range(0, rows - 3, 4):
        s0, s1, s2, s3 = smoothing[j], smoothing[j + 1], smoothing[j + 2], smoothing[j + 3]
        d0, d1, d2, d3 = sloping[j], sloping[j + 1], sloping[j + 2], sloping[j + 3]
        b0, b1, b2, b3 = bending[j], bending[j + 1], bending[j + 2], bending[j + 3]
        p0 = np.uintp(first + j * width)
        p1, p2, p3 = p0 + step, p0 + step + step, p0 + step + step + step
        for i in range(COLUMNS_AT_ONCE):
            k = np.uintp(i)
            g0, g1 = np.float32(picture[p0 + k]), np.float32(picture[p1 + k])
            g2, g3 = np.float32(picture[p2 + k]), np.float32(picture[p3 + k])
            columns[i] += s0 * g0 + s1 * g1 + s2 * g2 + s3 * g3
            columns[COLUMNS_AT_ONCE + i] += d0 * g0 + d1 * g1 + d2 * g2 + d3 * g3
            columns[2 * COLUMNS_AT_ONCE + i] += b0 * g0 + b1 * g1 + b2 * g2 + b3 * g3
    for j in range(rows - rows % 4, rows):
        s0, d0, b0, p0 = smoothing[j], sloping[j], bending[j], np.uintp(first + j * width)
        for i in range(COLUMNS_AT_ONCE):
            grey = np.float32(picture[p0 + np.uintp(i)])
            columns[i] += s0 * grey
            columns[COLUMNS_AT_ONCE + i] += d0 * grey
            columns[2 * COLUMNS_AT_ONCE + i] += b0 * grey
