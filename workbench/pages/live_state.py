"""What is known of a live recording while it runs, and how that is said."""

from __future__ import annotations

from PySide6.QtCore import QObject

from core.acquire.source import Step
from core.live.events import (
    LiveAdvice,
    LiveAnswered,
    LiveAsk,
    LiveBack,
    LiveChecks,
    LiveEvent,
    LiveStarted,
    LiveUnplugged,
    LiveView,
)
from core.scan.preflight import Check

LOST_SHARE = 0.02
"""From this share of lost frames on, the rate is too high."""

WELL_EXPOSED = LiveAdvice("", None)


class LiveState(QObject):
    """The state of the recording of one step; the texts are those of the panel and the strip."""

    name: str
    """Of the source, once it is open."""

    image_size: tuple[int, int]
    paused: bool
    stopping: bool
    gone: bool
    """The source is unplugged."""

    recorded: int
    dropped: int
    rate_hz: float
    advice: LiveAdvice
    """How to expose the stripes better."""

    checks: tuple[Check, ...]
    """What was looked at before a scan."""

    _ask: LiveAsk | None

    def __init__(self, step: Step, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.step = step
        self.forget()

    @property
    def running(self) -> bool:
        """Whether a recording is going on, from start until the source is closed."""
        raise NotImplementedError

    @property
    def live(self) -> bool:
        """Whether pictures are coming: the first one is there and nobody has pressed stop."""
        return self.running and self.name != "" and not self.stopping

    @property
    def question(self) -> tuple[str, str]:
        """What is asked now: sentence and button; two empty texts if nothing is."""
        return (self._ask.sentence, self._ask.button) if self._ask is not None else ("", "")

    def forget(self) -> None:
        """Nothing is known of a recording that has not begun."""
        self.name, self.image_size = "", (0, 0)
        self.recorded = self.dropped = 0
        self.rate_hz = 0.0
        self.over()

    def over(self) -> None:
        """Nothing is asked or advised any more; what was counted stays."""
        self.paused = self.stopping = self.gone = False
        self.advice, self.checks, self._ask = WELL_EXPOSED, (), None

    def hear(self, event: LiveEvent) -> None:
        """Take note of what the recording says."""
        match event:
            case LiveStarted():
                self.name, self.image_size = event.name, event.image_size
            case LiveView():
                self.recorded, self.dropped, self.rate_hz = event.recorded, event.dropped, event.rate_hz
            case LiveAsk() | LiveAnswered():
                self._ask = event if isinstance(event, LiveAsk) else None
            case LiveAdvice():
                self.advice = event
            case LiveChecks():
                self.checks = event.checks
            case LiveUnplugged():
                self.gone = True
            case LiveBack():
                self.gone = False

    def state_text(self) -> str:
        """What goes on, in a few words."""
        if not self.running:
            return self.tr("The live source is off.")
        if self.stopping:
            return self.tr("Stopping …")
        if not self.name:
            return self.tr("Opening the source …")
        if self.gone:
            return self.tr("{0} is unplugged.").format(self.name)
        if self.paused:
            return self.tr("Paused: {0}").format(self.name)
        return self.tr("Live: {0}").format(self.name)

    def counts_text(self) -> str:
        """Recorded and lost pictures and the rate, with their units."""
        if not self.running:
            return ""
        parts = [self._recorded_text()]
        if self.rate_hz > 0:
            parts.append(self.tr("{0} frames/s").format(f"{self.rate_hz:.0f}"))
        if self.step == "scan":
            parts.append(self.tr("{0} lost").format(self.dropped))
        return " · ".join(parts)

    def lost_text(self) -> str:
        """What to do when frames are lost, or "": only a scan needs every frame, and one now and then does no harm."""
        total = self.recorded + self.dropped
        if self.step != "scan" or not self.dropped or self.dropped < LOST_SHARE * total:
            return ""
        text = self.tr("{0} of {1} pictures were lost on the way").format(self.dropped, total)
        if not self.rate_hz > 0:
            return self.tr("{0}: choose a lower rate.").format(text)
        lower = f"{int(self.rate_hz)}" if self.rate_hz >= 1 else f"{0.9 * self.rate_hz:.1f}"
        return self.tr("{0}; {1} a second are taken: choose a rate of {2}/s or lower.").format(
            text, f"{self.rate_hz:.1f}", lower
        )

    def _recorded_text(self) -> str:
        words = {
            "camera": self.tr("{0} views taken"),
            "planes": self.tr("{0} poses taken"),
            "scan": self.tr("{0} frames recorded"),
        }
        return words[self.step].format(self.recorded)
