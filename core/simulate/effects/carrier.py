"""The carrier of reference marks that the object stands in, and what may be wrong with it."""

from __future__ import annotations

from dataclasses import dataclass

from core.simulate.effects.ranges import require_ranges


@dataclass(frozen=True, slots=True)
class CarrierBeside:
    """Carrier of a block: a plate round it with coded rings on both sides, seen in two views.

    Parameters
    ----------
    marks
        Rings on each side; 0: there is no carrier, and one view.
    turned
        Whether this is the view in which the block with its carrier is turned over, side B up.
    again
        Whether the second view shows side A again: the block was not turned over.
    moved_mm, smeared
        How far one mark of side B has moved since the carrier was calibrated, and how many marks of each side are
        smeared, their discs no longer round.
    bent_mm
        How far the left and right rims of the carrier are bent up since then, seen from side A.
    slipped_mm
        How far the block has slipped through its carrier between the views, towards side A.
    """

    marks: int = 0
    turned: bool = False
    again: bool = False
    moved_mm: float = 0.0
    smeared: int = 0
    bent_mm: float = 0.0
    slipped_mm: float = 0.0

    def __post_init__(self) -> None:
        require_ranges(
            self,
            (
                ("marks", 0, 24),
                ("moved_mm", -5.0, 5.0),
                ("smeared", 0, 24),
                ("bent_mm", -5.0, 5.0),
                ("slipped_mm", -20.0, 20.0),
            ),
        )


NO_CARRIER = CarrierBeside()
"""The object stands on the table by itself."""
