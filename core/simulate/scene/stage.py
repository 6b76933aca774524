"""The scene of a scenario: what stands where, and its true figures."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from core.model import Pose
from core.model.arrays import Array
from core.simulate.mask import face_mask
from core.simulate.objects import cylinder, gauge_block, step_block, stl, turned
from core.simulate.scenario import Scenario
from core.simulate.scene import Mesh, Scene, Sphere

WORK_POINT = np.array([0.0, 54.0, 510.0])
"""Where the fan's middle line passes before the camera, in mm: things are put under it."""

TABLE_DEPTH_MM = 560.0
TABLE_TILT_DEG = (3.0, -2.0, 5.0)


def table_pose() -> Pose:
    """Pose of the table: under the work point, z towards the camera, tilted and turned by a few degrees."""
    facing = Rotation.from_rotvec([np.pi, 0.0, 0.0])
    tilt = Rotation.from_euler("xyz", TABLE_TILT_DEG, degrees=True)
    return Pose((tilt * facing).as_matrix(), np.array([WORK_POINT[0], WORK_POINT[1], TABLE_DEPTH_MM]))


def build_scene(scenario: Scenario) -> tuple[Scene, dict[str, object]]:
    """The scene, and the true figures of the object in it (mm, camera frame where a place is given)."""
    pose = table_pose()
    thing = _thing(scenario)
    things = () if thing is None else (thing,)
    scene = Scene.on_table(pose, *things)
    up = pose.rotation[:, 2]
    figures: dict[str, object] = {"kind": scenario.object, "table_normal": up.tolist()}
    figures["table_point"] = pose.translation.tolist()
    if scenario.object in ("block", "narrow-block"):
        figures["thickness_mm"] = scenario.height_mm
    elif scenario.object == "steps":
        figures["step_heights_mm"] = list(STEP_HEIGHTS_MM)
    elif scenario.object == "sphere":
        figures["centre_mm"] = scene.spheres[0].centre.tolist()
        figures["radius_mm"] = scene.spheres[0].radius
    elif scenario.object == "cylinder":
        figures["radius_mm"] = scenario.height_mm / 2
    return scene, figures


STEP_HEIGHTS_MM = (40.0, 50.0, 60.0, 70.0)


def _thing(scenario: Scenario) -> Mesh | Sphere | None:
    """The object in table coordinates, turned on its base and put in its place."""
    yaw, place = np.radians(scenario.yaw_deg), np.array([scenario.right_mm, scenario.away_mm])
    if scenario.object == "block":
        return turned(gauge_block(scenario.height_mm), yaw, place)
    if scenario.object == "narrow-block":
        return turned(gauge_block(scenario.height_mm, (50.0, 30.0)), yaw, place + [0.0, 8.0])
    if scenario.object == "steps":
        return turned(step_block(STEP_HEIGHTS_MM), yaw, place)
    if scenario.object == "sphere":
        radius = scenario.height_mm / 2
        # 3 mm: the outer fan lines equally far from its rims
        return Sphere(np.array([*(place + [0.0, 3.0]), radius]), radius)
    if scenario.object == "cylinder":
        return turned(cylinder(scenario.height_mm), yaw, place)
    if scenario.object == "mask":
        return turned(face_mask(scenario.height_mm), yaw, place)
    if scenario.object == "stl":
        return turned(stl(Path(scenario.stl_path)), yaw, place)
    return None


def aim_of(scene: Scene) -> Array:
    """Where the hand points (3,) in mm: over the middle of what stands on the table, near its top."""
    if scene.meshes:
        corners = np.concatenate([mesh.triangles.reshape(-1, 3) for mesh in scene.meshes])
        return np.asarray((corners.min(axis=0) + corners.max(axis=0)) / 2)
    if scene.spheres:
        return np.asarray(scene.spheres[0].centre)
    return WORK_POINT
