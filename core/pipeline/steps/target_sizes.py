"""Pictures in SET/targets that show the plane target beside another one: do the sizes stated for both agree?"""

from __future__ import annotations

import math
from dataclasses import replace

import cv2
import numpy as np

from core.calibrate.board_shape import LARGEST_SCALE_SD
from core.calibrate.results import FanCalibration
from core.calibrate.target_ratio import NOT_FIXED, P_TOLD, TargetRatio, target_ratio
from core.files.reading import file_hash
from core.files.recording.picture_reader import PictureReader
from core.files.recording.set_listing import pictures_in
from core.findings.table import note_of
from core.image.targets import BlackSquare, Target, TargetNotFound, detect
from core.image.targets.picture import Picture
from core.image.targets.target_view import TargetView
from core.messages import Message
from core.model import Camera
from core.pipeline.steps.workspace import check_size

TARGETS = "targets"
"""The folder of these pictures, taken with the lasers off, the two targets fixed to each other."""


BESIDE_SQUARE = 0.1
"""Share of a black square's side around it that is of it: another one may lie near."""
_CAMERAS, _REFERENCE = (
    Message("target.beside_cameras", "the camera's target"),
    Message("target.beside_reference", "the reference target"),
)
"""What the plane target is seen beside."""


def compare_targets(pictures: PictureReader, camera: Camera) -> tuple[TargetRatio | None, tuple[Message, ...]]:
    """Measure the ratio of the sizes of two targets over the one stated, with notes; None if no picture shows both.

    The plane target's size over that of the reference target if rig.toml states one, else the camera's. None as well
    where it does not say what that is.

    Raises
    ------
    InputError
        If a picture is damaged, or of another size than the camera's.
    """
    rig = pictures.recording_set.rig
    paths = pictures_in(pictures.recording_set.rig_file.parent / TARGETS)
    other = None if rig.reference is None else rig.reference.target
    if other is None and not rig.one_target and "camera_target" not in rig.unstated:
        other = rig.camera_target
    if not paths or other is None:
        return None, ()
    shown: list[tuple[TargetView, TargetView]] = []
    notes: list[Message] = []
    for path in paths:
        picture = pictures.read_board(path)
        pictures.hashes[f"{TARGETS}/{path.name}"] = file_hash(path)
        check_size(path, picture.shape, camera)
        name = f"{TARGETS}/{path.stem}"
        try:
            shown.append(_both(other, rig.plane_target, picture, name, camera))
        except TargetNotFound as error:
            notes.append(
                note_of("target.not_both", picture=name, reason=error.what)
            )  # fmt: skip
    return (target_ratio(shown, camera) if shown else None), tuple(notes)


def _both(first: Target, second: Target, picture: Picture, name: str, camera: Camera) -> tuple[TargetView, TargetView]:
    """Two targets in one picture; TargetNotFound if one is not there.

    A board, or the larger of two black squares, is found beside the other; a square only where nothing else is dark.
    """
    sides = [target.side_mm if isinstance(target, BlackSquare) else math.inf for target in (first, second)]
    if sides[0] >= sides[1]:
        found = detect(first, picture, name, camera)
        return found, detect(second, _without(found, picture), name, camera)
    found = detect(second, picture, name, camera)
    return detect(first, _without(found, picture), name, camera), found


def _without(seen: TargetView, picture: Picture) -> Picture:
    """The picture with a target covered by the grey of its light parts: its squares may look like one dark square."""
    plane = seen.points[:, :2]
    steps = np.diff(np.unique(plane[:, 0].round(3)))
    reach = (float(steps.min()) if len(steps) else 0.0) * (BESIDE_SQUARE if len(steps) == 1 else 1.0)
    (x0, y0), (x1, y1) = plane.min(axis=0) - reach, plane.max(axis=0) + reach
    homography = cv2.findHomography(plane, seen.uv)[0]
    corners = np.array([[[x0, y0], [x1, y0], [x1, y1], [x0, y1]]])
    outline = np.round(cv2.perspectiveTransform(corners, homography)).astype(np.int32)
    inside = cv2.fillPoly(np.zeros(picture.shape, np.uint8), [outline[0]], 1) > 0
    covered = picture.copy()
    covered[inside] = np.quantile(picture[inside], 0.9)
    return covered


def with_compared_sizes(
    fan: FanCalibration, pictures: PictureReader, camera: Camera
) -> tuple[FanCalibration, tuple[Message, ...]]:
    """Widen the scale uncertainty of the fan by all that pictures of two targets find their sizes off; with notes.

    A plane target of which nothing is stated has the size that its pictures beside a target of a stated one give:
    uncertain by that one, by the pictures, and by all that they find, which nothing corrects.

    Raises
    ------
    InputError
        As `compare_targets`.
    """
    ratio, notes = compare_targets(pictures, camera)
    if ratio is None:
        return fan, notes
    rig = pictures.recording_set.rig
    reference = rig.reference
    board = rig.camera_board if reference is None else reference.board
    stated = math.hypot(board.size_sd, rig.plane_board.size_sd)
    said = (*notes, ratio.note(stated, _CAMERAS if reference is None else _REFERENCE))
    if ratio.fit_p < NOT_FIXED:
        return fan, said
    known = board.scale_sd
    if fan.scale_assumed is not False and known is not None:
        return with_known_size(fan, math.hypot(known, ratio.u, ratio.ratio - 1)), said
    if ratio.p(stated) < P_TOLD:
        fan = replace(fan, scale_sd=min(LARGEST_SCALE_SD, max(fan.scale_sd, abs(ratio.ratio - 1))))
    return fan, said


def with_known_size(fan: FanCalibration, scale_sd: float) -> FanCalibration:
    """Set the relative standard uncertainty of the size of the fan's target, which is then no longer assumed."""
    return replace(fan, scale_sd=min(LARGEST_SCALE_SD, scale_sd), scale_assumed=False)
