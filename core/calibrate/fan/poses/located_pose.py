"""A pose of the plane target in space, with the straight stripes on it."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from core.calibrate.fan.poses.line_assignment import PoseLines
from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.calibrate.fan.poses.stripe_lines import StripeLine, straight_lines
from core.calibrate.fan.poses.target_plane import target_plane, target_plane_covariance
from core.image.exclusion import Excludable, Reason
from core.image.targets import TargetNotFound, estimate_pose
from core.messages import Message
from core.model import Camera, Pose


@dataclass(frozen=True, eq=False, slots=True)
class LocatedPose(Excludable):
    """Pose of the target with its straight stripes.

    Parameters
    ----------
    features
        What its pictures show.
    pose
        From the target's own points; the identity if there is none.
    rms_px
        RMS residual of the target's points.
    lines
        The straight stripes, on the target or not.
    stripes
        Fan line (from 0) → the stripe it draws here, once that is known.
    exclusion
        Why the pose is not used; None if it is.
    """

    features: PoseFeatures
    pose: Pose
    rms_px: float
    lines: tuple[StripeLine, ...]
    stripes: dict[int, StripeLine] = field(default_factory=dict)
    exclusion: Reason | None = None

    @property
    def used(self) -> bool:
        """Whether the pose takes part in the fit of the light planes: it has no exclusion."""
        return self.exclusion is None

    @property
    def lines_left(self) -> tuple[StripeLine, ...]:
        """Straight stripes in the pose that are assigned to no line of the fan."""
        return tuple(line for line in self.lines if all(line is not stripe for stripe in self.stripes.values()))

    def left_out(self, exclusion: Reason) -> LocatedPose:
        """Mark the pose as not used, for the reason `exclusion`."""
        return replace(self, stripes={}, exclusion=exclusion)

    def as_lines(self, camera: Camera) -> PoseLines:
        """Return the straight stripes and the target's plane; no stripes if the pose is not used."""
        if not self.used or self.features.view is None:
            return PoseLines((), np.zeros(3), np.zeros((3, 3)), np.zeros((0, 3)))
        covariance = target_plane_covariance(self.features.view, self.pose, camera)
        return PoseLines(self.lines, target_plane(self.pose), covariance, camera.rays(self.features.view.uv))


def locate(features: PoseFeatures, camera: Camera) -> LocatedPose:
    """Estimate the target's pose and find its straight stripes; a pose that cannot be used has an exclusion."""
    nowhere = LocatedPose(features, Pose.identity(), np.nan, (), exclusion=features.exclusion)
    if not features.used or features.view is None:
        return nowhere
    try:
        estimate = estimate_pose(features.view, camera)
    except TargetNotFound as error:
        return nowhere.left_out(error.what)
    lines = straight_lines(features.centrelines, camera)
    located = LocatedPose(features, estimate.pose, estimate.rms_px, lines)
    if lines:
        return located
    return located.left_out(Message("fan.no_straight_stripe", "no straight stripe was found on the target"))


def shows_no_stripe(features: PoseFeatures, camera: Camera) -> bool:
    """Whether the target is found in a pose, but no straight stripe on it."""
    if features.view is None or features.target_moved:
        return False
    return not straight_lines(features.centrelines, camera)
