"""Where a plate shows nothing but itself: what is printed on it, holes and dirt are told by its own brightness."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.image.targets.target_view import TargetView

DARK = 0.4
"""Of the plate's brightness around the target's points: what is darker is none of the light plate."""
EVEN = 0.85
"""Of the plate's brightness about it that a pixel must have at least: one σ of the blur beside a blurred edge, and
another px is left out there."""
_BLUR_PX = 1.0  # σ: noise of single pixels makes none of them dark
_LEAST_LIGHT = 0.05  # of what is about a pixel, or the brightness there is not known


@dataclass(frozen=True, eq=False, slots=True)
class EvenPlate:
    """Picture of a plate without marks: `picture` (H, W) is as bright there as around, `uneven` (H, W) tells where."""

    picture: NDArray[np.float32]
    uneven: NDArray[np.bool_]

    @classmethod
    def of(cls, plate: NDArray[Any], view: TargetView, level: float) -> EvenPlate:
        """Remove the marks from a target's picture (H, W) without laser; `level` is the light plate's grey.

        The brightness about a pixel is the mean, a cell of the target wide, of what is not dark itself.
        """
        smooth = np.asarray(cv2.GaussianBlur(plate.astype(np.float32), (0, 0), _BLUR_PX), dtype=np.float32)
        size = 2 * round(cell_px(view)) + 1
        around: NDArray[Any] = np.full(smooth.shape, level, dtype=np.float32)
        for share in (DARK, EVEN):  # the mean is first known roughly
            around *= np.float32(share)
            light = np.asarray(smooth > around, dtype=np.float32)
            number = np.asarray(cv2.blur(light, (size, size)))
            light *= smooth
            around = np.asarray(cv2.blur(light, (size, size)))
            unknown = number <= _LEAST_LIGHT
            around /= np.maximum(number, _LEAST_LIGHT, out=number)
            around[unknown] = level
        dark = (smooth < EVEN * around).view(np.uint8)
        beside, about = (np.asarray(cv2.dilate(dark, np.ones((size, size), np.uint8))) > 0 for size in (3, 7))
        np.copyto(smooth, around, where=about)
        return cls(smooth, beside)


def cell_px(view: TargetView) -> float:
    """Compute the usual distance in px from one of the target's points to the next."""
    apart = np.asarray(cKDTree(view.uv).query(view.uv, k=2)[0])
    return float(np.median(apart[:, 1]))
