"""Hints for the hand that moves the laser, one short sentence each."""

from __future__ import annotations

from dataclasses import dataclass

from core.messages import Message

MOST_HINTS = 2
"""Hints shown at a time: a hand can follow no more."""

ENOUGH = 0.7
"""Covered share of what was lit from which on a live scan may be stopped: what is left lies between stripes, in shadow,
or beyond what the fan meets."""


@dataclass(frozen=True, slots=True)
class HintLimits:
    """Limits of σ, speed, brightness and saturation beyond which a hint is given on moving the hand-held laser.

    `sigma_mm`: a frame whose points are this uncertain (median) needs better crossings. `speed_share`: movement from
    frame to frame over the picture's width. `faint` of the largest grey level: a stripe lower than this. `saturated`:
    share of the stripe's points that are overexposed.
    """

    sigma_mm: float = 0.2
    speed_share: float = 0.05
    faint: float = 0.06
    saturated: float = 0.3


@dataclass(frozen=True, slots=True)
class HandState:
    """What one frame shows of the hand-held laser for hints: lines crossed, σ, speed, brightness, saturation.

    `lines_met` of the fan's `lines` are crossed, of the known planes where it has none; `sigma_mm` is the median over
    the frame's points, NaN when the sweep is not located; `speed_px` since the frame before, NaN if not known;
    `width_px` the picture's; `strength` and `full_scale` in grey levels; `saturated` share of the stripe's points.
    """

    lines_met: int
    lines: int
    sigma_mm: float
    speed_px: float
    width_px: int
    strength: float
    full_scale: float
    saturated: float
    has_fan: bool = True


def hints_for(state: HandState, limits: HintLimits) -> tuple[Message, ...]:
    """Choose at most MOST_HINTS hints on moving the hand-held laser, the more urgent first; () when all is well."""
    hints: list[Message] = []
    if state.strength < limits.faint * state.full_scale:
        hints.append(Message("scan.hint_brighter", "Brighter: the stripe is faint."))
    elif state.saturated > limits.saturated:
        hints.append(Message("scan.hint_darker", "Darker: the stripe is overexposed."))
    if state.speed_px > limits.speed_share * state.width_px:
        hints.append(
            Message(
                "scan.hint_slower",
                "Slower: the stripe moves {speed_px:.0f} px from frame to frame.",
                speed_px=state.speed_px,
            )
        )
    if not state.sigma_mm <= limits.sigma_mm:
        if state.lines_met < min(3, state.lines):
            hints.append(
                Message("scan.hint_cross_more", "Cross more of the fan.")
                if state.has_fan
                else Message("scan.hint_light_boards", "Let the line lie on all boards.")
            )
        else:
            hints.append(Message("scan.hint_tilt", "Tilt the laser more."))
    return tuple(hints[:MOST_HINTS])
