import numpy as np
import pytest

from core.simulate.rays import ray_map
from core.simulate.rig import fan_axis, paper_rig, pencil_fan, published_fan
from core.simulate.scenario import Scenario
from core.simulate.scene.laser import fan_sheets, laser_light
from core.simulate.scene.scene import surface_maps
from core.simulate.scene.stage import WORK_POINT, build_scene


def test_default_fan_is_one_pencil_of_exactly_five_degrees():
    fan = pencil_fan()
    assert np.degrees(fan.angles) == pytest.approx([5.0, 5.0], abs=1e-9)
    point, direction = fan_axis(fan)
    for reach in (-200.0, 0.0, 300.0):
        assert fan.pis @ (point + reach * direction) == pytest.approx([1, 1, 1], abs=1e-9)


def test_default_fan_is_near_the_published_one():
    for ours, theirs in zip(pencil_fan().planes, published_fan().planes, strict=True):
        at_work_point = WORK_POINT / (theirs.pi @ WORK_POINT)
        assert abs(ours.distances(at_work_point[None])[0]) < 0.5


def test_published_fan_has_the_angles_the_notes_found():
    assert np.degrees(published_fan().angles) == pytest.approx([4.929, 4.919], abs=1e-3)


def test_fan_emitter_is_on_every_plane_and_out_of_the_picture():
    rig = paper_rig()
    assert rig.fan.pis @ rig.fan_emitter == pytest.approx([1, 1, 1], abs=1e-9)
    u, v = rig.camera.project(rig.fan_emitter[None])[0]
    assert u > 3840 or v > 2748


def test_half_resolution_is_1920_by_1374_and_every_ray_is_the_cameras():
    camera = paper_rig(0.5).camera
    assert camera.image_size == (1920, 1374)
    rays = ray_map(camera)
    u, v = np.meshgrid([0, 1, 960, 1918, 1919], [0, 1, 700, 1373])
    expected = camera.undistort(np.column_stack([u.ravel(), v.ravel()]))
    assert np.abs(rays[v.ravel(), u.ravel()] - expected).max() < 3e-8


@pytest.mark.parametrize("height", [40.0, 50.0, 60.0, 70.0])
def test_all_three_lines_fall_on_the_default_block_and_on_the_table_on_both_sides(height):
    rig = paper_rig(0.2)
    scene, _ = build_scene(Scenario(height_mm=height))
    maps = surface_maps(scene, rig.camera)
    up = scene.pose_cam_table.rotation[:, 2]
    above = (maps.points - scene.pose_cam_table.translation.astype(np.float32)) @ up.astype(np.float32)
    top = np.abs(above - height) < 0.01
    block_columns = np.flatnonzero(top.any(axis=0))
    for sheet in fan_sheets(rig, WORK_POINT):
        lit = laser_light(sheet, scene, maps) > 20
        across_top = np.flatnonzero((lit & top).any(axis=0))
        assert np.ptp(across_top) > 0.93 * np.ptp(block_columns)
        on_table = np.flatnonzero((lit & maps.table).any(axis=0))
        assert (on_table < block_columns[0]).sum() > 80
        assert (on_table > block_columns[-1]).sum() > 80


def test_the_narrow_block_takes_two_lines():
    rig = paper_rig(0.2)
    scene, _ = build_scene(Scenario(object="narrow-block"))
    maps = surface_maps(scene, rig.camera)
    up = scene.pose_cam_table.rotation[:, 2]
    above = (maps.points - scene.pose_cam_table.translation.astype(np.float32)) @ up.astype(np.float32)
    top = np.abs(above - 50.0) < 0.01
    width = np.ptp(np.flatnonzero(top.any(axis=0)))
    lit = [(laser_light(sheet, scene, maps) > 20) & top for sheet in fan_sheets(rig, WORK_POINT)]
    assert sum(np.ptp(np.flatnonzero(one.any(axis=0))) > 0.9 * width for one in lit if one.any()) == 2
