"""What is seen in the pictures of one pose of the plane target, for looking at."""

from __future__ import annotations

import numpy as np

from core.calibrate.fan.poses.located_pose import locate
from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.calibrate.fan.poses.pose_stages import PoseStages, numbered_stripes
from core.errors import InputError
from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_set import RecordingSet
from core.image.display import in_8_bit, white_level
from core.image.stripes.stripe import StripeSettings
from core.messages import Message
from core.model import Camera, Fan
from core.pipeline.steps.no_stripe import ridge_of
from core.progress import Progress, silent


def pose_stages(
    recording_set: RecordingSet,
    pose: PoseFeatures,
    camera: Camera,
    fan: Fan | None = None,
    progress: Progress = silent,
    stripe: StripeSettings | None = None,
) -> PoseStages:
    """Compute all stages of finding the stripes in one pose; without a `fan` they have no line numbers.

    `stripe` is the width and contrast that were looked for, if given.

    Raises
    ------
    InputError
        If the set has no such pose, or its picture cannot be read.
    """
    progress("pose", 0, 1)
    pair = next((pair for pair in recording_set.planes if pair.name == pose.name), None)
    if pair is None:
        raise InputError(
            Message("project.no_such_pose", "there is no such pose in the set"), where=f"planes/{pose.name}"
        )
    pictures = PictureReader(recording_set)
    picture = pictures.read(pair.on)
    corners = np.zeros((0, 2)) if pose.view is None else pose.view.uv
    stripes = numbered_stripes(pose, camera, fan)
    ridge = ridge_of(pictures, pose, camera, stripe)
    progress("pose", 1, 1)
    shown = in_8_bit(picture, white_level(picture))
    return PoseStages(pose.name, shown, corners, stripes, locate(pose, camera).reason, pose.notes, ridge)
