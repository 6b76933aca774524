"""Why no stripe was found on a pose: a picture of how strongly each place looks like one."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from core.calibrate.fan.poses.located_pose import shows_no_stripe
from core.calibrate.fan.poses.plane_pose import stripe_strength
from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.errors import InputError
from core.files.recording.picture_reader import PictureReader
from core.image.display import in_8_bit
from core.image.stripes.stripe import USUAL_STRIPE, StripeSettings
from core.messages import Message
from core.model import Camera
from core.pipeline.steps.workspace import RIDGES, Workspace


def ridge_of(
    pictures: PictureReader, pose: PoseFeatures, camera: Camera, stripe: StripeSettings | None = None
) -> NDArray[np.uint8] | None:
    """Draw (H, W) where a pose without a straight stripe looks most like one of `stripe`, the likest place white.

    None where a stripe was found, or no target.

    Raises
    ------
    InputError
        If a picture cannot be read.
    """
    pair = next((pair for pair in pictures.recording_set.planes if pair.name == pose.name), None)
    if pair is None or not shows_no_stripe(pose, camera):
        return None
    off = None if pair.off is None else pictures.read(pair.off)
    strength = stripe_strength(pictures.read(pair.on), off, stripe or USUAL_STRIPE)
    return in_8_bit(strength, float(strength.max()))


def write_ridges(
    work: Workspace,
    pictures: PictureReader,
    poses: Sequence[PoseFeatures],
    camera: Camera,
    stripe: StripeSettings | None,
) -> Message | None:
    """Write a picture of ridge strength of each pose without a stripe into the folder RIDGES, in place of older ones.

    Returns a note on them, None if there are none.

    Raises
    ------
    InputError
        If nothing can be written there.
    """
    ridges = {pose.name: ridge_of(pictures, pose, camera, stripe) for pose in poses}
    shown = {name: ridge for name, ridge in ridges.items() if ridge is not None}
    work.put_ridges(shown)
    if not shown:
        return None
    return Message(
        "fan.ridges_written",
        "where no stripe was found, a picture in {folder} shows how strongly each place looks like one ({n} in all)",
        n=len(shown),
        folder=f"{RIDGES}/",
    )


def also_look_at_ridges(error: InputError) -> InputError:
    """Add to the error that ended a calibration the advice to look at the pictures in the folder RIDGES."""
    todo = Message(
        "advice.look_at_ridges",
        "look at the pictures in {folder}, where what looks most like a stripe is white; {advice}",
        folder=f"{RIDGES}/",
        advice=error.todo,
    )
    return InputError(error.what, where=error.where, todo=todo)
