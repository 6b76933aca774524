"""One pose of the plane target as it is shown, used or not: its picture, its stripes and the fan line each is of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.calibrate.fan.poses.located_pose import locate
from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.calibrate.fan.poses.stripe_lines import StripeLine
from core.calibrate.fan.poses.target_plane import on_target
from core.messages import Message
from core.model import Camera, Fan, LightPlane, Pose
from core.model.arrays import Array

NOT_SEEN = -1
"""The number of a stripe that no fan line drew, or of which it is not known."""
TOO_FAR = 0.005
"""A stripe whose points are further (RMS) from a light plane than this share of their depth is not of that plane."""


@dataclass(frozen=True, eq=False, slots=True)
class NumberedStripe:
    """Straight stripe: its points (N, 2) in px, and the fan line (from 0) that drew it or NOT_SEEN."""

    uv: Array
    line: int


@dataclass(frozen=True, eq=False, slots=True)
class PoseStages:
    """Picture (H, W) of a pose with the fan on, with the target and stripes found.

    `corners` (N, 2) in pixels are the target's points, none if it was not found; `stripes` the straight stripes with
    the fan line each is of; `reason` why the pose cannot be used, None if it can. `ridge` (H, W), where no
    stripe was found, is how strongly each place looks like one, the strongest white.
    """

    name: str
    picture: NDArray[np.uint8]
    corners: Array
    stripes: tuple[NumberedStripe, ...]
    reason: Message | None
    notes: tuple[Message, ...]
    ridge: NDArray[np.uint8] | None = None


def numbered_stripes(features: PoseFeatures, camera: Camera, fan: Fan | None = None) -> tuple[NumberedStripe, ...]:
    """List the straight stripes of a pose with the fan line that drew each; NOT_SEEN without `fan` or target."""
    located = locate(features, camera)
    if features.view is None or not located.lines:
        return tuple(NumberedStripe(piece.uv, NOT_SEEN) for piece in features.centrelines)
    numbers = line_numbers(located.lines, located.pose, fan) if fan else [NOT_SEEN] * len(located.lines)
    return tuple(NumberedStripe(stripe.uv, line) for stripe, line in zip(located.lines, numbers, strict=True))


def line_numbers(stripes: Sequence[StripeLine], pose: Pose, fan: Fan) -> list[int]:
    """Find for each stripe the index of the fan line that drew it, the nearest light plane, or NOT_SEEN.

    Each plane takes the stripe that is nearest to it, the best-fitting pair first.
    """
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
