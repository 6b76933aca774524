"""A bench on which poses are measured at once, from a synthetic fan; one shows no plate, one is poor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from datetime import UTC, datetime
from functools import lru_cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np

from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.calibrate.fan.poses.pose_stages import NumberedStripe, PoseStages
from core.calibrate.results import FanCalibration
from core.errors import InputError
from core.files.pictures import write_picture
from core.files.project.data import Accepted, Project, ProjectInfo, Sources
from core.files.results.planes_file import planes_id
from core.messages import Field, Message, plain
from core.pipeline.steps.planes_step import solve_planes
from tests.calibrate.fan_scenes import CAMERA, Noise, features, poses
from tests.workbench.hand_lane import HandLane
from workbench.bench import Bench
from workbench.work import jobs

POSES = 7
"""The last of them shows no plate."""

NO_PLATE = "no black square was found"


@lru_cache(maxsize=1)
def measured() -> tuple[PoseFeatures, ...]:
    """What finding target and stripes gives."""
    seen = features(poses(POSES - 1, 1), Noise(), 2)
    named = [replace(pose, name=f"pose{number:02d}") for number, pose in enumerate(seen)]
    return (*named, PoseFeatures(f"pose{POSES - 1:02d}", None, (), plain(NO_PLATE)))


@lru_cache(maxsize=32)
def solved(excluded: frozenset[str], constrain: bool, lines: int, angle: float) -> FanCalibration:
    """The calibration of those poses; solved once for all tests."""
    project = Project()
    rig = replace(project.rig, lines=lines, angle=angle)
    options = replace(project.options, excluded=excluded, constrain_fan=constrain)
    return solve_planes(measured(), CAMERA, rig, options.for_planes)


def folder_with_poses(folder: Path) -> Path:
    """Small pictures that stand for the poses, each with the laser on and off."""
    folder.mkdir(parents=True)
    for number in range(POSES):
        for name in (f"pose{number:02d}.png", f"pose{number:02d}_off.png"):
            write_picture(folder / name, np.full((12, 16), 20 * number, np.uint8))
    return folder


class Planes:
    """Answers what the page asks, and keeps what it asked."""

    def __init__(self, bench: Bench) -> None:
        self.bench = bench
        self.measuring, self.quick = cast(HandLane, bench.measuring), cast(HandLane, bench.quick)
        self.kept: list[Any] = []
        self.shown: list[tuple[str, bool]] = []
        self.ridges: dict[str, Any] = {}
        self.measuring.answers[jobs.FIND_POSES] = self.find
        self.quick.answers |= {
            jobs.SOLVE_POSES: self.solve,
            jobs.ACCEPT_PLANES: self.accept,
            jobs.SHOW_POSE: self.show,
            jobs.RECALL_POSES: lambda folder, project: (measured(), self.solve(folder, project, measured())),
            jobs.READ_CAMERA: lambda folder, id_: SimpleNamespace(camera=CAMERA),
            jobs.HISTORY: lambda folder: tuple(reversed(self.kept)),
        }

    def find(self, folder: Path, project: Project) -> tuple[PoseFeatures, ...]:
        if "Checker" in type(project.rig.plane_target).__name__:
            raise InputError(
                "none of the 7 poses can be used",
                where="planes",
                todo=Message("fan.check_lines", "check {field}", field=Field("laser_fan.lines")),
            )
        return measured()

    def solve(self, folder: Path, project: Project, found: Sequence[PoseFeatures]) -> FanCalibration:
        options, rig = project.options, project.rig
        left_out = frozenset(name for name in options.excluded if name.startswith("planes/"))
        return solved(left_out, options.constrain_fan, rig.lines, rig.angle)

    def accept(self, folder: Path, project: Project, calibration: FanCalibration, found: Any, few: bool) -> str:
        assert few or calibration.minority is None
        id_ = planes_id(calibration.fan)
        used, total = sum(pose.used for pose in calibration.poses), len(calibration.poses)
        camera = project.accepted.camera
        entry = SimpleNamespace(
            kind="planes", id=id_, kept_at=datetime.now(UTC), used=used, total=total, rms_mm=calibration.rms_mm,
            camera_id=camera, facts_known=True,
        )  # fmt: skip
        self.kept[:] = [one for one in self.kept if one.id != id_] + [entry]
        return id_

    def show(self, folder: Path, project: Project, pose: PoseFeatures, fan: Any) -> PoseStages:
        self.shown.append((pose.name, fan is not None))
        corners = np.zeros((0, 2)) if pose.view is None else pose.view.uv
        stripes = tuple(NumberedStripe(line.uv, place) for place, line in enumerate(pose.centrelines))
        return PoseStages(
            pose.name,
            np.zeros((12, 16), np.uint8),
            corners,
            stripes,
            pose.reason,
            pose.notes,
            self.ridges.get(pose.name),
        )


def project_with(camera: str = "c1", planes: Path | None = None) -> Project:
    """A project whose camera is accepted, with or without pictures of the plate."""
    sources = Sources(planes="" if planes is None else planes.as_posix())
    return Project(ProjectInfo(name="block"), sources=sources, accepted=Accepted(camera=camera))
