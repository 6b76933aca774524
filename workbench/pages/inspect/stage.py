"""How far the thickness is and which buttons of the Inspect page can be pressed, told by plain facts.

Every reason is a sentence, or "" where nothing speaks against it; of the thickness it is one of `WhyNot`.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import NamedTuple

from workbench.language import tr
from workbench.reasons import first, why


class Stage(StrEnum):
    """Stage of the inspection."""

    NO_SCAN = "no scan"
    READING = "reading"
    UNREADABLE = "unreadable"
    MEASURING = "measuring"
    UNMEASURED = "unmeasured"
    FAILED = "failed"
    MEASURED = "measured"
    OUTDATED = "outdated"


class WhyNot(StrEnum):
    """Reason why the thickness cannot be measured now; "": it can."""

    NOTHING = ""
    NO_SCAN = "no scan"
    UNREADABLE = "unreadable"
    READ_ONLY = "read-only"
    MEASURING = "measuring"
    FACE_MISSING = "face missing"


class Facts(NamedTuple):
    """Facts from which the stage follows."""

    scan: bool
    """There is a scan among the results."""
    shown: bool
    """It, or the one before, has been read."""
    unreadable: bool
    stale: bool
    """What is shown is the one before."""
    measuring: bool
    failed: bool
    """The last attempt gave no thickness."""
    thickness: bool
    """What is shown has one."""
    outdated: bool
    """It is not what the project would give now."""
    face_missing: bool
    """Only one of the two faces is drawn."""
    read_only: bool
    """Nothing can be kept in the project."""


def stage_of(facts: Facts) -> Stage:
    """Derive how far the thickness is (`Stage`) from what is known of the scan and the results."""
    if facts.measuring:
        return Stage.MEASURING
    if not facts.scan:
        return Stage.NO_SCAN
    if not facts.shown:
        return Stage.UNREADABLE if facts.unreadable else Stage.READING
    if facts.failed:
        return Stage.FAILED
    if facts.stale:
        return Stage.READING
    if not facts.thickness:
        return Stage.UNMEASURED
    return Stage.OUTDATED if facts.outdated else Stage.MEASURED


def why_not_measure(facts: Facts) -> WhyNot:
    """Return the reason why the thickness cannot be measured; `WhyNot` "" if it can."""
    reason = first(
        why(not facts.scan, WhyNot.NO_SCAN),
        why(facts.unreadable, WhyNot.UNREADABLE),
        why(facts.read_only, WhyNot.READ_ONLY),
        why(facts.measuring, WhyNot.MEASURING),
        why(facts.face_missing, WhyNot.FACE_MISSING),
    )
    return WhyNot(reason)


@dataclass(frozen=True, slots=True)
class SurfaceFacts:
    """Facts from which the buttons of showing the surface, and drawing and picking on it, follow."""

    scan: bool
    """There is a scan among the results."""
    unreadable: bool
    shown: bool
    """It, or the one before, has been read."""
    mesh: bool
    """What is shown has a mesh."""


class SurfaceButtons(NamedTuple):
    """Reason for each disabled button, or ""."""

    use: str
    """Show the points; draw, pick and click on them."""
    mesh: str
    """Show the mesh."""
    measure: str
    """Measure on it: it need not be shown."""


def surface_buttons(facts: SurfaceFacts) -> SurfaceButtons:
    """Derive why each button for showing, drawing on and picking from the surface is disabled; "" if enabled."""
    if facts.shown:
        return SurfaceButtons("", "" if facts.mesh else tr("This scan has no mesh."), "")
    none = tr("The scan cannot be read.") if facts.unreadable else "" if facts.scan else tr("Scan the part first.")
    reading = none or tr("The scan is being read.")
    return SurfaceButtons(reading, reading, none)


@dataclass(frozen=True, slots=True)
class FacesFacts:
    """Facts from which the buttons of the faces' regions follow."""

    no_surface: str
    """Why nothing can be drawn."""
    found: bool
    """The outlines of both faces are there."""
    own: bool
    """Both regions were drawn, or taken from those found."""
    missing: str
    """What is asked for where only one was."""


class FacesButtons(NamedTuple):
    """Reason for each disabled button, or ""."""

    draw: str
    take_found: str
    automatic: str
    exchange: str


def faces_buttons(facts: FacesFacts) -> FacesButtons:
    """Derive why each button of the faces' regions is disabled; "" for each that is enabled."""
    if facts.own:
        taken = tr("The faces are regions of your own already: drag their corners in the picture.")
        return FacesButtons(facts.no_surface, taken, "", "")
    missing = tr("Measure the thickness first, so that there are faces to begin with.")
    return FacesButtons(
        draw=facts.no_surface,
        take_found="" if facts.found else facts.no_surface or missing,
        automatic="" if facts.missing else tr("The faces are found automatically already."),
        exchange=facts.missing or tr("The faces are found automatically: there is nothing to exchange."),
    )


@dataclass(frozen=True, slots=True)
class PicksFacts:
    """Facts from which the buttons of points and distances follow."""

    no_surface: str
    """Why nothing can be picked."""
    some: bool
    """There are points or distances in the list."""
    chosen: bool
    """One of them is."""


class PicksButtons(NamedTuple):
    """Reason for each disabled button, or ""."""

    pick: str
    remove: str
    clear: str


def picks_buttons(facts: PicksFacts) -> PicksButtons:
    """Derive why each button of picked points and distances is disabled; "" for each that is enabled."""
    none = "" if facts.some else tr("Nothing is picked yet.")
    choose = "" if facts.chosen else tr("Choose a point or a distance in the list first.")
    return PicksButtons(facts.no_surface, none or choose, none)
