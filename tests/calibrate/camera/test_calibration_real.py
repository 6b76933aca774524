"""The camera calibration against published results on real pictures."""

import cv2
import numpy as np
import pytest

from core.calibrate.camera.calibration import calibrate_camera
from core.calibrate.camera.options import CameraOptions
from core.image.targets.target_view import TargetView
from tests.shared import REAL_SETS

SIZE = (640, 480)


@pytest.fixture(scope="module")
def zhang_views() -> list[TargetView]:
    folder = REAL_SETS / "zhang-original"
    if not folder.is_dir():
        pytest.skip("Zhang's corner data is not on this machine")
    model = np.loadtxt(folder / "Model.txt").reshape(-1, 2)
    points = np.column_stack([model, np.zeros(len(model))])
    return [
        TargetView(points, np.loadtxt(folder / f"data{i}.txt").reshape(-1, 2), np.ones(len(points)), f"data{i}.txt")
        for i in range(1, 6)
    ]


@pytest.fixture(scope="module")
def left_views() -> list[TargetView]:
    folder = REAL_SETS / "opencv-left13"
    if not folder.is_dir():
        pytest.skip("OpenCV's left pictures are not on this machine")
    x, y = np.meshgrid(np.arange(9), np.arange(6))
    points: np.ndarray = np.column_stack([x.ravel(), y.ravel(), np.zeros(54)]) * 25.0
    stop = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 30, 0.001)
    views = []
    for path in sorted(folder.glob("left*.jpg")):
        picture = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
        assert picture is not None
        found, corners = cv2.findChessboardCorners(picture, (9, 6))
        assert found
        corners = cv2.cornerSubPix(picture, corners, (11, 11), (-1, -1), stop)
        views.append(TargetView(points, corners.reshape(-1, 2).astype(np.float64), np.ones(54), path.name))
    return views


@pytest.mark.parametrize("outliers", ["keep", "gross", "all"])
def test_zhangs_own_corners_give_his_published_camera(zhang_views, outliers):
    options = CameraOptions(skew=True, fixed=frozenset({"p1", "p2"}), outliers=outliers)
    calibration = calibrate_camera(zhang_views, SIZE, options)
    matrix, (k1, k2, *_) = calibration.camera.matrix, calibration.camera.distortion
    assert [matrix[0, 0], matrix[1, 1]] == pytest.approx([832.5, 832.53], abs=0.05)
    assert [matrix[0, 2], matrix[1, 2]] == pytest.approx([303.959, 206.585], abs=0.05)
    assert matrix[0, 1] == pytest.approx(0.204494, abs=0.005)
    assert [k1, k2] == pytest.approx([-0.228601, 0.190353], abs=0.0005)
    assert calibration.rms_px == pytest.approx(0.3364, abs=0.001)
    assert sum(quality.used for quality in calibration.views) == 5


def test_left13_without_outlier_rules_is_opencvs_result(left_views):
    options = CameraOptions(skew=False, k3=True, outliers="keep")
    calibration = calibrate_camera(left_views, SIZE, options)
    matrix = calibration.camera.matrix
    found = [matrix[0, 0], matrix[1, 1], matrix[0, 2], matrix[1, 2]]
    assert found == pytest.approx([536.0735, 536.0164, 342.3705, 235.5369], abs=0.05)
    assert calibration.rms_px == pytest.approx(0.40869, abs=0.0005)


def test_left13_by_default_stays_within_half_a_pixel_of_the_table_and_names_the_bad_view(left_views):
    calibration = calibrate_camera(left_views, SIZE, CameraOptions(skew=False, k3=True))
    matrix = calibration.camera.matrix
    found = [matrix[0, 0], matrix[1, 1], matrix[0, 2], matrix[1, 2]]
    assert found == pytest.approx([536.07, 536.02, 342.37, 235.54], abs=0.5)
    assert calibration.rms_px == pytest.approx(0.409, abs=0.02)
    assert calibration.ranked[-1].view.name == "left02.jpg"
    assert any(str(note).startswith("left02.jpg fits") for note in calibration.notes)


def test_left13_with_all_misfound_corners_left_out_fits_twice_as_well(left_views):
    calibration = calibrate_camera(left_views, SIZE, CameraOptions(skew=False, k3=True, outliers="all"))
    assert calibration.rms_px < 0.2
    assert all(quality.used for quality in calibration.views)
    assert 4 <= (~calibration.views[1].counted).sum() <= 8
