"""Camera step: views of the target → camera.json. Finding the target takes long, solving does not: two functions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import chain, islice

import numpy as np
from numpy.typing import NDArray

from core.calibrate.board_shape import BoardTolerance
from core.calibrate.camera.calibration import calibrate_camera
from core.calibrate.camera.reprojection import parameters_of
from core.calibrate.camera.skew import SKEW
from core.calibrate.camera.third_radial import K3
from core.calibrate.camera.views import SeenView, SeenViews
from core.calibrate.results import CameraCalibration, ViewQuality
from core.errors import InputError
from core.files.pictures import Picture
from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_set import RecordingSet, require_camera
from core.files.results.camera_file import read_camera, write_camera
from core.findings.table import note_of
from core.image.exclusion import Exclusion, Reason
from core.image.hot_pixels import hot_pixels, standing_out
from core.image.targets import Target, detect
from core.image.targets.target_view import OtherBoard, TargetView
from core.messages import Field, Message
from core.model import Pose
from core.pipeline.steps.workspace import Workspace
from core.progress import Progress, silent
from core.settings.options import Options
from core.stage_times import stage
from core.threads import ordered_map

FEWEST_VIEWS = 3
"""Views a camera is solved from at least: three determine all five entries of its matrix (Zhang, 2000)."""
_LOOKED_AT_FIRST = 3
"""Pictures that are looked at quickly before the others: where all show the whole of one other board, it is that."""
FEWEST_HOT_SHARE = 3e-5
"""Share of hot pixels that is told: one in thirty of the patches of 31 × 31 px around corners has one."""


def camera_step(work: Workspace, settings: Options | None = None, progress: Progress = silent) -> CameraCalibration:
    """Calibrate the camera of a set and write camera.json.

    Raises
    ------
    InputError
        If there are too few views of the target, or they do not determine the camera.
    """
    settings = settings or Options()
    with work.step("camera") as log:
        log.settings.update(settings.run_settings("camera"))
        calibration = solve_camera(
            see_views(log.pictures, progress), settings, progress, work.recording_set.rig.camera_board
        )
        log.settings.update(solved_for(calibration))
        log.notes.extend((*calibration.notes, *work.recording_set.not_read("camera")))
        write_camera(log.path("camera"), calibration)
    return read_camera(work.path("camera"))


def solved_for(calibration: CameraCalibration) -> dict[str, bool]:
    """Return by name whether skew and k3 of a camera were solved for, by the settings or automatically."""
    found = (parameters_of(calibration.camera) != 0) & (np.diag(calibration.covariance) > 0)
    return {"skew": bool(found[SKEW]), "k3": bool(found[K3])}  # a skew left at 0 is uncertain all the same


def see_views(pictures: PictureReader, progress: Progress = silent) -> SeenViews:
    """Find the camera target in every view of a set, a few pictures at a time.

    Raises
    ------
    InputError
        If there are no pictures of it, or they differ in depth.
    """
    recording_set = pictures.recording_set
    require_camera(recording_set)
    target = recording_set.rig.camera_target

    def look(item: tuple[str, Picture | Reason]) -> tuple[SeenView, NDArray[np.int64] | None]:
        name, picture = item
        if isinstance(picture, Reason):
            return SeenView(name, exclusion=picture), None
        size = (picture.shape[1], picture.shape[0])
        try:
            with stage(progress, "camera views"):
                view = known.get(name) or detect(target, picture, name)
                return SeenView(name, view, size=size), standing_out(picture)
        except InputError as error:
            return SeenView(name, exclusion=error.what, size=size), None

    seen: list[SeenView] = []
    bright: list[NDArray[np.int64]] = []
    total = len(recording_set.camera)
    progress("camera views", 0, total)
    streamed = pictures.stream(recording_set.camera)
    first = list(islice(streamed, _LOOKED_AT_FIRST))
    known = _require_this_board(target, first, recording_set)
    looked = ordered_map(look, chain(first, streamed), idle=lambda: progress("camera views", len(seen), total))
    for one, places in looked:
        seen.append(one)
        if places is not None:
            bright.append(places)
        progress("camera views", len(seen), total)
    return SeenViews(tuple(seen), str(recording_set.where("camera")), len(hot_pixels(bright)))


def _require_this_board(
    target: Target, first: Sequence[tuple[str, Picture | Reason]], found: RecordingSet
) -> dict[str, TargetView]:
    """InputError if the first pictures all show the whole of one board of another size: the others will, too.

    To look for the one that was stated in every way takes ten times as long as to find it. Where the first picture
    shows it, the others are not looked at here; what was found is returned by its name.

    Raises
    ------
    OtherBoard
        With what they show.
    """
    shown: list[OtherBoard] = []
    for name, picture in first:
        if isinstance(picture, Reason):
            return {}
        try:
            return {name: detect(target, picture, name, thorough=False)}
        except OtherBoard as error:
            shown.append(error)
        except InputError:
            return {}  # told of that picture when all are looked at
        if shown[-1].counted != shown[0].counted:
            return {}
    if len(shown) > 1:
        raise OtherBoard(
            Message("camera.other_board", "in the first {n} pictures {reason}", n=len(shown), reason=shown[0].what),
            where=found.where("camera"),
            todo=shown[0].todo,
            counted=shown[0].counted,
        )
    return {}


def solve_camera(
    seen: SeenViews,
    settings: Options | None = None,
    progress: Progress = silent,
    tolerance: BoardTolerance | None = None,
) -> CameraCalibration:
    """Calibrate the camera from views except those left out by hand, whose residuals are computed all the same.

    `tolerance` is what is known of how true the target is.

    Raises
    ------
    InputError
        If there are too few views of the target, or they do not determine the camera.
    """
    settings = settings or Options()
    found, size = seen.found, seen.size
    if size is None or len(found) < FEWEST_VIEWS:
        raise _too_few(seen)
    left = sum(view.name not in settings.excluded for view in found)
    if left < min(FEWEST_VIEWS, len(found)):
        raise InputError(
            Message(
                "camera.too_many_left_out",
                "only {n} of {all} views are not left out by hand, but {least} are needed",
                n=left,
                all=len(found),
                least=FEWEST_VIEWS,
            ),
            where="camera",
            todo=Message("advice.take_in_again", "take some of them in again, or record more"),
        )
    calibration = calibrate_camera(found, size, settings.camera, progress, settings.excluded, tolerance)
    return _with_hot_pixels(_with_lost(calibration, seen), seen)


def _too_few(seen: SeenViews) -> InputError:
    lost, found = seen.lost, len(seen.found)
    hits = Message("camera.only", "only {n}", n=found) if found else Message("camera.none", "none")
    numbers = {"hits": hits, "all": len(seen.views), "least": FEWEST_VIEWS}
    if not lost:
        what = Message(
            "camera.few_found",
            "the camera target was found in {hits} of {all} pictures, but {least} are needed",
            **numbers,
        )
        return InputError(what, where=seen.where, todo=Message("advice.record_ten_views", "record ten or more views"))
    what = Message(
        "camera.few_found_why",
        "the camera target was found in {hits} of {all} pictures ({name}: {reason}), but {least} are needed",
        name=lost[0].name,
        reason=lost[0].reason,
        **numbers,
    )
    todo = Message(
        "advice.check_target_or_record", "check {field}, or record more views", field=Field("[camera_target]")
    )
    return InputError(what, where=seen.where, todo=todo)


def _with_lost(calibration: CameraCalibration, seen: SeenViews) -> CameraCalibration:
    """The calibration with the pictures in which no target was found among its views, in the order of the set."""
    lost = seen.lost
    if not lost:
        return calibration
    solved = iter(calibration.views)
    views = tuple(next(solved) if one.view is not None else _lost(one) for one in seen.views)
    without = [one for one in lost if one.exclusion is not Exclusion.REPEATED]
    repeated = [one.name for one in lost if one.exclusion is Exclusion.REPEATED]
    notes = list(calibration.notes)
    if without:
        name, reason = without[0].name, without[0].reason
        notes.append(
            note_of("camera.views_without_target", n=len(without), all=len(seen.views), name=name, reason=reason)
        )
    if repeated:
        notes.append(
            note_of(
                "camera.views_repeated",
                n=len(repeated),
                all=len(seen.views),
                reason=Exclusion.REPEATED.message,
                names=tuple(repeated),
            )
        )
    return replace(calibration, views=views, notes=tuple(notes))


def _with_hot_pixels(calibration: CameraCalibration, seen: SeenViews) -> CameraCalibration:
    """The calibration with the number of hot pixels; a note where so many that some lie at corners and in stripes."""
    width, height = calibration.camera.image_size
    calibration = replace(calibration, hot_pixels=seen.hot)
    if seen.hot is None or seen.hot < FEWEST_HOT_SHARE * width * height:
        return calibration
    note = note_of("camera.hot_pixels", n=seen.hot, all=width * height)
    return replace(calibration, notes=(*calibration.notes, note))


def _lost(one: SeenView) -> ViewQuality:
    nothing = TargetView(np.zeros((0, 3)), np.zeros((0, 2)), np.zeros(0), one.name)
    return ViewQuality(nothing, Pose.identity(), np.zeros((0, 2)), np.nan, np.nan, np.nan, False, one.exclusion)
