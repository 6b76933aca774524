"""What a scan's pictures showed, kept from the measurement before: solving again with other settings needs no picture.

The pictures are known by their bytes, so nothing is taken over that they might not show; and the program by its own
text, so that a version that looks at pictures in another way looks at them again.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import asdict
from functools import cache
from pathlib import Path
from typing import Any

import core
from core.calibrate.camera.views import SeenViews
from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.errors import InputError
from core.files.atomic import make_inner_folder
from core.files.project.calibration_store import FOLDER
from core.files.project.data import Project
from core.files.reading import file_hash
from core.files.recording.features_file import read_poses, read_views, write_poses, write_views
from core.files.recording.options import Options
from core.files.recording.recording_set import RecordingSet
from core.files.recording.rig import rig_tables, without_warmth
from core.files.results.scan_file import read_scan
from core.model import Camera
from core.progress import Progress, silent, steps
from core.scan.features.extraction import ScanFeatures

_CORE = Path(core.__file__).parent
_SCAN_ROOMS = ("acquire", "image", "scan")
"""The rooms that read a scan's pictures and make features of them."""


def kept_features(
    scan: Path, found: RecordingSet, options: Options, camera: Camera, progress: Progress = silent
) -> ScanFeatures | None:
    """The features that `scan`, an earlier scan.npz, holds, if they are those of these pictures, settings and camera.

    Takes the hashes of the pictures, as reading them would.
    """
    if not scan.exists():
        return None
    try:
        earlier = read_scan(scan)
    except InputError:
        return None  # damaged: it will be replaced
    if not earlier.features_key:
        return None
    take_hashes(found, _pictures(found, options), progress)
    return earlier.features if earlier.features_key == features_key(found, options, camera) else None


def features_key(found: RecordingSet, options: Options, camera: Camera) -> str:
    """What the features of a scan rest on, in 16 hex digits; the hashes of its pictures must have been taken.

    The camera's distortion is one of it: centrelines are crossed without it.
    """
    pictures = [(found.name_of(path), found.hashes.get(found.name_of(path), "")) for path in _pictures(found, options)]
    rests_on = {
        "program": program_text(_SCAN_ROOMS),
        "channel": found.laser_channel("scan").channel,
        "mosaic": found.rig.mosaic,
        "camera": [camera.matrix.tolist(), camera.distortion.tolist()],
        "stripe": asdict(options.stripe) if options.stripe else None,
        "frames": [found.name_of(path) for path in found.frames],
        "pictures": pictures,
    }
    return hashlib.sha256(json.dumps(rests_on).encode()).hexdigest()[:16]


def take_hashes(found: RecordingSet, pictures: Sequence[Path], progress: Progress = silent) -> None:
    """The hashes of pictures, as reading them would take them; one that cannot be read has none."""
    for path in steps(pictures, progress, "comparing the pictures", len(pictures)):
        with suppress(InputError):
            found.hashes[found.name_of(path)] = file_hash(path)


def _pictures(found: RecordingSet, options: Options) -> list[Path]:
    """The reference and the frames that are not left out by hand."""
    frames = [path for path in found.frames if found.name_of(path) not in options.excluded]
    return found.with_further(frames if found.reference is None else [found.reference, *frames])


@cache
def program_text(rooms: tuple[str, ...]) -> str:
    """The text of some rooms of core, as a hash."""
    digest = hashlib.sha256()
    for room in rooms:
        for source in sorted(_CORE.joinpath(room).rglob("*.py")):
            digest.update(source.read_bytes())
    return digest.hexdigest()


_CALIBRATION_ROOMS = ("acquire", "calibrate", "image", "model")
"""The rooms that read the pictures for a calibration and make features of them."""


def keep_views(project_folder: Path, project: Project, found: RecordingSet, seen: SeenViews) -> None:
    """Keep what the pictures of the camera's target showed; in a folder that cannot be written to, it is not kept."""
    with suppress(InputError):
        make_inner_folder(project_folder, FOLDER)
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
        make_inner_folder(project_folder, FOLDER)
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
    return _key(project, "camera", found, found.camera)


def _poses_key(project: Project, found: RecordingSet) -> str:
    return _key(project, "planes", found, _pose_pictures(found), project.accepted.camera)


def _pose_pictures(found: RecordingSet) -> list[Path]:
    return found.pictures_of(found.planes)


def _key(project: Project, step: str, found: RecordingSet, pictures: Sequence[Path], camera: str = "") -> str:
    rests_on: dict[str, Any] = {
        "program": program_text(_CALIBRATION_ROOMS),
        "target": without_warmth(rig_tables(project.rig)["camera_target" if step == "camera" else "plane_target"]),
        "channel": found.laser_channel(step).channel,
        "mosaic": found.rig.mosaic,
        "camera": camera,
        "pictures": [(found.name_of(path), found.hashes.get(found.name_of(path), "")) for path in pictures],
    }
    stripe = project.options.plane_stripe
    if step == "planes" and stripe is not None:
        rests_on["stripe"] = [stripe.width_px, stripe.contrast]
    return hashlib.sha256(json.dumps(rests_on, default=str).encode()).hexdigest()[:16]
