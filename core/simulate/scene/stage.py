"""The scene of a scenario: what stands where, and its true figures."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from core.model import Pose
from core.model.arrays import Array
from core.simulate.effects.setup import USUAL_SETUP, Setup
from core.simulate.scenario import Scenario
from core.simulate.scene.boards import PLATES
from core.simulate.scene.carrier import carrier_boards, pose_carrier_part, pose_table_carrier
from core.simulate.scene.known_planes import boards_of
from core.simulate.scene.objects import cylinder, face_mask, gauge_block, step_block, stl, turned
from core.simulate.scene.scene import Material, Mesh, Scene, Sphere

# Where the object is. Chosen so that the paper's fan falls on it.
WORK_POINT = np.array([0.0, 54.0, 510.0])
"""Point (3,) in mm on the fan's middle line before the camera: objects are put under it."""
TABLE_DEPTH_MM = 560.0
"""Depth of the table before the camera, on its axis."""
TABLE_TILT_DEG = (3.0, -2.0, 5.0)
"""Depth of the table in mm, and how it is tilted and turned about x, y and z: no table is quite straight."""
STEP_HEIGHTS_MM = (40.0, 50.0, 60.0, 70.0)
"""Of the step block."""
NARROW_BLOCK_MM, NARROW_BLOCK_BACK_MM = (50.0, 30.0), 8.0
"""Base of the narrow block, and how far it stands back so that the fan meets it."""
SPHERE_BACK_MM = 3.0
"""How far a sphere stands back: the outer fan lines are equally far from its rims."""


def table_pose(setup: Setup = USUAL_SETUP) -> Pose:
    """Make the pose of the table in the camera frame: under the work point, z up to the camera, slightly tilted."""
    facing = Rotation.from_rotvec([np.pi, 0.0, 0.0])
    tilt = Rotation.from_euler("xyz", TABLE_TILT_DEG, degrees=True)
    further = Rotation.from_euler("xy", (setup.table_right_deg, setup.table_away_deg), degrees=True)
    turned = tilt * facing * further
    return Pose(turned.as_matrix(), np.array([WORK_POINT[0], WORK_POINT[1], TABLE_DEPTH_MM]))


def build_scene(scenario: Scenario) -> tuple[Scene, dict[str, object]]:
    """Build the scene of a scenario; also give the object's true figures in mm, by name, places in the camera frame."""
    pose = table_pose(scenario.setup)
    thing = _thing(scenario)
    things = () if thing is None else (thing,)
    material = _material(scenario, pose)
    boards = (*boards_of(scenario, PLATES[scenario.plane_target], pose), *carrier_boards(scenario, pose))
    scene = Scene.on_table(pose, *things, material=material, boards=boards)
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


def _material(scenario: Scenario, table: Pose) -> Material:
    """What the object is made of; its lay turns with it."""
    turned_by = np.radians(scenario.yaw_deg + scenario.lay_deg)
    x, y, z = table.rotation @ [np.cos(turned_by), np.sin(turned_by), 0.0]
    return Material(
        scenario.inner_share,
        scenario.inner_mm,
        scenario.gloss,
        np.radians(scenario.gloss_deg),
        np.radians(scenario.gloss_along_deg),
        (float(x), float(y), float(z)),
        scenario.transport.scattered,
        scenario.transport.free_path_mm,
        scenario.transport.scatter_albedo,
    )


def _thing(scenario: Scenario) -> Mesh | Sphere | None:
    """The object in table coordinates, turned on its base and put in its place."""
    yaw, place = np.radians(scenario.yaw_deg), np.array([scenario.right_mm, scenario.away_mm])
    if scenario.carrier.marks:
        return gauge_block(scenario.height_mm).moved(pose_table_carrier(scenario) @ pose_carrier_part(scenario))
    if scenario.object == "block":
        return turned(gauge_block(scenario.height_mm), yaw, place)
    if scenario.object == "narrow-block":
        return turned(gauge_block(scenario.height_mm, NARROW_BLOCK_MM), yaw, place + [0.0, NARROW_BLOCK_BACK_MM])
    if scenario.object == "steps":
        return turned(step_block(STEP_HEIGHTS_MM), yaw, place)
    if scenario.object == "sphere":
        radius = scenario.height_mm / 2
        return Sphere(np.array([*(place + [0.0, SPHERE_BACK_MM]), radius]), radius)
    if scenario.object == "cylinder":
        return turned(cylinder(scenario.height_mm), yaw, place)
    if scenario.object == "mask":
        return turned(face_mask(scenario.height_mm), yaw, place)
    if scenario.object == "stl":
        return turned(stl(Path(scenario.stl_path)), yaw, place)
    return None


def aim_of(scene: Scene) -> Array:
    """Find the point (3,) in mm at which the hand aims: the middle of the box around what stands on the table."""
    if scene.meshes:
        corners = np.concatenate([mesh.triangles.reshape(-1, 3) for mesh in scene.meshes])
        return np.asarray((corners.min(axis=0) + corners.max(axis=0)) / 2)
    if scene.spheres:
        return np.asarray(scene.spheres[0].centre)
    return WORK_POINT
