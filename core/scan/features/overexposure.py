"""Stripes that are exposed too long: where a picture is saturated, neither a point nor a crossing is measured."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from core.findings.table import note_of
from core.image.exposure import BRIGHTEST
from core.image.stripes.centreline import Centreline
from core.messages import Message

MANY = 1 / 3
"""Share of a scan's stripe points whose saturation is told: what is left is darker surface and the stripes' ends."""
SOME = 0.01
"""Share of the fan's stripe points from which on saturation is told. In ideal scans at most 0.1 % are; a lobe of 6°
three times as bright as the rest saturates 1.5 % and more. The sweeps' share does not tell gloss: where they cross the
fan its light is added, which saturates 1.7 % of the sample. Held by tests/scan/features/test_overexposure.py."""
LOBE = 1.4
"""A shining surface reflects a lobe: its saturated places are 1.8 times as high as the rest of their stripes, or more.
On matt surfaces that are lit strongly it is grains of speckle that saturate, at most 1.2 times as high."""
_BRIGHT = 90.0
"""Percentile of the heights of saturated stripes, by their flanks, that the exposure is to hold."""
ADVICE = Message(
    "scan.advice_expose_less",
    "take at least 1 stop less of light: expose shorter, close the lens's aperture, or turn the lasers down",
)


def saturated_share(pieces: Sequence[Centreline]) -> float:
    """Compute the share of the points of centrelines that are saturated; 0 without points."""
    saturated = np.concatenate([np.zeros(0, np.bool_), *(piece.saturated for piece in pieces)])
    return float(saturated.mean()) if len(saturated) else 0.0


def overexposed(fan: Sequence[Centreline], sweeps: Sequence[Centreline]) -> Message | None:
    """Make the complaint that too many points of the fan's or the sweeps' stripes are saturated; None if not."""
    of_fan, of_sweeps = saturated_share(fan), saturated_share(sweeps)
    if max(of_fan, of_sweeps) <= MANY:
        return None
    return Message(
        "scan.overexposed",
        "stripes are overexposed: {fan:.0f} % of the fan's points and {sweeps:.0f} % of the hand-held laser's are "
        "saturated, and nothing is measured there",
        fan=100 * of_fan,
        sweeps=100 * of_sweeps,
    )


def notes_on_shine(fan: Sequence[Centreline], sweeps: Sequence[Centreline], full_scale: float) -> tuple[Message, ...]:
    """Make a note if a part of the fan's points is saturated, and by how much to expose less; () for few or too many.

    It says that the surface shines only where the fan's stripes rise to a lobe there (`LOBE`). How far above
    `full_scale`, the largest grey level, a saturated stripe reaches is what its flanks say.
    """
    of_fan, of_sweeps = saturated_share(fan), saturated_share(sweeps)
    if of_fan <= SOME or overexposed(fan, sweeps) is not None:
        return ()
    pieces = (*fan, *sweeps)
    heights = np.concatenate([piece.strength[piece.saturated] for piece in pieces])
    stops = math.log2(float(np.percentile(heights, _BRIGHT)) / (BRIGHTEST * full_scale))
    less = max(math.ceil(2 * stops), 1) / 2
    if _rises(fan):
        return (note_of("scan.shines", fan=100 * of_fan, sweeps=100 * of_sweeps, stops=less),)
    return (note_of("scan.bright_in_part", fan=100 * of_fan, sweeps=100 * of_sweeps, stops=less),)


def _rises(fan: Sequence[Centreline]) -> bool:
    """Whether most saturated points are of stripes that are far higher there than elsewhere, or saturated all along."""
    count = rising = 0
    for piece in fan:
        own = int(piece.saturated.sum())
        rest = piece.strength[~piece.saturated]
        above = float(np.median(piece.strength[piece.saturated]) / np.median(rest)) if own and len(rest) else math.inf
        count += own
        rising += own * (above >= LOBE)
    return 2 * rising >= count
