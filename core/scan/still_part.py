"""Which sweeps of a scan saw one and the same surface."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.model import Camera, Fan
from core.progress import Progress, silent
from core.scan.crossings import CrossingTable, Index
from core.scan.locate import locate_together
from core.scan.standstill import Movement, find_movement

FEWEST_SWEEPS = 12
"""A part of a scan with fewer sweeps, or fewer of their crossings with the fan, is not worth measuring."""

MUCH_WORSE = 1.5
"""The larger part is not taken if it disagrees with the fan so many times more than the smaller."""


@dataclass(frozen=True, eq=False, slots=True)
class StillPart:
    """The crossings (M,) that are kept, and when something moved."""

    kept: NDArray[np.bool_]
    movements: tuple[Movement, ...]

    def note(self, names: Sequence[str], frames: int) -> tuple[str, ...]:
        """A sentence for the technician, if anything moved; `frames` of them are used."""
        if not self.movements:
            return ()
        return (
            f"Object or camera moved {_when(self.movements, names)}: crossings of the frames before and after "
            f"disagree. Only {frames} frames between which nothing moved are used. Hold both still and scan again to "
            "use them all.",
        )


def still_part(
    crossings: CrossingTable,
    line: Index,
    camera: Camera,
    fan: Fan,
    names: Sequence[str],
    progress: Progress = silent,
) -> StillPart:
    """Of a scan during which something moved, the larger part that agrees with itself and with the fan.

    `line` (M,) is the fan's line of each crossing, −1 between sweeps; `names` are the frames'.

    Raises
    ------
    InputError
        If too little is left.
    """
    kept, movements = np.ones(len(crossings), dtype=np.bool_), []
    while movement := find_movement(crossings.select(kept), line[kept], camera, fan):
        movements.append(movement)
        later_a, later_b = crossings.a >= movement.first_after, crossings.b >= movement.first_after
        parts = [
            kept & ~later_a & (crossings.with_fan | ~later_b),
            kept & later_a & (crossings.with_fan | later_b),
        ]
        solved = []
        for part in parts:
            count = _sweeps(crossings, part)
            if count >= FEWEST_SWEEPS and np.count_nonzero(crossings.with_fan & part) >= FEWEST_SWEEPS:
                scale = locate_together(crossings.select(part), line[part], camera, fan, progress).scale
                solved.append((count, scale, part))
        if not solved:
            raise InputError(
                f"object or camera moved {_when(movements, names)}, and too few frames are left between which nothing "
                "did",
                where="scan",
                todo="hold both still and scan again",
            )
        solved.sort(key=lambda one: -one[0])
        worse = len(solved) > 1 and solved[0][1] > MUCH_WORSE * max(solved[1][1], 1.0)
        kept = solved[int(worse)][2]
    return StillPart(kept, tuple(movements))


def _sweeps(crossings: CrossingTable, rows: NDArray[np.bool_]) -> int:
    return len(np.unique(np.concatenate([crossings.a[rows], crossings.b[rows & ~crossings.with_fan]])))


def _when(movements: Sequence[Movement], names: Sequence[str]) -> str:
    ordered = sorted(movements, key=lambda one: one.first_after)
    return " and ".join(f"between {names[one.last_before]} and {names[one.first_after]}" for one in ordered)
