"""Whether everything can be measured in one go, told by plain facts; every reason is a sentence, or ""."""

from __future__ import annotations

from dataclasses import dataclass

from workbench.language import tr


@dataclass(frozen=True, slots=True)
class WholeFacts:
    """What *Measure everything* rests on."""

    running: bool
    """It is being done, or waits for its turn."""
    live: bool
    """A live source is on, or what it recorded is still being put into the project."""
    left: frozenset[str]
    """The steps that are not up to date."""
    scan_chosen: bool
    """Pictures of a scan are chosen."""
    read_only: bool
    """Nothing can be written into the project."""


def why_not_measure_all(facts: WholeFacts) -> str:
    """Why not everything can be measured now."""
    if facts.running:
        return tr("Everything is being measured.")
    if facts.live:
        return tr("Stop the live source first.")
    if not facts.left:
        return tr("Everything is done.")
    if facts.read_only:
        return tr("The project is read-only: go on in a copy (File, Save a copy).")
    if "scan" in facts.left and not facts.scan_chosen:
        return tr("Choose or record the pictures first: of the camera target, of the plane target, of the scan.")
    return ""
