"""k3 is solved for only where that surely predicts pictures left out better."""

from dataclasses import replace

import numpy as np
import pytest

from core.calibrate.camera.bundle import NO_PARAMETERS, Bundle, Observed, refine, residual_lengths
from core.calibrate.camera.calibration import calibrate_camera
from core.calibrate.camera.options import CameraOptions
from core.calibrate.camera.skew import FEWEST_VIEWS
from core.calibrate.camera.third_radial import K3, left_out_misfits, third_radial
from core.image.targets import Checkerboard
from core.image.targets.target_view import TargetView
from core.model import Camera
from core.pipeline.steps.camera_step import solved_for
from core.simulate.poses import camera_poses
from core.simulate.rig import DISTORTION, FULL_MATRIX, FULL_SIZE
from core.simulate.scene.boards import printed
from core.simulate.scene.image import generator
from tests.calibrate.camera_views import TRUTH, synthetic_views

PAPER = Camera(FULL_SIZE, np.array(FULL_MATRIX), np.array(DISTORTION))
TARGET = Checkerboard(17, 12, 10.0)
POINTS = TARGET.points
VIEWS, NEAREST_MM = 14, 450.0
NOISE_PX = 0.02
FREE = np.array([0, 1, 3, 4, 5, 6, 7, 8])


def with_k3(camera, k3):
    matrix = camera.matrix.copy()
    matrix[0, 1] = 0.0
    return Camera(camera.image_size, matrix, [*camera.distortion[:4], k3])


def seen(seed, k3, scale=0.25):
    """Views of a lens with this k3, all over the picture, and the camera; at quarter size."""
    camera = with_k3(PAPER.scaled(scale), k3)
    rng, points = np.random.default_rng(seed), POINTS
    drawn = generator(seed, "camera poses")
    poses = tuple(camera_poses(PAPER, printed(TARGET).outline, VIEWS, drawn, nearest_mm=NEAREST_MM))
    views = [
        Observed(
            points, camera.project_pose(pose, points) + rng.normal(0, NOISE_PX, (len(points), 2)), np.ones(len(points))
        )
        for pose in poses
    ]
    return Bundle(camera, poses), views


def solved_without(seed, k3, scale=0.25):
    truth, views = seen(seed, k3, scale)
    return refine(replace(truth, camera=with_k3(truth.camera, 0.0)), views, FREE), views


def views_of(k3, seed=2):
    """The same as a detector hands them over, and the size of the picture."""
    truth, views = seen(seed, k3)
    some = slice(None, None, 3)  # of their points, for time
    sigma = np.full(len(POINTS[some]), NOISE_PX)
    of_target = [TargetView(view.points[some], view.uv[some], sigma, f"{n}") for n, view in enumerate(views)]
    return of_target, truth.camera.image_size


def test_leaving_a_picture_out_by_one_step_is_as_solving_again_without_it():
    solved, views = solved_without(1, 1.0)
    for bundle, free in ((solved, FREE), (refine(solved, views, np.append(FREE, K3)), np.append(FREE, K3))):
        foretold = left_out_misfits(bundle, views, free)
        for left in (0, 5, 13):
            rest = [i for i in range(len(views)) if i != left]
            camera = refine(bundle.of_views(rest), [views[i] for i in rest], free).camera
            alone = refine(Bundle(camera, (bundle.poses[left],)), [views[left]], NO_PARAMETERS)
            again = float(np.sum(residual_lengths(alone, [views[left]])[0] ** 2))
            assert foretold[left] == pytest.approx(again, rel=0.02)


@pytest.mark.parametrize("k3", [0.3, 1.0, 3.0])
def test_a_lens_with_k3_gets_it_and_is_told_what_it_does(k3):
    found = third_radial(*solved_without(3, k3), FREE)
    assert found is not None
    assert found.gain > 2 * found.gain_error > 0
    assert found.px == pytest.approx(0.2 * k3, rel=0.3)
    assert found.mm == pytest.approx(found.px * found.depth_mm / (PAPER.focal / 4), rel=0.01)


def test_a_lens_without_k3_keeps_the_simpler_model():
    assert [third_radial(*solved_without(seed, 0.0), FREE) for seed in range(3)] == [None] * 3


@pytest.mark.accuracy
def test_a_lens_without_k3_keeps_the_simpler_model_98_times_of_100():
    assert sum(third_radial(*solved_without(seed, 0.0), FREE) is not None for seed in range(100)) <= 2


def test_few_views_do_not_tell():
    solved, views = solved_without(3, 3.0)
    few = range(FEWEST_VIEWS - 1)
    assert third_radial(solved.of_views(few), [views[i] for i in few], FREE) is None


def test_by_itself_the_solution_is_that_with_k3_free_where_it_is_taken_and_is_told_first():
    views, size = views_of(2.0)
    by_itself = calibrate_camera(views, size)
    asked_for = calibrate_camera(views, size, CameraOptions(k3=True))
    assert np.array_equal(by_itself.camera.distortion, asked_for.camera.distortion)
    assert np.array_equal(by_itself.covariance, asked_for.covariance)
    assert solved_for(by_itself)["k3"]
    assert by_itself.camera.distortion[4] == pytest.approx(2.0, abs=0.3)
    note, *others = by_itself.notes
    assert note.code == "camera.third_radial"
    assert tuple(others) == asked_for.notes
    zero = calibrate_camera(views, size, CameraOptions(k3=False))
    assert zero.camera.distortion[4] == zero.sd["k3"] == 0


def test_where_it_is_not_taken_the_numbers_are_those_without_it_to_the_last_bit():
    views, size = views_of(0.0)
    by_itself = calibrate_camera(views, size)
    without = calibrate_camera(views, size, CameraOptions(k3=False))
    assert np.array_equal(by_itself.camera.distortion, without.camera.distortion)
    assert np.array_equal(by_itself.camera.matrix, without.camera.matrix)
    assert np.array_equal(by_itself.covariance, without.covariance)
    assert by_itself.notes == without.notes
    assert by_itself.sd["gamma"] > 0 == by_itself.camera.matrix[0, 1]
    assert solved_for(by_itself) == {"skew": False, "k3": False}


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.accuracy)])
def test_a_bowed_target_is_no_k3(seed):
    views = synthetic_views(seed, shape=(1.0, -0.5, 0.3, 0.0))
    assert calibrate_camera(views, TRUTH.image_size).camera.distortion[4] == 0


def test_with_fewer_radial_coefficients_by_hand_there_is_no_third():
    calibration = calibrate_camera(*views_of(2.0), CameraOptions(fixed=frozenset({"k2"})))
    assert calibration.camera.distortion[4] == 0
