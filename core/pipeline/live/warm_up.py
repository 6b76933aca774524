"""Getting a process ready to look at a live scan: what is compiled is loaded, and what is not is compiled.

Compiled functions are kept on the disk, but every process loads them anew: without this a scan's reference and its
first looks would take a second. So a tiny scan is previewed beforehand, in every way a real one is.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from core.acquire.source import Frame, Picture
from core.files.options import Options
from core.model import Camera, Fan, LightPlane
from core.model.arrays import Array
from core.pipeline.live_preview import ScanPreviewer

Levels = type[np.uint8] | type[np.uint16]

FOCAL_PX, SIZE = 400.0, (320, 240)
CAMERA = Camera(SIZE, np.array([[FOCAL_PX, 0.0, 160.0], [0.0, FOCAL_PX, 120.0], [0.0, 0.0, 1.0]]))

_BESIDE_MM = 150.0
_FAN_ANGLES = (0.20, 0.29, 0.38)
"""The fan's planes against the view, in rad, for a laser so far beside the camera."""
_SWEEPS = 8
"""After so many the first ones have been located together, and all anew."""


def exposed(levels: Levels, light: Array) -> Picture:
    """The picture of stripes (h, w) of height 1 on a dark ground, with a little noise."""
    full = float(np.iinfo(levels).max)
    noise = np.random.default_rng(0).normal(0, 0.004, light.shape)
    grey = np.clip(full * (0.04 + 0.5 * light + noise), 0, full)
    return grey.astype(np.uint8) if levels is np.uint8 else grey.astype(np.uint16)


@cache
def get_ready_for_live(levels: Levels) -> None:
    """Have everything there that pictures of these `levels` need; what is there already takes no time.

    A plate with a ridge under the fan, and sweeps over it, are looked at.
    """
    v, u = np.mgrid[: SIZE[1], : SIZE[0]]
    rays = CAMERA.rays(np.column_stack([u.ravel(), v.ravel()])).reshape(*u.shape, 3)
    inverse_depth = np.where((u > 110) & (u < 210), 1 / 470, 1 / 500)
    fan = Fan(tuple(LightPlane(np.array([0.0, -1.0, np.tan(angle)]) / _BESIDE_MM) for angle in _FAN_ANGLES))
    fixed = np.sum([_stripe(plane.pi, rays, inverse_depth) for plane in fan.planes], axis=0)
    previewer = ScanPreviewer(CAMERA, fan, Options())
    previewer.read_reference(exposed(levels, fixed))
    for number in range(_SWEEPS):
        at, tilt = 0.6 * number / (_SWEEPS - 1) - 0.3, 0.5 * (-1) ** number
        sweep = np.array([1.0, tilt, 0.0]) / 200
        sweep[2] = 1 / 480 - sweep[0] * at
        picture = exposed(levels, fixed + _stripe(sweep, rays, inverse_depth))
        previewer.look(number, f"{number}", Frame(picture, number, 0.0, 0))
        while previewer.has_more:
            previewer.go_on()


def _stripe(pi: Array, rays: Array, inverse_depth: Array) -> Array:
    """The light (h, w) of the plane `pi` on a surface."""
    off_px = FOCAL_PX * (rays @ pi - inverse_depth) / np.hypot(pi[0], pi[1])
    return np.asarray(np.exp(-0.5 * (off_px / 2.0) ** 2))
