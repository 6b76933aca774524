"""Blur of an ideal lens and of a pixel's area."""

from __future__ import annotations

from typing import TYPE_CHECKING

import cv2
import numpy as np

if TYPE_CHECKING:  # a window that starts reads scenarios, and loads no compiled loops
    from core.simulate.rays import Map


BLUR_REACH = 4.5
"""Half width of the lens's blur in its σ: 7e-6 of the light is beyond."""


def blurred(light: Map, sigma_px: float) -> Map:
    """Blur `light` (H, W) by a lens of Gaussian σ `sigma_px`, and average it over each pixel's area."""
    from scipy.special import erf  # here: the command line reads scenarios, and `--help` waits for nothing it can spare

    reach = int(np.ceil(BLUR_REACH * sigma_px + 0.5))
    edges = np.arange(-reach, reach + 2) - 0.5
    kernel = np.diff(erf(edges / (sigma_px * np.sqrt(2)))) if sigma_px > 0 else np.ones(1)
    kernel = (kernel / kernel.sum()).astype(np.float32)
    smooth = cv2.sepFilter2D(light, cv2.CV_32F, kernel, kernel, borderType=cv2.BORDER_REPLICATE)
    return np.asarray(smooth, dtype=np.float32)
