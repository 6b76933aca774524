"""Which fan line each stripe on a pose of the target is, once the fan is known: for showing a pose, used or not."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.calibrate.located_pose import locate
from core.calibrate.pose_features import PoseFeatures
from core.calibrate.pose_stages import NOT_SEEN, NumberedStripe
from core.calibrate.stripe_lines import StripeLine
from core.calibrate.target_plane import on_target
from core.model import Camera, Fan, LightPlane, Pose
from core.model.arrays import Array

TOO_FAR = 0.005
"""A stripe whose points are further (RMS) from a light plane than this share of their depth is not of that plane."""


def numbered_stripes(features: PoseFeatures, camera: Camera, fan: Fan | None = None) -> tuple[NumberedStripe, ...]:
    """The straight stripes of a pose; without a fan, or where the target was not found, they have no numbers."""
    located = locate(features, camera)
    if features.view is None or not located.lines:
        return tuple(NumberedStripe(piece.uv, NOT_SEEN) for piece in features.centrelines)
    numbers = _numbers(located.lines, located.pose, fan) if fan else [NOT_SEEN] * len(located.lines)
    return tuple(NumberedStripe(stripe.uv, line) for stripe, line in zip(located.lines, numbers, strict=True))


def _numbers(stripes: Sequence[StripeLine], pose: Pose, fan: Fan) -> list[int]:
    """Each plane takes the stripe that is nearest to it, the best-fitting pair first."""
    points = [on_target(stripe.rays, pose) for stripe in stripes]
    off = np.array([[_misfit(plane, own) for plane in fan.planes] for own in points])
    numbers = [NOT_SEEN] * len(stripes)
    while off.size and off.min() < TOO_FAR:
        stripe, line = np.unravel_index(int(off.argmin()), off.shape)
        numbers[int(stripe)] = int(line)
        off[stripe, :] = off[:, line] = np.inf
    return numbers


def _misfit(plane: LightPlane, points: Array) -> float:
    """RMS distance of `points` (N, 3) from a plane as a share of their depth."""
    return float(np.sqrt(np.mean(plane.distances(points) ** 2)) / np.median(points[:, 2]))
