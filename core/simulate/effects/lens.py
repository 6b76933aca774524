"""A lens with more distortion, coma, and a depth of field that ends."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import cv2
import numpy as np

from core.model import Camera
from core.model.arrays import Array
from core.simulate.blur import blurred
from core.simulate.effects.ranges import require_ranges

if TYPE_CHECKING:  # a window that starts reads scenarios, and loads no compiled loops
    from core.simulate.rays import Map

LEVELS = 6
"""Blurs between which that of each pixel is interpolated, by the square of their σ."""
TAIL = 5
"""Places along a comet's tail that stand for it."""


@dataclass(frozen=True, slots=True)
class LensEffects:
    """Effects of a lens beyond an even blur and the distortion k1, k2, p1, p2.

    Parameters
    ----------
    k3
        Third radial coefficient. Lenses of 8 to 16 mm have up to some tenths (OpenCV's examples −0.3 to 0.3).
    coma_px
        Length of the comet's tail in the corners of the picture, in full-resolution pixels; it grows from the centre
        in proportion. Lenses wide open show 2 to 8 µm: 1 to 3 px.
    aperture_mm
        Diameter of the entrance pupil; 0: all is in focus. The paper's rig, f = 8.3 mm by its 1.67 µm pixels, has 1 mm
        at f/8 and 3 mm at f/2.8. A point at depth z is a disk of f·D·|1/z − 1/z₀|, here a Gaussian of a quarter of
        that as σ.
    focus_mm
        Depth z₀ that is in focus.

    References
    ----------
    Kingslake, R., A History of the Photographic Lens (1989), ch. 1 (coma); Hecht, E., Optics, 6.3.1 (coma grows in
    proportion to the field angle).
    """

    k3: float = 0.0
    coma_px: float = 0.0
    aperture_mm: float = 0.0
    focus_mm: float = 520.0

    def __post_init__(self) -> None:
        require_ranges(
            self,
            (
                ("k3", -5.0, 5.0),
                ("coma_px", -20.0, 20.0),
                ("aperture_mm", 0.0, 20.0),
                ("focus_mm", 100.0, 5000.0),
            ),
        )

    def through_lens(self, camera: Camera) -> Camera:
        """Make a copy of `camera` with this lens's third radial coefficient k3 added."""
        if not self.k3:
            return camera
        k1, k2, p1, p2, k3 = camera.distortion
        return Camera(camera.image_size, camera.matrix, np.array([k1, k2, p1, p2, k3 + self.k3]))

    def image(self, light: Map, blur_px: float, camera: Camera, depth: Map, scale: float) -> Map:
        """Blur the light (h, w) of points at `depth` (h, w) in mm as the lens does: σ `blur_px` px in focus."""
        shown = self._focused(light, blur_px, float(camera.matrix[0, 0]), depth)
        return self._with_tails(shown, camera, self.coma_px * scale) if self.coma_px else shown

    def _focused(self, light: Map, blur_px: float, focal_px: float, depth: Map) -> Map:
        if not self.aperture_mm:
            return blurred(light, blur_px)
        seen = depth > 0
        off = np.where(seen, np.abs(1 / np.where(seen, depth, 1.0) - 1 / self.focus_mm), 0.0)
        variance = ((focal_px * self.aperture_mm / 4) * off.astype(np.float32)) ** 2
        levels = np.linspace(0.0, max(float(variance.max()), 1e-6), LEVELS)
        place = np.minimum(variance / np.float32(levels[1]), np.float32(LEVELS - 1))
        shown = np.zeros_like(light)
        for number, level in enumerate(levels):
            share = np.maximum(1 - np.abs(place - np.float32(number)), 0)
            if share.any():
                shown += share * blurred(light, float(np.sqrt(blur_px**2 + level)))
        return shown

    def _with_tails(self, light: Map, camera: Camera, longest_px: float) -> Map:
        """Each point drawn out away from the centre, its own middle of gravity kept where it was."""
        height, width = light.shape
        centre = camera.matrix[:2, 2].astype(np.float32)
        v, u = np.mgrid[0:height, 0:width].astype(np.float32)
        reach = float(np.hypot(width, height) / 2)
        du, dv = (u - centre[0]) * (longest_px / reach), (v - centre[1]) * (longest_px / reach)
        places: Array = (np.arange(TAIL) + 0.5) / TAIL
        weights = (1 - places) / (1 - places).sum()
        shown = np.zeros_like(light)
        for place, weight in zip(places - places @ weights, weights, strict=True):
            from_u, from_v = u - np.float32(place) * du, v - np.float32(place) * dv
            there = cv2.remap(light, from_u, from_v, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE)
            shown += np.float32(weight) * np.maximum(there, 0)
        return shown


IDEAL_LENS = LensEffects()
"""Of nothing but an even blur."""
