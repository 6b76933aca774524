"""How far the pixel noise moves a corner that cornerSubPix found.

cornerSubPix solves Σ w g gᵀ (p − q) = 0 for the corner q, with g the central-difference gradient at pixel p and w a
Gaussian weight. To first order noise n in the pixels moves q by M⁻¹ Σ w [g δg·(p − q) + δg g·(p − q)], M = Σ w g gᵀ,
and δg is a difference of pixels: so every pixel of the window has a known influence on q.
"""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter

from core.image.targets.picture import Picture
from core.model.arrays import Array

SYSTEMATIC_PX = 0.025
SYSTEMATIC_SMOOTHED_PX = 0.015
"""What the pixels' phase leaves on perfect, sharp pictures, RMS per coordinate in windows of 23 pixels: as taken, and
smoothed by 1 px. It grows with the root of a smaller window."""


def corner_sigma(picture: Picture, corners: Array, half: int, noise: float, smoothing: float = 0.0) -> Array:
    """Standard uncertainty (N,) in pixels of each coordinate of `corners` (N, 2).

    Parameters
    ----------
    half
        Half the refinement's window, in pixels.
    noise
        Standard deviation of the pixel noise in grey levels, before any smoothing.
    smoothing
        σ in pixels of the Gaussian that `picture` was smoothed with.
    """
    margin = 2 + round(3 * smoothing)
    span = np.arange(-half - margin, half + margin + 1)
    base = np.rint(corners).astype(int)
    rows = (base[:, 1, None] + span).clip(0, picture.shape[0] - 1)
    columns = (base[:, 0, None] + span).clip(0, picture.shape[1] - 1)
    patch = picture[rows[:, :, None], columns[:, None, :]].astype(np.float64)

    gx, gy = np.zeros_like(patch), np.zeros_like(patch)
    gx[:, :, 1:-1] = (patch[:, :, 2:] - patch[:, :, :-2]) / 2
    gy[:, 1:-1] = (patch[:, 2:] - patch[:, :-2]) / 2
    x = np.broadcast_to((base[:, 0] - corners[:, 0])[:, None, None] + span[None, None, :], patch.shape)
    y = np.broadcast_to((base[:, 1] - corners[:, 1])[:, None, None] + span[None, :, None], patch.shape)
    window = np.where(np.abs(span) <= half, np.exp(-((span / half) ** 2)), 0.0)
    w = window[:, None] * window[None, :]

    normal = np.empty((len(corners), 2, 2))
    normal[:, 0, 0] = (w * gx * gx).sum((1, 2))
    normal[:, 1, 1] = (w * gy * gy).sum((1, 2))
    normal[:, 0, 1] = normal[:, 1, 0] = (w * gx * gy).sum((1, 2))
    normal += np.eye(2) * 1e-9 * (1 + np.trace(normal, axis1=1, axis2=2))[:, None, None]

    slope = gx * x + gy * y
    by_x = np.stack([w * (gx * x + slope), w * gy * x])  # ∂(sums)/∂(gx), for both components
    by_y = np.stack([w * gx * y, w * (gy * y + slope)])
    influence = np.zeros((2, *patch.shape))
    influence[:, :, :, 2:] += by_x[:, :, :, 1:-1] / 2
    influence[:, :, :, :-2] -= by_x[:, :, :, 1:-1] / 2
    influence[:, :, 2:] += by_y[:, :, 1:-1] / 2
    influence[:, :, :-2] -= by_y[:, :, 1:-1] / 2
    if smoothing:
        influence = gaussian_filter(influence, (0, 0, smoothing, smoothing), truncate=3)
    spread = np.einsum("anij,bnij->nab", influence, influence) * noise**2
    inverse = np.linalg.inv(normal)
    covariance = inverse @ spread @ inverse
    systematic = (SYSTEMATIC_SMOOTHED_PX if smoothing else SYSTEMATIC_PX) * np.sqrt(11 / half)
    sigma: Array = np.sqrt(np.trace(covariance, axis1=1, axis2=2) / 2 + systematic**2)
    return sigma
