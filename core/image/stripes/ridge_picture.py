"""Steger's ridge strength at every pixel of a picture, for display: it shows why a stripe was found or not.

Measuring looks only where stripes are (`core.image.stripes.tracing.ridge`); this is the same filter over the whole
picture.

References
----------
Steger, C., An unbiased detector of curvilinear structures, IEEE PAMI 20 (1998), doi:10.1109/34.659930.
"""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from core.image.stripes.stripe import StripeSettings
from core.image.stripes.tracing.ridge import kernel_radius, ridge_response
from core.model.arrays import Array


def ridge_strength(picture: NDArray[np.float32], settings: StripeSettings) -> NDArray[np.float32]:
    """Compute for each pixel (H, W) the height in grey levels of the stripe there; 0 where there is no ridge.

    Parameters
    ----------
    picture
        (H, W) float32, a picture or a difference of two.

    Returns
    -------
    (H, W) float32 in grey levels, 0 where there is no bright ridge.
    """
    smooth, first, second = _kernels(settings.filter_px)
    uu = _filtered(picture, second, smooth)
    vv = _filtered(picture, smooth, second)
    uv = _filtered(picture, first, first)
    half = (uu - vv) / 2
    across = (uu + vv) / 2 - np.sqrt(half * half + uv * uv)
    unit = np.float32(ridge_response(1.0, settings.stripe_px, settings.filter_px))
    return np.asarray(np.maximum(-across / unit, 0), dtype=np.float32)


def _filtered(picture: NDArray[np.float32], along_u: Array, along_v: Array) -> NDArray[np.float32]:
    filtered = cv2.sepFilter2D(picture, cv2.CV_32F, along_u, along_v, borderType=cv2.BORDER_REPLICATE)
    return np.asarray(filtered, dtype=np.float32)


def _kernels(filter_px: float) -> tuple[Array, Array, Array]:
    """A Gaussian and its first two derivatives; these are blind to a constant background."""
    radius = kernel_radius(filter_px)
    x = np.arange(-radius, radius + 1) / filter_px
    smooth = np.exp(-0.5 * x * x)
    smooth /= smooth.sum()
    second = (x * x - 1) / filter_px**2 * smooth
    return smooth, x / filter_px * smooth, second - second.sum() * smooth
