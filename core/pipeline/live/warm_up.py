"""Getting compiled functions ready before they are waited for.

`stages` compiles what a measurement needs and keeps it on the disk: a minute or two after an installation or an update,
else a moment. Every process loads it anew: without `get_ready_for_live` a live scan's reference and its first frames
would take a second, so a tiny scan is previewed beforehand, in every way a real one is.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
from scipy.sparse import csr_array

from core.acquire.source import Frame, Picture
from core.compiled import is_complete, keep_complete
from core.image.stripes.centreline import Centreline
from core.image.stripes.extraction import extract_centrelines
from core.image.stripes.noise import NoiseModel
from core.image.stripes.stripe import WIDTH_IN_SIGMA, StripeSettings
from core.model import Camera, Fan, LightPlane
from core.model.arrays import Array
from core.pipeline.live.preview import ScanPreviewer
from core.pipeline.steps.scan.surface import level_patch, make_surface
from core.scan.features.crossing_search import all_crossings
from core.scan.features.crossings import CrossingWindow
from core.scan.features.extraction import extract_features, saturated_pixels
from core.scan.features.reference import FeatureOptions, picture_difference
from core.scan.network.normal_matrix import normal_matrix
from core.scan.surface.bends import bends_of

PixelType = type[np.uint8] | type[np.uint16]

FOCAL_PX, SIZE = 400.0, (320, 240)
"""A small camera: focal length in pixels, and columns and rows. What is compiled does not depend on them."""
CAMERA = Camera(SIZE, np.array([[FOCAL_PX, 0.0, 160.0], [0.0, FOCAL_PX, 120.0], [0.0, 0.0, 1.0]]))

_BESIDE_MM = 150.0
"""How far the laser is beside the camera."""
_FAN_ANGLES = (0.20, 0.29, 0.38)
"""The fan's planes against the view, in rad, for a laser so far beside the camera."""
_SWEEPS = 8
"""After so many the first ones have been located together, and all anew."""


def exposed(levels: PixelType, light: Array) -> Picture:
    """Make a picture (h, w) from `light` (h, w), stripes of height 1, on a dark ground with a little noise."""
    full = float(np.iinfo(levels).max)
    noise = np.random.default_rng(0).normal(0, 0.004, light.shape)
    grey = np.clip(full * (0.04 + 0.5 * light + noise), 0, full)
    return grey.astype(np.uint8) if levels is np.uint8 else grey.astype(np.uint16)


@cache
def get_ready_for_live(levels: PixelType) -> None:
    """Compile all that the live preview needs for pictures of type `levels`, by previewing a made-up scan.

    A plate with a ridge under the fan, and sweeps over it, are looked at.
    """
    v, u = np.mgrid[: SIZE[1], : SIZE[0]]
    rays = CAMERA.rays(np.column_stack([u.ravel(), v.ravel()])).reshape(*u.shape, 3)
    inverse_depth = np.where((u > 110) & (u < 210), 1 / 470, 1 / 500)
    fan = Fan(tuple(LightPlane(np.array([0.0, -1.0, np.tan(angle)]) / _BESIDE_MM) for angle in _FAN_ANGLES))
    fixed = np.sum([_stripe(plane.pi, rays, inverse_depth) for plane in fan.planes], axis=0)
    previewer = ScanPreviewer(CAMERA, fan)
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


_FAN_PX = (70.0, 84.0, 170.0)
"""Rows in which the fan's stripes begin in the picture, in pixels."""
_SWEEPS_PX = (90.0, 150.0, 210.0)
"""Columns in which the sweeps' stripes begin, in pixels, one a frame."""


Stages = tuple[Callable[[], None], ...]


def stages() -> Stages:
    """List the functions that compile a part each, in about a minute at most; the last records that all are done."""
    return (*(stage for share in shares() for stage in share), keep_complete)


def ahead() -> tuple[Stages, bool]:
    """List the functions that compile a part each, and whether calling them takes long as it was not done before."""
    return stages(), not is_complete()


def shares() -> tuple[Stages, Stages]:
    """Divide the functions that compile a part each into two lists of about the same duration, for two processes."""
    return (lambda: _stripes(np.uint8), lambda: _stripes(np.uint16)), (_crossings, _surface, _whole_numbers)


def _stripes(levels: PixelType) -> None:
    """Three level lines of a fan, two of them close together, and three upright sweeps: found, refined, crossed."""
    reference = _picture(levels, rows=_FAN_PX)
    frames = [(f"{number}", _picture(levels, rows=_FAN_PX, column=place)) for number, place in enumerate(_SWEEPS_PX)]
    extract_features(reference, frames, len(frames), FeatureOptions(camera=CAMERA))


def _whole_numbers() -> None:
    """A frame of 8 bits minus its reference, in whole numbers: what `_stripes` comes to last."""
    reference, frame = _picture(np.uint8, rows=_FAN_PX), _picture(np.uint8, rows=_FAN_PX, column=_SWEEPS_PX[0])
    stripe, noise = StripeSettings(WIDTH_IN_SIGMA * 2.0, 100.0), NoiseModel(1.0)
    extract_centrelines(picture_difference(frame, reference), stripe, noise=noise, saturated=saturated_pixels(frame))


def _picture(levels: PixelType, rows: tuple[float, ...], column: float | None = None) -> Picture:
    v, u = np.mgrid[: SIZE[1], : SIZE[0]]
    light = sum(np.exp(-0.5 * ((v - row - 0.02 * u) / 2.0) ** 2) for row in rows)
    if column is not None:
        light = light + np.exp(-0.5 * ((u - column - 0.1 * v) / 2.0) ** 2)
    return exposed(levels, light)


def _crossings() -> None:
    """Level lines crossed by upright ones, all of them with a kink, which wants a judgement; three equations."""
    along = np.arange(20.0, 220.0)
    level = [_line(np.column_stack([along, row + 0.3 * np.abs(along - 120)])) for row in _FAN_PX]
    upright = [[_line(np.column_stack([column + 0.3 * np.abs(along - 120), along]))] for column in _SWEEPS_PX]
    all_crossings(level, upright, CrossingWindow())
    normal_matrix(csr_array(np.eye(3)), np.ones(3))


def _line(uv: Array) -> Centreline:
    count = len(uv)
    t = np.gradient(uv, axis=0)
    normal = np.column_stack([t[:, 1], -t[:, 0]]) / np.hypot(t[:, 0], t[:, 1])[:, None]
    level = np.ones(count)
    return Centreline(uv, normal, 2 * level, 100 * level, 0.02 * level, np.zeros(count, bool), correlation_px=7.0)


def _surface() -> None:
    """A level patch of points, fused, with normals, bends and triangles."""
    cloud, image_size = level_patch()
    bends_of(make_surface((cloud, image_size))[0], image_size)
