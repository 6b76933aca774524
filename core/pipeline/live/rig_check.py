"""Whether camera and laser were checked today: asked by the window as well, so nothing large is imported here."""

from __future__ import annotations

from datetime import datetime

from core.files.results.check_file import InterimCheck
from core.messages import Message
from core.scan.preview.preflight import Check


def rig_check(check: InterimCheck | None, now: datetime, sitting_hours: float | None = None) -> Check:
    """Make the check of whether camera and laser were checked on the day of `now`, a time with its zone.

    Planes calibrated in this sitting, so many hours ago, are as good as a check.
    """
    if check is None and sitting_hours is not None:
        return Check(
            "check",
            "ok",
            Message(
                "live.calibrated_in_this_sitting",
                "The laser planes were calibrated {hours:.1f} h ago with this camera: no check is needed.",
                hours=sitting_hours,
            ),
        )
    if check is None or check.taken_at.astimezone(now.tzinfo).date() != now.date():
        return Check(
            "check",
            "unknown",
            Message(
                "live.not_checked_today",
                "Camera and laser are not checked today: before the scan, press Take 3 pictures on the card of the "
                "check and hold the plane target into the fan.",
            ),
        )
    return Check("check", "ok" if check.passed else "failed", check.sentence)
