"""What a planned rig is made of: a few quantities one can choose, and the twin's rig and scene made of them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from core.errors import InputError
from core.files.recording.rig import KnownPlaneTarget
from core.image.targets import BlackSquare, Checkerboard, Target
from core.messages import Message
from core.model import Camera, Fan, LightPlane, Pose
from core.model.arrays import Array
from core.simulate.rig import (
    DISTORTION,
    FAN_EMITTER_X_MM,
    FULL_MATRIX,
    FULL_SIZE,
    Beam,
    Optics,
    Rig,
    fan_axis,
    pencil_fan,
)
from core.simulate.scenario import YAW_DEG
from core.simulate.scene.image import generator
from core.simulate.scene.laser import Sheet
from core.simulate.scene.objects import gauge_block, turned
from core.simulate.scene.scene import Scene, Sphere
from core.simulate.scene.stage import TABLE_DEPTH_MM, WORK_POINT, aim_of, table_pose
from core.simulate.sweep import hand_course, sweep_range

PAPER_PIXEL_UM = 1.67
"""Side of a pixel of the paper's camera, a sensor of 10.7 MP and 1/2.3"."""
_PAPER_FOCAL = math.sqrt(FULL_MATRIX[0][0] * FULL_MATRIX[1][1])
_PAPER_AXIS, _AXIS_DIRECTION = fan_axis(pencil_fan())
_FAN_FOCUS_MM, _HAND_FOCUS_MM = 240.0, 550.0
"""Distance from laser to focus, as below."""
_HAND_BASELINE_MM = 240.0
"""As in the twin: `core.simulate.rig.paper_rig` and `core.simulate.sweep.hand_course`."""
_UNDER_FAN_MM = TABLE_DEPTH_MM - float(WORK_POINT[2])
"""How far above the table the fan's middle line passes through the middle of the work."""

BALL_AWAY_MM = 3.0
"""So that the outer fan lines are equally far from its rims."""


class Range(NamedTuple):
    """Smallest and largest value of a quantity, and its unit."""

    low: float
    high: float
    unit: str = ""


CORNER_BOARDS = 2
"""Boards that stand in for a fan."""
USUAL_CHECK = 3
"""Pictures of a check on the day, as the manual advises."""

RANGES: Mapping[str, Range] = {
    "pixel_um": Range(0.5, 50.0, "µm"),
    "focal_mm": Range(1.0, 500.0, "mm"),
    "distance_mm": Range(100.0, 5000.0, "mm"),
    "baseline_mm": Range(5.0, 2000.0, "mm"),
    "hand_baseline_mm": Range(20.0, 2000.0, "mm"),
    "angle_deg": Range(0.2, 30.0, "degrees"),
    "lines": Range(1, 20, "lines"),
    "views": Range(3, 200, "views"),
    "poses": Range(2, 200, "poses"),
    "sweeps": Range(3, 1000, "sweeps"),
    "check_poses": Range(0, 20, "poses"),
    "speckle": Range(0.0, 1.0),
    "stripe_grey": Range(5.0, 5000.0, "grey levels"),
    "stripe_sigma_mm": Range(0.02, 3.0, "mm"),
    "electrons_per_grey": Range(0.5, 10_000.0, "electrons"),
    "read_noise_grey": Range(0.0, 50.0, "grey levels"),
    "ambient_grey": Range(0.0, 250.0, "grey levels"),
    "corner_deg": Range(60.0, 170.0, "degrees"),
}
"""What each quantity may be: wider than any rig that was built, so that only slips are refused."""


class PlanError(InputError):
    """Error of a planned rig that cannot be, or cannot measure, in the words of a plan."""


@dataclass(frozen=True, slots=True)
class Design:
    """Planned rig; the defaults are the paper's.

    Parameters
    ----------
    pixels
        (width, height) of the pictures.
    pixel_um, focal_mm
        Side of a pixel in µm, focal length in mm.
    distance_mm
        From the camera to the table along the optical axis.
    baseline_mm
        Of the fan: how far from the optical axis its axis, the line in which its planes meet, crosses the plane x = 0.
    hand_baseline_mm
        Typical distance of the hand-held laser from the optical axis.
    lines, angle_deg
        Of the fan, and between its neighbouring planes.
    heights_mm, block_mm
        Thicknesses to be measured; length and width of the blocks.
    views, poses, sweeps
        Pictures of the camera target, of the plane target, and frames of the scan.
    check_poses
        Pictures of the plane target in the fan on the day of the scan.
    speckle
        Contrast of the lasers' speckle as one pixel sees it.
    stripe_grey, stripe_sigma_mm
        Crest in 8-bit grey levels on a white surface that faces the laser at its focus, before the lens blurs it, and
        Gaussian σ of the light there.
    electrons_per_grey, read_noise_grey, ambient_grey
        Of the camera; and a white surface's grey level in the room's light.
    camera_target, plane_target
        The plates the rig is calibrated with.
    boards, corner_deg
        Boards by name that stand in for a fan, two that meet in a corner behind the part, and the angle between them;
        none: there is a fan.

    Raises
    ------
    InputError
        If a quantity is impossible, or camera, fan and object cannot see each other.
    """

    pixels: tuple[int, int] = FULL_SIZE
    pixel_um: float = PAPER_PIXEL_UM
    focal_mm: float = round(_PAPER_FOCAL * PAPER_PIXEL_UM * 1e-3, 4)
    distance_mm: float = TABLE_DEPTH_MM
    baseline_mm: float = round(float(_PAPER_AXIS[1]), 3)
    hand_baseline_mm: float = _HAND_BASELINE_MM
    lines: int = 3
    angle_deg: float = 5.0
    heights_mm: tuple[float, ...] = (50.0,)
    block_mm: tuple[float, float] = (70.0, 60.0)
    views: int = 14
    poses: int = 9
    sweeps: int = 60
    check_poses: int = 0
    speckle: float = 0.18
    stripe_grey: float = Beam().peak_grey
    stripe_sigma_mm: float = Beam().sigma_mm
    electrons_per_grey: float = Optics().electrons_per_grey
    read_noise_grey: float = Optics().read_noise_grey
    ambient_grey: float = 45.0
    camera_target: Target = field(default=Checkerboard(17, 12, 10.0))
    plane_target: Target = field(default=BlackSquare(60.0))
    boards: tuple[tuple[str, KnownPlaneTarget], ...] = ()
    corner_deg: float = 90.0

    def __post_init__(self) -> None:
        for name, (low, high, unit) in RANGES.items():
            value = getattr(self, name)
            if not low <= value <= high:
                if unit:
                    raise _impossible(
                        name,
                        value,
                        Message(
                            "plan.range_with_unit",
                            "it must be from {low:g} to {high:g} {unit}",
                            low=low,
                            high=high,
                            unit=unit,
                        ),
                    )
                raise _impossible(
                    name, value, Message("plan.range", "it must be from {low:g} to {high:g}", low=low, high=high)
                )
        for name, values, low, high in (
            ("pixels", self.pixels, 100, 20_000),
            ("block_mm", self.block_mm, 5.0, 1000.0),
            ("heights_mm", self.heights_mm, 1.0, 1000.0),
        ):
            if not values or not all(low <= value <= high for value in values):
                raise _impossible(
                    name,
                    list(values),
                    Message("plan.range_each", "each must be from {low:g} to {high:g}", low=low, high=high),
                )
        if self.boards and len(self.boards) != CORNER_BOARDS:
            raise PlanError(
                Message(
                    "plan.boards_of_corner",
                    "{n} boards are stated and no fan: of such a rig a corner of two boards is planned",
                    n=len(self.boards),
                ),
                where="[known_planes]",
                todo=Message("plan.advice_two_boards", "state two boards, or the fan"),
            )
        if max(self.heights_mm) > 0.6 * self.distance_mm:
            raise _impossible(
                "heights_mm",
                max(self.heights_mm),
                Message(
                    "plan.camera_too_near",
                    "the camera is only {distance_mm:g} mm above the table",
                    distance_mm=self.distance_mm,
                ),
            )

    @property
    def has_fan(self) -> bool:
        """Whether the rig has a fan, and no boards stand in for it."""
        return not self.boards

    @property
    def focal_px(self) -> float:
        """Focal length of the camera in pixels."""
        return self.focal_mm * 1e3 / self.pixel_um

    @property
    def work_point(self) -> Array:
        """Point (3,) in mm of the camera frame, a little above the table, on the fan's middle plane."""
        depth = self.distance_mm - _UNDER_FAN_MM * self.distance_mm / TABLE_DEPTH_MM
        middle = pencil_fan().planes[1].pi
        paper = (1 - middle[2] * WORK_POINT[2]) / middle[1]
        return np.array([0.0, paper * depth / WORK_POINT[2], depth])

    def camera(self) -> Camera:
        """Make the planned camera: its sensor and focal length, with the distortion and skew of the paper's camera."""
        width, height = self.pixels
        matrix = np.array(FULL_MATRIX) * (self.focal_px / _PAPER_FOCAL)
        matrix[:2, 2] = [
            (FULL_MATRIX[0][2] + 0.5) / FULL_SIZE[0] * width - 0.5,
            (FULL_MATRIX[1][2] + 0.5) / FULL_SIZE[1] * height - 0.5,
        ]
        matrix[2, 2] = 1.0
        return Camera((width, height), matrix, np.array(DISTORTION))

    def fan(self) -> Fan:
        """Make the planned fan: light planes through one axis at the baseline, the middle one through `work_point`."""
        point = self._axis_point()
        middle = np.cross(self.work_point - point, _AXIS_DIRECTION)
        middle /= np.linalg.norm(middle)
        middle *= np.sign(middle @ point)
        paper = pencil_fan()
        sense = np.sign(np.cross(paper.planes[1].normal, paper.planes[2].normal) @ _AXIS_DIRECTION)
        steps = np.radians(self.angle_deg) * (np.arange(self.lines) - (self.lines - 1) / 2)
        normals = [Rotation.from_rotvec(sense * step * _AXIS_DIRECTION).apply(middle) for step in steps]
        if any(normal @ point <= 0 for normal in normals):
            raise _impossible(
                "baseline_mm",
                self.baseline_mm,
                Message("plan.fan_through_camera", "a plane of the fan would pass through the camera"),
            )
        return Fan(tuple(LightPlane(normal / (normal @ point)) for normal in normals))

    def rig(self) -> Rig:
        """Make the simulated rig of this design: camera, fan and both lasers."""
        optics = replace(
            Optics(),
            speckle_contrast=self.speckle,
            electrons_per_grey=self.electrons_per_grey,
            read_noise_grey=self.read_noise_grey,
        )
        emitter = self._axis_point() + _AXIS_DIRECTION * (FAN_EMITTER_X_MM / _AXIS_DIRECTION[0])
        beam = Beam(focus_mm=_FAN_FOCUS_MM, peak_grey=self.stripe_grey, sigma_mm=self.stripe_sigma_mm)
        scale = PAPER_PIXEL_UM / self.pixel_um
        hand = replace(beam, focus_mm=_HAND_FOCUS_MM)
        return Rig(self.camera(), self.fan(), emitter, scale, optics, beam, hand)

    def scene(self, height_mm: float) -> Scene:
        """Make a scene with a block of `height_mm` on the table under the fan, placed as in the simulation."""
        block = turned(gauge_block(height_mm, self.block_mm), np.radians(YAW_DEG))
        return Scene.on_table(self.table(), block)

    def ball(self, diameter_mm: float) -> Scene:
        """Make a scene with a ball of `diameter_mm` on the table, placed as in the simulation."""
        radius = diameter_mm / 2
        return Scene.on_table(self.table(), Sphere(np.array([0.0, BALL_AWAY_MM, radius]), radius))

    def table(self) -> Pose:
        """Compute the pose of the table in the camera frame, tilted as in the simulation."""
        across = WORK_POINT[1] * self.distance_mm / TABLE_DEPTH_MM
        return Pose(table_pose().rotation, np.array([0.0, across, self.distance_mm]))

    def sweeps_over(self, scene: Scene, seed: int) -> list[Sheet]:
        """Draw the light sheets of the hand-held laser over `scene`, one for each planned sweep."""
        course = hand_course(sweep_range(scene, aim_of(scene)), self.sweeps, generator(seed, "sweeps"))
        factor = self.hand_baseline_mm / _HAND_BASELINE_MM
        return replace(course, baseline=course.baseline * factor).sheets(self.rig())

    def _axis_point(self) -> Array:
        """The axis at x = 0, at the paper's height above the table."""
        return np.array([0.0, self.baseline_mm, self.distance_mm - TABLE_DEPTH_MM + float(_PAPER_AXIS[2])])


def _impossible(name: str, value: object, why: Message) -> PlanError:
    return PlanError(
        Message("plan.impossible", "{value} is impossible: {why}", value=value, why=why),
        where=f"[plan] {name}",
        todo=Message("plan.advice_change", "change it in rig.toml"),
    )
