"""The Cramér–Rao bound of a stripe's place, from the pixels of its cross-section: no estimator is better.

Numerical Fisher information of the mean picture, a Gaussian section integrated over the pixels on a sloping background,
with the noise

    cov = (read² + k·I)·1 + m·mᵀ·(exp(ln(1 + C²)·ρ) − 1),    ρ(d) = exp(−d²/grain²)

of read and shot noise and of log-normal speckle of contrast C, which multiplies the stripe's own light m.
Known nuisances are none: place, height, offset and slope of the background are unknown together.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import erf

from core.image.stripes.noise import NoiseModel
from core.image.stripes.speckle import Speckle

Array = np.ndarray


@dataclass(frozen=True)
class Stripe:
    """An upright stripe: σ in px, height, background and its slope in grey levels (per px), seen over ± `reach` σ."""

    width: float
    height: float
    background: float = 0.0
    slope: float = 0.0
    reach: float = 6.0

    @property
    def x(self) -> Array:
        """Pixels across, from the middle."""
        half = int(np.ceil(self.reach * self.width))
        return np.arange(-half, half + 1.0)

    @property
    def section(self) -> Array:
        """Light of the stripe in each pixel."""
        edges = np.append(self.x - 0.5, self.x[-1] + 0.5) / (self.width * np.sqrt(2))
        return self.height * self.width * np.sqrt(np.pi / 2) * np.diff(erf(edges))

    @property
    def derivatives(self) -> Array:
        """With place, height, offset, slope of the background (W, 4)."""
        left, right = (np.exp(-0.5 * ((self.x + side) / self.width) ** 2) for side in (-0.5, 0.5))
        return np.column_stack([self.height * (left - right), self.section / self.height, np.ones_like(self.x), self.x])

    def white(self, noise: NoiseModel) -> Array:
        """Variance of each pixel without speckle."""
        return noise.variance(self.background + self.slope * self.x + self.section)


def grains(speckle: Speckle, across: Array, along: Array) -> Array:
    """Covariance of the factor that log-normal speckle is, at these distances in px."""
    correlation = np.exp(-(across**2 + along**2) / speckle.grain_px**2)
    return np.expm1(np.log1p(speckle.contrast**2) * correlation)


def bound_per_root_px(stripe: Stripe, noise: NoiseModel, speckle: Speckle | None = None) -> float:
    """N0 in px·√px: the mean over L px of a stripe much longer than a grain cannot be better than N0/√L."""
    covariance = np.diag(stripe.white(noise))
    if speckle is not None and speckle.contrast > 0:
        along = np.arange(-np.ceil(6 * speckle.grain_px), np.ceil(6 * speckle.grain_px) + 1)
        apart = stripe.x[:, None, None] - stripe.x[:, None]
        covariance += grains(speckle, apart, along).sum(axis=2) * np.outer(stripe.section, stripe.section)
    return _of_place(stripe.derivatives.T @ np.linalg.solve(covariance, stripe.derivatives))


def bound_of_mean(stripe: Stripe, noise: NoiseModel, speckle: Speckle | None, length: int) -> float:
    """The bound in px of the place of `length` px of stripe, all pixels with all."""
    derivatives = np.tile(stripe.derivatives, (length, 1))
    covariance = np.diag(np.tile(stripe.white(noise), length))
    if speckle is not None and speckle.contrast > 0:
        across = np.tile(stripe.x, length)
        along = np.repeat(np.arange(float(length)), len(stripe.x))
        light = np.tile(stripe.section, length)
        covariance += grains(speckle, across[:, None] - across, along[:, None] - along) * np.outer(light, light)
    return _of_place(derivatives.T @ np.linalg.solve(covariance, derivatives))


def _of_place(information: Array) -> float:
    return float(np.sqrt(np.linalg.inv(information)[0, 0]))
