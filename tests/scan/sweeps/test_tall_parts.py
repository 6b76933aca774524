"""Numbering of the fan on parts of up to 150 mm, seen by the twin's rig from near and far, upright and turned."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from core.model import Camera, Fan, LightPlane, Pose
from core.scan.sweeps.fan_lines import UNASSIGNED, possible_fan_lines
from core.scan.sweeps.locate import choose_numbering, number_fan_lines
from core.simulate.recording import scenario_rig
from core.simulate.rig import Rig, fan_axis
from core.simulate.scenario import Scenario
from core.simulate.scene.image import generator
from core.simulate.scene.objects import gauge_block, turned
from core.simulate.scene.scene import Scene
from core.simulate.scene.stage import aim_of, table_pose
from core.simulate.sweep import hand_sweeps, sweep_range
from tests.scan.centreline_scan import ExactScan

FRAMES = 16


def turned_rig(rig: Rig, degrees: float) -> Rig:
    """The rig whose fan is turned about the camera's axis; the picture is upright where that is by 90°."""
    turn = Rotation.from_euler("z", degrees, degrees=True).as_matrix()
    camera = rig.camera
    if degrees == 90:
        (width, height), matrix = camera.image_size, camera.matrix.copy()
        matrix[:2, 2] = height - 1 - matrix[1, 2], matrix[0, 2]
        camera = Camera((height, width), matrix, camera.distortion)
    planes = tuple(LightPlane(turn @ plane.pi) for plane in rig.fan.planes)
    return replace(rig, camera=camera, fan=Fan(planes), fan_emitter=turn @ rig.fan_emitter)


def scan_of_block(height_mm: float, table_mm: float, turned_deg: float = 0.0, emitter_x_mm: float = 120.0) -> ExactScan:
    """A block on a table that far away, under the middle of the fan, whose light comes from x = `emitter_x_mm`."""
    scenario = Scenario(scale=0.34, frames=FRAMES)
    rig = scenario_rig(scenario)
    point, along = fan_axis(rig.fan)
    rig = replace(rig, fan_emitter=point + along * (emitter_x_mm / along[0]))
    middle = rig.fan.planes[1].pi
    under = np.array([0.0, (1 - middle[2] * (table_mm - height_mm)) / middle[1], table_mm])
    block = turned(gauge_block(height_mm), np.radians(scenario.yaw_deg), np.zeros(2))
    scene = Scene.on_table(Pose(table_pose().rotation, under), block)
    sheets = hand_sweeps(rig, sweep_range(scene, aim_of(scene)), FRAMES, generator(scenario.seed, "sweeps"))
    turn = Rotation.from_euler("z", turned_deg, degrees=True).as_matrix()
    sheets = [
        replace(one, plane=LightPlane(turn @ one.plane.pi), emitter=turn @ one.emitter, axis=turn @ one.axis)
        for one in sheets
    ]
    scene = scene.moved(Pose(turn, np.zeros(3)), with_table=True)
    aim = turn @ (under - [0.0, 0.0, height_mm])
    return ExactScan.seen(turned_rig(rig, turned_deg), scene, sheets, aim=aim)


@pytest.mark.parametrize(
    ("height_mm", "table_mm", "turned_deg", "emitter_x_mm"),
    [
        (110.0, 610.0, 0.0, 120.0),
        (110.0, 610.0, 30.0, 120.0),
        (150.0, 610.0, 0.0, 120.0),
        (150.0, 610.0, 90.0, 120.0),
        (150.0, 610.0, 0.0, 0.0),
        (150.0, 560.0, 0.0, 120.0),
    ],
)
def test_every_stretch_on_a_tall_block_gets_its_line_or_none(height_mm, table_mm, turned_deg, emitter_x_mm):
    exact = scan_of_block(height_mm, table_mm, turned_deg, emitter_x_mm)
    features = exact.measured(seed=1)
    found = number_fan_lines(features.fan, features.crossings, exact.rig.camera, exact.rig.fan)
    crossed = set(features.crossings.piece_b[features.crossings.with_fan].tolist())
    for piece, (number, true) in enumerate(zip(found.line, exact.fan_line, strict=True)):
        assert number == true or (number == UNASSIGNED and piece not in crossed and found.reason[piece] is not None)


def test_a_numbering_whose_planes_fall_together_is_not_chosen():
    exact = scan_of_block(110.0, 610.0)
    features, camera, fan = exact.measured(seed=1), exact.rig.camera, exact.rig.fan
    right = next(one for one in possible_fan_lines(features.fan, camera, fan) if one.line == exact.fan_line)
    top = [i for i, curve in enumerate(exact.fan) if np.median(curve.points[:, 2]) < 550]
    alike = tuple(2 if i in top else k for i, k in enumerate(exact.fan_line))
    collapsing = replace(right, line=alike, choices=tuple((k,) for k in alike))
    assert choose_numbering((collapsing, right), features.crossings, camera, fan).line == exact.fan_line
