"""What is said to the hand while a scan is recorded: one light, one sentence, what is covered, and the next button."""

from __future__ import annotations

from typing import NamedTuple

from core.image.exclusion import MOVEMENTS
from core.pipeline.live.events import ScanDetail
from core.scan.preview.hints import ENOUGH
from core.scan.preview.preflight import Check
from workbench.language import sentence, text_of, tr
from workbench.pages.words import percent
from workbench.views.colours import Level


class Guidance(NamedTuple):
    """Guidance that the page shows large: light, sentence and button."""

    level: Level
    """Of the light; "" while something is to be done that is neither good nor bad."""
    sentence: str
    beside: str
    """In small letters: what was found wrong before the sweeps began."""
    covered: str
    needed: str
    button: str


class Situation(NamedTuple):
    """Facts from which the guidance follows."""

    state: str
    """What goes on, in a few words."""
    gone: bool
    """The source is unplugged."""
    stopping: bool
    question: tuple[str, str]
    """Sentence and button of what is asked; two empty texts: nothing."""
    paused: bool
    detail: ScanDetail | None
    checks: tuple[Check, ...]
    has_fan: bool = True


def guidance(now: Situation) -> Guidance:
    """Choose what to tell the hand during a scan, by what is most urgent: light, sentence and button."""
    recording = now.detail is not None and is_recording(now.detail.stage)
    level, said = _said(now)
    failed = next((text_of(one.message) for one in now.checks if one.state == "failed"), "") if recording else ""
    covered = percent(now.detail.share) if now.detail is not None and recording else ""
    needed = tr("of {share} needed", share=percent(ENOUGH)) if covered else ""
    return Guidance(level, said, failed, covered, needed, _button(now))


def is_recording(stage: str) -> bool:
    """Whether frames are recorded at this stage of a live scan, a pause included."""
    return stage in ("scanning", "paused")


def is_enough(detail: ScanDetail) -> bool:
    """Whether enough of what was lit is covered by points for the recording to be stopped."""
    return detail.stage == "scanning" and detail.share >= ENOUGH


def _said(now: Situation) -> tuple[Level, str]:
    asked, _ = now.question
    if now.gone:
        return "bad", tr("The source is unplugged. Plug it in again: the recording goes on.")
    if now.stopping:
        return "", tr("Stopping …")
    if asked:
        return "", asked
    if now.paused:
        return "warn", tr("Paused: nothing is recorded.")
    if now.detail is None:
        return "", now.state
    match now.detail.stage:
        case "boards":
            return "", tr("Taking the boards: all lasers are off, light falls on the boards, nothing moves.")
        case "reference" if not now.has_fan:
            return "", tr("Taking the reference: all lasers are off, nothing moves.")
        case "reference":
            return "", tr("Taking the reference: only the three-line laser is on, nothing moves.")
        case "ready":
            return "", tr("The reference is taken. Switch the hand-held laser on.")
    return _of_the_hand(now.detail)


def _of_the_hand(detail: ScanDetail) -> tuple[Level, str]:
    preview = detail.preview
    if is_enough(detail):
        return "good", tr("Enough is covered: stop.")
    if preview is None:
        return "warn", tr("Sweep the line slowly over the part.")
    if preview.hints:
        return "warn", text_of(preview.hints[0])
    if preview.reason is not None:
        return "bad" if preview.exclusion in MOVEMENTS else "warn", sentence(text_of(preview.reason))
    return "good", tr("Good. Go on where there is no colour yet.")


def _button(now: Situation) -> str:
    _, button = now.question
    if button:
        return button
    return tr("Resume") if now.paused else tr("Stop")
