"""Model of the light along one cut of a stripe, and when a pixel shows other light.

See `core.image.stripes.likelihood.refinement`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.compiled import inlined
from core.model.arrays import Array

# Held by tests/image/stripes/likelihood/test_refinement.py (other light) on stripes beside other light.
TAIL = 2.5
"""Stripe σ from the middle where the tails begin: 4 % of the height is left there."""
_OTHER_LIGHT = 0.15  # of the height: a residual in the tails beyond this
_SIGNIFICANT = 6.0  # and beyond so many standard deviations of the noise is other light
GAUSSIAN = np.zeros((2, 0), np.float32)
"""No measured section."""


class Light(NamedTuple):
    """The light of a stripe along a run of N points, and the weights of its pixels.

    Parameters
    ----------
    sections
        (N, 4) the columns of `core.image.stripes.profile.Sections`.
    kind
        (N,) which of the weights suits each point.
    weights
        (K, DEGREE + 1) ψ as `core.image.stripes.likelihood.influence` gives it for a Gaussian section, or (K, PLACES)
        of a measured one.
    noise
        The variance of a dark pixel, and what each grey level adds to it.
    measured
        (2, PLACES) the measured section and its push: `core.image.stripes.likelihood.measured_section`; (2, 0) for a
        Gaussian.
    """

    sections: Array
    kind: NDArray[np.int64]
    weights: Array
    noise: tuple[float, float]
    measured: NDArray[np.float32] = GAUSSIAN


class CutModel(NamedTuple):
    """Model along one cut: grey values of the section, and the curve it lies on.

    `across` is the normal's component along the cut, `bend` the curve's; `fade` and `widening` are the shares by which
    height and width change from one pixel's foot on the curve to the next. Of a pixel in the tails a squared residual
    of more than `other` + `per_light` · (light / height) is other light than this stripe's.
    """

    across: float
    bend: float
    fade: float
    widening: float
    height: float
    width: float
    background: float
    slope: float
    other: float
    per_light: float


@inlined(fastmath=True)
def cut_model(run: Array, light: Light, near: int, upright: bool) -> CutModel:
    """Model the light on the pixel row or (if `upright`) column that cuts a `run` (N, 5) at point `near`."""
    model, noise = light.sections, light.noise
    height, width, background = model[near, 0], model[near, 1], model[near, 2]
    across, slip = (run[near, 2], -run[near, 3]) if upright else (run[near, 3], run[near, 2])
    reach = math.ceil(3 * width)
    before, behind = max(near - reach, 0), min(near + reach, len(model) - 1)
    slip /= max(behind - before, 1)
    least = max(height, 1e-6)
    variance = noise[0] + noise[1] * max(background, 0.0)
    return CutModel(
        across,
        run[near, 4],
        slip * (model[behind, 0] - model[before, 0]) / least,
        slip * (model[behind, 1] - model[before, 1]) / width,
        height,
        width,
        background,
        model[near, 3],
        (_OTHER_LIGHT * height) ** 2 + _SIGNIFICANT**2 * variance,
        _SIGNIFICANT**2 * noise[1] * height,
    )
