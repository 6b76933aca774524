"""Camera step: views of the target → camera.json. Finding the target takes long, solving does not: two functions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from core.calibrate.board_shape import BoardTolerance
from core.calibrate.camera import calibrate_camera
from core.calibrate.results import CameraCalibration, ViewQuality
from core.calibrate.seen_views import SeenView, SeenViews
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

__all__ = ["FEWEST_VIEWS", "SeenView", "SeenViews", "camera_step", "see_views", "solve_camera"]

FEWEST_VIEWS = 3


def camera_step(work: Workspace, options: Options | None = None, progress: Progress = silent) -> CameraCalibration:
    """Calibrate the camera of a set and write camera.json.

    Raises
    ------
    InputError
        If there are too few views of the target, or they do not determine the camera.
    """
    options = options or Options()
    with work.step("camera") as log:
        log.settings.update(options.camera_settings)
        calibration = solve_camera(see_views(work.found, progress), options, progress, work.found.rig.camera_board)
        log.notes.extend(calibration.notes)
        write_camera(work.path("camera"), calibration)
    return read_camera(work.path("camera"))


def see_views(found: RecordingSet, progress: Progress = silent) -> SeenViews:
    """Look for the target in every view, a few pictures at a time.

    Raises
    ------
    InputError
        If there are no pictures of it, or they differ in depth.
    """
    require_camera(found)

    def look(item: tuple[str, Picture | str]) -> SeenView:
        name, picture = item
        if isinstance(picture, str):
            return SeenView(name, reason=picture)
        size = (picture.shape[1], picture.shape[0])
        try:
            return SeenView(name, detect(found.rig.camera_target, picture, name), size=size)
        except InputError as error:
            return SeenView(name, reason=error.what, size=size)

    seen: list[SeenView] = []
    total = len(found.camera)
    progress("camera views", 0, total)
    for one in ordered_map(look, found.stream(found.camera), idle=lambda: progress("camera views", len(seen), total)):
        seen.append(one)
        progress("camera views", len(seen), total)
    return SeenViews(tuple(seen), str(found.where("camera")))


def solve_camera(
    seen: SeenViews,
    options: Options | None = None,
    progress: Progress = silent,
    tolerance: BoardTolerance | None = None,
) -> CameraCalibration:
    """The camera from what the pictures show, without those left out by hand: they are judged by the solution.

    `tolerance` is what is known of how true the target is.

    Raises
    ------
    InputError
        If there are too few views of the target, or they do not determine the camera.
    """
    options = options or Options()
    found, size = seen.found, seen.size
    if size is None or len(found) < FEWEST_VIEWS:
        raise _too_few(seen)
    left = sum(view.name not in options.excluded for view in found)
    if left < min(FEWEST_VIEWS, len(found)):
        raise InputError(
            f"only {left} of {len(found)} views are not left out by hand, but {FEWEST_VIEWS} are needed",
            where="camera",
            todo="take some of them in again, or record more",
        )
    return _with_lost(calibrate_camera(found, size, options.camera, progress, options.excluded, tolerance), seen)


def _too_few(seen: SeenViews) -> InputError:
    lost, number = seen.lost, len(seen.found)
    hits = f"only {number}" if number else "none"
    why = f" ({lost[0].name}: {lost[0].reason})" if lost else ""
    return InputError(
        f"the camera target was found in {hits} of {len(seen.views)} pictures{why}, but {FEWEST_VIEWS} are needed",
        where=seen.where,
        todo="check [camera_target] in rig.toml, or record more views" if lost else "record ten or more views",
    )


def _with_lost(calibration: CameraCalibration, seen: SeenViews) -> CameraCalibration:
    """The calibration with the pictures in which no target was found among its views, in the order of the set."""
    lost = seen.lost
    if not lost:
        return calibration
    solved = iter(calibration.views)
    views = tuple(next(solved) if one.view is not None else _lost(one) for one in seen.views)
    note = f"{len(lost)} of {len(seen.views)} views show no usable target, the first {lost[0].name}: {lost[0].reason}."
    return replace(calibration, views=views, notes=(*calibration.notes, note))


def _lost(one: SeenView) -> ViewQuality:
    nothing = TargetView(np.zeros((0, 3)), np.zeros((0, 2)), np.zeros(0), one.name)
    return ViewQuality(nothing, Pose.identity(), np.zeros((0, 2)), np.nan, np.nan, np.nan, False, one.reason)
