"""A rig that warms: focal length and laser since the calibration, and all of them in the course of a scan."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from core.model import Camera
from core.simulate.effects.ranges import require_ranges

if TYPE_CHECKING:  # a window that starts reads scenarios, and loads no compiled loops
    from core.simulate.rays import Map


@dataclass(frozen=True, slots=True)
class Warming:
    """Effects of warmth on camera and laser, beside `Scenario.drifted_px` and `turned_urad`.

    What happens within the scan grows evenly from the reference to the last frame.

    Parameters
    ----------
    focal_ppm
        Millionths by which the focal length has grown since the calibration: 10 to 30 for each kelvin of a lens.
    scan_px
        How far the picture moves on the sensor to the right, and 0.6 times as far down, within the scan, in pixels of
        the pictures: cameras drift by 0.1 to 0.5 px in their first hour, most of it in minutes.
    scan_focal_ppm
        Growth of the focal length within the scan.
    scan_urad
        How far the fan's laser turns about its emitter and the camera's x axis within the scan: modules point
        elsewhere by 10 to 100 µrad for each kelvin.

    References
    ----------
    Temperature compensation method for digital cameras in 2D and 3D measurement applications, Sensors 2018, 18, 3685,
    doi:10.3390/s18113685.
    """

    focal_ppm: float = 0.0
    scan_px: float = 0.0
    scan_focal_ppm: float = 0.0
    scan_urad: float = 0.0

    def __post_init__(self) -> None:
        require_ranges(
            self,
            (
                ("focal_ppm", -1e5, 1e5),
                ("scan_px", -50.0, 50.0),
                ("scan_focal_ppm", -1e5, 1e5),
                ("scan_urad", -1e5, 1e5),
            ),
        )

    def at(self, share: float, light: Map, camera: Camera) -> Map:
        """Shift and scale the image `light` (h, w) as a camera has warmed up when the `share` of the scan is over."""
        if not share or not (self.scan_px or self.scan_focal_ppm):
            return light
        from scipy.ndimage import affine_transform  # here: the command line reads scenarios, and --help needs no scipy

        grown = 1 + share * self.scan_focal_ppm * 1e-6
        centre = camera.matrix[:2, 2]
        shift = (1 - grown) * centre + share * self.scan_px * np.array([1.0, 0.6])
        # not by OpenCV: it rounds to 1/32 px, and a drift of a tenth would come in three jumps
        moved = affine_transform(light, np.full(2, 1 / grown), -shift[::-1] / grown, order=3, mode="nearest")
        return np.asarray(np.maximum(moved, 0), dtype=np.float32)


NO_WARMING = Warming()
"""Nothing changes beyond what a scenario says."""
