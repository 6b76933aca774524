"""A second generator of stripes, which shares nothing with the first nor with the simulated rig.

Electrons are drawn one Poisson number a pixel, from light that is summed over 3 × 3 places of it; read noise and
rounding follow. Speckle is what coherent light does: the mean of 1/C² intensities |a|², each of a circular Gaussian
field a with a Gaussian pupil, so that it is distributed by a gamma law and its correlation is exp(−d²/grain²).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.fft import ifft2

from core.image.stripes.noise import NoiseModel
from core.image.stripes.speckle import Speckle
from tests.image.bound import Stripe, bound_per_root_px

Array = NDArray[np.float64]

FINE = 3
"""Places a pixel each way."""
GREY_PER_ELECTRON = 0.02
READ_GREY = 1.0
NOISE = NoiseModel(float(np.sqrt(READ_GREY**2 + 1 / 12)), GREY_PER_ELECTRON)


def picture(
    shape: tuple[int, int],
    point: tuple[float, float],
    angle_deg: float,
    stripe: Stripe,
    speckle: Speckle | None,
    rng: np.random.Generator,
) -> NDArray[np.float32]:
    """A straight stripe through `point` (u, v) in the direction `angle_deg`, in 8 bits and whole grey levels."""
    rows, columns = shape
    fine = (np.arange(FINE) + 0.5) / FINE - 0.5
    u, v = np.meshgrid(np.arange(columns) - point[0], np.arange(rows) - point[1])
    sine, cosine = np.sin(np.radians(angle_deg)), np.cos(np.radians(angle_deg))
    field = _speckled(shape, speckle, rng) if speckle is not None and speckle.contrast > 0 else None
    light = np.zeros(shape)
    for i, dv in enumerate(fine):
        for k, du in enumerate(fine):
            across = cosine * (v + dv) - sine * (u + du)
            part = np.exp(-0.5 * (across / stripe.width) ** 2)
            light += part if field is None else part * field[i::FINE, k::FINE]
    light = stripe.background + stripe.height * light / FINE**2
    electrons = rng.poisson(np.maximum(light, 0) / GREY_PER_ELECTRON)
    return np.round(electrons * GREY_PER_ELECTRON + rng.normal(0, READ_GREY, shape)).astype(np.float32)


def bound(stripe: Stripe, speckle: Speckle | None) -> float:
    """N0 in px·√px: speckle is summed over the pixel, which lowers its contrast and lengthens its grains."""
    if speckle is None or speckle.contrast == 0:
        return bound_per_root_px(stripe, NOISE)
    square = speckle.grain_px**2
    summed = Speckle(speckle.contrast * float(np.sqrt(square / (square + 1 / 3))), float(np.sqrt(square + 1 / 3)))
    return bound_per_root_px(stripe, NOISE, summed)


def _speckled(shape: tuple[int, int], speckle: Speckle, rng: np.random.Generator) -> Array:
    """A factor of mean 1, (rows, columns) times FINE."""
    rows, columns = FINE * shape[0], FINE * shape[1]
    frequency = np.hypot(np.fft.fftfreq(rows)[:, None], np.fft.fftfreq(columns)[None, :])
    # |γ|² = exp(−d²/grain²), so γ = exp(−d²/2 grain²), whose spectrum exp(−2π² grain² f²) is the pupil's square
    pupil = np.exp(-((np.pi * FINE * speckle.grain_px * frequency) ** 2))
    number = round(1 / speckle.contrast**2)
    total = np.zeros((rows, columns))
    for _ in range(number):
        white = rng.standard_normal((rows, columns, 2), dtype=np.float32).view(np.complex64)[..., 0]
        total += np.abs(ifft2(white * pupil.astype(np.float32))) ** 2  # white noise is white in either domain
    return total / total.mean()
