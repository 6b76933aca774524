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

import numpy as np
from numba import njit
from numpy.typing import NDArray

KERNEL_REACH = 4.0
"""Half width of the kernels in filter σ; cut earlier, the pixels that enter and leave shift the point by 0.001 px."""
PHASES = 32
"""Sets of kernels to a pixel."""
_LANES = 8  # kernels are as long as a multiple of what the processor multiplies at once


def kernel_radius(filter_px: float) -> int:
    """Half width of the kernels in pixels."""
    return math.ceil(KERNEL_REACH * filter_px)


def ridge_response(amplitude: float, stripe_px: float, filter_px: float) -> float:
    """Second derivative across a Gaussian stripe of σ `stripe_px` after the filter, at its crest (sign reversed)."""
    return float(amplitude * stripe_px / math.hypot(stripe_px, filter_px) ** 3)


@lru_cache(maxsize=32)
def kernel_table(filter_px: float) -> NDArray[np.float32]:
    """Gaussian and its first two derivatives (PHASES + 1, 3, ≥ 2·radius + 1) at −½ … ½ px beside a pixel's centre.

    Behind the kernels' 2·radius + 1 weights there are zeros.
    """
    radius = kernel_radius(filter_px)
    shift = np.arange(PHASES + 1)[:, None] / PHASES - 0.5
    x = np.arange(-radius, radius + 1) - shift
    weight = np.exp(-0.5 * (x / filter_px) ** 2)
    weight /= weight.sum(axis=1, keepdims=True)
    table = np.zeros((PHASES + 1, 3, -(-x.shape[1] // _LANES) * _LANES), dtype=np.float32)
    slope, bend = x / filter_px**2 * weight, (x**2 / filter_px**2 - 1) / filter_px**2 * weight
    for k, kernel in enumerate((weight, slope, bend)):
        if k:  # blind to a constant background in spite of the cut tails
            kernel = kernel - kernel.sum(axis=1, keepdims=True) * weight
        table[:, k, : x.shape[1]] = kernel
    table.flags.writeable = False
    return table


@njit(cache=True, nogil=True, fastmath=True)
def ridge_at(
    picture: NDArray[np.float32] | NDArray[np.int16],
    width: int,
    u: float,
    v: float,
    radius: int,
    kernels: NDArray[np.float32],
) -> tuple[float, float, float, float]:
    """Line point seen from (u, v), which must be `radius` + 1 px inside the picture.

    Parameters
    ----------
    picture, width
        The picture's rows one after another, (H·W,), and the length of a row.
    radius, kernels
        `kernel_radius` and `kernel_table` of the filter.

    Returns
    -------
    The second derivative across the line (negative on a bright one), the unit normal (n_u, n_v), and the signed
    distance along it from (u, v) to the crest, in pixels.
    """
    column, row = math.floor(u + 0.5), math.floor(v + 0.5)
    phase_u, phase_v = int((u - column + 0.5) * PHASES + 0.5), int((v - row + 0.5) * PHASES + 0.5)
    of_u, of_v = kernels[phase_u], kernels[phase_v]
    smoothing, sloping, bending = of_u[0], of_u[1], of_u[2]
    length = len(smoothing)
    ru, rv, ruu, ruv, rvv = 0.0, 0.0, 0.0, 0.0, 0.0
    first = (row - radius) * width + column - radius
    for j in range(2 * radius + 1):
        line = picture[first + j * width : first + j * width + length]
        smooth, slope, bend = np.float32(0), np.float32(0), np.float32(0)
        for i in range(length):
            grey = np.float32(line[i])
            smooth += grey * smoothing[i]
            slope += grey * sloping[i]
            bend += grey * bending[i]
        ru += slope * of_v[0, j]
        ruu += bend * of_v[0, j]
        rv += smooth * of_v[1, j]
        ruv += slope * of_v[1, j]
        rvv += smooth * of_v[2, j]
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
    return across, nu, nv, beside - (ru * nu + rv * nv) / across
