"""What is told of a comparison with another surface: where material is missing or added, and what would be seen."""

from __future__ import annotations

from typing import Protocol

from core.messages import Message, label, plain
from core.report.facts.fact import Fact, Reader
from core.wings.geometry.comparison.shown import ALIGNED, Alignment

NOWHERE = label("nowhere significant")


class ChangedPart(Protocol):
    """Places that differ significantly to one side: their share of all, mean and most extreme deviation in mm."""

    @property
    def share(self) -> float: ...
    @property
    def mean_mm(self) -> float: ...
    @property
    def extreme_mm(self) -> float: ...


class Compared(Protocol):
    """Summary of a comparison, as `core.wings.geometry.comparison.comparison_file.ComparisonFile`."""

    @property
    def other(self) -> str: ...
    @property
    def alignment(self) -> Alignment: ...
    @property
    def core_points(self) -> int: ...
    @property
    def lower(self) -> ChangedPart: ...
    @property
    def higher(self) -> ChangedPart: ...
    @property
    def lod95_mm(self) -> float: ...
    @property
    def diameter_mm(self) -> float: ...
    @property
    def registration_mm(self) -> float: ...


def comparison_facts(found: Compared) -> tuple[Fact, ...]:
    """Make the facts on a comparison of two surfaces: the other surface, what differs, and the level of detection."""
    return (
        Fact(label("compared with"), plain(found.other)),
        Fact(label("aligned"), ALIGNED[found.alignment], level=Reader.AUDITOR),
        _changed(label("less material"), found.lower),
        _changed(label("more material"), found.higher),
        Fact(
            label("detectable from"), found.lod95_mm, "mm", 3,
            label("Median of the level of detection: 1.96 times the standard uncertainty of a deviation"),
        ),
        Fact(
            label("registration"), found.registration_mm, "mm", 4,
            label("Standard uncertainty of how both lie on each other, by what most of the surface shows"),
            Reader.AUDITOR,
        ),
        Fact(label("places"), found.core_points, level=Reader.AUDITOR),
        Fact(
            label("diameter of a place"), found.diameter_mm, "mm", tip=label("Of the circles that are compared"),
            level=Reader.AUDITOR,
        ),
    )  # fmt: skip


def _changed(name: str, part: ChangedPart) -> Fact:
    chance = label("Significant at 95 %: by chance alone up to 5 % of the places of an unchanged part are")
    if not part.share:
        return Fact(name, NOWHERE, tip=chance)
    said = Message(
        "told.changed_part",
        "{percent:.1f} % of the places, mean {mean_mm:+.3f} mm, at most {extreme_mm:+.3f} mm",
        percent=100 * part.share,
        mean_mm=part.mean_mm,
        extreme_mm=part.extreme_mm,
    )
    return Fact(name, said, tip=chance, grade="warn")
