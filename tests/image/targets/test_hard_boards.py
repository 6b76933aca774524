"""Checkerboards that are hard to find: small, blurred, among clutter, cut by the picture's border."""

import numpy as np
import pytest

from core.image.targets import Checkerboard, TargetNotFound, detect
from core.image.targets.checkerboard import detect_checkerboard
from core.model import Camera
from tests.image.rendered_targets import Noise, checkers, pose, render
from tests.shared import REAL_SETS

BOARD = Checkerboard(9, 6, 10.0)
CAMERA = Camera((960, 720), np.array([[1250.0, 0, 480], [0, 1250, 360], [0, 0, 1]]), np.array([-0.08, 0.1, 0.0, 0.0]))
MIDDLE = (40, 25)
LEFT13 = REAL_SETS / "opencv-left13"


def seen(where, board=BOARD, seed=1, **how):
    how = {"noise": Noise(2.0, seed), "samples": 2} | how
    return render(CAMERA, where, checkers(board.columns, board.rows, board.square_mm), **how)


def cluttered(picture, keep, seed=2, amplitude=120, size=6):
    """The picture with squares of random brightness outside the box `keep` (u0, v0, u1, v1)."""
    cells = np.random.default_rng(seed).uniform(-1, 1, (picture.shape[0] // size + 1, picture.shape[1] // size + 1))
    texture = np.kron(cells, np.ones((size, size)))[: picture.shape[0], : picture.shape[1]]
    outside = np.ones(picture.shape, dtype=bool)
    outside[keep[1] : keep[3], keep[0] : keep[2]] = False
    return np.where(outside, np.clip(120 + amplitude * texture, 0, 255), picture).astype(np.uint8)


def box_of(where, margin=16):
    uv = CAMERA.project_pose(where, np.array([[-10, -10, 0], [90, -10, 0], [90, 60, 0], [-10, 60, 0.0]]))
    low, high = np.rint(uv.min(axis=0)).astype(int) - margin, np.rint(uv.max(axis=0)).astype(int) + margin
    return (*low.clip(0), *high)


def errors(view, where, board=BOARD):
    return np.linalg.norm(view.uv - CAMERA.project_pose(where, view.points), axis=1)


def test_a_small_board_far_away():
    where = pose(20, -10, 14, MIDDLE, 1900)  # squares of 6.5 pixels
    assert errors(detect(BOARD, seen(where)), where).max() < 0.5


@pytest.mark.accuracy
def test_a_small_board_among_clutter_with_more_saddles_than_the_quick_search_looks_at():
    where = pose(20, -10, 14, MIDDLE, 1000)
    picture = cluttered(seen(where, grey=(90, 150)), box_of(where))
    with pytest.raises(TargetNotFound):
        detect(BOARD, picture, thorough=False)
    assert errors(detect(BOARD, picture), where).max() < 0.5


def test_a_board_out_of_focus():
    where = pose(15, 20, -30, MIDDLE, 520)
    view = detect(BOARD, seen(where, blur=5.0))
    assert np.sqrt(np.mean(errors(view, where) ** 2)) < 0.25


def test_clutter_alone_is_no_board():
    with pytest.raises(TargetNotFound):
        detect(BOARD, cluttered(np.full((720, 960), 200, dtype=np.uint8), (0, 0, 0, 0)))


@pytest.mark.accuracy
@pytest.mark.parametrize("shape", [(8, 5), (8, 6), (10, 7)])
def test_no_detector_takes_a_board_of_another_size_for_a_part_of_it(shape):
    where = pose(15, 20, -30, MIDDLE, 500)
    with pytest.raises(TargetNotFound):
        detect(Checkerboard(*shape, 10.0), seen(where))


CUTS = {
    "left": pose(10, 15, 8, MIDDLE, 260, (-95, 0)),
    "right": pose(10, 15, 188, MIDDLE, 260, (95, 0)),
    "corner": pose(-15, 10, -20, MIDDLE, 230, (55, 40)),
}


@pytest.mark.accuracy
@pytest.mark.parametrize("name", CUTS)
def test_a_board_cut_at_one_end_of_each_direction_is_known_by_the_other_ends(name):
    where = CUTS[name]
    view = detect(BOARD, seen(where), name)
    assert 14 <= len(view.points) < 54
    assert view.placed
    assert errors(view, where).max() < 0.3


@pytest.mark.accuracy
def test_a_board_cut_at_both_ends_is_refused_for_the_camera_and_taken_for_its_plane():
    where = pose(15, 15, 5, MIDDLE, 105)
    picture = seen(where)
    with pytest.raises(TargetNotFound) as raised:
        detect(BOARD, picture, "cut.png", CAMERA)
    assert raised.value.what.code == "target.part_anywhere"
    view = detect(BOARD, picture, "cut.png", CAMERA, plane_only=True)
    assert not view.placed
    shift = (view.uv - CAMERA.project_pose(where, view.points))[0]
    assert np.linalg.norm(shift) > 50 or len(view.points) < 54  # which corners they are is not known
    # … but that they are corners is: each is where some corner of an endless board would be
    j, i = np.mgrid[-10:20, -10:20]
    endless = np.column_stack([i.ravel() * 10.0, j.ravel() * 10.0, np.zeros(i.size)])
    endless = endless[where.apply(endless)[:, 2] > 10]
    uv = CAMERA.project_pose(where, endless)
    assert np.linalg.norm(view.uv[:, None] - uv, axis=2).min(axis=1).max() < 0.3


@pytest.mark.accuracy
def test_a_board_on_dark_ground_may_be_counted_without_the_corners_of_its_outer_squares():
    where = pose(15, 10, 20, MIDDLE, 500)
    light_on_dark = 230 - seen(where)  # 9 × 6 corners; its outer dark squares melt into the ground
    view = detect(Checkerboard(7, 4, 10.0), light_on_dark)
    there = [70.0, 40.0, 0.0] - view.points  # its first corner has a black square outside: the other end than before
    assert np.linalg.norm(view.uv - CAMERA.project_pose(where, there), axis=1).max() < 0.3
    with pytest.raises(TargetNotFound, match="shows 9 × 6 inner corners"):
        detect(Checkerboard(7, 4, 10.0), seen(where))


def test_the_thorough_search_finds_what_the_quick_one_finds():
    where = pose(20, -10, 14, MIDDLE, 500)
    picture = seen(where)
    quick = detect_checkerboard(BOARD, picture, thorough=False)
    assert np.array_equal(quick.uv, detect_checkerboard(BOARD, picture).uv)


@pytest.mark.skipif(not LEFT13.is_dir(), reason="the real pictures of opencv-left13 are not on this machine")
@pytest.mark.parametrize("width", [pytest.param(320, marks=pytest.mark.accuracy), 200])
def test_left13_is_found_in_small_pictures_too(width):
    import cv2

    for file in sorted(LEFT13.glob("*.jpg")):
        picture = cv2.imread(str(file), cv2.IMREAD_GRAYSCALE)
        factor = 640 / width
        small = cv2.resize(picture, (width, round(480 / factor)), interpolation=cv2.INTER_AREA)
        uv = (detect(BOARD, small, file.name).uv + 0.5) * factor - 0.5
        assert np.median(np.linalg.norm(uv - detect(BOARD, picture).uv, axis=1)) < 0.2 * factor
