"""Calibration pictures of a simulated set: plates, poses and the pictures of them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from core.calibrate.board_shape import TRUE, BoardTolerance
from core.calibrate.change import STABLE
from core.files.recording.rig import PLANE_TARGET, GaugeSpec, KnownPlaneTarget, rig_to_toml
from core.files.recording.rig import Rig as StatedRig
from core.inspect.uncertainty.part import TARGET_AT_20, Part
from core.model import Pose
from core.model.arrays import Array
from core.simulate.poses import camera_poses, plane_poses
from core.simulate.rays import Map
from core.simulate.rig import FULL_SIZE, Rig
from core.simulate.scenario import GAUGE_TOLERANCE_MM, Scenario
from core.simulate.scene.boards import PLATES, printed
from core.simulate.scene.image import Picture, Sensor, generator
from core.simulate.scene.patterns import Pattern
from core.simulate.scene.stage import table_pose
from core.simulate.scene.targets import RenderContext, camera_picture, fan_centres, plane_pictures
from core.simulate.scene.wrong_plates import scaled

CAMERA_GREY, PLANE_GREY = 230.0, 75.0
"""8-bit grey level of a white surface in the room's light, while the camera and while the fan is calibrated: the target
nearly white, and dark enough for the fan's stripes to stand out."""

CHECK_SEEDS = 10_000
"""Poses of a check draw their noise by numbers from here on, those of the calibration below."""


def rig_toml(scenario: Scenario, known_planes: Mapping[str, KnownPlaneTarget] = MappingProxyType({})) -> str:
    """Make the text of the rig.toml that describes a scenario's rig, and what its `known_planes` are."""
    gauge = (
        GaugeSpec(float(scenario.height_mm), GAUGE_TOLERANCE_MM)
        if scenario.object in ("block", "narrow-block")
        else None
    )
    targets = PLATES[scenario.camera_target], PLATES[scenario.plane_target]
    return rig_to_toml(
        StatedRig(
            *targets,
            lines=scenario.fan_lines,
            angle=math.radians(5.0) if scenario.fan_lines > 1 else 0.0,
            gauge=gauge,
            stability=STABLE if scenario.stated else None,
            row_time_us=1000 * scenario.readout_ms / round(FULL_SIZE[1] * scenario.scale),
            camera_board=TRUE if scenario.stated else BoardTolerance(),
            plane_board=TRUE if scenario.stated else BoardTolerance(),
            part=_part(scenario) if scenario.stated else Part(),
            mosaic="RGGB" if scenario.sensor.colour and scenario.sensor.raw else None,
            simulated=True,
            known_planes=known_planes,
            unstated=frozenset() if scenario.fan_lines or scenario.boards.plate else frozenset({PLANE_TARGET}),
        )
    )


def _part(scenario: Scenario) -> Part:
    """What a simulated object is made of, and its temperature, which nothing changes."""
    material = "plastic" if scenario.inner_share else "metal"
    return Part(material=material, celsius=20.0, u_celsius=0.0, target=TARGET_AT_20)


def calibration_sensor(scenario: Scenario, rig: Rig) -> Sensor:
    """Make a scenario's sensor with the usual brightness, as for the pictures of plates."""
    effects = replace(scenario.sensor, brightness=1.0)
    return Sensor(rig.optics, scenario.bits, scenario.noise, effects=effects, seed=scenario.seed)


def plane_plate(scenario: Scenario) -> tuple[Pattern, float]:
    """Make the true plane target of a scenario; also give by how many mm its left and right edges are bent."""
    plates = scenario.plates
    return scaled(printed(PLATES[scenario.plane_target]), plates.plane_scale), plates.plane_bow_mm


class CalibrationPictures:
    """Camera views and plane poses of one scenario, rendered one at a time."""

    def __init__(self, scenario: Scenario, rig: Rig, rays: Map) -> None:
        self._seed, self._bow_mm = scenario.seed, scenario.plates.camera_bow_mm
        self._context = RenderContext(rig, rays, calibration_sensor(scenario, rig), scenario.lens)
        self._camera_plate = scaled(printed(PLATES[scenario.camera_target]), scenario.plates.camera_scale)
        self._plane_plate, self._plane_bow_mm = plane_plate(scenario)
        views = camera_poses(
            rig.camera, self._camera_plate.outline, scenario.camera_views, generator(self._seed, "camera poses")
        )
        self.camera_poses = {f"view{i:02d}": pose for i, pose in enumerate(views)}
        shown = plane_poses(
            fan_centres(rig, scenario.plane_poses), self._plane_plate.outline, generator(self._seed, "plane poses")
        )
        self.plane_poses = {f"pose{i:02d}": pose for i, pose in enumerate(shown)}
        if not scenario.hand_laser:
            self.plane_poses["stage"] = _on_table(rig, self._plane_plate.outline)

    def render(self, name: str) -> Iterator[tuple[str, Picture]]:
        """Yield the pictures of the view or pose called `name`, each with its path within the recording set."""
        if name in self.camera_poses:
            yield f"camera/{name}.png", self._view(name, self.camera_poses[name])
            return
        index = list(self.plane_poses).index(name)
        pose = self.plane_poses[name]
        plate = self._plane_plate, self._plane_bow_mm
        pictures = plane_pictures(self._context, plate, pose, PLANE_GREY, self._seed, index)
        yield from ((f"planes/{name}{ending}.png", picture) for ending, picture in pictures.items())

    def _view(self, name: str, pose: Pose) -> Picture:
        rng = generator(self._seed, "camera", list(self.camera_poses).index(name))
        return camera_picture(self._context, self._camera_plate, pose, CAMERA_GREY, rng, self._bow_mm)


def _on_table(rig: Rig, outline: Array) -> Pose:
    """The plate flat on the table, its middle under the fan's middle line."""
    table = table_pose()
    pi = rig.fan.planes[rig.fan.lines // 2].pi
    along = table.rotation[:, 1]
    middle = table.translation + along * (1 - pi @ table.translation) / (pi @ along)
    rotation = table.rotation @ np.diag([1.0, -1.0, -1.0])  # a plate's z points away from the camera
    return Pose(rotation, middle - rotation @ outline.mean(axis=0))


class CheckPictures:
    """Pictures of an interim check, rendered one pose at a time: held where the scanned parts will be."""

    def __init__(self, scenario: Scenario, rig: Rig, rays: Map) -> None:
        self._seed = scenario.seed
        self._context = RenderContext(rig, rays, calibration_sensor(scenario, rig), scenario.lens)
        self._plate = plane_plate(scenario)
        poses = plane_poses(
            fan_centres(rig, scenario.check_poses), self._plate[0].outline, generator(self._seed, "check poses")
        )
        self.poses = {f"check{i:02d}": pose for i, pose in enumerate(poses)}

    def render(self, name: str) -> Iterator[tuple[str, Picture]]:
        """Yield the pictures of the check's pose called `name`, each with its path within the recording set."""
        index = CHECK_SEEDS + list(self.poses).index(name)
        pictures = plane_pictures(self._context, self._plate, self.poses[name], PLANE_GREY, self._seed, index)
        yield from ((f"check/{name}{ending}.png", picture) for ending, picture in pictures.items())
