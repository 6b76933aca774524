"""What is said before all other notes, and in red: that something changed or moved, and why nothing is proven."""

from __future__ import annotations

from collections.abc import Iterable

from core.messages import Message

URGENT = frozenset(
    {
        "inspection.drifted_during_scan",
        "inspection.moved_during_scan",
        "inspection.rig_has_changed",
        "inspection.rig_may_have_changed",
        "inspection.section_has_changed",
        "scan.drifted",
        "scan.fan_has_moved",
        "scan.fan_is_elsewhere",
        "scan.fan_shifted",
        "scan.moved",
        "scan.section_changed",
        "target.size_unconfirmed",
        "target.sizes_disagree",
        "validity.calibration_lapsed",
        "validity.calibration_undated",
        "validity.check_failed",
        "validity.check_lapsed",
        "validity.history_unreadable",
        "validity.never_checked",
        "validity.planes_not_settled",
        "validity.target_points_off",
    }
)
"""Their codes."""


def is_urgent(note: Message) -> bool:
    """Whether a note, or the one that it says of a result, is said first and in red."""
    return note.code in URGENT or any(isinstance(one, Message) and is_urgent(one) for one in note.values.values())


def urgent_first(notes: Iterable[Message]) -> tuple[Message, ...]:
    """Each note once, the urgent ones before the others, else in their order."""
    return tuple(sorted(dict.fromkeys(notes), key=lambda note: not is_urgent(note)))
