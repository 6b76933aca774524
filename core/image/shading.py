"""How far uneven brightness may have moved a centreline.

Where a surface turns away from the laser, light falls off across the stripe too: a Gaussian section of width s times
a slope g = ∂ln I/∂n has its crest moved by s² g, and no estimator can see it, for the section stays a Gaussian. Across
the stripe g is not known, but along it the brightness can be read off, and on a bent surface the two are alike. So
s² |∂ln I/∂s| is what the crest may be off by, and it counts as uncertainty. On an evenly lit face it vanishes.

It is a bound on the safe side: what counts is the width of the light on the surface, and the lens, which blurs what
is shaded already, is in s as well. Nothing is corrected. What would be is known: with s the light's own width, b the
lens, S² = s² + b², κ the second over the first derivative of the distance from the light plane across the stripe, and c
the stripe's curvature in the picture, the centre lies off the plane by

    s² (g − 3κ/2) − κ s⁴/S² + b² c/2

(the second term with weights that trust the flanks, as speckle asks for). On a rendered sphere of 50 mm at half
resolution (s = 1, b = 1.03 px) that foretells the offset, 0.012 px rms and 0.03 px at the rim, to 0.0025 px rms where
bend and emitter are given. Radially it is 0.010 mm on the flanks against nothing on the top, the same for all stripes,
and the radius follows with 0.03 to 0.05 mm, the more the less of the sphere is seen; `core.inspect.sphere` counts it.
A fit of the bends to the measured surface does not reach the flanks, where most of it is, well enough to take it off.
"""

from __future__ import annotations

import numpy as np
from scipy.ndimage import uniform_filter1d

from core.image.centreline import Centreline
from core.model.arrays import Array

WINDOW_PX = 41
"""Length over which speckle is averaged out of the brightness."""


def shading_sigma(centreline: Centreline) -> Array:
    """Standard uncertainty (N,) in px, across the stripe, from the brightness that changes along it."""
    count = len(centreline)
    if count < 5:
        return np.zeros(count)
    window = min(WINDOW_PX, count)
    brightness = np.log(np.maximum(centreline.strength, 1e-3))
    even = uniform_filter1d(brightness, window, mode="nearest")
    slope = uniform_filter1d(np.gradient(even), window, mode="nearest")
    return np.asarray(np.median(centreline.width) ** 2 * np.abs(slope))
