"""Boards that lie beside the object during the scan, known planes, and what may be wrong with them."""

from __future__ import annotations

from dataclasses import dataclass

from core.errors import InputError
from core.messages import Message
from core.simulate.effects.ranges import require_ranges

KINDS = ("charuco", "rectangle")
"""What may be printed on the corner's boards."""


@dataclass(frozen=True, slots=True)
class BoardsBeside:
    """Known planes of a scan: the plate of the plane target on the table, and a corner of two boards behind the object.

    The first board is the plate, or the near one of the corner. Each has a picture, lasers off, in scan/planes.

    Parameters
    ----------
    plate
        Whether the plate with the plane target lies on the table.
    plate_right_mm, plate_away_mm, plate_turned_deg
        Its middle, from that of the table, and how it is turned. As usual it lies behind the object, where all sweeps
        cross it; at 125 and 10 to the right of it, in all lines of the fan.
    corner
        Whether two boards meet behind the object, hollow to the camera: "near" rises from the edge in which they meet
        towards the object, "far" away from it. All sweeps cross the near one, nine in ten the far one as well.
    corner_deg
        Angle between them.
    kind
        What is printed on both, "charuco" or "rectangle" (an outline).
    bent_mm
        How far the left and right edges of the first board lie in front of the plane through its middle.
    larger
        By which share all boards are larger than stated.
    moved_mm
        How far the first board is moved aside from the scenario's `moved_frame` on.
    shaded
        Whether the room's light comes low from the front, so that the object's shadow falls on the plate behind it; the
        near board of a corner is dark then.
    """

    plate: bool = False
    plate_right_mm: float = 0.0
    plate_away_mm: float = 116.0
    plate_turned_deg: float = 0.0
    corner: bool = False
    corner_deg: float = 90.0
    kind: str = "charuco"
    bent_mm: float = 0.0
    larger: float = 0.0
    moved_mm: float = 0.0
    shaded: bool = False

    def __post_init__(self) -> None:
        require_ranges(
            self,
            (
                ("plate_right_mm", -200.0, 200.0),
                ("plate_away_mm", -200.0, 200.0),
                ("plate_turned_deg", -180.0, 180.0),
                ("corner_deg", 60.0, 170.0),
                ("bent_mm", -5.0, 5.0),
                ("larger", -0.1, 0.1),
                ("moved_mm", -20.0, 20.0),
            ),
        )
        if self.kind not in KINDS:
            raise InputError(
                Message("simulate.not_one_of", "'{value}' is not one of {allowed}", value=self.kind, allowed=KINDS),
                where="boards.kind",
            )


NO_BOARDS = BoardsBeside()
"""Nothing lies beside the object."""
