"""ChArUco corners: OpenCV's marker search on a reduced picture, corners refined at full resolution."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.image.targets.corners import corner_sigma, refined
from core.image.targets.kinds import Charuco
from core.image.targets.picture import Picture, as_8bit, enlarged, noise_of, reduced, without_stripes
from core.image.targets.pose import homography_of, map_by
from core.image.targets.target_view import TargetNotFound, TargetView
from core.messages import Field, Message
from core.model.arrays import Array

LEAST_CORNERS = 6
"""Fewer corners fix neither a pose nor a camera with anything to spare."""

LARGEST_HALF_WINDOW = 11
"""Half the window of the corner refinement in pixels, where the markers leave room for it."""

SMOOTHING = 1.0
"""σ in pixels of the smoothing before the refinement, against the error from the pixels' phase."""


def detect_charuco(board: Charuco, picture: Picture, name: str = "") -> TargetView:
    """The inner corners of `board` in `picture`; a part of the board will do.

    Boards printed in OpenCV's pattern before version 4.6 (even number of rows) are recognised too.

    Raises
    ------
    TargetNotFound
        If fewer than six corners are seen, or all of them in one line.
    InputError
        If the board needs more markers than its dictionary has.
    """
    full = as_8bit(picture)
    dictionary = dictionary_of(board)
    markers = 0
    for longest in (1300, 2600):
        small, factor = reduced(full, longest)
        for candidate in (small, without_stripes(small, 5)):
            corners, ids, count = _best_reading(board, dictionary, candidate)
            markers = max(markers, count)
            if len(ids) >= LEAST_CORNERS and _spread_out(board, ids):
                return _view(board, picture, enlarged(corners, factor), ids, factor, name)
        if factor == 1:
            break
    raise _failure(board, markers, name)


def dictionary_of(board: Charuco) -> cv2.aruco.Dictionary:
    """The markers of `board`, as OpenCV has them.

    Raises
    ------
    InputError
        If the board needs more markers than its dictionary has.
    """
    dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, board.dictionary_id))
    needed, available = board.columns * board.rows // 2, len(dictionary.bytesList)
    if needed > available:
        raise InputError(
            Message(
                "target.few_markers",
                "the board has {n} markers, but {dictionary} only {available}",
                n=needed,
                dictionary=board.dictionary_id,
                available=available,
            ),
            where="dictionary",
            todo=Message("target.advice_dictionary", "choose a dictionary with more markers, or fewer squares"),
        )
    return dictionary


def _best_reading(
    board: Charuco, dictionary: cv2.aruco.Dictionary, picture: NDArray[np.uint8]
) -> tuple[Array, NDArray[np.intp], int]:
    """Corners (N, 2), their indices into `board.points`, and how many markers were read."""
    best: tuple[Array, NDArray[np.intp], int] = (np.empty((0, 2)), np.empty(0, dtype=np.intp), 0)
    for old_pattern in (False, True) if board.rows % 2 == 0 else (False,):
        layout = cv2.aruco.CharucoBoard((board.columns, board.rows), board.square_mm, board.marker_mm, dictionary)
        layout.setLegacyPattern(old_pattern)
        corners, ids, _, marker_ids = cv2.aruco.CharucoDetector(layout).detectBoard(picture)
        markers = 0 if marker_ids is None else len(marker_ids)
        count = 0 if ids is None else len(ids)
        if count > len(best[1]) or (count == len(best[1]) and markers > best[2]):
            points = np.empty((0, 2)) if count == 0 else np.asarray(corners, dtype=np.float64).reshape(-1, 2)
            best = (points, np.empty(0, np.intp) if count == 0 else np.asarray(ids, np.intp).ravel(), markers)
    return best


def _spread_out(board: Charuco, ids: NDArray[np.intp]) -> bool:
    return bool(np.linalg.matrix_rank(board.points[ids, :2] - board.points[ids, :2].mean(axis=0)) == 2)


def _view(
    board: Charuco, picture: Picture, corners: Array, ids: NDArray[np.intp], factor: int, name: str
) -> TargetView:
    """Refine at full size, in a window that keeps clear of the markers."""
    pixels = cv2.GaussianBlur(picture.astype(np.float32), (0, 0), SMOOTHING)
    points = board.points[ids]
    reach = _clear_of_markers(board, points[:, :2], corners)
    if factor > 1:
        corners = refined(pixels, corners, int(np.clip(reach, 3, 2 * factor + 1)))
    half = int(np.clip(round(reach), 2, LARGEST_HALF_WINDOW))
    corners = refined(pixels, corners, half)
    sigma = corner_sigma(pixels, corners, half, noise_of(picture, corners), SMOOTHING)
    return TargetView(points, corners, sigma, name)


def _clear_of_markers(board: Charuco, xy: Array, corners: Array) -> float:
    """Pixels around every corner that no marker reaches into."""
    homography = homography_of(xy, corners, robust=True)
    if homography is None:
        return 2.0
    step = 0.9 * (board.square_mm - board.marker_mm) / 2
    moved = [map_by(homography, xy + offset) - map_by(homography, xy) for offset in ([step, 0.0], [0.0, step])]
    return float(np.linalg.norm(moved, axis=2).min())


def _failure(board: Charuco, markers: int, name: str) -> TargetNotFound:
    if markers == 0:
        return TargetNotFound(
            Message("target.no_marker", "no marker of {name} is seen in the picture", name=board.dictionary_id),
            where=name,
            todo=Message(
                "advice.check_dictionary_or_leave_out",
                "check the {field}, or leave the picture out",
                field=Field("target.dictionary"),
            ),
        )
    return TargetNotFound(
        Message(
            "target.few_charuco_corners",
            "{n} markers of the ChArUco board are seen, but fewer than {least} of its corners",
            n=markers,
            least=LEAST_CORNERS,
        ),
        where=name,
        todo=Message(
            "advice.show_more_of_board",
            "show more of the board, or check its {fields}",
            fields=Field("target.columns, rows and dictionary"),
        ),
    )
