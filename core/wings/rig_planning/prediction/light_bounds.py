"""The Cramér–Rao bounds of what is read from pictures: the place of a stripe, of an edge, of a target's point.

No unbiased estimator is better, whatever it does. For a straight stripe or edge the bound is a density N0 in px·√px:
the mean over L px cannot be better than N0/√L. It is the Fisher information of the mean cross-section with place,
height, offset and slope of the background unknown together, and the noise

    cov = (read² + k·I)·1 + m·mᵀ·(exp(ln(1 + C²)·ρ) − 1),    ρ(d) = exp(−d²/grain²)

of read and shot noise and of log-normal speckle, which multiplies the stripe's own light m, summed along the stripe.

References
----------
Cramér, H., Mathematical Methods of Statistics (1946), 32.3; Goodman, J. W., Speckle Phenomena in Optics (2007), 8.
"""

from __future__ import annotations

import numpy as np
from scipy.special import ndtr

from core.image.stripes.noise import NoiseModel
from core.image.stripes.speckle import Speckle
from core.image.targets import Charuco, Checkerboard, CircleGrid
from core.model.arrays import Array

REACH = 6.0
"""Half the part of a cross-section that is looked at, in its σ."""


def stripe_density(width: float, height: float, background: float, noise: NoiseModel, speckle: Speckle) -> float:
    """Compute N0 in px·√px of a stripe of Gaussian σ `width` in px: its mean place over L px has σ ≥ N0/√L."""
    x = _pixels(width)
    section = height * np.exp(-0.5 * (x / width) ** 2)
    derivatives = np.column_stack([section * x / width**2, section / height, np.ones_like(x), x])
    covariance = np.diag(noise.variance(background + section))
    if speckle.contrast > 0:
        # the spectrum along the stripe at frequency zero: what a long mean feels
        along = np.arange(-np.ceil(REACH * speckle.grain_px), np.ceil(REACH * speckle.grain_px) + 1)
        apart = (x[:, None, None] - x[:, None]) ** 2 + along**2
        grains = np.expm1(np.log1p(speckle.contrast**2) * np.exp(-apart / speckle.grain_px**2)).sum(axis=2)
        covariance += np.outer(section, section) * grains
    return _of_first(derivatives, covariance)


def edge_density(step: float, dark: float, blur_px: float, noise: NoiseModel) -> float:
    """Compute N0 in px·√px of a straight edge of `step` grey levels: its mean place over L px has σ ≥ N0/√L."""
    x = _pixels(blur_px)
    slope = step * np.exp(-0.5 * (x / blur_px) ** 2) / (np.sqrt(2 * np.pi) * blur_px)
    risen = np.asarray(ndtr(x / blur_px), dtype=np.float64)
    derivatives = np.column_stack([slope, risen, np.ones_like(x)])
    return _of_first(derivatives, np.diag(noise.variance(dark + step * risen)))


def crossing_bound(density_a: float, density_b: float, length_px: float, angle: float) -> Array:
    """Compute the least covariance (2, 2) in px² of the crossing of two straight stripes at `angle` in rad.

    Stripe a lies along u, the crossing in the middle of both, so that their directions count for nothing.
    """
    information = np.zeros((2, 2))
    for density, direction in ((density_a, 0.0), (density_b, angle)):
        normal = np.array([-np.sin(direction), np.cos(direction)])
        information += np.outer(normal, normal) * length_px / density**2
    return np.asarray(np.linalg.inv(information))


def point_bound(target: Checkerboard | Charuco | CircleGrid, density: float, px_per_mm: float) -> float:
    """Compute the least σ in px per coordinate of a target's point from the N0 (`density`) of its edges.

    A corner of a board hangs on half a square of edge to each of four sides, a circle's middle on its rim.
    """
    if isinstance(target, CircleGrid):
        return float(density / np.sqrt(np.pi * target.pitch_mm / 4 * px_per_mm))
    return float(density / np.sqrt(target.square_mm * px_per_mm))


def _pixels(width: float) -> Array:
    half = np.ceil(REACH * width)
    return np.arange(-half, half + 1.0)


def _of_first(derivatives: Array, covariance: Array) -> float:
    information = derivatives.T @ np.linalg.solve(covariance, derivatives)
    return float(np.sqrt(np.linalg.inv(information)[0, 0]))
