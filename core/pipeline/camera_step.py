"""Camera step: views of the target → camera.json."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from core.calibrate.camera import calibrate_camera
from core.calibrate.results import CameraCalibration, ViewQuality
from core.errors import InputError
from core.files.camera_file import read_camera, write_camera
from core.files.pictures import Picture
from core.files.recording_set import RecordingSet, require_camera
from core.image.target_view import TargetView
from core.image.targets import detect
from core.model import Pose
from core.pipeline.options import Options
from core.pipeline.workspace import Workspace
from core.progress import Progress, silent
from core.threads import ordered_map

FEWEST_VIEWS = 3


@dataclass(frozen=True, eq=False, slots=True)
class _Seen:
    """One picture: the target found in it, or the reason why it was not; size (width, height) if it could be read."""

    name: str
    view: TargetView | None = None
    reason: str = ""
    size: tuple[int, int] | None = None


def camera_step(work: Workspace, options: Options | None = None, progress: Progress = silent) -> CameraCalibration:
    """Calibrate the camera of a set and write camera.json.

    Raises
    ------
    InputError
        If there are too few views of the target, or they do not determine the camera.
    """
    options = options or Options()
    require_camera(work.found)
    with work.step("camera") as log:
        log.settings.update(options.camera_settings)
        seen = _detect_all(work.found, progress)
        views = [one.view for one in seen if one.view is not None]
        size = next((one.size for one in seen if one.size is not None), None)
        if size is None or len(views) < FEWEST_VIEWS:
            raise _too_few(seen, work.found)
        calibration = _with_lost(calibrate_camera(views, size, options.camera, progress), seen)
        log.notes.extend(calibration.notes)
        write_camera(work.path("camera"), calibration)
    return read_camera(work.path("camera"))


def _detect_all(found: RecordingSet, progress: Progress) -> list[_Seen]:
    """Look for the target in every view, a few pictures at a time."""

    def look(item: tuple[str, Picture | str]) -> _Seen:
        name, picture = item
        if isinstance(picture, str):
            return _Seen(name, reason=picture)
        size = (picture.shape[1], picture.shape[0])
        try:
            return _Seen(name, detect(found.rig.camera_target, picture, name), size=size)
        except InputError as error:
            return _Seen(name, reason=error.what, size=size)

    seen: list[_Seen] = []
    total = len(found.camera)
    progress("camera views", 0, total)
    for one in ordered_map(look, found.stream(found.camera)):
        seen.append(one)
        progress("camera views", len(seen), total)
    return seen


def _too_few(seen: Sequence[_Seen], found: RecordingSet) -> InputError:
    lost = [one for one in seen if one.view is None]
    number = len(seen) - len(lost)
    hits = f"only {number}" if number else "none"
    why = f" ({lost[0].name}: {lost[0].reason})" if lost else ""
    return InputError(
        f"the camera target was found in {hits} of {len(seen)} pictures{why}, but {FEWEST_VIEWS} are needed",
        where=found.folder / "camera",
        todo="check [camera_target] in rig.toml, or record more views" if lost else "record ten or more views",
    )


def _with_lost(calibration: CameraCalibration, seen: Sequence[_Seen]) -> CameraCalibration:
    """The calibration with the pictures in which no target was found among its views, in the order of the set."""
    solved = iter(calibration.views)
    views = tuple(next(solved) if one.view is not None else _lost(one) for one in seen)
    lost = [one for one in seen if one.view is None]
    if not lost:
        return calibration
    note = f"{len(lost)} of {len(seen)} views show no usable target, the first {lost[0].name}: {lost[0].reason}."
    return replace(calibration, views=views, notes=(*calibration.notes, note))


def _lost(one: _Seen) -> ViewQuality:
    nothing = TargetView(np.zeros((0, 3)), np.zeros((0, 2)), np.zeros(0), one.name)
    return ViewQuality(nothing, Pose.identity(), np.zeros((0, 2)), np.nan, np.nan, np.nan, False, one.reason)
