"""Pictures of stripes whose truth is known: Gaussian sections integrated over the pixels, noise, speckle."""

from __future__ import annotations

from collections.abc import Callable

import cv2
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Distance = Callable[[Array, Array], Array]
"""Signed distance in px of the places (u, v) from the stripe's middle."""


def straight(point: tuple[float, float], angle: float) -> Distance:
    """A line through `point` in direction `angle` (rad); its left-hand normal (−sin, cos) counts positive."""
    return lambda u, v: -np.sin(angle) * (u - point[0]) + np.cos(angle) * (v - point[1])


def circle(centre: tuple[float, float], radius: float) -> Distance:
    """A circle; outside counts positive."""
    return lambda u, v: np.hypot(u - centre[0], v - centre[1]) - radius


def draw(
    shape: tuple[int, int], distance: Distance, sigma: float | Distance, height: float | Distance, samples: int = 4
) -> Array:
    """A stripe of Gaussian section, `samples`² points a pixel."""
    v, u = np.mgrid[: shape[0], : shape[1]].astype(np.float64)
    offsets = (np.arange(samples) + 0.5) / samples - 0.5
    picture = np.zeros(shape)
    for du in offsets:
        for dv in offsets:
            x, y = u + du, v + dv
            s = sigma(x, y) if callable(sigma) else sigma
            a = height(x, y) if callable(height) else height
            picture += a * np.exp(-0.5 * (distance(x, y) / s) ** 2)
    return picture / samples**2


def expose(light: Array, rng: np.random.Generator, read: float = 1.0, grey_per_electron: float = 0.02) -> Array:
    """`light` with read and shot noise."""
    return light + rng.standard_normal(light.shape) * np.sqrt(read**2 + grey_per_electron * np.maximum(light, 0))


def speckle(shape: tuple[int, int], contrast: float, grain: float, rng: np.random.Generator) -> Array:
    """A log-normal factor of mean 1 and the given contrast, Gaussian-correlated over `grain` px."""
    pad = int(4 * grain) + 4
    field = rng.standard_normal((shape[0] + 2 * pad, shape[1] + 2 * pad))
    smooth = cv2.GaussianBlur(field, (0, 0), grain / np.sqrt(2))[pad:-pad, pad:-pad]
    sigma = np.sqrt(np.log1p(contrast**2))
    return np.exp(sigma * smooth / smooth.std() - sigma**2 / 2)
