"""Where an object stands on the twin's table."""

import numpy as np
import pytest

from core.simulate.scenario import Scenario
from core.simulate.scene.stage import build_scene, table_pose


def corners(**place):
    scene, _ = build_scene(Scenario(height_mm=50.0, **place))
    pose = table_pose()
    points = np.concatenate([mesh.triangles.reshape(-1, 3) for mesh in scene.meshes])
    return np.unique(np.round((points - pose.translation) @ pose.rotation, 6), axis=0)


def test_an_object_put_elsewhere_is_moved_over_the_table_and_stays_on_it():
    here, there = corners(), corners(right_mm=7.0, away_mm=-4.0)
    assert there[:, 2] == pytest.approx(here[:, 2])
    assert there.mean(axis=0) - here.mean(axis=0) == pytest.approx([7.0, -4.0, 0.0])


def test_an_object_turned_keeps_its_size_and_place():
    here, turned = corners(), corners(yaw_deg=94.0)
    assert np.ptp(turned[:, :2], axis=0) == pytest.approx(np.ptp(here[:, :2], axis=0)[::-1])
    assert turned.mean(axis=0) == pytest.approx(here.mean(axis=0), abs=1e-6)
