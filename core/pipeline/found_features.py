"""What the pictures for a calibration showed, kept in the project: a solution that nobody has accepted yet is found
again when the project is opened, without searching the pictures.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from core.calibrate.pose_features import PoseFeatures
from core.calibrate.seen_views import SeenViews
from core.errors import InputError
from core.files.atomic import make_folder
from core.files.calibration_store import FOLDER
from core.files.poses_file import read_poses, write_poses
from core.files.project_data import Project
from core.files.recording_set import RecordingSet
from core.files.rig import rig_tables
from core.files.views_file import read_views, write_views
from core.pipeline.kept_features import program_text, take_hashes
from core.progress import Progress

_SEES = ("acquire", "calibrate", "image", "model")
"""The rooms that read the pictures for a calibration and make features of them."""


def keep_views(project_folder: Path, project: Project, found: RecordingSet, seen: SeenViews) -> None:
    """Keep what the pictures of the camera's target showed; in a folder that cannot be written to, it is not kept."""
    with suppress(InputError):
        make_folder(project_folder / FOLDER)
        write_views(_path(project_folder, "camera"), _views_key(project, found), seen)


def kept_views(project_folder: Path, project: Project, found: RecordingSet, progress: Progress) -> SeenViews | None:
    """What was kept, if it is of these very pictures and this target."""
    take_hashes(found, found.camera, progress)
    try:
        return read_views(_path(project_folder, "camera"), _views_key(project, found))
    except InputError:
        return None  # damaged: the pictures are still there


def keep_poses(project_folder: Path, project: Project, found: RecordingSet, poses: Sequence[PoseFeatures]) -> None:
    """Keep what the pictures of the plate showed; in a folder that cannot be written to, it is not kept."""
    with suppress(InputError):
        make_folder(project_folder / FOLDER)
        write_poses(_path(project_folder, "planes"), _poses_key(project, found), poses)


def kept_poses(
    project_folder: Path, project: Project, found: RecordingSet, progress: Progress
) -> tuple[PoseFeatures, ...]:
    """What was kept, if it is of these very pictures, this plate and this camera; else nothing."""
    take_hashes(found, _pose_pictures(found), progress)
    try:
        return read_poses(_path(project_folder, "planes"), _poses_key(project, found))
    except InputError:
        return ()


def _path(project_folder: Path, step: str) -> Path:
    return project_folder / FOLDER / f"{step}-found.npz"


def _views_key(project: Project, found: RecordingSet) -> str:
    return _key(project, "camera_target", found, found.camera)


def _poses_key(project: Project, found: RecordingSet) -> str:
    return _key(project, "plane_target", found, _pose_pictures(found), project.accepted.camera)


def _pose_pictures(found: RecordingSet) -> list[Path]:
    return [path for pair in found.planes for path in (pair.on, pair.off) if path is not None]


def _key(project: Project, target: str, found: RecordingSet, pictures: Sequence[Path], camera: str = "") -> str:
    rests_on: dict[str, Any] = {
        "program": program_text(_SEES),
        "target": rig_tables(project.rig)[target],
        "channel": project.rig.channel,
        "camera": camera,
        "pictures": [(found.name_of(path), found.hashes.get(found.name_of(path), "")) for path in pictures],
    }
    return hashlib.sha256(json.dumps(rests_on, default=str).encode()).hexdigest()[:16]
