"""The interim check: pictures of the plane target in the fan, taken on the day of a measurement.

The camera says where the target is, the calibration where the fan's stripes are on it, and the pictures where they
truly are. The differences tell of camera and fan together, as a measurement uses them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from operator import itemgetter

import numpy as np

from core.calibrate.camera.reprojection import linearise, moved, parameters_of
from core.calibrate.change import Evidence
from core.calibrate.deviations import SCALES, Deviation
from core.calibrate.fan.pencil import FreePlanes
from core.calibrate.fan.poses.located_pose import LocatedPose, locate
from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.calibrate.fan.poses.pose_stages import NOT_SEEN, line_numbers
from core.calibrate.fan.poses.stripe_lines import StripeLine
from core.calibrate.fan.poses.target_plane import on_target
from core.calibrate.fan.stripe_distances import Stripes
from core.calibrate.results import FanCalibration
from core.image.targets.target_view import TargetView
from core.messages import Message
from core.model import Camera, Fan, Pose
from core.model.arrays import Array

FORM_MM = 0.05
"""Standard deviation of a stripe's place for a plate's form, where the calibration's own poses do not tell."""
ROUNDS = 4
"""Of Gauss–Newton for the target's pose: from a pose that is nearly right, two are enough."""
PARAMETERS = 10
"""Of the camera."""


@dataclass(frozen=True, eq=False, slots=True)
class CheckedPose:
    """One pose of the target in an interim check.

    Parameters
    ----------
    located
        Where the target is, and the stripe of each fan line; a reason where nothing can be said.
    offset_mm
        (S,) distances of its stripes, in the order of `located.stripes`, from the light planes calibrated.
    offset_px
        (S,) the same in the picture.
    sd_mm
        (S,) their standard uncertainty by what the picture shows.
    squares, freedom
        Sum of squares of the stripes' offsets and slopes in units of their covariance, and how many there are.
    """

    located: LocatedPose
    offset_mm: Array
    offset_px: Array
    sd_mm: Array
    squares: float = 0.0
    freedom: int = 0

    @property
    def misses_fan(self) -> bool:
        """Whether the target shows stripes, but none near a calibrated light plane."""
        return not self.located.used and bool(self.located.lines)


def check_poses(
    poses: Sequence[PoseFeatures], camera: Camera, fan: FanCalibration, deviations: Sequence[Deviation]
) -> tuple[tuple[CheckedPose, ...], Evidence]:
    """Measure how far the stripes of each pose are from the calibrated light planes; also their normal equations."""
    found = _as_noisy_as_all([_located(pose, camera, fan.fan) for pose in poses])
    checked, evidence = [], Evidence.none(len(deviations))
    for pose in found:
        if not pose.used:
            checked.append(CheckedPose(pose, np.zeros(0), np.zeros(0), np.zeros(0)))
            continue
        one, said = _check(pose, camera, fan, deviations)
        checked.append(one)
        evidence += said
    return tuple(checked), evidence


def step_errors(
    poses: Sequence[CheckedPose], camera: Camera, fan: Fan, deviations: Sequence[Deviation], step_mm: float
) -> Array:
    """Compute the mean error (K,) in mm that each deviation makes in the height of a step of `step_mm`.

    Where the fan meets it.
    """
    here = Deviation("fan", camera, fan)
    changes = [
        _step(pose.located, line, camera, fan, one, step_mm) - _step(pose.located, line, camera, fan, here, step_mm)
        for one in deviations
        for pose in poses
        if pose.located.used
        for line in pose.located.stripes
    ]
    return np.asarray(np.array(changes).reshape(len(deviations), -1).mean(axis=1), dtype=np.float64)


def _step(pose: LocatedPose, line: int, camera: Camera, fan: Fan, displaced: Deviation, step_mm: float) -> float:
    """The step's height in mm as measured with the displaced camera and fan on one line."""
    pi, up = fan.pis[line], -pose.pose.rotation[:, 2]
    up = up if up[2] < 0 else -up  # towards the camera
    low = on_target(pose.stripes[line].rays[len(pose.stripes[line]) // 2][None], pose.pose)[0]
    within = up - (up @ pi) / (pi @ pi) * pi  # along the light, square to its stripe
    high = low + step_mm * within / (within @ up)
    points = np.array([low, high])
    rays = displaced.camera.rays(camera.project(points))
    there = rays / (rays @ displaced.fan.pis[line])[:, None]
    return float((there[1] - there[0]) @ up)


def _located(features: PoseFeatures, camera: Camera, fan: Fan) -> LocatedPose:
    """The pose with the stripe of each light plane; a reason where none is near any of them."""
    pose = locate(features, camera)
    if not pose.used:
        return pose
    numbers = line_numbers(pose.lines, pose.pose, fan)
    stripes = dict(sorted(zip(numbers, pose.lines, strict=True), key=itemgetter(0)))
    stripes.pop(NOT_SEEN, None)
    if stripes:
        return replace(pose, stripes=stripes)
    return pose.left_out(
        Message("check.no_stripe_near", "no stripe is near where the calibration has the fan: laser or camera moved")
    )


def _as_noisy_as_all(poses: Sequence[LocatedPose]) -> list[LocatedPose]:
    """The poses, no stripe surer than all of them together let expect by its points and their stated noise.

    A stripe's own noise is known from some ten pieces of it. Where these happen to scatter little the stripe would
    count for more than it is worth, and of a hundred rigs that nothing has changed several would seem changed.
    """
    stripes = [stripe for pose in poses for stripe in pose.stripes.values()]
    if not stripes:
        return list(poses)
    points = np.array([len(stripe) for stripe in stripes])
    independent = np.array([stripe.noise for stripe in stripes]) / np.sqrt(points)
    times = np.sqrt(np.average((np.array([stripe.sigma for stripe in stripes]) / independent) ** 2, weights=points))
    return [
        replace(
            pose,
            stripes={
                line: replace(stripe, sigma=max(stripe.sigma, float(times) * stripe.noise / np.sqrt(len(stripe))))
                for line, stripe in pose.stripes.items()
            },
        )
        for pose in poses
    ]


def _check(
    pose: LocatedPose, camera: Camera, fan: FanCalibration, deviations: Sequence[Deviation]
) -> tuple[CheckedPose, Evidence]:
    view = pose.features.view
    assert view is not None
    settled, covariance = _settled(view, camera, pose.pose)
    stripes = Stripes([pose.stripes], [settled])

    def misfit(with_camera: Camera, with_fan: Fan) -> Array:
        """(2S,) offset and slope in mm of each stripe."""
        at = settled if with_camera is camera else _settled(view, with_camera, settled)[0]
        change = parameters_of(with_camera) - parameters_of(camera)
        return stripes.distances(FreePlanes(with_fan.pis), [at], change).mm.ravel()

    here, planes = misfit(camera, fan.fan), FreePlanes(fan.fan.pis)
    by = np.array([misfit(one.camera, one.fan) - here for one in deviations]).reshape(len(deviations), -1).T
    # a target of another size has its stripes where they were: it made all of space as much larger when it was
    # calibrated with
    by[:, [one.source in SCALES for one in deviations]] = 0.0
    by_pose = stripes.distances(planes, [settled], np.zeros(PARAMETERS)).by_pose.reshape(-1, 6)
    form = fan.stripe_sd_mm if np.isfinite(fan.stripe_sd_mm) else FORM_MM
    own = np.repeat(np.hypot(stripes.noise_mm(planes, [settled]), form), stripes.parts)
    worse = max(1.0, fan.corner_scale) if np.isfinite(fan.corner_scale) else 1.0
    expected = np.diag(own**2) + worse**2 * by_pose @ covariance @ by_pose.T
    weighed = np.linalg.solve(expected, np.column_stack([by, here]))
    information = by.T @ weighed[:, :-1]
    evidence = Evidence(information, information, -by.T @ weighed[:, -1])
    # offset and slope are the sum and the difference of both pivots, over the root of 2
    offset = here[:: stripes.parts] / np.sqrt(2)
    sd = np.sqrt(np.diag(expected)[:: stripes.parts] / 2)
    per_px = np.array([_mm_per_px(stripe, settled, camera, fan.fan.pis[line]) for line, stripe in pose.stripes.items()])
    squares = float(here @ weighed[:, -1])
    return CheckedPose(replace(pose, pose=settled), offset, offset / per_px, sd, squares, len(here)), evidence


def _settled(view: TargetView, camera: Camera, pose: Pose) -> tuple[Pose, Array]:
    """The pose by the target's points with their whole covariance, from near it; and its covariance (6, 6)."""
    for _ in range(ROUNDS):
        uv, _, by_pose = linearise(camera, pose, view.points)
        rows = view.whitened(np.concatenate([(uv - view.uv)[..., None], by_pose], axis=2))
        normal = rows[:, 1:].T @ rows[:, 1:]
        pose = moved(pose, np.asarray(-np.linalg.solve(normal, rows[:, 1:].T @ rows[:, 0]), dtype=np.float64))
    return pose, np.asarray(np.linalg.inv(normal), dtype=np.float64)


def _mm_per_px(stripe: StripeLine, pose: Pose, camera: Camera, pi: Array) -> float:
    """How far in mm from the light plane a pixel across the stripe takes the point on the target."""
    middle = stripe.rays[len(stripe) // 2]
    to_ray = camera.ray_jacobian(middle[None])[0]
    across = to_ray @ _normal_px(stripe)
    beside = middle + np.append(across, 0.0)
    points = on_target(np.array([middle, beside]), pose)
    return float(abs((points[1] - points[0]) @ pi) / np.linalg.norm(pi))


def _normal_px(stripe: StripeLine) -> Array:
    """(2,) across the stripe in the picture, of unit length."""
    along = stripe.uv[-1] - stripe.uv[0]
    return np.asarray(np.array([-along[1], along[0]]) / np.linalg.norm(along), dtype=np.float64)
