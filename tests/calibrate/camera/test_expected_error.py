"""The error to be expected over the picture, against cameras drawn from the covariance and against the truth."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import Delaunay

from core.calibrate.camera.bundle import Bundle, Observed, refine, residuals
from core.calibrate.camera.calibration import calibrate_camera
from core.calibrate.camera.expected_error import expected_error, residual_field
from core.calibrate.camera.options import CameraOptions
from core.calibrate.camera.reprojection import camera_of, parameters_of
from core.image.exclusion import Exclusion
from core.model import Pose
from tests.calibrate.camera_views import TRUTH, synthetic_views

GRID = (9, 7)
NO_PARAMETERS = np.zeros(0, dtype=np.intp)


@pytest.fixture(scope="module")
def calibration():
    return calibrate_camera(synthetic_views(1), TRUTH.image_size)


@pytest.fixture(scope="module")
def expected(calibration):
    return expected_error(calibration, grid=GRID)


def corner_depths(calibration):
    return np.concatenate([view.pose.apply(view.view.points)[:, 2] for view in calibration.views if view.used])


def distances(true, camera, calibration, expected):
    """Distance in mm across the ray between what two cameras see, `camera` moved to where it fits the work volume."""
    depths, corners = corner_depths(calibration), residual_field(calibration).uv
    axes = [np.linspace(corners[:, i].min(), corners[:, i].max(), count) for i, count in enumerate((20, 16))]
    spread = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
    inside = spread[Delaunay(corners).find_simplex(spread) >= 0]
    pixels, z = np.tile(inside, (3, 1)), np.repeat(np.linspace(depths.min(), depths.max(), 3), len(inside))
    volume = Observed(true.rays(pixels) * z[:, None], pixels, z**2)
    pose = refine(Bundle(camera, (Pose.identity(),)), [volume], NO_PARAMETERS).poses[0]
    uv = expected.uv.reshape(-1, 2)
    here = Observed(true.rays(uv) * expected.depth_mm, uv, np.ones(len(uv)))
    across = camera.ray_jacobian(camera.rays(uv)) @ residuals(camera, pose, here)[:, :, None]
    return (np.linalg.norm(across[:, :, 0], axis=1) * expected.depth_mm).reshape(expected.error_mm.shape)


@pytest.mark.accuracy
def test_cameras_drawn_from_the_covariance_scatter_as_expected(calibration, expected):
    rng = np.random.default_rng(4)
    camera = calibration.camera
    drawn = rng.multivariate_normal(parameters_of(camera), calibration.covariance, size=250, method="eigh")
    squares = [distances(camera, camera_of(one, camera.image_size), calibration, expected) ** 2 for one in drawn]
    ratio = np.sqrt(np.mean(squares, axis=0)) / expected.error_mm
    assert np.abs(ratio - 1).max() < 0.15


@pytest.mark.accuracy
def test_calibrations_miss_the_truth_by_as_much_as_they_expect():
    shares = []
    for seed in range(12):
        calibration = calibrate_camera(
            synthetic_views(seed, count=10), TRUTH.image_size, CameraOptions(outliers="keep")
        )
        expected = expected_error(calibration, grid=GRID)
        shares.append((distances(TRUTH, calibration.camera, calibration, expected) / expected.error_mm) ** 2)
    assert np.sqrt(np.mean(shares)) == pytest.approx(1, abs=0.3)


def test_the_error_is_smallest_where_the_corners_were(expected):
    inside, outside = expected.error_mm[expected.covered], expected.error_mm[~expected.covered]
    assert 0 < np.median(inside) < 0.5 * np.median(outside)
    assert expected.worst_mm == expected.error_mm.max()
    assert expected.median_mm == np.median(expected.error_mm)


def test_the_grid_spans_the_picture_in_rows_and_columns(expected):
    columns, rows = GRID
    assert expected.uv.shape == (rows, columns, 2)
    assert expected.error_mm.shape == expected.covered.shape == (rows, columns)
    assert expected.uv[0, 0].tolist() == [0, 0]
    assert expected.uv[-1, -1].tolist() == [TRUTH.image_size[0] - 1, TRUTH.image_size[1] - 1]


def test_depth_is_the_middle_of_the_corners_unless_given(calibration, expected):
    depths = corner_depths(calibration)
    assert expected.depth_mm == pytest.approx((depths.min() + depths.max()) / 2)
    far = expected_error(calibration, 1200.0, GRID)
    assert far.depth_mm == 1200
    assert far.median_mm > 2 * expected.median_mm


@pytest.mark.accuracy
def test_more_views_promise_less_error():
    few, many = (calibrate_camera(synthetic_views(3, count=count), TRUTH.image_size) for count in (6, 24))
    assert expected_error(many, 540.0).median_mm < expected_error(few, 540.0).median_mm


def test_a_shift_of_the_centre_is_for_the_most_part_a_turn_of_the_frame(calibration):
    shifted = np.zeros((10, 10))
    shifted[3, 3] = 1.0  # one pixel of u0: 0.2 mm at this distance
    found = expected_error(replace(calibration, covariance=shifted))
    assert found.depth_mm / calibration.camera.focal > 0.2
    assert found.median_mm < 0.03


def test_residuals_are_those_of_the_corners_that_count_in_used_views(calibration):
    views = list(calibration.views)
    views[2] = replace(views[2], used=False, exclusion=Exclusion.BY_HAND)
    keep = views[5].counted.copy()
    keep[:7] = False
    views[5] = replace(views[5], counted=keep)
    field = residual_field(replace(calibration, views=tuple(views)))
    assert set(field.view) == set(range(len(views))) - {2}
    assert np.count_nonzero(field.view == 5) == np.count_nonzero(keep)
    assert np.array_equal(field.uv[field.view == 5], views[5].view.uv[keep])
    assert np.array_equal(field.residual[field.view == 5], views[5].residuals[keep])
    rms = np.sqrt(np.mean(np.sum(residual_field(calibration).residual ** 2, axis=1)))
    assert rms == pytest.approx(calibration.rms_px)


def test_without_a_used_view_there_is_nothing_to_expect(calibration):
    unused = replace(calibration, views=tuple(replace(view, used=False) for view in calibration.views))
    assert len(residual_field(unused).uv) == 0
    with pytest.raises(ValueError, match="no view was used"):
        expected_error(unused)
    with pytest.raises(ValueError, match="grid"):
        expected_error(calibration, -5.0)
