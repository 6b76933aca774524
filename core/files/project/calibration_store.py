"""A project's history of calibrations: everyone that was kept, to be compared, restored and measured with.

Layout::

    PROJECT/calibrations/camera-ID.json         as camera.json
    PROJECT/calibrations/planes-ID.json         as planes.json; planes-ID.npz beside it: what the poses showed
    PROJECT/calibrations/KIND-ID.kept.json      when it was kept, and its quality in short; written last
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import datetime
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field

from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.calibrate.results import CameraCalibration, FanCalibration
from core.errors import InputError
from core.files.atomic import make_folder, make_inner_folder, write_bytes
from core.files.complaints import checked_json
from core.files.json_text import write_json
from core.files.project.data import EARLIER_CALIBRATIONS, Accepted
from core.files.reading import read_bytes, read_json
from core.files.recording.features_file import read_poses, write_poses
from core.files.results.camera_file import camera_id, read_camera, write_camera
from core.files.results.planes_file import planes_id, read_planes, states_all_facts, write_planes
from core.files.tables import KeptMessage, OrNan, Time, kept
from core.messages import Message
from core.model import Camera

FOLDER = "calibrations"

Kind = Literal["camera", "planes"]

_KEPT = ".kept.json"
READJUSTED_FROM = "readjusted_from"
"""Setting of planes that were re-adjusted: the id of the calibration before, whose poses are kept with it."""

IMPORTED = "imported"
"""Among the settings of a camera taken from another program: its file."""


@dataclass(frozen=True, slots=True)
class StoredCalibration:
    """Summary of one calibration of the history.

    Parameters
    ----------
    kind, id
        What is calibrated, and the id in the file's name.
    kept_at
        When it was (last) kept.
    used, total
        Views or poses that count, and all there were.
    rms_px
        RMS of the reprojection of a camera; NaN of light planes.
    expected_error_mm
        RMS distance between the points that cameras solved from odd and from even views give; NaN if not known.
    rms_mm
        RMS distance from each light plane; nothing for a camera.
    camera_id
        The camera that light planes rest on.
    settings
        What the calibration was told, as in run.json.
    inputs
        SHA-256 in hex of the pictures it was made from, by their names within the set.
    notes
        Sentences on single pictures that the calibration itself does not hold.
    facts_known
        Whether the calibration's file says all that decides what it proves; that of an earlier version does not.
    """

    kind: Annotated[Kind, Field(description='"camera" or "planes"')]
    id: str
    kept_at: Time
    used: int
    total: int
    rms_px: OrNan = math.nan
    expected_error_mm: OrNan = math.nan
    rms_mm: Annotated[tuple[OrNan, ...], Field(description="a list of lengths in mm")] = ()
    camera_id: str = ""
    settings: Mapping[str, Any] = field(default_factory=dict, hash=False)
    inputs: Mapping[str, str] = field(default_factory=dict, hash=False)
    notes: tuple[KeptMessage, ...] = ()
    facts_known: bool = True
    __pydantic_config__ = ConfigDict(extra="ignore", strict=True)


def store_camera(
    project_folder: Path,
    calibration: CameraCalibration,
    settings: Mapping[str, Any],
    inputs: Mapping[str, str] | None = None,
) -> str:
    """Add a camera's calibration to the project's history as the newest one, and return its id.

    `settings` are what it was told, as in run.json: of another program's, the file, as IMPORTED. `inputs` are the
    hashes of what it was made from: pictures, or that file.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    id_ = camera_id(calibration.camera)
    folder = make_inner_folder(project_folder, FOLDER)
    write_camera(_path(folder, "camera", id_), calibration)
    about = {
        **_counts([view.used for view in calibration.views]),
        "rms_px": calibration.rms_px,
        "expected_error_mm": calibration.cross_validation_mm,
        "settings": settings,
        "inputs": inputs or {},
    }
    _write_about(folder, "camera", id_, about)
    return id_


def store_planes(
    project_folder: Path,
    calibration: FanCalibration,
    camera: Camera,
    poses: Sequence[PoseFeatures],
    settings: Mapping[str, Any] | None = None,
    inputs: Mapping[str, str] | None = None,
) -> str:
    """Add a calibration of the light planes and its poses to the project's history as the newest one; returns its id.

    One that is there already becomes the newest.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    id_ = planes_id(calibration.fan)
    folder = make_inner_folder(project_folder, FOLDER)
    path = _path(folder, "planes", id_)
    write_poses(path.with_suffix(".npz"), id_, poses)
    write_planes(path, calibration, camera)
    about = {
        **_counts([pose.used for pose in calibration.poses]),
        "rms_mm": calibration.rms_mm,
        "camera_id": camera_id(camera),
        "settings": settings or {},
        "inputs": inputs or {},
        "notes": [kept(note) for pose in poses for note in pose.notes],
    }
    _write_about(folder, "planes", id_, about)
    return id_


def history(project_folder: Path) -> tuple[StoredCalibration, ...]:
    """List the stored calibrations of a project, of camera and light planes, the newest first.

    Raises
    ------
    InputError
        If an entry is damaged; names its file.
    """
    folder = project_folder / FOLDER
    entries = [_read_about(path) for path in sorted(folder.glob(f"*{_KEPT}"))] if folder.is_dir() else []
    there = [entry for entry in entries if _path(folder, entry.kind, entry.id).exists()]
    told = [
        replace(one, facts_known=one.kind != "planes" or states_all_facts(_path(folder, "planes", one.id)))
        for one in there
    ]
    return tuple(sorted(told, key=lambda entry: entry.kept_at, reverse=True))


def read_stored(project_folder: Path, kind: Kind, id_: str) -> StoredCalibration | None:
    """Read the summary of a stored calibration by kind and id; None if there is none, InputError if it is damaged."""
    path = _path(project_folder / FOLDER, kind, id_).with_suffix(_KEPT)
    return _read_about(path) if path.exists() else None


def read_stored_camera(project_folder: Path, id_: str) -> CameraCalibration:
    """Read a stored calibration of the camera by its id; InputError if it is not there, or damaged."""
    path = _found(project_folder, "camera", id_)
    calibration = read_camera(path)
    _check_id(path, camera_id(calibration.camera), id_)
    return calibration


def read_stored_planes(project_folder: Path, id_: str, camera: Camera) -> FanCalibration:
    """Read stored light planes by their id; InputError if missing, damaged, or calibrated with another camera."""
    path = _found(project_folder, "planes", id_)
    calibration = read_planes(path, camera)
    _check_id(path, planes_id(calibration.fan), id_)
    return calibration


def read_stored_poses(project_folder: Path, id_: str) -> tuple[PoseFeatures, ...]:
    """Read what the poses' pictures of a stored calibration of light planes show; InputError if missing or damaged."""
    return read_poses(_found(project_folder, "planes", id_).with_suffix(".npz"), id_)


def put_in_place(project_folder: Path, accepted: Accepted, results: Path, *, has_fan: bool = True) -> None:
    """Copy the `accepted` calibrations from the project's history into the folder of `results`, for the steps to read.

    A file that says the same already is left alone. Of a rig that has no fan, it is the camera's alone.

    Raises
    ------
    InputError
        If none is accepted, one is not in the history, the two are not of each other, or nothing can be written.
    """
    for kind, id_ in (("camera", accepted.camera), ("laser planes", accepted.planes))[: 2 if has_fan else 1]:
        if not id_:
            raise InputError(
                Message("project.none_accepted", "no calibration of the {kind} is accepted yet", kind=kind),
                todo=Message("advice.calibrate_camera_and_accept", "calibrate, and accept the result"),
            )
    camera = read_stored_camera(project_folder, accepted.camera)
    copies = {"camera.json": _found(project_folder, "camera", accepted.camera)}
    if has_fan:
        read_stored_planes(project_folder, accepted.planes, camera.camera)
        fan = _found(project_folder, "planes", accepted.planes)
        copies |= {"planes.json": fan, "planes.npz": fan.with_suffix(".npz")}
    make_folder(results)
    for name, source in copies.items():
        _copy(source, results / name)


def _path(folder: Path, kind: Kind, id_: str) -> Path:
    return folder / f"{kind}-{id_}.json"


def _found(project_folder: Path, kind: Kind, id_: str) -> Path:
    path = _path(project_folder / FOLDER, kind, id_)
    if not path.exists():
        raise InputError(
            Message("project.calibration_missing", "the calibration {id} is not in the project", id=id_),
            where=path,
            todo=Message("advice.calibrate_again", "calibrate again"),
        )
    return path


def _check_id(path: Path, found: str, wanted: str) -> None:
    if found != wanted:
        raise InputError(
            Message("project.other_calibration", "the file holds the calibration {found}", found=found),
            where=path,
            todo=Message("advice.changed_calibrate_again", "it was changed; calibrate again"),
        )


def _counts(used: Sequence[bool]) -> dict[str, int]:
    return {"used": sum(used), "total": len(used)}


def _write_about(folder: Path, kind: Kind, id_: str, about: Mapping[str, Any]) -> None:
    kept_at = datetime.now().astimezone().isoformat()
    path = _path(folder, kind, id_)
    write_json(path.with_suffix(_KEPT), {"kind": kind, "id": id_, "kept_at": kept_at, **about})


def _read_about(path: Path) -> StoredCalibration:
    about = read_json(path)
    if about.get("kind") in EARLIER_CALIBRATIONS:
        about["kind"] = EARLIER_CALIBRATIONS[about["kind"]]
    return checked_json(StoredCalibration, about, path)


def _copy(source: Path, target: Path) -> None:
    data = read_bytes(source)
    if not target.exists() or read_bytes(target) != data:
        write_bytes(target, data)
