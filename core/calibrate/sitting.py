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
SIMULATED = "simulated"
"""Kind of source, and so the first word of the camera's name, of pictures that the simulated rig took."""


@dataclass(frozen=True, slots=True)
class Acquisition:
    """Camera of a recording, as its log names it, and the times of its first and last picture."""

    camera: str
    first: datetime
    last: datetime

    @property
    def simulated(self) -> bool:
        """Whether the simulated rig took the pictures."""
        return self.camera.split(" ")[0] == SIMULATED


def hours_of_sitting(
    planes: Acquisition | None, scan: Acquisition | None, fresh_hours: float | None = None
) -> float | None:
    """Compute the hours from the first picture of planes and scan to the last; None if not of one sitting, or unknown.

    Of one sitting are pictures of one camera within `fresh_hours`, or the usual hours where the rig states none.
    """
    if planes is None or scan is None or planes.camera != scan.camera:
        return None
    hours = (max(planes.last, scan.last) - min(planes.first, scan.first)) / timedelta(hours=1)
    return hours if hours <= (FRESH_HOURS if fresh_hours is None else fresh_hours) else None
