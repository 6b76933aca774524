"""What a camera's residuals say: their size, and a pattern over the picture that all views have in common.

The lens does the same in every view. What its model does not have is left in every view at the same place in the
picture, and more views of the kind do not average it out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.calibrate.camera.coverage import REGIONS
from core.calibrate.camera.expected_error import corner_depths, residual_field
from core.calibrate.results import CameraCalibration
from core.findings.table import note_of
from core.messages import Message
from core.model.residuals import Judgement, Residuals, judge_residuals, of_vectors, over_picture

GRID = (3, 3)
"""Columns and rows in which residuals of all views are compared: the parts of a picture that have names."""
RINGS = 8
"""About the principal point, equally wide."""
BAD_PX, BAD_TIMES, LITTLE_PX = 0.5, 15.0, 0.3
"""RMS of residual vectors from which a calibration is called bad, and already from LITTLE_PX where that is BAD_TIMES
what the corners were found to. On pictures of others sharp corners of true boards fit to 0.05 … 0.07 px, 2 to 4 times
that; JPEGs of a webcam to 0.28 px and 13 times, OpenCV's pictures of 2001 to 0.40 px and 11 times, a curled sheet to
0.45 px and 20 times."""
WORTH_A_NOTE_PX = 0.01
"""Patterns below this are in the covariance, and not told."""


@dataclass(frozen=True, eq=False, slots=True)
class PictureResiduals:
    """Judgement of the residuals, u and v by the cells of GRID, and of their part away from the principal point."""

    over_picture: Judgement
    outwards: Judgement


def judge_picture(calibration: CameraCalibration) -> PictureResiduals:
    """Judge whether the corners' residuals have a pattern over the picture, or along its radii."""
    field, camera = residual_field(calibration), calibration.camera
    sigma = np.concatenate([view.view.sigma[view.counted] for view in calibration.views if view.used])
    cell = over_picture(field.uv, camera.image_size, GRID)
    both = of_vectors(field.residual, sigma, field.view, cell, GRID[0] * GRID[1])
    off = field.uv - camera.matrix[:2, 2]
    radius = np.linalg.norm(off, axis=1)
    outwards = (field.residual * off).sum(axis=1) / np.maximum(radius, 1e-9)
    ring = np.minimum((RINGS * radius / radius.max()).astype(np.intp), RINGS - 1)
    return PictureResiduals(judge_residuals(both), judge_residuals(Residuals(outwards, sigma, field.view, ring, RINGS)))


def notes_on_picture(calibration: CameraCalibration) -> tuple[Message, ...]:
    """Note a pattern of the corners' residuals over the picture, and its direction; () if there is none."""
    found = judge_picture(calibration)
    bad = _bad_fit(calibration.rms_px, found.over_picture.times)
    notes = [] if bad is None else [bad]
    if found.outwards.systematic > max(found.over_picture.systematic / 2, WORTH_A_NOTE_PX):
        notes.append(_on_rings(calibration, found.outwards))
    elif found.over_picture.systematic > WORTH_A_NOTE_PX:
        notes.append(_on_regions(calibration, found.over_picture))
    return tuple(notes)


def bad_fit(calibration: CameraCalibration) -> Message | None:
    """Make the complaint about a calibration whose corners have too large residuals; None if they fit."""
    return _bad_fit(calibration.rms_px, judge_picture(calibration).over_picture.times)


def _bad_fit(rms_px: float, times: float) -> Message | None:
    if not (rms_px > BAD_PX or (rms_px > LITTLE_PX and times > BAD_TIMES)):
        return None
    return note_of("camera.bad_fit", rms=rms_px, times=times)


def _at_the_target(calibration: CameraCalibration, px: float) -> tuple[float, float]:
    """Pixels in mm across the line of sight where the target was, and that depth in mm: the median of its corners."""
    depth, focal = float(np.median(corner_depths(calibration))), float(calibration.camera.matrix[[0, 1], [0, 1]].mean())
    return px * depth / focal, depth


def _on_rings(calibration: CameraCalibration, outwards: Judgement) -> Message:
    ring = outwards.strongest
    px = float(outwards.profile[ring])
    mm, depth_mm = _at_the_target(calibration, abs(px))
    return note_of(
        "camera.pattern_outwards",
        direction=_INWARDS if px < 0 else _OUTWARDS,
        px=abs(px),
        mm=mm,
        depth_mm=depth_mm,
        share=(ring + 0.5) / RINGS,
    )


def _on_regions(calibration: CameraCalibration, found: Judgement) -> Message:
    region = found.strongest % (GRID[0] * GRID[1])
    u, v = found.profile.reshape(2, -1)[:, region]
    px = float(np.hypot(u, v))
    mm, depth_mm = _at_the_target(calibration, px)
    return note_of(
        "camera.pattern_in_region", place=REGIONS[region], direction=direction_of(u, v), px=px, mm=mm, depth_mm=depth_mm
    )


_OUTWARDS, _INWARDS = Message("camera.outwards", "outwards"), Message("camera.inwards", "inwards")


def direction_of(u: float, v: float) -> Message:
    """Name the direction in the picture in which (u, v) points: right, left, up or down."""
    if abs(u) > abs(v):
        return Message("camera.to_the_right", "to the right") if u > 0 else Message("camera.to_the_left", "to the left")
    return Message("camera.downwards", "downwards") if v > 0 else Message("camera.upwards", "upwards")
