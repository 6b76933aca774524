"""What is told of pictures: how many were used, whether they are enough, and why others were left out."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple, Protocol

from core.calibrate import grades
from core.calibrate.grades import Limit
from core.messages import Message
from core.report.facts.fact import Fact, Grade
from core.scan.features.frames import NO_REASON

_GRADES: dict[grades.Grade, Grade] = {
    grades.Grade.GOOD: "good", grades.Grade.FAIR: "warn", grades.Grade.POOR: "bad",
}  # fmt: skip
NAMES_SHOWN = 3
"""So many pictures left out for one reason are named in a line."""


class Picture(Protocol):
    """View, pose or frame; one that was left out may have a reason."""

    @property
    def name(self) -> str:
        """Name of the picture: of a view, a pose or a frame."""

    @property
    def used(self) -> bool:
        """Whether the picture is used in the result."""

    @property
    def reason(self) -> Message | None:
        """Reason why the picture was left out; None if it is used, or if no reason is known."""


class LeftOut(NamedTuple):
    """Reason, with the names of the pictures left out for it."""

    reason: Message
    names: list[str]

    def line(self, most: int = NAMES_SHOWN) -> Message:
        """Make the message of how many pictures were left out, why, and which: at most `most` names."""
        shown = [name.rpartition("/")[2] for name in self.names[:most]]
        names = (*shown, *(["…"] if len(self.names) > most else []))
        return Message(
            "told.left_out", "{count} × {reason}: {names}",
            count=len(self.names), reason=self.reason, names=names,
        )  # fmt: skip


def left_out(pictures: Iterable[Picture]) -> list[LeftOut]:
    """Group the pictures that were left out by their reason, the most frequent reason first."""
    reasons: dict[Message, list[str]] = {}
    for picture in pictures:
        if not picture.used:
            reasons.setdefault(picture.reason or NO_REASON, []).append(picture.name)
    return sorted((LeftOut(*item) for item in reasons.items()), key=lambda one: -len(one.names))


def used_fact(name: str, pictures: Sequence[Picture], tip: str, limit: Limit | None = None) -> Fact:
    """Make the fact on how many of the pictures are used, graded by `limit` if one is given."""
    used = sum(picture.used for picture in pictures)
    value = Message("told.used", "{used:,} of {all:,}", used=used, all=len(pictures))
    if limit is None:
        return Fact(name, value, tip=tip)
    return Fact(name, value, tip=limits_tip(tip, limit.good, limit.poor), grade=grade(limit, used))


def grade(limit: Limit, value: float) -> Grade:
    """Grade a value by a limit of the calibrations: "good", "warn" or "bad"."""
    return _GRADES[limit.grade(value)]


def limits_tip(tip: str, good: float, poor: float, unit: str = "") -> Message:
    """Make the tooltip of a value: `tip`, then from which value on it is good and below which it is poor."""
    return Message(
        "told.limits", "{what}. Good from {good:.0f}{unit} on, poor below {poor:.0f}{unit}",
        what=tip, good=good, poor=poor, unit=unit,
    )  # fmt: skip
