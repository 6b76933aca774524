"""What the target's points leave over in all poses of the fan, by place: judged as a camera's views are.

Poses differ, but all show one target through one camera. What all of them leave at one point of the target is a print
that is not true; what they leave at one place in the picture is a camera that is not as calibrated. More poses of the
kind average out neither, and no pose is worse than the others for it.

Not judged are the stripes over the picture, but along their lines (`core.calibrate.fan.straightness`): light that is
curved in depth by 0.5 mm is taken up by planes and poses so far that no map shows it, with nine poses or with sixteen.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.calibrate.camera.coverage import REGIONS
from core.calibrate.camera.picture_residuals import GRID, direction_of
from core.calibrate.fan.bundle import Bundle
from core.calibrate.fan.poses.located_pose import LocatedPose
from core.findings.table import note_of
from core.messages import Message
from core.model import Camera, Pose
from core.model.arrays import Array
from core.model.residuals import ENOUGH_GROUPS, Judgement, judge_residuals, of_vectors, over_picture

TOLD_PX, TOLD_MM = 0.05, 0.05
"""What lies off by less at its strongest is not told: a camera's own uncertainty may be of this size."""


@dataclass(frozen=True, eq=False, slots=True)
class PointResiduals:
    """Judgements of the residuals of the target's points.

    Parameters
    ----------
    over_picture
        In pixels, u and v by the cells of GRID.
    over_target
        In mm on the target, along its x and y by the points of `places`; of poses that tell which points they show.
    places
        (P, 2) in mm.
    """

    over_picture: Judgement
    over_target: Judgement
    places: Array


def judge_points(located: Sequence[LocatedPose], bundle: Bundle) -> PointResiduals:
    """Judge whether the target points' residuals in the used poses follow a pattern over the picture or the target."""
    camera = bundle.camera
    views = [view for pose in located if pose.used and (view := pose.features.view) is not None]
    shaped = [bundle.shape.shaped(view.points) for view in views]
    off = np.concatenate(
        [
            view.uv - camera.project_pose(at, points)
            for view, points, at in zip(views, shaped, bundle.poses, strict=True)
        ]
    )
    to_mm = np.concatenate([_to_mm(camera, at, points) for points, at in zip(shaped, bundle.poses, strict=True)])
    uv, sigma = np.concatenate([view.uv for view in views]), np.concatenate([view.sigma for view in views])
    counts = [len(view.uv) for view in views]
    pose = np.repeat(np.arange(len(views)), counts)
    placed = np.repeat([view.placed for view in views], counts)
    plane = np.concatenate([view.points[:, :2] for view in views])[placed]
    places, point = np.unique(plane.round(6), axis=0, return_inverse=True)
    cell = over_picture(uv, camera.image_size, GRID)
    of_picture = of_vectors(off, sigma, pose, cell, GRID[0] * GRID[1])
    of_target = of_vectors(
        np.einsum("nij,nj->ni", to_mm, off)[placed],
        (sigma * np.sqrt((to_mm**2).sum(axis=(1, 2)) / 2))[placed],
        pose[placed],
        point.reshape(-1),
        len(places),
    )
    return PointResiduals(judge_residuals(of_picture), judge_residuals(of_target), places)


def points_off_alike(found: PointResiduals) -> bool | None:
    """Whether target points lie off alike in all poses; None where they seem to, in too few poses to tell from chance.

    Points that lie off by less than is told are not doubted, nor those that turned signs of the poses show as far off:
    U holds their scatter.
    """
    judged = (found.over_target, TOLD_MM), (found.over_picture, TOLD_PX)
    off = [one for one, told in judged if _size(one) > told]
    if any(one.systematic for one in off):
        return True
    return None if any(one.undecided for one in off) else False


def notes_on_points(found: PointResiduals, poses: int) -> tuple[Message, ...]:
    """Note where target points lie off alike, and which way, or that too few `poses` can tell; () if all is well."""
    alike = points_off_alike(found)
    if alike is None:
        return (note_of("fan.points_not_judged", n=poses, least=ENOUGH_GROUPS),)
    if not alike:
        return ()
    if found.over_target.systematic and _size(found.over_target) > TOLD_MM:
        point, (dx, dy) = _strongest(found.over_target)
        x, y = found.places[point]
        return (note_of("fan.point_off_target", x=float(x), y=float(y), dx=dx, dy=dy),)
    region, (du, dv) = _strongest(found.over_picture)
    return (
        note_of(
            "fan.points_off_in_region",
            place=REGIONS[region],
            direction=direction_of(du, dv),
            px=float(np.hypot(du, dv)),
        ),
    )


def _size(found: Judgement) -> float:
    """How far the points of the strongest place lie off, in the residuals' unit; 0 where there are none."""
    return float(np.hypot(*_strongest(found)[1])) if len(found.profile) else 0.0


def _strongest(found: Judgement) -> tuple[int, tuple[float, float]]:
    """The place where the mean vector is furthest from zero for its number, and it."""
    both = found.profile.reshape(2, -1)
    place = found.strongest % both.shape[1]
    return place, (float(both[0, place]), float(both[1, place]))


def _to_mm(camera: Camera, at: Pose, points: Array) -> Array:
    """What turns pixels at `points` (N, 3) of a target into mm along its x and y, (N, 2, 2)."""
    by_mm = [
        camera.project_pose(at, points + side) - camera.project_pose(at, points - side) for side in np.eye(3)[:2] / 2
    ]
    return np.asarray(np.linalg.inv(np.stack(by_mm, axis=2)), dtype=np.float64)
