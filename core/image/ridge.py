"""Steger's line point: Gaussian derivatives, Hessian eigenvector and sub-pixel offset at one place of a picture.

The derivatives are taken at any place, not only at pixel centres: the kernels are sampled where they are needed. A
point is then found by stepping onto the ridge and looking again from there, so the error of the Taylor step (the
phase bias of up to 0.01 px) vanishes with the step itself.

References
----------
Steger, C., An unbiased detector of curvilinear structures, IEEE PAMI 20 (1998), doi:10.1109/34.659930, §3.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.model.arrays import Array

KERNEL_REACH = 4.0
"""Half width of the kernels in filter σ; cut earlier, the pixels that enter and leave shift the point by 0.001 px."""


def kernel_radius(filter_px: float) -> int:
    """Half width of the kernels in pixels."""
    return math.ceil(KERNEL_REACH * filter_px)


def ridge_response(amplitude: float, stripe_px: float, filter_px: float) -> float:
    """Second derivative across a Gaussian stripe of σ `stripe_px` after the filter, at its crest (sign reversed)."""
    return float(amplitude * stripe_px / math.hypot(stripe_px, filter_px) ** 3)


@njit(cache=True, nogil=True, fastmath=True)
def _sample_kernels(shift: float, filter_px: float, radius: int, kernels: Array) -> None:
    """Gaussian and its first two derivatives (3, 2·radius+1) around a place `shift` px beside a pixel's centre."""
    size = 2 * radius + 1
    inverse = 1.0 / (filter_px * filter_px)
    total = 0.0
    for i in range(size):
        x = i - radius - shift
        weight = math.exp(-0.5 * x * x * inverse)
        kernels[0, i] = weight
        total += weight
    first, second = 0.0, 0.0
    for i in range(size):
        x = i - radius - shift
        weight = kernels[0, i] / total
        kernels[0, i] = weight
        kernels[1, i] = x * inverse * weight
        kernels[2, i] = (x * x * inverse - 1.0) * inverse * weight
        first += kernels[1, i]
        second += kernels[2, i]
    for i in range(size):  # blind to a constant background in spite of the cut tails
        kernels[1, i] -= first * kernels[0, i]
        kernels[2, i] -= second * kernels[0, i]


@njit(cache=True, nogil=True, fastmath=True)
def ridge_at(
    picture: NDArray[np.float32], u: float, v: float, filter_px: float, radius: int, kernels: Array
) -> tuple[float, float, float, float]:
    """Line point seen from (u, v), which must be `radius` + 1 px inside the picture.

    `kernels` (2, 3, 2·radius+1) is scratch space. Returns the second derivative across the line (negative on a
    bright one), the unit normal (n_u, n_v), and the signed distance along it to the crest, in pixels.
    """
    column, row = math.floor(u + 0.5), math.floor(v + 0.5)
    _sample_kernels(u - column, filter_px, radius, kernels[0])
    _sample_kernels(v - row, filter_px, radius, kernels[1])
    size = 2 * radius + 1
    ru, rv, ruu, ruv, rvv = 0.0, 0.0, 0.0, 0.0, 0.0
    for j in range(size):
        line = picture[row - radius + j, column - radius : column + radius + 1]
        smooth, slope, bend = 0.0, 0.0, 0.0
        for i in range(size):
            grey = line[i]
            smooth += grey * kernels[0, 0, i]
            slope += grey * kernels[0, 1, i]
            bend += grey * kernels[0, 2, i]
        ru += slope * kernels[1, 0, j]
        ruu += bend * kernels[1, 0, j]
        rv += smooth * kernels[1, 1, j]
        ruv += slope * kernels[1, 1, j]
        rvv += smooth * kernels[1, 2, j]
    half_difference = 0.5 * (ruu - rvv)
    across = 0.5 * (ruu + rvv) - math.sqrt(half_difference * half_difference + ruv * ruv)
    nu, nv = ruv, across - ruu  # eigenvector of the most negative eigenvalue, from the better conditioned row
    if abs(across - rvv) > abs(across - ruu):
        nu, nv = across - rvv, ruv
    length = math.sqrt(nu * nu + nv * nv)
    if length == 0.0 or across == 0.0:
        return 0.0, 1.0, 0.0, 0.0
    nu /= length
    nv /= length
    return across, nu, nv, -(ru * nu + rv * nv) / across
