"""One recording set of a batch: how far it is, what became of it, how tables of command line and window tell it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from core.messages import Message, label
from core.report.wording import Words, grouped, with_uncertainty
from core.states import DECISIONS

SET_COLUMNS = (
    label("set"), label("thickness"), label("U"), label("verdict"), label("points"), label("frames"), label("time"),
)  # fmt: skip
"""Titles: the set's name, and the cells of `set_cells`."""


@dataclass(frozen=True, slots=True)
class SetResult:
    """Result of measuring one recording set of a batch, or the error that it ended with.

    Parameters
    ----------
    folder, out
        The set, and where its results are.
    thickness_mm, U_mm, verdict
        None and "" where no thickness was measured or no verdict asked for.
    points, frames, frames_used
        Of the scan.
    seconds
        Time taken.
    error
        Why it could not be measured; None if it could.
    no_thickness
        Whether that is no more than that no thickness could be found.
    fault
        Whether the program was at fault, not the set.
    """

    folder: Path
    out: Path
    thickness_mm: float | None = None
    U_mm: float | None = None
    verdict: str = ""
    points: int = 0
    frames: int = 0
    frames_used: int = 0
    seconds: float = 0.0
    error: Message | None = None
    no_thickness: bool = False
    fault: bool = False


@dataclass(frozen=True, slots=True)
class SetProgress:
    """Progress of a recording set that is being measured: its stage, and the share of the whole that is done, 0 … 1."""

    stage: str
    share: float


class SetCells(NamedTuple):
    """Texts for the row of one recording set in a table; "" for what was not measured."""

    thickness: str
    """In mm, without the unit, as U."""
    U: str
    verdict: str
    points: str
    frames: str
    """How many were used, of how many."""
    time: str


def set_cells(result: SetResult, words: Words) -> SetCells:
    """Make the texts for the row of one recording set in a table, in the language of `words`."""
    seconds = words("{seconds:.1f} s", seconds=result.seconds)
    if result.error:
        return SetCells("", "", "", "", "", seconds)
    thickness = U = ""
    if result.thickness_mm is not None and result.U_mm is not None:
        thickness, U = with_uncertainty(result.thickness_mm, result.U_mm, words)
    frames = words("{used} of {all}", used=result.frames_used, all=result.frames)
    return SetCells(thickness, U, words(DECISIONS[result.verdict]), grouped(result.points), frames, seconds)
