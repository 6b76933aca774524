"""Pictures exposed otherwise than the reference, as a camera with automatic exposure takes them: found and taken off.

The fan stands still, so its light tells how a frame was exposed, which the room's light, that may change by itself,
does not. With d the frame less the reference and less the change of the room's light as far as that was taken off, F
the fan's light in the reference and B the background under it, at the pixels where F is strong and not saturated::

    gain − 1 = m((d − c·B) / F),    c = m(d) / median(B) over the whole picture

with m the mean of the middle half, which whole grey levels do not round as they do a median; the sweep crosses few of
those pixels. The background under the fan is the lowest beside it, which makes F too large, and gain − 1 too small by
up to a fifth where the fan is faint; their product stays. What a gain other than 1 leaves of the fan in d, which is
(gain − 1)·F, is taken off: else it would be looked at as a stripe of the sweep.

A fan that lies aside, as that of a rig that warms, is darker where it was brightest, too: by (shift / σ)² / 2 of its
light. But the light of its whole width stays. So a gain counts only where the sums over tiles of the picture have
changed, too; the background's change is taken off there as well.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.scan.features.room_light import LEAST_CHANGE, Difference, Picture

STRONG = 0.5
"""Share of nearly its largest light from which on the fan's light tells the gain."""
UNSATURATED = 0.8
"""Share of the full scale below which it does, so that a brighter frame has it unsaturated as well."""
FEWEST, MOST = 200, 4000
"""Pixels of the fan that tell a gain, and that are looked at."""
SPARSE = 32
"""Rows and columns from one pixel to the next where the background is looked at."""
TILE_PX = 16
"""Size of the tiles over which the fan's light is summed up: wider than its lines."""
AS_WELL = 0.5
"""Of a gain − 1 by the brightest pixels that the sums show at least. Of a fan 0.3 px aside, of σ 1 px, they show a
third of it, by what leaves the tiles; of other exposures about all of it."""
LARGEST_GAIN = 2.0
"""Frames whose light differs by more, either way, are not exposed otherwise: their fan is off, or lost."""


@dataclass(frozen=True, eq=False, slots=True)
class FanLight:
    """Light of the fan in the reference picture, for removing what is left of it in frames of another brightness.

    Parameters
    ----------
    pixels, light
        (K,) flat indices of the pixels that it lights, unsaturated, and its grey levels there.
    strong
        (S,) which of those tell the gain; none where too few do.
    under
        (K,) level of the background at all of them over its median in the picture.
    least
        Smallest gain − 1 that matters: it leaves of the strong light what matters to no stripe.
    tile, sums
        (K,) the tile of each of those pixels, and (T,) the light of the brighter half of the tiles; 0 of the others.
    """

    pixels: NDArray[np.intp]
    light: NDArray[np.float32]
    strong: NDArray[np.intp]
    under: NDArray[np.float32]
    least: float
    tile: NDArray[np.intp]
    sums: NDArray[np.float64]

    @classmethod
    def of(cls, base: Picture, bare: NDArray[np.float32], full_scale: float) -> FanLight:
        """Separate the fan's light in the reference `base` (H, W) from `bare` (H, W), its background without it."""
        light = base - bare
        pixels = np.flatnonzero((light > 0) & (base < full_scale))
        light, level = light.ravel()[pixels], base.ravel()[pixels]
        crest = STRONG * float(np.quantile(light, 0.9)) if len(light) else 0.0
        strong = np.flatnonzero((light > crest) & (level < UNSATURATED * full_scale))
        if len(strong) < FEWEST:
            return cls(pixels, light, strong[:0], light[:0], np.inf, strong[:0], np.zeros(0))
        across = -(-base.shape[1] // TILE_PX)
        tile = pixels // base.shape[1] // TILE_PX * across + pixels % base.shape[1] // TILE_PX
        sums = np.bincount(tile, light).astype(np.float64)
        sums[sums < np.median(sums[sums > 0])] = 0.0
        least = LEAST_CHANGE * full_scale / float(np.median(light[strong]))
        strong = strong[:: -(-len(strong) // MOST)]
        under = bare.ravel()[pixels] / np.float32(max(float(np.median(bare[::SPARSE, ::SPARSE])), 1.0))
        return cls(pixels, light, strong, under, least, tile, sums)

    def gain(self, difference: Difference) -> float:
        """Estimate the ratio of the fan's light in a frame to that in the reference, from frame − reference (H, W).

        1 if they are about equal, or it cannot be told.
        """
        if not len(self.strong):
            return 1.0
        of_room = _middle_mean(difference[::SPARSE, ::SPARSE].ravel())
        of_fan = difference.ravel()[self.pixels] - np.float32(of_room) * self.under
        change = _middle_mean(of_fan[self.strong] / self.light[self.strong])
        gain = 1 + change
        if abs(change) < self.least or not 1 / LARGEST_GAIN < gain < LARGEST_GAIN:
            return 1.0
        bright = self.sums > 0
        summed = np.bincount(self.tile, of_fan, len(self.sums))
        return gain if _middle_mean(summed[bright] / self.sums[bright]) / change >= AS_WELL else 1.0

    def take_off(self, difference: Difference, gain: float) -> None:
        """Subtract in place the fan's light times (`gain` − 1) from `difference` (H, W), a frame − the reference."""
        left = np.float32(gain - 1) * self.light
        if np.issubdtype(difference.dtype, np.integer):
            left = np.rint(left)
        flat = difference.reshape(-1)
        flat[self.pixels] -= left.astype(difference.dtype)


def _middle_mean(values: NDArray[np.generic]) -> float:
    """Mean of the middle half of some values (N,), N ≥ 2."""
    quarter = len(values) // 4
    return float(np.sort(values)[quarter : len(values) - quarter].mean(dtype=np.float64))
