"""A planned rig without a fan: two boards stand in for it, and the real solvers foretell what it measures."""

import dataclasses

import numpy as np
import pytest

from core.calibrate.board_shape import TRUE
from core.files.recording.rig import KnownPlaneTarget
from core.image.targets import Rectangle
from core.scan.method import ReconstructOptions
from core.wings.rig_planning.plan_step import plan
from core.wings.rig_planning.prediction.boards import board_poses, plan_planes
from core.wings.rig_planning.prediction.changes import CHANGES, OF_ALL
from core.wings.rig_planning.prediction.design import Design, PlanError
from core.wings.rig_planning.prediction.from_rig import read_design
from core.wings.rig_planning.prediction.predict import Planner
from tests.wings.rig_planning.small import CUT_MM

SHEET = KnownPlaneTarget(Rectangle(266.0, 70.0, 6.0), TRUE)
SMALL = Design(
    pixels=(960, 687), pixel_um=6.68, views=6, sweeps=24, boards=(("near", SHEET), ("far", SHEET)), speckle=0.1
)

RIG = """
[camera_target]
kind = "checkerboard"
inner_corners = [17, 12]
square_mm = 10.0
{fan}
[known_planes.near]
kind = "rectangle"
size_mm = [266.0, 70.0]
line_mm = 6.0
[known_planes.far]
kind = "rectangle"
size_mm = [266.0, 70.0]
line_mm = 6.0
print_of = "near"
"""


def test_boards_without_a_fan_are_planned_in_its_place_and_beside_one_are_not(tmp_path):
    file = tmp_path / "rig.toml"
    file.write_text(RIG.format(fan=""))
    design = read_design(file)
    assert not design.has_fan and [name for name, _ in design.boards] == ["near", "far"]
    assert design.boards[1][1].print_of == "near"
    file.write_text(RIG.format(fan="[laser_fan]\nlines = 3\nangle_deg = 5.0"))
    assert read_design(file).has_fan


def test_the_planes_of_planned_boards_are_about_where_these_stand():
    for plane, pose in zip(plan_planes(SMALL, SMALL.camera(), 1), board_poses(SMALL), strict=True):
        normal = pose.rotation[:, 2]
        true = normal / (normal @ pose.translation)
        off = plane.pi - true
        assert off @ np.linalg.inv(plane.of_pose) @ off < 20.0
        assert np.degrees(np.arccos(abs(true @ plane.pi) / np.linalg.norm(true) / np.linalg.norm(plane.pi))) < 0.5


def test_a_rig_without_a_fan_is_foretold_with_rows_of_its_boards():
    prediction = Planner(solving=ReconstructOptions(sigma_cut_mm=CUT_MM)).predict(SMALL, 50.0)
    assert prediction.sweeps_used == SMALL.sweeps
    assert 0.005 < prediction.U_mm < 0.2
    assert abs(prediction.errors_mm[0]) < 4 * prediction.u_mm
    sources = [str(row.words) for row in prediction.budget]
    assert any("known planes" in source for source in sources)
    assert not any("fan" in source or "fixed laser" in source for source in sources)


def test_one_board_is_no_corner():
    with pytest.raises(PlanError, match="a corner of two boards is planned"):
        dataclasses.replace(SMALL, boards=SMALL.boards[:1])


def test_no_change_of_a_fan_is_tried_where_there_is_none():
    assert set(OF_ALL) < set(CHANGES)
    for change in OF_ALL:
        made = change.make(SMALL)
        assert (made.baseline_mm, made.angle_deg, made.poses) == (SMALL.baseline_mm, SMALL.angle_deg, SMALL.poses)
        assert made.check_poses == SMALL.check_poses


def test_bounds_are_refused_where_there_is_no_fan(tmp_path):
    file = tmp_path / "rig.toml"
    file.write_text(RIG.format(fan=""))
    with pytest.raises(PlanError, match="for a rig with a fan only"):
        plan(file, bounds=True)
