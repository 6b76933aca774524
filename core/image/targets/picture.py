"""Pictures made ready for finding targets: exposure, 8 bit, reduction, noise."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from core.image.targets.target_view import TargetNotFound
from core.messages import Message
from core.model.arrays import Array

Picture = NDArray[Any]
"""(H, W) grey levels, uint8 or uint16."""

_FAINTEST = {np.dtype(np.uint8): 8, np.dtype(np.uint16): 128}
"""Grey levels below which a difference is no picture."""


def check_exposure(picture: Picture, name: str) -> None:
    """Raise TargetNotFound if a picture (H, W) is all black, all white or of one grey level.

    Raises
    ------
    ValueError
        If the picture is not 2-D uint8 or uint16.
    TargetNotFound
        If it is all black, all white, or of one grey.
    """
    if picture.ndim != 2 or picture.dtype not in _FAINTEST or picture.size == 0:
        raise ValueError(f"a picture must be (H, W) of uint8 or uint16, not {picture.shape} of {picture.dtype}")
    low, high = grey_range(picture)
    faint = _FAINTEST[picture.dtype]
    white = np.iinfo(picture.dtype).max
    if high <= faint:
        raise TargetNotFound(
            Message("picture.black", "the picture is all black"),
            where=name,
            todo=Message("advice.expose_longer", "expose longer, or check the lens cap"),
        )
    if low >= white - faint:
        raise TargetNotFound(
            Message("picture.white", "the picture is all white"),
            where=name,
            todo=Message("advice.expose_shorter", "expose shorter"),
        )
    if high - low <= faint:
        raise TargetNotFound(
            Message(
                "picture.one_grey", "the picture is of one grey (levels {low:.0f} to {high:.0f})", low=low, high=high
            ),
            where=name,
            todo=Message("advice.check_light_and_focus", "check light and focus"),
        )


def grey_range(picture: Picture) -> tuple[float, float]:
    """Compute the grey levels below and above which are 0.2 % of the pixels of a picture (H, W) each."""
    step = max(1, min(picture.shape) // 400)
    low, high = level_quantiles(picture[::step, ::step], 0.002, 0.998)
    return low, high


def level_quantiles(levels: Picture, *shares: float) -> list[float]:
    """Compute the quantiles `shares` of grey `levels` of any shape, by counting, for many pixels."""
    upto = np.cumsum(np.bincount(levels.ravel()))
    quantiles: list[float] = []
    for share in shares:
        place = share * (levels.size - 1)
        below, above = np.searchsorted(upto, [np.floor(place), np.ceil(place)], side="right").tolist()
        share_above = place - np.floor(place)
        step = float(above - below)  # rounded as numpy does
        quantiles.append(below + step * share_above if share_above < 0.5 else above - step * (1 - share_above))
    return quantiles


def as_8bit(picture: Picture) -> NDArray[np.uint8]:
    """Convert a picture (H, W) to 8 bit, stretched to the full range unless it is a bright 8-bit one already."""
    low, high = grey_range(picture)
    if picture.dtype == np.uint8 and high >= 128:
        return picture
    scale = 255 / max(high - low, 1.0)
    return np.asarray(cv2.convertScaleAbs(np.maximum(picture, low), alpha=scale, beta=-low * scale), dtype=np.uint8)


def as_refinable(picture: Picture) -> Picture:
    """Convert a picture (H, W) to a pixel type that OpenCV's corner refinement takes; grey levels stay."""
    return picture if picture.dtype == np.uint8 else picture.astype(np.float32)


def reduced(picture: NDArray[np.uint8], longest: int) -> tuple[NDArray[np.uint8], int]:
    """Reduce a picture by a whole factor to a longer side of about `longest` px; returns it and the factor."""
    factor = max(1, round(max(picture.shape) / longest))
    if factor == 1:
        return picture, 1
    rows, columns = (side // factor * factor for side in picture.shape)
    small = cv2.resize(picture[:rows, :columns], (columns // factor, rows // factor), interpolation=cv2.INTER_AREA)
    return np.asarray(small, dtype=np.uint8), factor


def resized(picture: NDArray[np.uint8], factor: float) -> tuple[NDArray[np.uint8], float]:
    """Resize a picture to 1 / `factor` of its size, rounded to whole px; returns it and `factor`."""
    rows, columns = (max(1, round(side / factor)) for side in picture.shape)
    way = cv2.INTER_AREA if factor > 1 else cv2.INTER_CUBIC
    small = picture if factor == 1 else cv2.resize(picture, (columns, rows), interpolation=way)
    return np.asarray(small, dtype=np.uint8), factor


def enlarged(uv: Array, factor: float) -> Array:
    """Convert points `uv` (…, 2) of a picture reduced by `factor` to px of the full one.

    Pixel centres are whole numbers in both.
    """
    return (np.asarray(uv, dtype=np.float64) + 0.5) * factor - 0.5


def without_stripes(picture: NDArray[np.uint8], width: int) -> NDArray[np.uint8]:
    """Remove bright lines narrower than `width` px from a picture by grey opening; dark shapes keep their outline."""
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (width, width))
    return np.asarray(cv2.morphologyEx(picture, cv2.MORPH_OPEN, disc), dtype=np.uint8)


def only_within(picture: Picture, polygon: Array, name: str) -> Picture:
    """Cover all of a picture (H, W) outside a `polygon` (K, 2) in px by the nearest grey levels in it: no new edges.

    TargetNotFound, with the picture's `name`, if the polygon lies outside of it.
    """
    within = cv2.fillPoly(np.zeros(picture.shape, np.uint8), [np.rint(polygon).astype(np.int32)], 1)
    if not within.any():
        height, width = picture.shape
        raise TargetNotFound(
            Message(
                "target.region_outside",
                "the region to look in lies outside of the picture of {width} × {height} pixels",
                width=width,
                height=height,
            ),
            where=name,
            todo=Message("advice.check_region", "check region_px: it is in pixels of the picture, from its top left"),
        )
    rows, columns = distance_transform_edt(within == 0, return_distances=False, return_indices=True)
    covered: Picture = picture[rows, columns]
    return covered


def noise_of(picture: Picture, uv: Array) -> float:
    """Estimate the standard deviation of the pixel noise in grey levels around the points `uv` (N, 2).

    From the median absolute response of a mask blind to edges, apart for the darker and the brighter half of the area,
    as noise grows with light.

    The mask is the difference of two Laplacians (Immerkær, Fast noise variance estimation, CVIU 64 (1996),
    doi:10.1006/cviu.1996.0060). Never less than the noise of rounding to whole grey levels.
    """
    left, top = np.floor(uv.min(axis=0)).astype(int).clip(0)
    right, bottom = np.ceil(uv.max(axis=0)).astype(int) + 1
    area = picture[top:bottom, left:right].astype(np.float32)
    mask = np.array([[1, -2, 1], [-2, 4, -2], [1, -2, 1]], dtype=np.float32)
    response = np.abs(cv2.filter2D(area, -1, mask)) / (0.6745 * 6)
    bright = area > np.mean(area)
    halves = [float(np.median(response[half])) for half in (bright, ~bright) if half.any()]
    return max(float(np.sqrt(np.mean(np.square(halves)))), 0.29)
