"""Sentences for the technician on what a camera calibration lacks."""

from __future__ import annotations

import numpy as np

from core.calibrate.camera_covariance import Widening
from core.calibrate.coverage import empty_regions
from core.calibrate.results import CameraCalibration, ViewQuality

_ENOUGH_VIEWS = 8
_ENOUGH_TILT = np.deg2rad(25.0)
_WORSE_VIEW = 3.0
_MUCH_WIDER = 1.5
_BOWED_MM = 0.05


def notes_on(calibration: CameraCalibration, widening: Widening) -> tuple[str, ...]:
    """Notes on views and corners left out, missing coverage, small tilt, few views and correlated residuals."""
    used = [quality for quality in calibration.views if quality.used]
    notes = [f"{_name(quality)} is left out: {quality.reason}." for quality in calibration.views if not quality.used]
    notes += [
        f"{np.sum(~quality.counted)} misfound corners of {_name(quality)} are left out."
        if np.sum(~quality.counted) > 1
        else f"One misfound corner of {_name(quality)} is left out."
        for quality in used
        if not quality.counted.all()
    ]
    notes += _worse_views(used)
    if len(used) < _ENOUGH_VIEWS:
        notes.append(f"Only {len(used)} views are used: take at least {_ENOUGH_VIEWS}, better 10 to 15.")
    uv = np.concatenate([quality.view.uv[quality.counted] for quality in used])
    empty = empty_regions(uv, calibration.camera.image_size)
    if empty:
        notes.append(f"There is no corner in the {_listed(empty)} of the picture: take a view that reaches there.")
    if calibration.tilt_range < _ENOUGH_TILT:
        notes.append(
            f"The views are tilted by at most {np.rad2deg(calibration.tilt_range):.0f}° against each other: tilt the "
            "target by about 30° in different directions, or the focal length stays uncertain."
        )
    if np.isnan(calibration.cross_validation_mm):
        notes.append("With fewer than six views two halves of them cannot be checked against each other.")
    shape = calibration.board
    if shape.surely_bowed and shape.departure_mm > _BOWED_MM:
        notes.append(
            f"The target is bowed by {shape.departure_mm:.2f} mm from its lowest to its highest place, which is taken "
            "into account: better fix it to something flat."
        )
    limit = max(_MUCH_WIDER, 1 + 3 * widening.chance)
    if widening.within_views > limit:
        notes.append(
            "Corners of one view err together (a target that is not flat, blur, or a detector's bias): the standard "
            f"deviations are {widening.within_views:.1f} times those of independent corners."
        )
    if widening.across_views > limit:
        notes.append(
            "Corners of the target err alike in every view (a print that is not true): the standard "
            f"deviations are {widening.across_views:.1f} times those of independent corners."
        )
    return tuple(notes)


def _worse_views(used: list[ViewQuality]) -> list[str]:
    typical = float(np.median([quality.rms_px for quality in used]))
    return [
        f"{_name(quality)} fits {quality.rms_px / typical:.0f} times worse than most views ({quality.rms_px:.2f} px "
        f"against {typical:.2f} px): look at its corners, and take it again or leave it out."
        for quality in used
        if quality.rms_px > _WORSE_VIEW * typical
    ]


def _name(quality: ViewQuality) -> str:
    return quality.view.name or "A view without a name"


def _listed(names: list[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
