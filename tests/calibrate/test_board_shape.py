"""A board that is bowed or not printed true, found by its views and taken into account."""

import numpy as np
import pytest

from core.calibrate.board_shape import BoardShape, BoardTolerance
from core.calibrate.camera.calibration import calibrate_camera
from core.calibrate.camera.options import CameraOptions
from core.calibrate.camera.reprojection import parameters_of
from core.calibrate.results import CameraCalibration
from tests.calibrate.camera_views import TRUTH, synthetic_views

FLAT = BoardTolerance(0.0, 0.0)
UNSURE = BoardTolerance(0.2, 0.0)
TRUE = parameters_of(TRUTH)
BENT = (0.25, -0.1, 0.15, 0.0)


def calibrated(seed: int, shape=None, tolerance: BoardTolerance | None = None) -> CameraCalibration:
    views, skewed = synthetic_views(seed, shape=shape), CameraOptions(skew=True)
    return calibrate_camera(views, TRUTH.image_size, skewed, tolerance=tolerance)


def focal_error(calibration: CameraCalibration) -> float:
    return float(np.abs(parameters_of(calibration.camera) - TRUE)[:2].max())


def test_a_bowed_board_is_found_and_does_not_spoil_the_camera():
    found, blind = calibrated(1, BENT), calibrated(1, BENT, FLAT)
    assert (np.abs(found.board.values - BENT)[:3] < 4 * found.board.sd[:3]).all()
    assert (found.board.sd[:3] < 0.01).all()
    assert found.rms_px == pytest.approx(0.03 * np.sqrt(2), rel=0.05)
    assert blind.rms_px > 1.5 * found.rms_px
    assert focal_error(found) < 0.3 * focal_error(blind)
    assert found.board.departure_mm == pytest.approx(0.425, abs=0.02)  # from the middle of two edges to two corners
    assert any("bowed by 0.4" in str(note) for note in found.notes)


@pytest.mark.accuracy
def test_a_flat_board_is_found_flat_and_nothing_is_lost():
    shaped, flat = zip(
        *[(calibrated(seed, tolerance=UNSURE), calibrated(seed, tolerance=FLAT)) for seed in range(2, 8)], strict=True
    )
    z = np.array([one.board.values[:3] / one.board.sd[:3] for one in shaped])
    assert 0.6 < np.sqrt(np.mean(z**2)) < 1.5
    assert np.mean([one.sd["alpha"] for one in shaped]) < 1.25 * np.mean([one.sd["alpha"] for one in flat])
    assert not any("bowed" in str(note) for one in shaped for note in one.notes)
    assert (calibrated(2).camera.matrix == flat[0].camera.matrix).all()  # where nothing is said, it is taken as flat


@pytest.mark.accuracy
def test_the_cameras_covariance_holds_beside_an_unknown_shape():
    errors = []
    for seed in range(20, 32):
        calibration = calibrated(seed, BENT)
        sd = np.sqrt(np.diag(calibration.covariance))[:9]
        errors.append((parameters_of(calibration.camera) - TRUE)[:9] / sd)
    assert 0.8 < np.sqrt(np.mean(np.square(errors))) < 1.25


@pytest.mark.accuracy
def test_a_print_that_is_drawn_out_is_found_where_its_size_is_not_sure():
    drawn = (0.0, 0.0, 0.0, 4e-4)
    true, unsure = calibrated(9, drawn), calibrated(9, drawn, BoardTolerance(scale_sd=3e-4))
    assert true.board.values[3] == 0
    assert unsure.board.values[3] == pytest.approx(4e-4, abs=4 * unsure.board.sd[3])
    assert focal_error(unsure) < 0.7 * focal_error(true)
    print_is_true, nothing_said = calibrated(9, tolerance=BoardTolerance(scale_sd=3e-4)), calibrated(9)
    assert 0.9 < print_is_true.sd["alpha"] / nothing_said.sd["alpha"] < 1.5


def test_residuals_take_the_shape_into_account_also_of_views_left_out():
    views = synthetic_views(1, shape=BENT)
    calibration = calibrate_camera(views, TRUTH.image_size, excluded={views[3].name})
    for quality in calibration.views:
        points = calibration.board.shaped(quality.view.points)
        again = quality.view.uv - calibration.camera.project_pose(quality.pose, points)
        assert again == pytest.approx(quality.residuals, abs=1e-9)
        assert quality.rms_px == pytest.approx(0.03 * np.sqrt(2), rel=0.2)


def test_a_shape_is_only_believed_when_it_is_sure_or_expected():
    nearly = (0.002, 0.0, 0.0, 0.0)
    assert not calibrated(5, nearly).board.values.any()
    assert calibrated(5, nearly, BoardTolerance(0.2, 0.0)).board.values[:3].all()
    assert calibrated(5, (0.05, 0, 0, 0)).board.values[0] == pytest.approx(0.05, abs=0.01)


def test_absurd_tolerances_are_refused():
    with pytest.raises(ValueError, match="flatness of −1"):
        BoardTolerance(flatness_mm=-1)
    with pytest.raises(ValueError, match=r"uncertainty of 0\.5"):
        BoardTolerance(scale_sd=0.5)
    assert BoardShape().departure_mm == 0
