"""A stated width of stripes, held against the width that their cross-sections have.

Told a width 40 % too small, centrelines scatter by twice the Cramér–Rao bound, and σ is 1.3 times too small; what is
measured of the cross-sections is the width all the same.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np

from core.findings.table import note_of
from core.image.stripes.centreline import Centreline
from core.image.stripes.stripe import WIDTH_IN_SIGMA, StripeSettings
from core.messages import Message

_NARROWEST, _WIDEST = 0.8, 1.25
"""Measured over told width between which it is left as told: scatter and σ hardly change there."""
_ROUNDS = 3
"""Corrections at most: told a third of the width of a speckled stripe, it is right within 10 % after two."""


def as_measured(
    told: StripeSettings, look: Callable[[StripeSettings], tuple[Centreline, ...]]
) -> tuple[StripeSettings, tuple[Centreline, ...]]:
    """Extract centrelines by `look` with the `told` width, again with the measured one if that differs much from it.

    Returns the settings that they were found with, and the centrelines.
    """
    found = look(told)
    for _ in range(_ROUNDS):
        if not found:
            break
        measured_px = WIDTH_IN_SIGMA * float(np.median(np.concatenate([line.width for line in found])))
        if _NARROWEST <= measured_px / told.width_px <= _WIDEST:
            break
        told = replace(told, width_px=measured_px)
        found = look(told)
    return told, found


def stated_width_notes(told: StripeSettings | None, used: Iterable[StripeSettings | None]) -> tuple[Message, ...]:
    """Note that much wider or narrower stripes were `used` than `told`, with the farthest width; () if not."""
    if told is None:
        return ()
    widths = [settings.width_px for settings in used if settings is not None]
    measured = max(widths, key=lambda width: abs(np.log(width / told.width_px)), default=told.width_px)
    if _NARROWEST <= measured / told.width_px <= _WIDEST:
        return ()
    return (note_of("stripes.told_width_wrong", told_px=told.width_px, measured_px=measured),)
