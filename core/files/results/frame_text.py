"""The frame of reference of files that are handed over: in words, and as the motion back into the camera frame."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from core.errors import InputError
from core.files.limits import LARGEST
from core.inspect.shown.view_frame import CAMERA_FRAME, FrameKind, ViewFrame
from core.messages import Message
from core.model import Pose

IN_WORDS: Mapping[FrameKind, str] = {
    FrameKind.CAMERA: "the camera, z forward, y down",
    FrameKind.GROUND: "the part, z up from its lower face, x along the camera's",
    FrameKind.PART: "the part, coordinates of the inspection plan",
}
"""As files say it, in English: it is read by programs, too."""
SHORT: Mapping[FrameKind, str] = {
    FrameKind.CAMERA: "camera frame, z forward",
    FrameKind.GROUND: "part, z up from lower face",
    FrameKind.PART: "part coordinates of the plan",
}
"""Where there is room for 80 letters."""
_FRAME, _BACK = "frame of reference: ", "into the camera frame: "
_LARGEST_SHEAR = 1e-6
"""That rows of a rotation may be off right angles and length 1."""


def frame_words(kind: FrameKind) -> str:
    """Name a frame of this kind in English, for the head of a file."""
    return f"{_FRAME}{IN_WORDS[kind]}"


def frame_comments(frame: ViewFrame) -> list[str]:
    """Make the comments of a PLY file's head that tell its frame: the name, and the motion into the camera frame."""
    words = frame_words(frame.kind)
    if frame.kind is FrameKind.CAMERA:
        return [words]
    pose = frame.pose_camera_frame
    numbers = " ".join(repr(float(one)) for one in (*pose.rotation.ravel(), *pose.translation))
    return [words, f"{_BACK}{numbers}"]


def pose_in_comments(comments: Sequence[str], path: Path) -> Pose:
    """Read the motion into the camera frame from a PLY file's comments; the identity where they name no frame.

    Raises
    ------
    InputError
        If it is no rotation and translation, or another frame is named without it.
    """
    told = [line.removeprefix(_BACK) for line in comments if line.startswith(_BACK)]
    if not told and all(line == frame_words(FrameKind.CAMERA) for line in comments if line.startswith(_FRAME)):
        return CAMERA_FRAME.pose_camera_frame
    try:
        numbers = np.array([float(word) for word in told[0].split()]) if told else np.zeros(0)
    except ValueError:
        numbers = np.zeros(0)
    rotation = numbers[:9].reshape(3, 3) if numbers.shape == (12,) else np.zeros((3, 3))
    with np.errstate(over="ignore", invalid="ignore"):
        rigid = np.abs(rotation @ rotation.T - np.eye(3)).max() < _LARGEST_SHEAR and np.linalg.det(rotation) > 0
    if not rigid or not np.all(np.abs(numbers[9:]) <= LARGEST):
        raise InputError(
            Message(
                "file.no_frame",
                "the motion into the camera frame, which its head states, is missing or no rotation and translation",
            ),
            where=path,
            todo=Message("advice.make_file_again", "make it again"),
        )
    return Pose(rotation, numbers[9:])
