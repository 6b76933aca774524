"""What a fan's calibration tells of the poses it left out."""

from __future__ import annotations

import math
from collections.abc import Sequence

from core.calibrate.results import PlanePose
from core.findings.table import note_of
from core.image.exclusion import Exclusion
from core.messages import Message


def note_on_left_out(poses: Sequence[PlanePose]) -> Message | None:
    """Note which poses are left out and why, and how far off the planes they are if known; None if all count."""
    out = [
        Message("fan.pose_and_reason", "{pose} ({reason})", pose=pose.name, reason=pose.reason)
        if math.isnan(pose.rms_mm) or pose.exclusion is Exclusion.BY_HAND
        else Message(
            "fan.pose_reason_and_distance",
            "{pose} ({reason}; {off:.2f} mm off)",
            pose=pose.name,
            reason=pose.reason,
            off=pose.rms_mm,
        )
        for pose in poses
        if pose.reason is not None
    ]
    if not out:
        return None
    return note_of("fan.poses_left_out", n=len(out), all=len(poses), names=tuple(out))
