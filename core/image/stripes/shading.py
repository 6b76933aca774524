"""Uncertainty of a centreline from uneven brightness.

Where a surface turns away from the laser, light falls off across the stripe too: a Gaussian section of width s times
a slope g = ∂ln I/∂n has its crest moved by s² g, and no estimator can see it, for the section stays a Gaussian. Across
the stripe g is not known, but along it the brightness can be read off, and on a bent surface the two are alike. So
s² |∂ln I/∂s| is what the crest may be off by, and it counts as uncertainty. On an evenly lit face it vanishes.

It is a bound on the safe side: what counts is the width of the light on the surface, and the lens, which blurs what
is shaded already, is in s as well. What a bend does is known better, and taken off, once a first solution has shown the
surface: `core.scan.surface.sections`.
"""

from __future__ import annotations

import numpy as np
from scipy.ndimage import uniform_filter1d

from core.image.stripes.centreline import Centreline
from core.model.arrays import Array
from core.model.robust import median

WINDOW_PX = 41
"""Length in px over which the brightness is averaged, so that an evenly lit stripe with speckle is not suspected:
tests/image/stripes/test_shading.py holds it."""

_DARKEST = 1e-3  # grey levels: the logarithm needs a positive height
_LEAST_POINTS = 5  # of a centreline; fewer have no slope


def shading_sigma(centreline: Centreline) -> Array:
    """Compute the standard uncertainty (N,) in px across the stripe by brightness that changes along it."""
    count = len(centreline)
    if count < _LEAST_POINTS:
        return np.zeros(count)
    window = min(WINDOW_PX, count)
    brightness = np.log(np.maximum(centreline.strength, _DARKEST))
    even = uniform_filter1d(brightness, window, mode="nearest")
    slope = uniform_filter1d(np.gradient(even), window, mode="nearest")
    return np.asarray(median(centreline.width) ** 2 * np.abs(slope))
