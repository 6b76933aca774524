"""What a scan's pictures showed, kept from the measurement before or while they were recorded: no picture is needed.

The pictures are known by their bytes, so nothing is taken over that they might not show; and the program by its own
text, so that a version that looks at pictures in another way looks at them again.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any

from core.calibrate.camera.views import SeenViews
from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.errors import InputError
from core.files.atomic import make_folder, make_inner_folder
from core.files.project.calibration_store import FOLDER
from core.files.project.data import Project
from core.files.recording.features_file import read_poses, read_views, write_poses, write_views
from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_set import RecordingSet
from core.files.recording.rig import Rig, as_calibrated_with, rig_tables
from core.files.results.scan_features import FEATURES, read_features, write_features
from core.image.stripes.stripe import StripeSettings
from core.model import Camera
from core.progress import Progress, silent
from core.scan.features.extraction import ScanFeatures
from core.settings.options import Options
from core.sources import text_hash

_SCAN_ROOMS = ("acquire", "image", "scan")
"""The rooms that read a scan's pictures and make features of them."""


def stored_features(
    earlier: Path | None,
    pictures: PictureReader,
    settings: Options,
    camera: Camera,
    progress: Progress = silent,
) -> ScanFeatures | None:
    """Read features stored in an earlier scan.npz or with the recording, if of these pictures, settings and camera.

    None if there are none.

    Takes the hashes of the pictures, as reading them would, if features were kept.
    """
    recorded = pictures.recording_set.folders.get("scan")
    places = [path for path in (earlier, recorded and recorded / FEATURES) if path and path.exists()]
    if not places:
        return None
    pictures.take_hashes(_pictures(pictures.recording_set, settings), progress)
    key = features_key(pictures, settings, camera)
    return next(filter(None, (_features_in(path, key) for path in places)), None)


def _features_in(path: Path, key: str) -> ScanFeatures | None:
    try:
        return read_features(path, key)
    except InputError:
        return None  # damaged: the pictures are still there


def keep_features(pictures: PictureReader, settings: Options, camera: Camera, features: ScanFeatures) -> None:
    """Store the features of a recording beside its frames; `pictures` must have taken the hashes of its files.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    folder = pictures.recording_set.folders["scan"]
    write_features(folder / FEATURES, features, features_key(pictures, settings, camera))


def features_key(pictures: PictureReader, settings: Options, camera: Camera) -> str:
    """Compute a key of 16 hex digits of all that a scan's features rest on: pictures, settings and camera.

    The hashes of the pictures must have been taken.
    """
    recording_set = pictures.recording_set
    rests_on = {
        "program": text_hash(_SCAN_ROOMS),
        "channel": pictures.laser_channel("scan").channel,
        "mosaic": recording_set.rig.mosaic,
        "fan": recording_set.rig.has_fan,
        "camera": [camera.matrix.tolist(), camera.distortion.tolist()],
        "stripe": asdict(settings.stripe) if settings.stripe else None,
        "boards": repr([board.stated for board in recording_set.known_planes if recording_set.rig.has_fan]),
        "frames": [recording_set.name_of(path) for path in recording_set.frames],
        "pictures": pictures.named_hashes(_pictures(recording_set, settings)),
    }
    return _hash_of(rests_on)


def _pictures(recording_set: RecordingSet, settings: Options) -> list[Path]:
    """The reference with the boards' pictures, and the frames that are not left out by hand."""
    frames = [path for path in recording_set.frames if recording_set.name_of(path) not in settings.excluded]
    shown = frames if recording_set.reference is None else [recording_set.reference, *frames]
    boards = recording_set.known_plane_pictures() if recording_set.rig.has_fan else []
    return [*recording_set.with_further(shown), *boards]


_CALIBRATION_ROOMS = ("acquire", "calibrate", "image", "model")
"""The rooms that read the pictures for a calibration and make features of them."""


def store_views(project_folder: Path, project: Project, pictures: PictureReader, seen: SeenViews) -> None:
    """Store in the project the views found in its pictures of the camera target; nothing if it cannot be written to."""
    with suppress(InputError):
        make_inner_folder(project_folder, FOLDER)
        write_views(_path(project_folder, "camera"), _views_key(project, pictures), seen)


def stored_views(
    project_folder: Path, project: Project, pictures: PictureReader, progress: Progress
) -> SeenViews | None:
    """Read the views of the camera target stored in the project, if they are of these pictures and this target.

    None if they are not, or there are none.
    """
    pictures.take_hashes(pictures.recording_set.camera, progress)
    try:
        return read_views(_path(project_folder, "camera"), _views_key(project, pictures))
    except InputError:
        return None  # damaged: the pictures are still there


def store_poses(project_folder: Path, project: Project, pictures: PictureReader, poses: Sequence[PoseFeatures]) -> None:
    """Store in the project the poses found in its pictures of the plate; nothing if it cannot be written to."""
    with suppress(InputError):
        make_inner_folder(project_folder, FOLDER)
        write_poses(_path(project_folder, "planes"), _poses_key(project, pictures), poses)


def stored_poses(
    project_folder: Path, project: Project, pictures: PictureReader, progress: Progress
) -> tuple[PoseFeatures, ...]:
    """Read the poses stored in the project, if they are of these pictures, this plate and this camera; else ()."""
    pictures.take_hashes(_pose_pictures(pictures.recording_set), progress)
    try:
        return read_poses(_path(project_folder, "planes"), _poses_key(project, pictures))
    except InputError:
        return ()


def poses_once(
    folder: Path | None,
    pictures: PictureReader,
    camera: Camera,
    stripe: StripeSettings | None,
    measure: Callable[[], tuple[PoseFeatures, ...]],
    progress: Progress = silent,
) -> tuple[PoseFeatures, ...]:
    """Read the poses of an interim check stored in `folder`, or call `measure` and store them there.

    `measure` has the `camera` and the `stripe` as well. In a folder that cannot be written to, it is not kept.
    """
    if folder is None:
        return measure()
    recording_set = pictures.recording_set
    paths = _pose_pictures(recording_set)
    pictures.take_hashes(paths, progress)
    of_camera = [camera.matrix.tolist(), camera.distortion.tolist()]
    part = recording_set.part_of(paths[0])
    key = _key(pictures, recording_set.rig, ("plane_target", part), paths, of_camera, stripe)
    path = folder / "check-found.npz"
    with suppress(InputError):  # damaged: the pictures are still there
        if poses := read_poses(path, key):
            return poses
    poses = measure()
    with suppress(InputError):
        make_folder(folder)
        write_poses(path, key, poses)
    return poses


def _hash_of(rests_on: dict[str, Any]) -> str:
    return hashlib.sha256(json.dumps(rests_on, default=str).encode()).hexdigest()[:16]


def _path(project_folder: Path, step: str) -> Path:
    return project_folder / FOLDER / f"{step}-found.npz"


def _views_key(project: Project, pictures: PictureReader) -> str:
    return _key(pictures, project.rig, ("camera_target", "camera"), pictures.recording_set.camera)


def _poses_key(project: Project, pictures: PictureReader) -> str:
    paths, stripe = _pose_pictures(pictures.recording_set), project.options.plane_stripe
    return _key(pictures, project.rig, ("plane_target", "planes"), paths, project.accepted.camera, stripe)


def _pose_pictures(recording_set: RecordingSet) -> list[Path]:
    return recording_set.pictures_of(recording_set.planes)


def _key(
    pictures: PictureReader,
    rig: Rig,
    of: tuple[str, str],
    paths: Sequence[Path],
    camera: object = "",
    stripe: StripeSettings | None = None,
) -> str:
    """What the features of a target's pictures rest on; the target's table in rig.toml, and the part they are `of`."""
    target, part = of
    rests_on: dict[str, Any] = {
        "program": text_hash(_CALIBRATION_ROOMS),
        "target": as_calibrated_with(rig_tables(rig)[target]),
        "channel": pictures.laser_channel(part).channel,
        "mosaic": pictures.recording_set.rig.mosaic,
        "camera": camera,
        "pictures": pictures.named_hashes(paths),
    }
    if stripe is not None:
        rests_on["stripe"] = [stripe.width_px, stripe.contrast]
    return _hash_of(rests_on)
