"""Stripes that are exposed too long: where a picture is saturated, neither a point nor a crossing is measured."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.image.stripes.centreline import Centreline
from core.messages import Message

MANY = 1 / 3
"""Share of a scan's stripe points whose saturation is told: what is left is darker surface and the stripes' ends."""
ADVICE = Message("scan.advice_expose_less", "expose shorter, close the lens's aperture, or turn the lasers down")


def saturated_share(pieces: Sequence[Centreline]) -> float:
    """Share of the points of centrelines that are saturated; 0 without points."""
    saturated = np.concatenate([np.zeros(0, np.bool_), *(piece.saturated for piece in pieces)])
    return float(saturated.mean()) if len(saturated) else 0.0


def overexposed(fan: Sequence[Centreline], sweeps: Sequence[Centreline]) -> Message | None:
    """What to say of stripes that are saturated too often; None if they are not."""
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
