"""The fan's calibration as it is handed on: quality of lines and poses, and notes for the technician."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from core.calibrate.board_shape import BoardShape
from core.calibrate.fan_bundle import Bundle
from core.calibrate.fan_verdict import Verdict, fan_of
from core.calibrate.located_pose import LocatedPose
from core.calibrate.results import FanCalibration, PlanePose
from core.calibrate.target_plane import on_target
from core.model import LightPlane, Pose
from core.model.arrays import Array

ODDLY_PREDICTED = 4.0
"""A pose that the others foretell this many times worse than the median pose is worth a word."""

WORTH_A_WORD_MM = 0.05
"""Of a prediction that is odd, and of a bow."""

SATURATED_SHARE = 1 / 3
"""A share of saturated stripe points worth a warning."""


def summarise(
    located: Sequence[LocatedPose],
    free: Bundle,
    used: Bundle,
    verdict: Verdict,
    prediction_errors: Array,
    notes: Sequence[str],
) -> FanCalibration:
    """Put together the result of a free fit, the fit in use and the verdict between them, with `notes` in front.

    `prediction_errors` in mm are those of the poses that are used.
    """
    pis = used.planes.pis
    adjusted, errors = iter(used.poses), iter(prediction_errors.tolist())
    poses = tuple(
        _plane_pose(pose, next(adjusted), pis, used.shape, next(errors))
        if pose.used
        else _plane_pose(pose, None, pis, used.shape)
        for pose in located
    )
    free_fan = fan_of(free.planes, free.covariance)
    return FanCalibration(
        fan=fan_of(used.planes, used.covariance),
        free=free_fan,
        rms_mm=tuple(_rms([pose.distances[line] for pose in poses]) for line in range(len(pis))),
        angles=verdict.constrained_angles,
        free_angles=free_fan.angles,
        pencil_gap_mm=verdict.pencil_gap_mm,
        constraint_suits=verdict.suits,
        verdict=verdict.sentence,
        poses=poses,
        notes=(*notes, *_notes(located), *_notes_on_predictions(poses), *_notes_on_bow(used.shape)),
        constraint_p=verdict.p,
        stripe_sd_mm=used.extra_mm,
        corner_scale=used.corner_scale,
        by_camera=used.by_camera,
        cross_validation_mm=float(np.sqrt(np.mean(prediction_errors**2))),
        board=used.shape,
    )


def _plane_pose(
    located: LocatedPose, adjusted: Pose | None, pis: Array, shape: BoardShape, prediction_mm: float = math.nan
) -> PlanePose:
    points = [np.zeros((0, 3)) for _ in pis]
    if adjusted is not None:
        for line, stripe in located.stripes.items():
            points[line] = on_target(stripe.rays, adjusted, shape)
    distances = [LightPlane(pi).distances(own) for pi, own in zip(pis, points, strict=True)]
    return PlanePose(
        name=located.features.name,
        pose=located.pose if adjusted is None else adjusted,
        target_rms_px=located.rms_px,
        points=tuple(points),
        distances=tuple(distances),
        rms_mm=_rms(distances),
        used=located.used,
        reason=located.reason,
        prediction_mm=prediction_mm,
    )


def _rms(distances: Sequence[Array]) -> float:
    joined = np.concatenate(distances)
    return float(np.sqrt((joined**2).mean())) if len(joined) else float("nan")


def _notes(located: Sequence[LocatedPose]) -> tuple[str, ...]:
    notes = []
    out = [f"{pose.features.name} ({pose.reason})" for pose in located if not pose.used]
    if out:
        notes.append(f"{len(out)} of {len(located)} poses left out: {'; '.join(out)}")
    stripes = [stripe for pose in located for stripe in pose.stripes.values()]
    share = float(np.average([s.saturated for s in stripes], weights=[len(s) for s in stripes]))
    if share > SATURATED_SHARE:
        notes.append(
            f"the stripes are saturated at {share:.0%} of their points, which can shift them: expose shorter, dim the "
            "laser, or set channel in rig.toml to a colour in which the laser is weaker"
        )
    return tuple(notes)


def _notes_on_predictions(poses: Sequence[PlanePose]) -> tuple[str, ...]:
    known = [pose for pose in poses if np.isfinite(pose.prediction_mm)]
    if not known:
        return ()
    usual = float(np.median([pose.prediction_mm for pose in known]))
    return tuple(
        f"the other poses foretell the stripes of {pose.name} to {pose.prediction_mm:.3f} mm only, those of a usual "
        f"pose to {usual:.3f} mm: look at its pictures, or take more poses like it"
        for pose in known
        if pose.prediction_mm > max(ODDLY_PREDICTED * usual, WORTH_A_WORD_MM)
    )


def _notes_on_bow(shape: BoardShape) -> tuple[str, ...]:
    if not shape.surely_bowed or shape.departure_mm < WORTH_A_WORD_MM:
        return ()
    return (
        f"the plane target is bowed by {shape.departure_mm:.2f} mm from its lowest to its highest place, which is "
        "taken into account: better fix it to something flat",
    )
