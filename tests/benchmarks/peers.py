"""What others do with a full frame: Steger's detector by OpenCV's separable filters, and scikit-image's ridges."""

from __future__ import annotations

import math

import cv2
import numpy as np


def opencv_steger(picture: np.ndarray, filter_px: float, threshold: float) -> np.ndarray:
    """Steger's line points (N, 2) of a picture, every pixel filtered; not linked."""
    radius = math.ceil(4 * filter_px)
    x = np.arange(-radius, radius + 1) / filter_px
    smooth = np.exp(-0.5 * x * x)
    smooth /= smooth.sum()
    slope, bend = x / filter_px * smooth, (x * x - 1) / filter_px**2 * smooth
    kernels = ((slope, smooth), (smooth, slope), (bend, smooth), (slope, slope), (smooth, bend))
    ru, rv, ruu, ruv, rvv = (cv2.sepFilter2D(picture, cv2.CV_32F, along_u, along_v) for along_u, along_v in kernels)
    half = (ruu - rvv) / 2
    across = (ruu + rvv) / 2 - np.sqrt(half * half + ruv * ruv)
    row, column = np.nonzero(across < -threshold)
    most = across[row, column]
    nu, nv = ruv[row, column], most - ruu[row, column]
    norm = np.hypot(nu, nv)
    nu, nv = nu / np.maximum(norm, 1e-30), nv / np.maximum(norm, 1e-30)
    offset = -(ru[row, column] * nu + rv[row, column] * nv) / most
    here = (np.abs(offset * nu) <= 0.5) & (np.abs(offset * nv) <= 0.5)
    return np.column_stack([column + offset * nu, row + offset * nv])[here]


def skimage_hessian(picture: np.ndarray, filter_px: float) -> np.ndarray:
    """scikit-image's eigenvalues of the Hessian at every pixel: the heart of its ridge filters."""
    from skimage.feature import hessian_matrix, hessian_matrix_eigvals

    hessian = hessian_matrix(picture, sigma=filter_px, order="rc", use_gaussian_derivatives=False)
    return hessian_matrix_eigvals(hessian)
