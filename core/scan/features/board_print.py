"""What is printed on boards that lie in a scan: strips between dark marks are no stripes, and light on ink is faint.

Marks are found in a picture of the board, without a calibration, and count where the reference still shows them: a part
that stands on the board covers some.
"""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.calibrate.fan.poses.even_plate import EvenPlate, cell_px
from core.calibrate.fan.poses.plane_pose import plate_level
from core.image.targets import Target, detect
from core.image.targets.target_view import TargetView

# Held by tests/scan/features/test_board_print.py.
STILL_SEEN = 0.5
"""Of the contrast that marks have in the board's picture, that in the reference at least where it shows them, too."""
_WINDOW = 1.5
"""Cells of the target over which contrast is compared."""
_LEAST_SHARE = 0.02
"""Share of a window that is marked, and that is not, at least, or its contrast is not known."""

Grey = NDArray[np.float32]


def marks_on_board(
    target: Target, picture: NDArray[Any], reference: NDArray[Any], region_px: ArrayLike | None = None
) -> NDArray[np.bool_]:
    """Find the marks (H, W) of the `target` on a board in a `picture` of it that the `reference` shows as well.

    Parameters
    ----------
    target
        What is printed on the board.
    picture, reference
        (H, W) grey levels of the board, lasers off, and of the scan with the fan alone.
    region_px
        Polygon (K, 2) within which the board is looked for; None: anywhere.

    Raises
    ------
    TargetNotFound
        If the picture does not show the board.
    """
    view = detect(target, picture, region_px=region_px, plane_only=True)
    uneven = EvenPlate.of(picture, view, plate_level(picture, view)).uneven
    marks = uneven & _around(view, uneven.shape)
    size = 2 * round(_WINDOW * cell_px(view)) + 1
    own, there = (_contrast(one.astype(np.float32), marks, size) for one in (picture, reference))
    return marks & (there >= STILL_SEEN * own)


def _around(view: TargetView, shape: tuple[int, ...]) -> NDArray[np.bool_]:
    """Where (H, W) the target is, a cell beyond its points included."""
    inside = np.zeros(shape, np.uint8)
    cv2.fillConvexPoly(inside, cv2.convexHull(np.rint(view.uv).astype(np.int32)), 1)
    beyond = 2 * round(1.2 * cell_px(view)) + 1
    return np.asarray(cv2.dilate(inside, np.ones((beyond, beyond), np.uint8))) > 0


def _contrast(picture: Grey, marks: NDArray[np.bool_], size: int) -> Grey:
    """By what share (H, W) the marks about a pixel are darker than what is no mark there; 0 where that is not known."""
    marked = marks.astype(np.float32)

    def mean(weight: Grey) -> tuple[Grey, Grey]:
        share = np.asarray(cv2.blur(weight, (size, size)), dtype=np.float32)
        light = np.asarray(cv2.blur(weight * picture, (size, size)), dtype=np.float32)
        return np.asarray(light / np.maximum(share, 1e-6), dtype=np.float32), share

    (dark, share), (light, rest) = mean(marked), mean(1 - marked)
    known = (share > _LEAST_SHARE) & (rest > _LEAST_SHARE)
    return np.where(known, 1 - dark / np.maximum(light, 1e-6), np.float32(0))


def without_marks(picture: Grey, marks: NDArray[np.bool_] | None, width_px: int = 25) -> Grey:
    """Copy a picture (H, W) with the mean of what is about them, `width_px` wide, in place of marks."""
    if marks is None or not marks.any():
        return picture
    beside = (~marks).astype(np.float32)
    share = np.asarray(cv2.blur(beside, (width_px, width_px)))
    about = np.asarray(cv2.blur(beside * picture, (width_px, width_px))) / np.maximum(share, 1e-6)
    return np.where(marks, np.where(share > 0, about, np.float32(np.median(picture))), picture)
