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
from core.image.targets.target_view import OtherBoard, TargetNotFound, TargetView
from core.messages import Field, Message
from core.model.arrays import Array

LEAST_IN_PLACE = 0.9
"""Share of the markers that lie as on a board of the size that they are to tell."""

LEAST_CORNERS = 6
"""Fewer corners fix neither a pose nor a camera with anything to spare."""

LARGEST_HALF_WINDOW = 11
"""Half the window of the corner refinement in pixels, where the markers leave room for it."""

SMOOTHING = 1.0
"""σ in pixels of the smoothing before the refinement, against the error from the pixels' phase."""


def detect_charuco(board: Charuco, picture: Picture, name: str = "") -> TargetView:
    """Find the inner corners of `board` in `picture` (H, W); a part of the board is enough.

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
    if not markers:
        raise _no_marker(board, dictionary, small, name)
    counted = None if board.first_id else _counted(dictionary, small)
    raise _few_corners(markers, name) if counted is None else _other_board(board, counted, name)


def dictionary_of(board: Charuco) -> cv2.aruco.Dictionary:
    """Make OpenCV's dictionary of the markers on `board`; InputError if it needs more than there are.

    Raises
    ------
    InputError
        If the board needs more markers than its dictionary has.
    """
    dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, board.dictionary_id))
    needed, available = board.first_id + board.columns * board.rows // 2, len(dictionary.bytesList)
    if needed > available:
        values = {"n": needed, "dictionary": board.dictionary_id, "available": available}
        raise InputError(
            Message(
                "target.ids_beyond",
                "the board's markers end at {last}, those of {dictionary} at {highest}",
                last=needed - 1,
                dictionary=board.dictionary_id,
                highest=available - 1,
            )
            if board.first_id
            else Message(
                "target.few_markers", "the board has {n} markers, but {dictionary} only {available}", **values
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
        numbers = board.first_id + np.arange(board.columns * board.rows // 2)
        layout = cv2.aruco.CharucoBoard(
            (board.columns, board.rows), board.square_mm, board.marker_mm, dictionary, numbers
        )
        layout.setLegacyPattern(old_pattern)
        corners, ids, _, marker_ids = cv2.aruco.CharucoDetector(layout).detectBoard(picture)
        markers = 0 if marker_ids is None else int(np.isin(marker_ids, numbers).sum())
        count = 0 if ids is None else len(ids)
        if count > len(best[1]) or (count == len(best[1]) and markers > best[2]):
            points = np.empty((0, 2)) if count == 0 else np.asarray(corners, dtype=np.float64).reshape(-1, 2)
            best = (points, np.empty(0, np.intp) if count == 0 else np.asarray(ids, np.intp).ravel(), markers)
    return best


def _counted(dictionary: cv2.aruco.Dictionary, picture: NDArray[np.uint8]) -> tuple[int, int] | None:
    """Columns and rows of squares of the board that the markers in the picture make up; None if they make up none.

    Markers are numbered row by row, so with another number of columns they lie otherwise. The board's last row is that
    of the highest number, where the picture shows the ground around it.
    """
    corners, ids, _ = cv2.aruco.ArucoDetector(dictionary).detectMarkers(picture)
    if ids is None or len(ids) < LEAST_CORNERS:
        return None
    numbers = np.asarray(ids, np.intp).ravel()
    centres = np.array([np.asarray(one, dtype=np.float64).reshape(4, 2).mean(axis=0) for one in corners])
    for columns in range(3, int(numbers.max()) + 2):
        for first in (1, 0):  # column of the first row's first marker; 0 before OpenCV 4.6
            row, column = np.divmod(2 * np.arange(numbers.max() + 1) + first, columns)
            if columns % 2 == 0:  # rows of an even number of squares begin with the two colours in turn
                column += np.where(row % 2 == 1, 1 - 2 * first, 0)
            places = np.column_stack([column, row])[numbers] + 0.5
            if _lie_there(picture, places, centres, (columns, int(row[-1]) + 1)):
                return columns, int(row[-1]) + 1
    return None


def _lie_there(picture: NDArray[np.uint8], places: Array, centres: Array, size: tuple[int, int]) -> bool:
    """Whether markers at `places` (N, 2), in squares, are seen at `centres`, all a square around the board is."""
    if np.ptp(places[:, 0]) < 2 or np.ptp(places[:, 1]) < 2:
        return False
    homography = homography_of(places, centres, robust=True)
    if homography is None:
        return False
    off = np.linalg.norm(map_by(homography, places) - centres, axis=1)
    side = np.linalg.norm(map_by(homography, places + [0.5, 0.5]) - map_by(homography, places - 0.5), axis=1)
    right, bottom = size[0] + 1.0, size[1] + 1.0
    outline = map_by(homography, np.array([(-1.0, -1.0), (right, -1.0), (-1.0, bottom), (right, bottom)]))
    height, width = picture.shape
    within = (outline > 0) & (outline < [width - 1, height - 1])
    return bool(np.mean(off < 0.2 * side) > LEAST_IN_PLACE and within.all())


def _other_board(board: Charuco, counted: tuple[int, int], name: str) -> OtherBoard:
    return OtherBoard(
        Message(
            "target.other_charuco",
            "the board shows {n} squares, not {all}",
            n=f"{counted[0]} × {counted[1]}",
            all=f"{board.columns} × {board.rows}",
        ),
        where=name,
        todo=Message("advice.check_squares", "check {fields}", fields=Field("target.columns and rows")),
        counted=counted,
    )


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


def _no_marker(
    board: Charuco, dictionary: cv2.aruco.Dictionary, picture: NDArray[np.uint8], name: str
) -> TargetNotFound:
    others = cv2.aruco.ArucoDetector(dictionary).detectMarkers(picture)[1]
    if others is not None and len(others):
        return TargetNotFound(
            Message(
                "target.other_markers",
                "the picture shows markers from {lowest} to {highest}, none of the board's, {first} to {last}",
                lowest=int(np.min(others)),
                highest=int(np.max(others)),
                first=board.first_id,
                last=board.first_id + board.columns * board.rows // 2 - 1,
            ),
            where=name,
            todo=Message("advice.check_first_id", "check first_id, or show this board"),
        )
    return TargetNotFound(
        Message("target.no_marker", "no marker of {name} is seen in the picture", name=board.dictionary_id),
        where=name,
        todo=Message(
            "advice.check_dictionary_or_leave_out",
            "check the {field}, or leave the picture out",
            field=Field("target.dictionary"),
        ),
    )


def _few_corners(markers: int, name: str) -> TargetNotFound:
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
