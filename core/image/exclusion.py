"""Why a view, a pose or a frame counts for nothing. Light to import: a window holds these."""

from __future__ import annotations

from collections.abc import Mapping
from enum import Enum, auto

from core.messages import Message


class Exclusion(Enum):
    """Reason to exclude a readable view, pose or frame, where something is decided by it."""

    BY_HAND = auto()
    REPEATED = auto()
    MOVED = auto()
    WITHOUT_FAN = auto()
    WITHOUT_STRIPE = auto()

    @property
    def message(self) -> Message:
        """Sentence that tells why a view, pose or frame is excluded."""
        return _WORDS[self]


_WORDS: Mapping[Exclusion, Message] = {
    Exclusion.BY_HAND: Message("set.left_out_by_hand", "left out by hand"),
    Exclusion.REPEATED: Message(
        "set.picture_repeated", "the same picture as an earlier one, pixel for pixel: it counts once"
    ),
    Exclusion.MOVED: Message(
        "scan.frame_moved",
        "object or camera moved during the scan: the fan's light lies elsewhere than in the reference",
    ),
    Exclusion.WITHOUT_FAN: Message(
        "scan.frame_without_fan",
        "the fan's light is gone: object or camera moved far during the scan, or the three-line laser was off",
    ),
    Exclusion.WITHOUT_STRIPE: Message("scan.frame_without_stripe", "no stripe of the hand-held laser"),
}
MOVEMENTS = frozenset({Exclusion.MOVED, Exclusion.WITHOUT_FAN})
"""Those of frames that show the fan's light elsewhere than the reference, or not at all."""

Reason = Exclusion | Message
"""What excludes something: one of these, or else what is wrong with it, in words alone."""


def message_of(reason: Reason) -> Message:
    """Return the sentence that a reason for excluding something tells, be it an `Exclusion` or a message."""
    return reason.message if isinstance(reason, Exclusion) else reason


class Excludable:
    """View, pose or frame that counts unless it has an `exclusion`."""

    __slots__ = ()
    exclusion: Reason | None

    @property
    def reason(self) -> Message | None:
        """Sentence that tells why the view, pose or frame is excluded; None if it counts."""
        return None if self.exclusion is None else message_of(self.exclusion)


_KNOWN = {one.message.code: one for one in Exclusion} | {str(one.message): one for one in Exclusion}


def known_exclusion(kept: Message | None) -> Reason | None:
    """Convert the reason for an exclusion read from a file to an `Exclusion`, or leave a message as it is.

    None stays None.

    Examples
    --------
    >>> known_exclusion(Exclusion.MOVED.message)
    <Exclusion.MOVED: 3>
    """
    return None if kept is None else _KNOWN.get(kept.code or str(kept), kept)
