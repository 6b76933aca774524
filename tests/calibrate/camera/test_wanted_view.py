import cv2
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from core.calibrate.camera.capture import CaptureJudge
from core.calibrate.camera.missing import CAMERA_VIEWS, PLANE_POSES
from core.image.targets.target_view import TargetView
from core.model import Pose
from tests.calibrate.camera_views import TRUTH, board

SIZE = TRUTH.image_size
CORNERS = [0, 1, 3, 2]
"""Of the board's extent, in the order of an outline."""


def first_view() -> TargetView:
    points, rotation = board(), Rotation.from_euler("xy", (3.0, 4.0), degrees=True).as_matrix()
    middle = TRUTH.rays(np.array([[960.0, 687.0]]))[0] * 600
    return seen(Pose(rotation, middle - rotation @ points.mean(axis=0)))


def seen(pose: Pose) -> TargetView:
    points = board()
    return TargetView(points, TRUTH.project_pose(pose, points), np.full(len(points), 0.03))


def held_at(outline) -> TargetView:
    """What is seen of the board by somebody who lays it on the outline."""
    low, high = board().min(axis=0), board().max(axis=0)
    corners = np.array([[x, y, 0.0] for y in (low[1], high[1]) for x in (low[0], high[0])])[CORNERS]
    ideal = np.ascontiguousarray(TRUTH.rays(outline[:4])[:, :2])
    found, turn, shift = cv2.solvePnP(corners, ideal, np.eye(3), None, flags=cv2.SOLVEPNP_ITERATIVE)
    assert found
    return seen(Pose.from_vector(np.concatenate([turn.ravel(), shift.ravel()])))


@pytest.mark.parametrize("series", [CAMERA_VIEWS, PLANE_POSES], ids=["camera", "planes"])
def test_a_series_that_follows_the_wanted_views_lacks_nothing_at_its_end(series):
    judge = CaptureJudge(SIZE, TRUTH, series=series)
    judge.record_taken(first_view(), 0.0)
    for number in range(series.enough + 2):
        wanted = judge.next_outline()
        if wanted is None:
            break
        view = held_at(wanted)
        still = [judge.judge(view, 1.1, 10.0 * (number + 1) + step) for step in (0.0, 0.15, 0.3)]
        assert still[-1].take, "what is wanted is taken"
        judge.record_taken(view, 10.0 * (number + 1) + 0.3)
    assert judge.missing() == ()
    assert judge.next_outline() is None
    assert len(judge.views) <= series.enough + 2


def test_a_wanted_view_lies_in_the_picture_whole_and_is_a_closed_outline():
    judge = CaptureJudge(SIZE, TRUTH)
    judge.record_taken(first_view(), 0.0)
    wanted = judge.next_outline()
    assert wanted.shape == (5, 2)
    assert np.array_equal(wanted[0], wanted[-1])
    assert np.all(wanted > 0)
    assert np.all(wanted < np.array(SIZE) - 1)


def test_nothing_is_wanted_before_the_target_is_known():
    assert CaptureJudge(SIZE, TRUTH).next_outline() is None


def test_the_plane_target_is_wanted_where_it_was_seen_under_the_fan():
    judge = CaptureJudge(SIZE, TRUTH, series=PLANE_POSES)
    view = first_view()
    judge.record_taken(view, 0.0)
    assert np.linalg.norm(judge.next_outline()[:4].mean(axis=0) - view.uv.mean(axis=0)) < 0.05 * SIZE[0]
