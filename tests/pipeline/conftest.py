"""One small project, done from the first step to the last; copy it before changing it."""

import pickle
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from core.calibrate.camera.views import SeenViews
from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.calibrate.results import CameraCalibration, FanCalibration
from core.files.project.data import Accepted, Project
from core.files.project.folder import project_from_set
from core.files.project.results import ScanSummary
from core.pipeline.project.calibration import (
    accept_camera,
    accept_planes,
    find_poses,
    find_views,
    solve_poses,
    solve_views,
)
from core.pipeline.project.measuring import measure_scan
from core.pipeline.project.report import make_report
from core.scan.preview.shown import FramePreview
from tests.shared import made_once

GIVEN = "given.pickle"


@dataclass(frozen=True, eq=False)
class DoneProject:
    """A project and what each of its steps gave."""

    folder: Path
    project: Project
    seen: SeenViews
    camera: CameraCalibration
    poses: tuple[PoseFeatures, ...]
    fan: FanCalibration
    summary: ScanSummary
    watched: tuple[FramePreview, ...]
    told: tuple[str, ...]

    def with_options(self, **changes) -> Project:
        return replace(self.project, options=replace(self.project.options, **changes))


@pytest.fixture(scope="session")
def done(simulated: Path, tmp_path_factory: pytest.TempPathFactory) -> DoneProject:
    common = made_once(tmp_path_factory, "done-project", lambda folder: _do(simulated, folder))
    done: DoneProject = pickle.loads((common / GIVEN).read_bytes())
    folder = common / "block"  # where the one it was made in has been moved to
    files = {key: folder / path.relative_to(done.folder) for key, path in done.summary.files.items()}
    return replace(done, folder=folder, summary=replace(done.summary, files=files))


def _do(simulated: Path, made: Path) -> None:
    """Do every step of a project in `made`/block and keep beside it what the steps gave."""
    folder = made / "block"
    folder.mkdir(parents=True)
    project = project_from_set(simulated, "block")
    project = replace(project, options=replace(project.options, sigma_cut_mm=0.3))
    told: list[str] = []
    watched: list[FramePreview] = []

    def progress(step, done, total):
        told.append(step)

    seen = find_views(folder, project, progress)
    camera = solve_views(folder, project, seen, progress)
    project = replace(project, accepted=Accepted(accept_camera(folder, project, camera)))
    poses = find_poses(folder, project, progress)
    fan = solve_poses(folder, project, poses, progress)
    project = replace(project, accepted=replace(project.accepted, planes=accept_planes(folder, project, fan, poses)))
    summary = measure_scan(folder, project, progress, watched.append)
    make_report(folder, project, progress)
    done = DoneProject(folder, project, seen, camera, poses, fan, summary, tuple(watched), tuple(told))
    (made / GIVEN).write_bytes(pickle.dumps(done))
