"""The fan's calibration as it is handed on: quality of lines and poses, and notes for the technician."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from core.calibrate.board_shape import BoardShape
from core.calibrate.fan.bundle import Bundle
from core.calibrate.fan.cross_validation import FEWEST, Predictions
from core.calibrate.fan.left_out import note_on_left_out
from core.calibrate.fan.picture_residuals import judge_points, notes_on_points, points_off_alike
from core.calibrate.fan.poses.located_pose import LocatedPose
from core.calibrate.fan.poses.target_plane import on_target
from core.calibrate.fan.straightness import bends_of, bow_or_bend, judge_lines, notes_on_lines, off_planes_mm
from core.calibrate.fan.verdict import Verdict, fan_of
from core.calibrate.results import FanCalibration, PlanePose
from core.findings.table import note_of
from core.messages import Field, Message
from core.model import LightPlane, Pose
from core.model.arrays import Array

WORTH_A_NOTE_MM = 0.05
"""Scatter and bows below this are not noted."""

SCATTERED = 3.0
"""Poses that disagree by this many times their noise do so by themselves, not by chance of points and stripes."""

SURELY_WORSE = 1.2
"""If the target's own points scatter so many times more about a flat target, it is they that show it bowed. Those of a
square cannot, grids of corners do: tests/calibrate/fan/test_straightness.py."""

SATURATED_SHARE = 1 / 3
"""A share of saturated stripe points worth a warning."""


def summarise(
    located: Sequence[LocatedPose],
    free: Bundle,
    used: Bundle,
    verdict: Verdict,
    foretold: Predictions,
    notes: Sequence[Message],
    flat: Bundle | None = None,
) -> FanCalibration:
    """Make the fan's calibration from a free fit, the fit in use, the verdict between them, and predictions.

    The `notes` come in front of those made here.

    `foretold` is of the poses that are used. Where nothing but the stripes tells the target's bow, `flat` is the fit in
    use with a flat target.
    """
    pis = used.planes.pis
    adjusted, errors = iter(used.poses), iter(foretold.error_mm.tolist())
    poses = tuple(
        _plane_pose(pose, next(adjusted), pis, used.shape, next(errors))
        if pose.used
        else replace(_plane_pose(pose, None, pis, used.shape), rms_mm=_distance_left_out(pose, pis))
        for pose in located
    )
    lines = judge_lines(located, used.poses, pis, used.shape)
    bends, bent_mm = None, 0.0
    of_lines = notes_on_lines(lines)
    if lines.systematic:
        points = _by_line([pose.points for pose in poses])
        bends = bends_of(points, _by_line([pose.distances for pose in poses]), pis)
        bent_mm = off_planes_mm(points, bends)
    if flat is not None and flat.corner_scale < SURELY_WORSE * used.corner_scale:
        on_flat = judge_lines(located, flat.poses, flat.planes.pis, flat.shape)
        if on_flat.systematic:
            bends = _bends_if_flat(located, flat, pis)
            bent_mm = off_planes_mm(_by_line([pose.points for pose in poses]), bends)
            of_lines = (*of_lines, bow_or_bend(on_flat))
    free_fan = fan_of(free.planes, free.covariance)
    residuals = judge_points(located, used)
    alike = points_off_alike(residuals)
    return FanCalibration(
        fan=fan_of(used.planes, used.covariance),
        free=free_fan,
        rms_mm=tuple(_rms([pose.distances[line] for pose in poses]) for line in range(len(pis))),
        angles=verdict.constrained_angles,
        free_angles=free_fan.angles,
        pencil_gap_mm=verdict.pencil_gap_mm,
        pencil_gap_sd_mm=verdict.pencil_gap_sd_mm,
        constraint_suits=verdict.suits,
        verdict=verdict.sentence,
        poses=poses,
        notes=(
            *notes,
            *_notes(located, poses, few_told=alike is None),
            *of_lines,
            *notes_on_points(residuals, sum(pose.used for pose in located)),
            *_notes_on_scatter(foretold.error_mm, max(used.expected_mm, bent_mm)),
            *_notes_on_predictions([pose.features.name for pose in located if pose.used], foretold),
            *_notes_on_bow(used.shape),
        ),
        stripe_sd_mm=used.extra_mm,
        corner_scale=used.corner_scale,
        by_camera=used.by_camera,
        cross_validation_mm=float(np.sqrt(np.mean(foretold.error_mm**2))),
        board=used.shape,
        bends=bends,
        points_off_alike=alike,
    )


def _by_line(of_poses: Sequence[Sequence[Array]]) -> list[Array]:
    """What poses have of each line, (n, …), joined line by line."""
    return [np.concatenate(own) for own in zip(*of_poses, strict=True)]


def _bends_if_flat(located: Sequence[LocatedPose], flat: Bundle, pis: Array) -> Array:
    """Forms (N, 3, 3) in 1/mm of how the light is off the planes `pis` (N, 3) if it is not the target that is bowed."""
    used = (pose for pose in located if pose.used)
    poses = [
        _plane_pose(pose, place, flat.planes.pis, flat.shape) for pose, place in zip(used, flat.poses, strict=True)
    ]
    bends = bends_of(
        _by_line([pose.points for pose in poses]), _by_line([pose.distances for pose in poses]), flat.planes.pis
    )
    moved = np.einsum("ni,nj->nij", flat.planes.pis - pis, pis)  # with π·X = 1 another plane is such a form, too
    return np.asarray(bends + (moved + moved.transpose(0, 2, 1)) / 2)


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
        exclusion=located.exclusion,
        prediction_mm=prediction_mm,
    )


def _distance_left_out(located: LocatedPose, pis: Array) -> float:
    """RMS distance in mm of a left-out pose's stripes from the planes, each plane with the stripe nearest to it.

    NaN where no target or no straight stripe was found.
    """
    points = [on_target(line.rays, located.pose) for line in located.lines]
    if not points or not np.isfinite(located.rms_px):
        return math.nan
    off = [[_rms([LightPlane(pi).distances(own)]) for own in points] for pi in pis]
    nearest = np.min(off, axis=1)[: len(points)]
    return float(np.sqrt(np.mean(nearest**2)))


def _rms(distances: Sequence[Array]) -> float:
    joined = np.concatenate(distances)
    return float(np.sqrt((joined**2).mean())) if len(joined) else float("nan")


def _notes(located: Sequence[LocatedPose], poses: Sequence[PlanePose], *, few_told: bool) -> tuple[Message, ...]:
    """On poses left out, on too few that are used unless that is told, on saturated stripes and uneven exposure."""
    left_out = note_on_left_out(poses)
    notes = [] if left_out is None else [left_out]
    used = sum(pose.used for pose in poses)
    if used < FEWEST and not few_told:
        notes.append(note_of("fan.few_poses", n=used, all=len(poses), least=FEWEST))
    stripes = [stripe for pose in located for stripe in pose.stripes.values()]
    share = float(np.average([s.saturated for s in stripes], weights=[len(s) for s in stripes]))
    if share > SATURATED_SHARE:
        notes.append(note_of("fan.saturated_stripes", share=share, field=Field("channel")))
    changed = [pose.features for pose in located if pose.features.gain != 1]
    if changed:
        n, most, first = len(changed), max(abs(pose.gain - 1) for pose in changed), changed[0].name
        notes.append(note_of("fan.brightness_changed", n=n, all=len(located), pose=first, percent=100 * most))
    return tuple(notes)


def _notes_on_scatter(prediction_errors: Array, expected_mm: float) -> tuple[Message, ...]:
    """On poses that agree far worse than their noise allows."""
    known = prediction_errors[np.isfinite(prediction_errors)]
    if not len(known):
        return ()
    # of the usual pose, for a single bad one has a note of its own: the median of squares of a plane error is 0.69
    scatter = float(np.sqrt(np.median(known**2) / np.log(2)))
    times = scatter / expected_mm
    if scatter < WORTH_A_NOTE_MM or times < SCATTERED:
        return ()
    return (note_of("fan.poses_scatter", scatter=scatter, times=times),)


def _notes_on_predictions(names: Sequence[str], foretold: Predictions) -> tuple[Message, ...]:
    """On the poses that the others predict badly, of all that have these names."""
    return tuple(
        note_of(
            "fan.poorly_predicted", pose=names[index], error=float(foretold.error_mm[index]), usual=foretold.usual_mm
        )
        for index in foretold.poor
    )


def _notes_on_bow(shape: BoardShape) -> tuple[Message, ...]:
    """On a plate that is surely bowed."""
    if not shape.surely_bowed or shape.departure_mm < WORTH_A_NOTE_MM:
        return ()
    return (note_of("fan.bowed_target", bow=shape.departure_mm),)
