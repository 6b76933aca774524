"""Scene of the simulated rig in real time: a plate moved by hand, or a still object being swept.

Everything is a function of time, and chance of the number of the frame, so the same times give the same pictures.
One rig, one seed for all steps: calibrations made from these pictures are right for these scans.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from core.acquire.source import Lasers, Shown
from core.errors import InputError
from core.image.targets import Target
from core.messages import Message
from core.model import Camera, Fan, Pose
from core.model.arrays import Array
from core.simulate.blur import blurred
from core.simulate.calibration import CAMERA_GREY, PLANE_GREY
from core.simulate.effects.boards import NO_BOARDS, BoardsBeside
from core.simulate.live.motion import HandPath, PlateMotion
from core.simulate.poses import camera_poses, plane_poses
from core.simulate.rays import Map, ray_map
from core.simulate.recording import BOARDS_GREY, scan_of, scenario_rig
from core.simulate.rig import Rig
from core.simulate.scan import ScanStage
from core.simulate.scenario import Scenario
from core.simulate.scene.boards import PLATES, printed
from core.simulate.scene.image import NoiseTile, Picture, Sensor, generator
from core.simulate.scene.patterns import Pattern, draw_pattern
from core.simulate.scene.stage import aim_of, build_scene
from core.simulate.scene.targets import fan_centres, fan_light, room_shade, speckled
from core.simulate.sweep import sweep_range

CAMERA_RESTS, CAMERA_REST_S, CAMERA_MOVE_S = 16, 1.2, 1.3
"""Of the camera target: poses, time in s of a rest at least, and of a move between two."""
PLANE_RESTS, PLANE_REST_S, PLANE_MOVE_S = 10, 2.5, 1.3
"""The same of the plane target."""
PLANE_ROUNDS = 3
"""Of such poses, each round tilted otherwise, before its motion repeats: of some no square is found, as a line of the
fan lies along its edge, others are tilted alike, and a calibration would wait for one more for ever."""
CHECK_RESTS = 5
"""Poses at which a plate rests, more than a calibration asks for; times in s of a rest, at least, and of a move."""


@dataclass(frozen=True, eq=False, slots=True)
class LiveTruth:
    """True camera, fan and thickness; `thickness_mm` is None where the object has no two parallel faces."""

    camera: Camera
    fan: Fan
    thickness_mm: float | None


@dataclass(frozen=True, slots=True)
class Moment:
    """Instant at which a picture is exposed, and what is before the camera then.

    Parameters
    ----------
    step, lasers
        What is before the camera, and the lasers that are on.
    time_s
        Since the step began.
    sweep_s
        Time for which the hand-held laser has been moved so far.
    number
        Of the exposure; its noise and speckle follow from it.
    """

    step: Shown
    lasers: Lasers
    time_s: float
    sweep_s: float
    number: int


class LiveScene:
    """Renderer of the pictures of the simulated rig.

    Parameters
    ----------
    scenario
        Object, picture size, noise and seed; its numbers of frames, views and poses are not used.
    camera_target, plane_target
        The plates shown; without them, those of the scenario.

    Raises
    ------
    InputError
        If the object cannot be made, or a plate is too large for the picture.
    """

    def __init__(
        self, scenario: Scenario, camera_target: Target | None = None, plane_target: Target | None = None
    ) -> None:
        self._scenario = scenario
        self.rig: Rig = scenario_rig(scenario)
        self._scene, figures = build_scene(scenario)
        thickness = figures.get("thickness_mm")
        self.truth = LiveTruth(self.rig.camera, self.rig.fan, thickness if isinstance(thickness, float) else None)
        self._plates = {
            "camera": printed(camera_target or PLATES[scenario.camera_target]),
            "planes": printed(plane_target or PLATES[scenario.plane_target]),
        }
        self._plates["check"] = self._plates["planes"]
        self._motions: dict[Shown, PlateMotion] = {
            "camera": self._camera_motion(),
            "planes": self._plane_motion(PLANE_RESTS, "live plane poses", PLANE_ROUNDS),
            "check": self._plane_motion(CHECK_RESTS, "live check poses"),
        }
        reach = sweep_range(self._scene, aim_of(self._scene))
        self._hand = HandPath(self.rig, reach, generator(scenario.seed, "live sweeps"))
        self._rays: Map | None = None
        self._stage: ScanStage | None = None
        self._view: _PlateView | None = None
        self._sensor = Sensor(self.rig.optics, scenario.bits, scenario.noise)

    def precompute(self, step: Shown) -> None:
        """Compute in advance what all pictures of a `step` share, so that each is rendered quickly."""
        width, height = self.rig.camera.image_size
        if self._rays is None:
            self._rays = ray_map(self.rig.camera)
            if self._scenario.noise > 0:
                tile = NoiseTile((height, width), generator(self._scenario.seed, "live noise"))
                self._sensor = replace(self._sensor, tile=tile)
        if step == "boards" and self._scenario.boards == NO_BOARDS:  # the plate is laid beside the object
            self._scenario, self._stage = replace(self._scenario, boards=BoardsBeside(plate=True)), None
        if step in ("scan", "boards") and self._stage is None:
            self._stage = scan_of(self._scenario, self.rig)[0]

    def picture(self, moment: Moment, exposure: float = 1.0, gain: float = 1.0) -> Picture:
        """Render the picture (height, width) of `moment`; `exposure` and `gain` are factors on the usual ones."""
        self.precompute(moment.step)
        rng = generator(self._scenario.seed, f"live {moment.step}", moment.number)
        of_scan = moment.step in ("scan", "boards")
        light = self._scan_light(moment, rng) if of_scan else self._plate_light(moment, rng)
        return replace(self._sensor, exposure=exposure, gain=gain).expose(light, rng)

    def motion(self, step: Shown) -> PlateMotion | None:
        """Return the motion of the target in this step; None for a step without a target."""
        return self._motions.get(step)

    def _scan_light(self, moment: Moment, rng: np.random.Generator) -> Map:
        assert self._stage is not None
        if moment.step == "boards":
            return self._stage.lit_by_room(BOARDS_GREY)
        if moment.lasers.hand:
            return self._stage.lit_by(self._hand.sheet(moment.sweep_s), rng=rng, fan=moment.lasers.fan)
        return self._stage.still if moment.lasers.fan else self._stage.room_light

    def _plate_light(self, moment: Moment, rng: np.random.Generator) -> Map:
        """Light of the plate; while it rests nothing changes but the noise, so it is kept."""
        pose, rest = self._motions[moment.step].at(moment.time_s)
        view = self._view
        if view is None or rest is None or view.key != (moment.step, rest):
            assert self._rays is not None
            grey = CAMERA_GREY if moment.step == "camera" else PLANE_GREY
            plate = self._plates[moment.step]
            view = self._view = _PlateView((moment.step, rest), self.rig, self._rays, plate, pose, grey)
        if not moment.lasers.fan:
            return view.room
        seed = self._scenario.seed
        return view.with_fan(rng if rest is None else generator(seed, f"live {moment.step} speckle", rest))

    def _camera_motion(self) -> PlateMotion:
        outline = self._plates["camera"].outline
        try:
            poses = camera_poses(self.rig.camera, outline, CAMERA_RESTS, self._generator("live camera poses"))
        except ValueError as error:
            raise InputError(
                Message("simulate.target_too_large", "the camera target is too large for the simulated rig's picture")
            ) from error
        return PlateMotion(poses, outline.mean(axis=0), CAMERA_REST_S, CAMERA_MOVE_S)

    def _plane_motion(self, rests: int, kind: str, rounds: int = 1) -> PlateMotion:
        outline, centres, rng = self._plates["planes"].outline, fan_centres(self.rig, rests), self._generator(kind)
        poses = [pose for number in range(rounds) for pose in plane_poses(centres, outline, rng, first=number * rests)]
        return PlateMotion(poses, outline.mean(axis=0), PLANE_REST_S, PLANE_MOVE_S)

    def _generator(self, kind: str) -> np.random.Generator:
        return generator(self._scenario.seed, kind)


class _PlateView:
    """The light of a plate in one pose: the room's, and with the fan's when it is asked for.

    Only the window of the picture in which the plate lies is drawn.
    """

    def __init__(
        self, key: tuple[Shown, int | None], rig: Rig, rays: Map, pattern: Pattern, pose: Pose, grey: float
    ) -> None:
        self.key, self._rig, self._pose = key, rig, pose
        self._window = _window(rig, pose, pattern.outline)
        self._points, self._albedo = draw_pattern(pattern, pose, np.ascontiguousarray(rays[self._window]))
        shade = room_shade(pose, grey)
        self.room = np.full(rays.shape[:2], pattern.background * shade, np.float32)
        self.room[self._window] = blurred(self._albedo * shade, rig.blur_px)
        self._both: Map | None = None

    def with_fan(self, rng: np.random.Generator) -> Map:
        """Room and fan (h, w); `rng` chooses the speckle, once."""
        if self._both is None:
            fan = fan_light(self._rig, self._points, self._albedo, self._pose)
            self._both = self.room.copy()
            self._both[self._window] += speckled(fan, self._rig, rng)
        return self._both


def _window(rig: Rig, pose: Pose, outline: Array) -> tuple[slice, slice]:
    """Rows and columns round a plate, with room for the lens's blur and the bow of its edges; one pixel at least."""
    margin = 8 + 24 * rig.scale
    uv = rig.camera.project_pose(pose, outline)
    width, height = rig.camera.image_size
    (u0, v0), (u1, v1) = uv.min(axis=0) - margin, uv.max(axis=0) + margin
    rows = slice(int(np.clip(v0, 0, height - 2)), int(np.clip(v1, 2, height)))
    return rows, slice(int(np.clip(u0, 0, width - 2)), int(np.clip(u1, 2, width)))
