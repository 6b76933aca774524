"""The live source of one step: which one, how it is set, one recording from start to stop.

Shared by the pages for the camera, the laser planes and the scan. One recording runs at a time in the whole window:
the process that runs it runs one after another.
"""

from __future__ import annotations

from collections.abc import Callable
from datetime import datetime
from pathlib import Path
from typing import Any

from PySide6.QtCore import QEventLoop, QObject, QTimer, Signal

from core.acquire.source import Lasers, Step
from core.errors import InputError
from core.files.unfinished import forget_recording, note_recording
from core.image.target_view import TargetView
from core.live.events import (
    Auto,
    Capture,
    Command,
    Configure,
    Discard,
    LiveAnswered,
    LiveAsk,
    LiveBack,
    LiveEnded,
    LiveEvent,
    LiveNotice,
    LiveRequest,
    LiveSaving,
    LiveStarted,
    LiveTaken,
    LiveUnplugged,
    LiveView,
    Pause,
    Resume,
    Stop,
    Switch,
    TakeReference,
)
from core.model import Camera, Fan
from workbench import jobs
from workbench.bench import Bench
from workbench.live import LiveSession
from workbench.pages.live_settings import LiveSettings
from workbench.pages.sources import folder_of, put_source
from workbench.tasks import details, sentence

STOP_WITHIN_MS = 5000
"""A source that has not let go by then is ended with its process; what is on the disk stays."""

DISPLAY_PX = 1280

LOST_SHARE = 0.02
"""From this share of lost frames on, the rate is too high."""


class LivePresenter(QObject):
    """Starts, steers and ends the live recordings of one step.

    `calibration`, `cannot_start`, `there` and `pairs` may be set by the page: what is known of camera and fan when a
    recording starts, why none can start now ("" if it can), the views that count in the pictures new ones may be added
    to, and whether poses are taken with the laser on and off. Each `view`
    must be answered by one `shown()` when it is on the screen; no other comes before. When a recording ends, its folder
    becomes the step's source by an undoable edit, then `ended` is emitted.
    """

    changed = Signal()
    """State, choice or settings are others: draw the controls anew."""

    started = Signal(object)
    view = Signal(object)
    taken = Signal(object)
    asked = Signal(str, str)
    """Sentence and name of the button that calls `answer`; two empty texts: nothing is asked any more."""

    notice = Signal(str)
    unplugged = Signal(str)
    back = Signal()
    ended = Signal(object)
    """LiveEnded; its `error` says why if it ended by itself."""

    other_running = Signal(str)
    """Another page's recording runs: this question, to be answered by `start(stop_other=True)` or not at all."""

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
    _ask: LiveAsk | None
    _folder: Path | None
    _project_folder: Path | None

    def __init__(self, bench: Bench, step: Step, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.bench, self.model, self.step = bench, bench.model, step
        self.settings = LiveSettings(bench, step, self)
        self.settings.changed.connect(self._configure)
        self.calibration: Callable[[], tuple[Camera | None, Fan | None]] = lambda: (None, None)
        self.cannot_start: Callable[[], str] = lambda: ""
        self.there: Callable[[], tuple[TargetView, ...]] = tuple
        self.pairs = True
        self.adding = False
        self._auto = step != "scan"
        self._session = LiveSession(bench.live, self)
        self._session.told.connect(self._on_event)
        self._session.view.connect(self._on_view)
        self._session.ended.connect(self._on_ended)
        self._session.failed.connect(self._on_failed)
        self._deadline = QTimer(self)
        self._deadline.setSingleShot(True)
        self._deadline.setInterval(STOP_WITHIN_MS)
        self._deadline.timeout.connect(self._session.abandon)
        self._forget()
        self.model.opened.connect(self._project_opened)
        self.model.leaving.connect(self.finish)

    @property
    def running(self) -> bool:
        """Whether a recording is going on, from start until the source is closed."""
        return self._session.running

    @property
    def live(self) -> bool:
        """Whether pictures are coming: the first one is there and nobody has pressed stop."""
        return self.running and self.name != "" and not self.stopping

    @property
    def auto(self) -> bool:
        """Whether views and poses are taken without being told."""
        return self._auto

    @property
    def question(self) -> tuple[str, str]:
        """What is asked now: sentence and button; two empty texts if nothing is."""
        return (self._ask.sentence, self._ask.button) if self._ask is not None else ("", "")

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

    @property
    def can_add(self) -> bool:
        """Whether there are pictures that new ones can be added to."""
        return self.step != "scan" and folder_of(self.model, self.step) is not None

    def set_adding(self, on: bool) -> None:
        """Add the pictures of the next recording to those in use, instead of replacing them."""
        self.adding = on
        self.changed.emit()

    def get_ready(self) -> None:
        """A source will soon be wanted: have the process for it ready, and know the simulated scenes."""
        self.bench.live.warm_up()
        if self.settings.kind == "simulated" and not self.settings.devices and not self.settings.looking:
            self.settings.look_for_devices()

    def start(self, *, stop_other: bool = False) -> None:
        """Open the source and go; if another page's recording runs, ask first (`other_running`)."""
        if self.running or self.model.folder is None or self.cannot_start():
            return
        other = self.bench.live.current
        if other is not None:
            if not stop_other:
                self.other_running.emit(
                    self.tr("Another page is recording. Stop that recording? What it has recorded is kept.")
                )
                return
            other.send(Stop())
        try:
            request = self._request(self.model.folder)
            note_recording(self.model.folder, self.step, request.folder)
        except InputError as error:
            self.bench.notices.error(str(error))
            return
        self._forget()
        self._folder, self._project_folder = request.folder, self.model.folder
        self._session.start(request)
        self.changed.emit()

    def stop(self) -> None:
        """Finish the recording; what is recorded is kept."""
        if self.running and not self.stopping:
            self.stopping = True
            self._session.send(Stop())
            self._deadline.start()
            self.changed.emit()

    def toggle(self) -> None:
        """Start, or stop."""
        if self.running:
            self.stop()
        else:
            self.start()

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

    def busy(self) -> str:
        """What would be interrupted if the project were left now, or ""."""
        return self.tr("A recording is running.") if self.running else ""

    def finish(self) -> None:
        """The project is about to be left: end the recording, and wait for it for a moment."""
        if not self.running:
            return
        loop = QEventLoop()
        self.ended.connect(loop.quit)
        limit = QTimer(loop)
        limit.setSingleShot(True)
        limit.setInterval(1000)
        limit.timeout.connect(loop.quit)
        self._deadline.timeout.connect(limit.start)
        self.stop()
        if not self._deadline.isActive():
            limit.start(STOP_WITHIN_MS)
        loop.exec()
        limit.stop()
        self._deadline.timeout.disconnect(limit.start)
        self.ended.disconnect(loop.quit)

    def _request(self, project: Path) -> LiveRequest:
        camera, fan = self.calibration()
        return LiveRequest(
            self.step,
            self.settings.choice,
            self.settings.values,
            self.model.project.rig,
            _new_folder(project / "recordings", self.step),
            camera,
            fan,
            self.model.project.options,
            DISPLAY_PX,
            self._auto,
            self.pairs,
            self.there() if self.adding and self.can_add else (),
        )

    def _recorded_text(self) -> str:
        words = {
            "camera": self.tr("{0} views taken"),
            "planes": self.tr("{0} poses taken"),
            "scan": self.tr("{0} frames recorded"),
        }
        return words[self.step].format(self.recorded)

    def _forget(self) -> None:
        self.name, self.image_size = "", (0, 0)
        self.paused = self.stopping = self.gone = False
        self.recorded = self.dropped = 0
        self.rate_hz = 0.0
        self._ask = self._folder = self._project_folder = None

    def _configure(self) -> None:
        if self.running:
            self._session.send(Configure(self.settings.values))
        self.changed.emit()

    def _on_view(self, view: LiveView) -> None:
        self.recorded, self.dropped, self.rate_hz = view.recorded, view.dropped, view.rate_hz
        self.view.emit(view)

    def _on_event(self, event: LiveEvent) -> None:
        match event:
            case LiveStarted():
                self.name, self.image_size = event.name, event.image_size
                self.started.emit(event)
            case LiveTaken():
                self.taken.emit(event)
            case LiveAsk() | LiveAnswered():
                self._ask = event if isinstance(event, LiveAsk) else None
                self.asked.emit(*self.question)
            case LiveNotice():
                self.notice.emit(event.sentence)
                self.bench.notices.info(event.sentence)
            case LiveSaving() if self.stopping:
                self._deadline.start()  # it is not hanging: frames still go to the disk
            case LiveUnplugged():
                self.gone = True
                self.bench.notices.info(event.sentence)  # the page says it, as long as it is so
                self.unplugged.emit(event.sentence)
            case LiveBack():
                self.gone = False
                self.bench.notices.info(self.tr("{0} is back; the recording goes on.").format(self.name))
                self.back.emit()
        self.changed.emit()

    def _on_ended(self, ended: LiveEnded) -> None:
        self._deadline.stop()
        if ended.error:
            self.bench.notices.error(ended.error)
        self.recorded, self.dropped = ended.recorded, ended.dropped
        if not ended.error and (lost := self.lost_text()):
            self.bench.notices.warning(lost)
        asked, self._ask = self._ask, None
        project, self.stopping, self.paused, self.gone = self._project_folder, False, False, False
        if asked is not None:
            self.asked.emit("", "")
        if not ended.recorded or project is None or project != self.model.folder:
            self._tell_ended(ended)
        elif self.adding and (before := folder_of(self.model, self.step)) is not None:
            self.bench.glance(
                jobs.ADD_RECORDING,
                before,
                ended.folder,
                label=self.tr("Adding the pictures that were there"),
                on_done=lambda _: self._take(ended, keep_left_out=True),
                on_failed=lambda _: self._take(ended),
                on_cancelled=lambda: self._take(ended),
            )
        else:
            self._take(ended)

    def _take(self, ended: LiveEnded, *, keep_left_out: bool = False) -> None:
        """The recording becomes the step's source."""
        label = {
            "camera": self.tr("record views of the target"),
            "planes": self.tr("record poses of the plate"),
            "scan": self.tr("record a scan"),
        }[self.step]
        put_source(self.model, self.step, ended.folder, label, keep_left_out=keep_left_out)
        self._tell_ended(ended)

    def _tell_ended(self, ended: LiveEnded) -> None:
        if self._project_folder is not None and (not ended.recorded or self._project_folder == self.model.folder):
            self._forget_note(self._project_folder)
        self.adding = False
        self.ended.emit(ended)
        self.changed.emit()

    def _forget_note(self, project: Path) -> None:
        """The recording is in the project: once that is on the disk, it need not be found after a crash."""
        self.model.autosave()
        try:
            forget_recording(project)
        except InputError as error:
            self.bench.notices.error(str(error))

    def _on_failed(self, problem: Any) -> None:
        """The loop did not get to its own end: it was ended, its process died, or the source could not be opened."""
        why = "" if problem is None else sentence(problem)
        if problem is not None and details(problem):
            self.bench.notices.error(why, details(problem))
            why = ""
        recorded = self.recorded
        self._on_ended(LiveEnded(self._folder or Path(), recorded, self.dropped, why))

    def _project_opened(self) -> None:
        if self.running and self.model.folder != self._project_folder:
            self.stop()
        self.changed.emit()


def _new_folder(recordings: Path, step: str) -> Path:
    """A folder that is not there yet, named by the step and the time."""
    name = f"{step}-{datetime.now():%Y%m%d-%H%M%S}"
    folders = (recordings / (name if number == 1 else f"{name}-{number}") for number in range(1, 1000))
    return next(folder for folder in folders if not folder.exists())
