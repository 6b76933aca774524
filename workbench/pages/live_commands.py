"""What a live recording can be told while it runs."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QObject, Signal

from core.acquire.source import Lasers, Step
from core.live.commands import Auto, Capture, Command, Configure, Discard, Pause, Resume, Switch, TakeReference
from core.live.events import LiveView
from workbench.bench import Bench
from workbench.live import LiveSession
from workbench.pages.live_settings import LiveSettings
from workbench.pages.live_state import WELL_EXPOSED, LiveState


class LiveCommands(LiveState):
    """The recording of one step, its source's settings, and the commands it takes; without one they do nothing."""

    changed = Signal()
    """State, choice or settings are others: draw the controls anew."""

    view = Signal(object)

    def __init__(self, bench: Bench, step: Step, parent: QObject | None = None) -> None:
        super().__init__(step, parent)
        self.settings = LiveSettings(bench, step, self)
        self.settings.changed.connect(self._configure)
        self._auto = step != "scan"
        self._session = LiveSession(bench.live, self)

    @property
    def running(self) -> bool:
        """Whether a recording is going on, from start until the source is closed."""
        return self._session.running

    @property
    def auto(self) -> bool:
        """Whether views and poses are taken without being told."""
        return self._auto

    def pause(self, on: bool) -> None:
        """Record nothing for a while, or go on."""
        if self.live and on != self.paused:
            self.paused = on
            self._session.send(Pause() if on else Resume())
            self.changed.emit()

    def capture(self) -> None:
        """Take this picture now."""
        if self.live:
            self._session.send(Capture())

    def set_auto(self, on: bool) -> None:
        """Take views and poses without being told, or no longer; also before a start."""
        if on != self._auto:
            self._auto = on
            self._session.send(Auto(on))
            self.changed.emit()

    def lasers(self, lasers: Lasers) -> None:
        """Switch the lasers, or have the technician asked to."""
        self._session.send(Switch(lasers))

    def take_reference(self) -> None:
        """Take the scan's reference: the fan alone is on."""
        self._session.send(TakeReference())

    def discard(self, name: str) -> None:
        """Put a picture aside that has been taken."""
        self._session.send(Discard(name))

    def take_advice(self) -> None:
        """Tell the source how to expose the stripes better, as was advised."""
        if self.advice.settings is not None:
            settings, self.advice = self.advice.settings, WELL_EXPOSED
            self.settings.take(settings)

    def answer(self) -> None:
        """The button of what was asked has been pressed."""
        if self._ask is not None:
            self._session.send(self._ask.answer)

    def send(self, command: Command) -> None:
        """Give the recording any other command."""
        self._session.send(command)

    def shown(self) -> None:
        """The last view is on the screen; the next one is welcome."""
        self._session.shown()

    def show_by(self, draw: Callable[[LiveView], None]) -> None:
        """Have each view drawn by this while it runs, and answered by `shown()` whatever comes of that."""

        def show(view: LiveView) -> None:
            try:
                if self.running:
                    draw(view)
            finally:
                self.shown()

        self.view.connect(show)

    def _configure(self) -> None:
        if self.running:
            self._session.send(Configure(self.settings.values))
        self.changed.emit()
