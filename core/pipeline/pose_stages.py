"""What is seen in the pictures of one pose of the plane target, for looking at."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.calibrate.plane_pose import PoseFeatures
from core.calibrate.pose_stripes import NumberedStripe, numbered_stripes
from core.errors import InputError
from core.files.recording_set import RecordingSet
from core.image.display import in_8_bit, white_level
from core.model import Camera, Fan
from core.model.arrays import Array
from core.pipeline.frame_stages import Picture8
from core.progress import Progress, silent


@dataclass(frozen=True, eq=False, slots=True)
class PoseStages:
    """The picture of a pose with the fan on, and what was found.

    `corners` (N, 2) in pixels are the target's points, none if it was not found; `stripes` the straight stripes with
    the fan line each is of; `reason` why the pose cannot be used, empty if it can.
    """

    name: str
    picture: Picture8
    corners: Array
    stripes: tuple[NumberedStripe, ...]
    reason: str
    notes: tuple[str, ...]


def pose_stages(
    found: RecordingSet,
    pose: PoseFeatures,
    camera: Camera,
    fan: Fan | None = None,
    progress: Progress = silent,
) -> PoseStages:
    """Look at one pose; without a fan its stripes have no numbers yet.

    Raises
    ------
    InputError
        If the set has no such pose, or its picture cannot be read.
    """
    progress("pose", 0, 1)
    pair = next((pair for pair in found.planes if pair.name == pose.name), None)
    if pair is None:
        raise InputError("there is no such pose in the set", where=f"planes/{pose.name}")
    picture = found.read(pair.on)
    corners = np.zeros((0, 2)) if pose.view is None else pose.view.uv
    stripes = numbered_stripes(pose, camera, fan)
    progress("pose", 1, 1)
    return PoseStages(pose.name, in_8_bit(picture, white_level(picture)), corners, stripes, pose.reason, pose.notes)
