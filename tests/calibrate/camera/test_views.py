"""What views are worth together, and two calibrations side by side."""

from dataclasses import replace

import numpy as np
import pytest

from core.calibrate.camera.calibration import calibrate_camera
from core.calibrate.camera.changes import camera_changes
from core.calibrate.camera.views import SeenView, SeenViews, judge_views, recovered_views
from core.calibrate.results import CAMERA_PARAMETERS
from core.image.targets.target_view import TargetView
from core.messages import plain
from tests.calibrate.camera_views import TRUTH, synthetic_views


@pytest.fixture(scope="module")
def calibration():
    return calibrate_camera(synthetic_views(1), TRUTH.image_size)


def test_the_views_of_a_calibration_can_be_solved_again_without_their_pictures(calibration):
    seen = recovered_views(calibration, "somewhere")
    again = calibrate_camera(seen.found, seen.size)
    assert seen.size == TRUTH.image_size
    assert np.array_equal(again.camera.matrix, calibration.camera.matrix)


def test_a_lost_view_stays_lost_when_seen_again(calibration):
    nothing = TargetView(np.zeros((0, 3)), np.zeros((0, 2)), np.zeros(0), "camera/empty.png")
    lost = replace(calibration.views[0], view=nothing, used=False, exclusion=plain("no board"))
    seen = recovered_views(replace(calibration, views=(*calibration.views, lost)), "somewhere")
    assert [(one.name, str(one.reason)) for one in seen.lost] == [("camera/empty.png", "no board")]


def test_views_are_judged_with_and_without_a_calibration(calibration):
    seen = recovered_views(calibration, "somewhere")
    alone, solved = judge_views(seen), judge_views(seen, (), calibration)
    assert alone.expected == () and alone.residuals is None
    near, middle, far = solved.expected
    assert near.depth_mm < middle.depth_mm < far.depth_mm
    assert 0 < near.median_mm < far.median_mm
    assert np.array_equal(alone.cells, solved.cells)
    assert alone.cells.any()
    assert solved.cells.mean() == calibration.coverage, "the map has the share that is told"


def test_views_left_out_cover_nothing(calibration):
    seen = recovered_views(calibration, "somewhere")
    judged = judge_views(seen, {view.name for view in seen.found})
    assert not judged.cells.any()
    assert "there is none" in str(judged.missing[0])


def test_no_readable_picture_is_judged_too():
    judged = judge_views(SeenViews((SeenView("camera/a.png", exclusion=plain("damaged")),), "somewhere"))
    assert not judged.cells.any()


def test_a_calibration_does_not_change_against_itself(calibration):
    same = camera_changes(calibration, calibration)
    assert [one.name for one in same.parameters] == list(CAMERA_PARAMETERS)
    assert not any(one.change or one.unlikely for one in same.parameters)


def test_two_calibrations_of_one_camera_differ_within_their_uncertainties(calibration):
    other = calibrate_camera(synthetic_views(7), TRUTH.image_size)
    changes = camera_changes(calibration, other)
    focal = changes.parameters[0]
    assert focal.change == pytest.approx(other.camera.matrix[0, 0] - calibration.camera.matrix[0, 0])
    assert focal.sd == pytest.approx(np.hypot(calibration.sd["alpha"], other.sd["alpha"]))
    assert sum(one.unlikely for one in changes.parameters) <= 1
