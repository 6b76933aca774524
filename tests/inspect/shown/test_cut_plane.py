"""A plane laid through the points by hand shows what the section it becomes measures."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from core.inspect.evaluate import evaluate
from core.inspect.plan.feature_spec import FeatureSpec
from core.inspect.plan.inspection_plan import InspectionPlan
from core.inspect.shown.cut_plane import CutPlane, turned_for
from core.inspect.shown.view_frame import CAMERA_FRAME, FrameKind, ViewFrame, part_frame
from core.inspect.uncertainty.point_errors import PointErrors
from core.model import LightPlane, Pose
from tests.inspect.block_scan import NORMAL, TABLE_MM, BlockScan

TABLE = LightPlane.from_normal(NORMAL, TABLE_MM)


@pytest.fixture(scope="module")
def cloud():
    return BlockScan().measure(np.random.default_rng(0))


def frame_on_table():
    frame = part_frame(None, TABLE)
    assert frame is not None
    return frame


def test_the_patch_lies_in_the_plane_and_holds_what_is_cut(cloud):
    frame = frame_on_table()
    coordinates = frame.coordinates(cloud.points)
    corners = frame.coordinates(CutPlane(frame, 1, 4.0).corners(coordinates))
    assert_allclose(corners[:, 1], 4.0, atol=1e-9)
    for axis in (0, 2):
        assert corners[:, axis].min() < coordinates[:, axis].min()
        assert corners[:, axis].max() > coordinates[:, axis].max()


@pytest.mark.parametrize("axis", [0, 1])
def test_across_the_block_the_profile_has_its_height(cloud, axis):
    frame = frame_on_table()
    profile = CutPlane(frame, axis, 0.0).profile(frame.coordinates(cloud.points))
    inside = np.abs(profile.mean_position - np.mean(profile.mean_position[profile.mean_height > 30])) < 15
    assert np.median(profile.mean_height[inside]) == pytest.approx(40, abs=0.2)
    assert np.median(profile.mean_height[profile.mean_height < 20]) == pytest.approx(0, abs=0.2)


def test_in_the_cameras_frame_what_is_nearer_to_it_is_higher(cloud):
    plane = CutPlane(CAMERA_FRAME, 0, float(np.median(cloud.points[:, 0])))
    profile = plane.profile(cloud.points)
    assert plane.upwards == -1
    depths = plane.corners(cloud.points)[:, 2]
    assert depths[:2].min() > depths[2:].max(), "the lower edge first"
    assert profile.height.max() == -cloud.points[np.abs(cloud.points[:, 0] - plane.at_mm) <= 1, 2].min()


@pytest.mark.parametrize("axis", [0, 1])
def test_the_section_it_becomes_lays_out_the_same_points_in_the_same_direction(cloud, axis):
    frame = frame_on_table()
    plane, coordinates = CutPlane(frame, axis, 3.0), frame.coordinates(cloud.points)
    spec = FeatureSpec("cut", "section", section=plane.section(None))
    profile = evaluate(InspectionPlan((spec,)), cloud, errors=PointErrors()).result("cut").profile
    assert profile is not None
    near = np.abs(coordinates[:, axis] - 3.0)
    assert np.setxor1d(profile.indices, np.flatnonzero(near <= 1.0)).size <= 2  # rounded to 0.001 mm
    along = coordinates[profile.indices, 1 - axis]
    assert_allclose(profile.position, along - along.min(), atol=0.02)  # square to the plane found, not to the true one
    shown = plane.profile(coordinates)
    assert_allclose(np.ptp(shown.position), np.ptp(profile.position), atol=0.02)


@pytest.mark.parametrize("axis", [0, 1])
def test_in_part_coordinates_the_section_lies_where_the_plane_is(cloud, axis):
    pose = Pose.from_vector([2.8, 0.4, 0.2, 20.0, -30.0, 520.0])
    frame = frame_on_table()
    section = CutPlane(frame, axis, 3.0).section(pose)
    place, normal = pose.apply(section.point_mm), pose.rotation @ section.normal
    away = frame.coordinates(cloud.points)[:, axis] - 3.0
    assert_allclose(np.abs((cloud.points - place) @ normal), np.abs(away), atol=2e-3)


def test_a_plane_square_to_y_runs_along_x():
    frame = ViewFrame(FrameKind.PART, Pose.identity())
    assert CutPlane(frame, 0, 2.0).section(None).normal == (1.0, 0.0, 0.0)
    assert CutPlane(frame, 1, 2.0).section(None).normal == (0.0, -1.0, 0.0)
    assert CutPlane(frame, 1, 2.0).section(None).point_mm == (0.0, 2.0, 0.0)


def test_square_to_z_the_outline_is_that_of_the_block_without_a_mean_line(cloud):
    frame = frame_on_table()
    coordinates = frame.coordinates(cloud.points)
    plane = CutPlane(frame, 2, 40.0)
    outline = plane.profile(coordinates)
    near = coordinates[np.abs(coordinates[:, 2] - 40.0) <= 1.0]
    assert len(near) and len(outline.mean_position) == 0
    for shown, of in ((outline.position, near[:, 0]), (outline.height, near[:, 1])):
        assert_allclose([shown.min(), shown.max()], [of.min(), of.max()], atol=0.5)
    corners = frame.coordinates(plane.corners(coordinates))
    assert_allclose(corners[:, 2], 40.0, atol=1e-9)
    assert corners[:, :2].min(axis=0) @ [1, 1] < coordinates[:, :2].min(axis=0) @ [1, 1]


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("turned", [-90.0, -35.0, 0.0, 60.0])
@pytest.mark.parametrize("tilted", [-20.0, 0.0, 90.0])
def test_a_turned_frame_is_one_and_turning_alone_leaves_the_heights(axis, turned, tilted):
    frame = frame_on_table()
    plane = CutPlane(turned_for(frame, axis, turned, tilted), axis, 0.0)
    assert_allclose(plane.frame.axes @ plane.frame.axes.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(plane.frame.axes) == pytest.approx(1.0)
    assert plane.normal @ frame.axes[axis] == pytest.approx(np.cos(np.radians(turned)) * np.cos(np.radians(tilted)))
    if not tilted:
        assert_allclose(plane.frame.axes[plane.height], frame.axes[plane.height], atol=1e-12)


def test_across_a_square_plate_a_turned_cut_is_longer_by_its_angle():
    frame, side = ViewFrame(FrameKind.PART, Pose.identity()), np.arange(-20.0, 20.01, 0.25)
    plate = np.array([(x, y, 5.0) for x in side for y in side])
    lengths = []
    for turned in (0.0, 30.0):
        plane = CutPlane(turned_for(frame, 1, turned, 0.0), 1, 0.0)
        lengths.append(np.ptp(plane.profile(plane.frame.coordinates(plate)).position))
    assert lengths[0] == pytest.approx(40.0)
    assert lengths[1] == pytest.approx(40.0 / np.cos(np.radians(30.0)), abs=1.2)  # as wide as the cut at its ends
