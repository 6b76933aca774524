"""How fan, table and hand are set up: other than in the paper, and nothing wrong with it."""

from __future__ import annotations

from dataclasses import dataclass

from core.simulate.effects.ranges import require_ranges


@dataclass(frozen=True, slots=True)
class Setup:
    """Turns of rig, table and hand beside their default places.

    Parameters
    ----------
    fan_turned_deg
        The fan, and the course of the hand with it, turned about the viewing direction through the work point: at 90
        the fan's lines run down the picture.
    table_right_deg, table_away_deg
        The table with the object on it, tilted about its own x and y axis.
    stripes_turned
        Factor on the tilts of the hand-held laser's stripes, pass by pass: at 0 all run nearly alike.
    hand_aside
        Factor on the distance of the hand-held laser from the optical axis: the larger, the more obliquely its light
        meets the table.
    """

    fan_turned_deg: float = 0.0
    table_right_deg: float = 0.0
    table_away_deg: float = 0.0
    stripes_turned: float = 1.0
    hand_aside: float = 1.0

    def __post_init__(self) -> None:
        require_ranges(
            self,
            (
                ("fan_turned_deg", -180.0, 180.0),
                ("table_right_deg", -30.0, 30.0),
                ("table_away_deg", -30.0, 30.0),
                ("stripes_turned", -1.0, 1.2),
                ("hand_aside", 0.3, 3.0),
            ),
        )


USUAL_SETUP = Setup()
"""Everything in its usual place."""
