"""The frame in which measured points are looked at."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from core.inspect.shown.view_frame import CAMERA_FRAME, FrameKind, Ground, ViewFrame, part_frame
from core.model import LightPlane, Pose

TABLE = LightPlane.from_normal([0.1, -0.2, 0.97], 560.0)
POINTS = np.random.default_rng(1).uniform([-90, -90, 400], [90, 90, 600], (50, 3))
DATUMS = Pose.from_vector([2.9, 0.3, -0.1, 12.0, -7.0, 540.0])


def test_ground_frame_is_right_handed_and_heights_are_distances_from_the_plane():
    ground = Ground.of(TABLE, np.zeros((0, 3)))
    assert np.allclose(ground.axes @ ground.axes.T, np.eye(3))
    assert np.linalg.det(ground.axes) == pytest.approx(1)
    assert np.allclose(ground.local(POINTS)[:, 2], -TABLE.distances(POINTS))


def test_in_the_camera_frame_coordinates_are_those_of_the_points():
    assert_array_equal(CAMERA_FRAME.coordinates(POINTS), POINTS)


def test_part_coordinates_of_a_plan_go_before_the_lower_face():
    frame = part_frame(DATUMS, TABLE)
    assert frame is not None and frame.kind is FrameKind.PART
    assert_allclose(frame.coordinates(DATUMS.apply(np.eye(3))), np.eye(3), atol=1e-9)
    assert_allclose(frame.coordinates(DATUMS.translation), np.zeros(3), atol=1e-9)


def test_without_part_coordinates_z_is_the_height_over_the_lower_face():
    frame = part_frame(None, TABLE)
    assert frame is not None and frame.kind is FrameKind.GROUND
    assert_allclose(frame.coordinates(POINTS), Ground.of(TABLE, POINTS).local(POINTS), atol=1e-9)
    assert_allclose(frame.axes[2], -TABLE.normal)
    assert frame.axes[0] @ [1, 0, 0] > 0.9


def test_a_part_of_which_nothing_is_known_has_no_frame():
    assert part_frame(None, None) is None


def test_frames_are_the_same_if_what_they_rest_on_and_their_pose_are():
    frame = part_frame(DATUMS, None)
    assert frame is not None and frame.same_as(ViewFrame(FrameKind.PART, DATUMS))
    assert not frame.same_as(ViewFrame(FrameKind.GROUND, DATUMS))
    moved = Pose(DATUMS.rotation, DATUMS.translation + [0, 0, 1e-6])
    assert not frame.same_as(ViewFrame(FrameKind.PART, moved))
