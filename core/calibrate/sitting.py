"""Whether light planes and a scan are of one sitting, by what the logs of their recordings say.

Pictures of a calibration leave open what pictures of a check do: what has changed since they were taken. So planes
that were calibrated by the same camera within a few hours of the scan are a check of the day. What the dates of files
say is not believed: copying changes them.
"""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime, timedelta

FRESH_HOURS = 4.0
"""From the first picture of the planes to the last of the scan, at most, where the rig's description does not say."""


@dataclass(frozen=True, slots=True)
class Taken:
    """By which camera a recording was made, as its log names it, and when its first and last picture were taken."""

    camera: str
    first: datetime
    last: datetime


def hours_of_sitting(planes: Taken | None, scan: Taken | None, fresh_hours: float | None = None) -> float | None:
    """Hours from the first picture to the last where both are of one sitting; else, or where that is not known, None.

    That is within `fresh_hours`, where the rig's description states them.
    """
    if planes is None or scan is None or planes.camera != scan.camera:
        return None
    hours = (max(planes.last, scan.last) - min(planes.first, scan.first)) / timedelta(hours=1)
    return hours if hours <= (FRESH_HOURS if fresh_hours is None else fresh_hours) else None
