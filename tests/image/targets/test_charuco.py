"""ChArUco boards, whole and in part, against the analytic truth of rendered pictures."""

import cv2
import numpy as np
import pytest

from core.image.targets import Charuco, TargetNotFound, detect
from core.image.targets.target_view import OtherBoard
from tests.image.rendered_targets import Noise, board_picture, pose, render, rig

BOARD = Charuco(9, 7, 10.0, 7.0, "4X4_50")
CAMERA = rig(1 / 4)
WHERE = pose(20, -15, 7, (45, 35), 420)


def printed(legacy=False, rows=7, markers=cv2.aruco.DICT_4X4_50):
    dictionary = cv2.aruco.getPredefinedDictionary(markers)
    board = cv2.aruco.CharucoBoard((9, rows), 10.0, 7.0, dictionary)
    board.setLegacyPattern(legacy)
    return board_picture(board.generateImage((900, 100 * rows)), 0.1)


@pytest.fixture(scope="module")
def picture():
    return render(CAMERA, WHERE, printed(), noise=Noise(1), samples=4)


def errors(view):
    return view.uv - CAMERA.project_pose(WHERE, view.points)


def test_a_whole_board_gives_all_its_corners(picture):
    view = detect(BOARD, picture)
    assert np.array_equal(view.points, BOARD.points)
    assert np.sqrt(np.mean(errors(view) ** 2)) < 0.05


def test_a_part_of_the_board_gives_the_corners_it_shows(picture):
    view = detect(BOARD, np.ascontiguousarray(picture[:, :475]))
    assert 10 < len(view.uv) < 40
    assert np.abs(errors(view)).max() < 0.15


def test_boards_of_the_pattern_before_opencv_4_6_are_read():
    old = render(CAMERA, WHERE, printed(legacy=True, rows=6), samples=4)
    view = detect(Charuco(9, 6, 10.0, 7.0), old)
    assert len(view.uv) == 40
    assert np.abs(errors(view)).max() < 0.15


@pytest.mark.parametrize("family", ["16h5", "25h9", "36h10", "36h11"])
def test_boards_of_april_tags_are_read(family):
    shown = render(CAMERA, WHERE, printed(rows=5, markers=getattr(cv2.aruco, f"DICT_APRILTAG_{family}")), samples=4)
    view = detect(Charuco(9, 5, 10.0, 7.0, f"DICT_APRILTAG_{family}"), shown)
    assert len(view.uv) == 32
    assert np.abs(errors(view)).max() < 0.15


def test_the_wrong_dictionary_and_a_foreign_picture_are_named(picture):
    with pytest.raises(TargetNotFound, match=r"no marker of DICT_7X7_50 is seen.*check the dictionary"):
        detect(Charuco(9, 7, 10.0, 7.0, "DICT_7X7_50"), picture)
    with pytest.raises(TargetNotFound, match="fewer than 6 of its corners"):
        detect(BOARD, np.ascontiguousarray(picture[:, :385]))


@pytest.mark.parametrize(("columns", "rows"), [(8, 7), (10, 7), (7, 9), (8, 6)])
def test_a_board_counted_wrongly_is_counted(picture, columns, rows):
    with pytest.raises(OtherBoard, match=f"shows 9 × 7 squares, not {columns} × {rows}") as told:
        detect(Charuco(columns, rows, 10.0, 7.0), picture)
    assert told.value.counted == (9, 7)


def test_the_old_pattern_is_counted_as_well():
    old = render(CAMERA, WHERE, printed(legacy=True, rows=6), samples=4)
    with pytest.raises(OtherBoard) as told:
        detect(Charuco(10, 6, 10.0, 7.0), old)
    assert told.value.counted == (9, 6)


def test_a_board_that_goes_on_beyond_the_picture_is_not_counted(picture):
    with pytest.raises(TargetNotFound, match="show more of the board") as told:
        detect(Charuco(8, 7, 10.0, 7.0), np.ascontiguousarray(picture[:, :475]))
    assert not isinstance(told.value, OtherBoard)


def test_impossible_boards_are_refused():
    with pytest.raises(ValueError, match="marker_mm"):
        Charuco(9, 7, 10.0, 12.0)
    with pytest.raises(ValueError, match="dictionary"):
        Charuco(9, 7, 10.0, 7.0, "4x4_51")
