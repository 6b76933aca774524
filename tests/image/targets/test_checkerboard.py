"""Checkerboards against the analytic truth of rendered pictures, and against OpenCV's published calibration."""

import cv2
import numpy as np
import pytest

from core.image.targets import Checkerboard, TargetNotFound, checkerboard, detect
from core.model import Camera
from tests.image.rendered_targets import Noise, checkers, pose, render, rig
from tests.shared import REAL_SETS

BOARD = Checkerboard(9, 6, 10.0)
CAMERA = rig(1 / 4)
POSES = {
    "frontal": pose(0, 0, 3, (40, 25), 500),
    "tilted": pose(30, -12, 14, (40, 25), 500),
    "turned": pose(-20, 35, -40, (40, 25), 500),
}
LEFT13 = REAL_SETS / "opencv-left13"


@pytest.fixture(scope="module")
def tilted():
    return render(CAMERA, POSES["tilted"], checkers(9, 6, 10.0), noise=Noise(2), samples=3)


@pytest.mark.parametrize("name", POSES)
def test_corners_of_a_noise_free_board_are_true_to_three_hundredths_of_a_pixel(name):
    picture = render(CAMERA, POSES[name], checkers(9, 6, 10.0), blur=0.9, samples=5)
    view = detect(BOARD, picture)
    errors = view.uv - CAMERA.project_pose(POSES[name], BOARD.points)
    assert np.sqrt(np.mean(errors**2)) < 0.03
    assert np.abs(errors.mean(axis=0)).max() < 0.01


def test_large_squares_are_smoothed_and_twice_as_true():
    camera = rig(0.25)
    where = pose(20, -10, 5, (40, 25), 270)
    view = detect(BOARD, render(camera, where, checkers(9, 6, 10.0), blur=0.8, samples=5))
    assert np.sqrt(np.mean((view.uv - camera.project_pose(where, BOARD.points)) ** 2)) < 0.02


def test_windows_grow_with_the_squares_and_bring_truer_corners(monkeypatch):
    where = pose(20, -10, 5, (40, 25), 200)
    picture = render(CAMERA, where, checkers(9, 6, 10.0), blur=0.9, noise=Noise(4, 1), samples=3)
    errors = []
    for largest in (checkerboard.HALF_WINDOW, checkerboard.LARGEST_HALF_WINDOW):
        monkeypatch.setattr(checkerboard, "LARGEST_HALF_WINDOW", largest)
        view = detect(BOARD, picture)
        errors.append(np.sqrt(np.mean((view.uv - CAMERA.project_pose(where, BOARD.points)) ** 2)))
        assert 0.6 < errors[-1] / np.sqrt(np.mean(view.sigma**2)) < 1.6
    assert errors[1] < 0.8 * errors[0]


def test_windows_stay_small_where_the_lens_bends_edges():
    def window(k1):
        camera = Camera(CAMERA.image_size, CAMERA.matrix, [k1, 0, 0, 0])
        return checkerboard.half_window(camera.project_pose(where, BOARD.points).reshape(6, 9, 2))

    where = pose(20, -10, 5, (40, 25), 200)
    assert window(0.0) == 27
    assert window(-0.3) < 27
    assert window(-3.0) == checkerboard.HALF_WINDOW


def test_sigma_is_the_size_of_the_errors_under_noise():
    ratios = []
    for seed in range(3):
        picture = render(CAMERA, POSES["tilted"], checkers(9, 6, 10.0), blur=0.9, noise=Noise(5, seed), samples=3)
        view = detect(BOARD, picture)
        errors = view.uv - CAMERA.project_pose(POSES["tilted"], BOARD.points)
        ratios.append(np.mean(errors**2 / view.sigma[:, None] ** 2))
    assert 0.5 < np.sqrt(np.mean(ratios)) < 1.4


def test_first_corner_has_the_black_square_outside_however_the_board_is_turned():
    for roll in (0, 95, 180, -85):
        where = pose(10, 10, roll, (40, 25), 480)
        view = detect(BOARD, render(CAMERA, where, checkers(9, 6, 10.0), samples=2))
        assert np.abs(view.uv - CAMERA.project_pose(where, BOARD.points)).max() < 1


def test_sixteen_bit_and_dim_pictures_give_the_same_corners(tilted):
    view = detect(BOARD, tilted)
    for other in (tilted.astype(np.uint16) * 16, tilted.astype(np.uint16) * 257):
        assert np.abs(detect(BOARD, other).uv - view.uv).max() < 0.005
    assert np.abs(detect(BOARD, tilted // 6).uv - view.uv).max() < 0.3


def test_laser_stripes_across_the_board_do_not_hide_it():
    stripes = [(0.2, 1, c, 1.2, 120) for c in (390, 440, 490)]
    picture = render(CAMERA, POSES["tilted"], checkers(9, 6, 10.0), stripes=stripes, noise=Noise(1), samples=3)
    errors = np.linalg.norm(detect(BOARD, picture).uv - CAMERA.project_pose(POSES["tilted"], BOARD.points), axis=1)
    assert np.median(errors) < 0.3  # most windows hold a piece of stripe
    assert np.max(errors) < 6


@pytest.mark.parametrize(
    ("columns", "rows", "todo"),
    [
        pytest.param(8, 6, "check inner_corners", marks=pytest.mark.accuracy),
        pytest.param(11, 8, "check inner_corners", marks=pytest.mark.accuracy),
        (17, 12, "check inner_corners"),
    ],
)
def test_a_board_of_another_size_is_named(tilted, columns, rows, todo):
    with pytest.raises(TargetNotFound, match=f"shows 9 × 6 inner corners, not {columns} × {rows}.*{todo}") as raised:
        detect(Checkerboard(columns, rows, 10.0), tilted, "view07.png")
    assert str(raised.value).startswith("view07.png: ")


def test_a_part_too_small_to_be_sure_of_is_told_from_a_board_of_another_size(tilted):
    with pytest.raises(TargetNotFound, match=r"only a part of the board is in the picture: .* of its 17 × 12"):
        detect(Checkerboard(17, 12, 10.0), np.ascontiguousarray(tilted[:, :500]))


@pytest.mark.skipif(not LEFT13.is_dir(), reason="the real pictures of opencv-left13 are not on this machine")
def test_left13_gives_the_published_calibration():
    uv, size = [], None
    for file in sorted(LEFT13.glob("*.jpg")):
        picture = cv2.imread(str(file), cv2.IMREAD_GRAYSCALE)
        size = picture.shape[::-1]
        uv.append(detect(BOARD, picture, file.name).uv.astype(np.float32))
    assert len(uv) == 13
    points = [BOARD.points.astype(np.float32)] * 13
    rms, matrix, *_ = cv2.calibrateCamera(points, uv, size, None, None)
    assert rms == pytest.approx(0.4087, abs=0.001)
    assert matrix[[0, 1, 0, 1], [0, 1, 2, 2]] == pytest.approx([536.0735, 536.0164, 342.3705, 235.5369], abs=0.02)
