"""The live source of one step: which one, how it is set, one recording from start to stop.

Shared by the pages for the camera, the laser planes and the scan. One recording runs at a time in the whole window:
the process that runs it runs one after another.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject, QTimer, Signal

from core.acquire.source import Step
from core.errors import InputError
from core.image.target_view import TargetView
from core.live.commands import LiveRequest, Stop
from core.live.events import (
    LiveAnswered,
    LiveAsk,
    LiveBack,
    LiveEnded,
    LiveEvent,
    LiveNotice,
    LiveSaving,
    LiveStarted,
    LiveTaken,
    LiveUnplugged,
    LiveView,
)
from core.model import Camera, Fan
from workbench.bench import Bench
from workbench.pages.live_commands import LiveCommands
from workbench.pages.live_ending import LiveEnding, calibrated_s, new_folder, wait_until_ended
from workbench.pages.sources import folder_of
from workbench.problems import details, sentence

STOP_WITHIN_MS = 5000
"""A source that has not let go by then is ended with its process; what is on the disk stays."""

DISPLAY_PX = 1280


class LivePresenter(LiveCommands):
    """Starts, steers and ends the live recordings of one step.

    `calibration`, `cannot_start`, `there` and `pairs` may be set by the page: what is known of camera and fan when a
    recording starts, why none can start now ("" if it can), the views that count in the pictures new ones may be added
    to, and whether poses are taken with the laser on and off. Each `view`
    must be answered by one `shown()` when it is on the screen; no other comes before. When a recording ends, its folder
    becomes the step's source by an undoable edit, then `ended` is emitted.
    """

    started = Signal(object)
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

    def __init__(self, bench: Bench, step: Step, parent: QObject | None = None) -> None:
        super().__init__(bench, step, parent)
        self.bench, self.model = bench, bench.model
        self._ending = LiveEnding(bench, step, self)
        self.calibration: Callable[[], tuple[Camera | None, Fan | None]] = lambda: (None, None)
        self.cannot_start: Callable[[], str] = lambda: ""
        self.there: Callable[[], tuple[TargetView, ...]] = tuple
        self.pairs = True
        self.adding = False
        self._source = self.settings.choice
        self._session.told.connect(self._on_event)
        self._session.view.connect(self._on_view)
        self._session.ended.connect(self._on_ended)
        self._session.failed.connect(self._on_failed)
        self._deadline = QTimer(self)
        self._deadline.setSingleShot(True)
        self._deadline.setInterval(STOP_WITHIN_MS)
        self._deadline.timeout.connect(self._session.abandon)
        self.model.opened.connect(self._project_opened)
        self.model.leaving.connect(self.finish)

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
            self._ending.begin(self.model.folder, request.folder)
        except InputError as error:
            self.bench.notices.error(str(error))
            return
        self.forget()
        self._source = request.source
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

    def busy(self) -> str:
        """What would be interrupted if the project were left now, or ""."""
        return self.tr("A recording is running.") if self.running else ""

    def finish(self) -> None:
        """The project is about to be left: end the recording, and wait for it for a moment."""
        if self.running:
            wait_until_ended(self.ended, self.stop, self._deadline)

    def _request(self, project: Path) -> LiveRequest:
        camera, fan = self.calibration()
        return LiveRequest(
            step=self.step,
            source=self.settings.choice,
            settings=self.settings.values,
            rig=self.model.project.rig,
            folder=new_folder(project / "recordings", self.step),
            camera=camera,
            fan=fan,
            options=self.model.project.options,
            display_px=DISPLAY_PX,
            auto=self._auto,
            pairs=self.pairs,
            there=self.there() if self.adding and self.can_add else (),
            calibrated_s=calibrated_s(self.model.results),
            ending=self.settings.ending,
            kept_fan=(project, self.model.project.accepted.fan) if self.model.project.accepted.fan else None,
        )

    def _on_view(self, view: LiveView) -> None:
        self.hear(view)
        self.view.emit(view)

    def _on_event(self, event: LiveEvent) -> None:
        self.hear(event)
        match event:
            case LiveStarted():
                self.settings.opened(self._source, event.capabilities)
                self.started.emit(event)
            case LiveTaken():
                self.taken.emit(event)
            case LiveAsk() | LiveAnswered():
                self.asked.emit(*self.question)
            case LiveNotice():
                self.notice.emit(event.sentence)
                self.bench.notices.info(event.sentence)
            case LiveSaving() if self.stopping:
                self._deadline.start()  # it is not hanging: frames still go to the disk
            case LiveUnplugged():
                self.bench.notices.info(event.sentence)  # the page says it, as long as it is so
                self.unplugged.emit(event.sentence)
            case LiveBack():
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
        asked = self.question[0]
        self.over()
        if asked:
            self.asked.emit("", "")

        def finished() -> None:
            self.adding = False
            self.ended.emit(ended)
            self.changed.emit()

        self._ending.hand_over(ended, adding=self.adding, then=finished)

    def _on_failed(self, problem: Any) -> None:
        """The loop did not get to its own end: it was ended, its process died, or the source could not be opened."""
        why = "" if problem is None else sentence(problem)
        if problem is not None and details(problem):
            self.bench.notices.error(why, details(problem))
            why = ""
        recorded = self.recorded
        self._on_ended(LiveEnded(self._ending.folder or Path(), recorded, self.dropped, why))

    def _project_opened(self) -> None:
        if self.running and self.model.folder != self._ending.project_folder:
            self.stop()
        self.changed.emit()
