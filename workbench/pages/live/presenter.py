"""The live source of one step: which one, how it is set, one recording from start to stop.

Shared by the pages for the camera, the laser planes and the scan. One recording runs at a time in the whole window:
the process that runs it runs one after another.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject, QTimer, Signal

from core.acquire.source import Step
from core.errors import InputError
from core.files.results.check_file import InterimCheck
from core.image.targets import Target
from core.image.targets.target_view import TargetView
from core.messages import plain
from core.model import Camera, Fan
from core.pipeline.live.commands import (
    Auto,
    Capture,
    Command,
    Configure,
    Discard,
    LiveRequest,
    LookFor,
    Mark,
    Pause,
    Resume,
    Stop,
)
from core.pipeline.live.events import (
    LiveAdvice,
    LiveAnswered,
    LiveAsk,
    LiveBack,
    LiveChecks,
    LiveEnded,
    LiveEvent,
    LiveNotice,
    LiveSaving,
    LiveStarted,
    LiveTaken,
    LiveUnplugged,
    LiveView,
)
from core.scan.preview.preflight import Check
from workbench.bench import Bench
from workbench.language import number, text_of, tr
from workbench.pages.live.buttons import LiveButtons, LiveFacts, live_buttons
from workbench.pages.live.ending import LiveEnding, calibrated_s
from workbench.pages.live.settings import LiveSettings
from workbench.pages.sources import folder_of, recording_folder
from workbench.work import jobs
from workbench.work.tasks import Task
from workbench.work.worker import Failure

STOP_WITHIN_MS = 5000
"""A source that has not let go by then is ended with its process; what is on the disk stays."""

DISPLAY_PX = 1280
"""Width of the live pictures, at most."""

LOST_SHARE = 0.02
"""From this share of lost frames on, the rate is too high."""

WELL_EXPOSED = LiveAdvice()

SOUND = "live/sound"
TWICE_MS = 250
"""Between the two sounds that say a picture was refused; one says it was taken."""


class LivePresenter(QObject):
    """Presenter of the live recordings of one step.

    `calibration`, `check`, `cannot_start`, `there`, `boards` and `pairs` may be set by the page: what is known of
    camera and fan when a recording starts, what their last check said, why none can start now ("" if it can), the views
    that count in the pictures new ones may be added to, the boards beside the part, and whether poses are taken with
    the laser on and off. Each `view` must be answered by one `shown()` when it is on the screen; no other comes before.
    When a recording ends, its folder becomes the step's source by an undoable edit, then `ended` is emitted.
    """

    sounded = Signal()
    """A sound is due."""

    changed = Signal()
    """State, choice or settings are others: draw the controls anew."""

    view = Signal(object)
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

    def __init__(self, bench: Bench, step: Step, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.bench, self.model, self.step = bench, bench.model, step
        self.forget()
        self.settings = LiveSettings(bench, step, self)
        self.settings.changed.connect(self._configure)
        self._auto = step != "scan"
        self._task: Task | None = None
        self._ending = LiveEnding(bench, step, self)
        self.calibration: Callable[[], tuple[Camera | None, Fan | None]] = lambda: (None, None)
        self.check: Callable[[], InterimCheck | None] = lambda: None
        self.cannot_start: Callable[[], str] = lambda: ""
        self.there: Callable[[], tuple[TargetView, ...]] = tuple
        self.boards: Callable[[], tuple[str, ...]] = tuple
        self.pairs = True
        self.adding = False
        self._source = self.settings.choice
        self._deadline = QTimer(self)
        self._deadline.setSingleShot(True)
        self._deadline.setInterval(STOP_WITHIN_MS)
        self._deadline.timeout.connect(self._abandon)
        self.model.opened.connect(self._project_opened)
        self.model.leaving.connect(self.stop)

    # ---- what is known while it runs

    @property
    def running(self) -> bool:
        """Whether a recording goes on, from start until its source is closed."""
        return self._task is not None

    @property
    def live(self) -> bool:
        """Whether live pictures arrive: after the first one, and before stop is pressed."""
        return self.running and self.name != "" and not self.stopping

    @property
    def question(self) -> tuple[str, str]:
        """Sentence and button text of what the recording asks the user to do; two empty texts for nothing."""
        return (text_of(self._ask.sentence), tr(self._ask.button)) if self._ask is not None else ("", "")

    def forget(self) -> None:
        """Reset counts and messages of the last recording."""
        self.name, self.image_size = "", (0, 0)
        self.recorded = self.dropped = 0
        self.rate_hz = 0.0
        self.over()

    def over(self) -> None:
        """Drop what the recording asks and advises; its counts stay."""
        self.paused = self.stopping = self.gone = False
        self.advice, self.checks, self._ask = WELL_EXPOSED, (), None

    def hear(self, event: LiveEvent) -> None:
        """Handle an event that the recording has sent: state, counts, request, advice or view."""
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

    @property
    def buttons(self) -> LiveButtons:
        """Reason why each button of the live source is disabled; "" if it is enabled."""
        return live_buttons(LiveFacts(self.running, self.name != "", self.stopping, self.why_not_start))

    @property
    def why_not_start(self) -> str:
        """Reason why no recording can be started, apart from one that runs; "" if it can."""
        return self.bench.cannot_write or self.cannot_start()

    def state_text(self) -> str:
        """Write the state of the recording in a few words."""
        if not self.running:
            return tr("The live source is off.")
        if self.stopping:
            return tr("Stopping …")
        if not self.name:
            return tr("Opening the source …")
        if self.gone:
            return tr("{camera} is unplugged.", camera=self.name)
        if self.paused:
            return tr("Paused: {camera}", camera=self.name)
        return tr("Live: {camera}", camera=self.name)

    def counts_text(self) -> str:
        """Write how many pictures were recorded and lost, and how many a second."""
        if not self.running:
            return ""
        parts = [self._recorded_text()]
        if self.rate_hz > 0:
            parts.append(tr("{rate:.0f} frames/s", rate=self.rate_hz))
        if self.step == "scan":
            parts.append(tr("{count} lost", count=self.dropped))
        return " · ".join(parts)

    def lost_text(self) -> str:
        """Write what to do against lost frames; "" if so few are lost that they do no harm."""
        total = self.recorded + self.dropped
        if self.step != "scan" or not self.dropped or self.dropped < LOST_SHARE * total:
            return ""
        text = tr("{lost} of {total} pictures were lost on the way", lost=self.dropped, total=total)
        if not self.rate_hz > 0:
            return tr("{text}: choose a lower rate.", text=text)
        lower = f"{int(self.rate_hz)}" if self.rate_hz >= 1 else number(0.9 * self.rate_hz, ".1f")
        return tr(
            "{text}; {rate:.1f} a second are taken: choose a rate of {lower}/s or lower.",
            text=text,
            rate=self.rate_hz,
            lower=lower,
        )

    def _recorded_text(self) -> str:
        n = self.recorded
        match self.step:
            case "camera":
                return tr("{count} views taken", count=n)
            case "planes" | "check":
                return tr("{count} poses taken", count=n)
        return tr("{count} frames recorded", count=n)

    # ---- start and stop

    @property
    def can_add(self) -> bool:
        """Whether the step has pictures that new ones can be added to."""
        return self.step in ("camera", "planes") and folder_of(self.model, self.step) is not None

    def set_adding(self, on: bool) -> None:
        """Set whether the next recording is added to the pictures in use or replaces them."""
        self.adding = on
        self.changed.emit()

    def get_ready(self) -> None:
        """Start the process of the live source ahead of its use, and compile what it needs."""
        self.bench.live.prepare()
        if self.settings.kind == "simulated" and not self.settings.devices and not self.settings.looking:
            self.settings.look_for_devices()

    def start(self, *, stop_other: bool = False) -> None:
        """Start a recording; if one of another page runs, `other_running` asks first, unless `stop_other`."""
        if self.running or self.model.folder is None or self.cannot_start():
            return
        if why_not := self.bench.cannot_write:
            self.bench.notices.warning(why_not)
            return
        other = self.bench.live.current
        if other is not None:
            if not stop_other:
                self.other_running.emit(
                    tr("Another page is recording. Stop that recording? What it has recorded is kept.")
                )
                return
            other.send(Stop())
        try:
            request = self._request(self.model.folder)
            self._ending.begin(self.model.folder, request.folder)
        except InputError as error:
            self.bench.notices.failed(error)
            return
        self.forget()
        self._source = request.source
        self.model.recording_begins(self)
        self._task = task = self.bench.live.run(
            self,
            jobs.RUN_LIVE,
            request,
            label=f"live {request.step}",
            on_done=self._on_ended,
            on_failed=self._on_failed,
            on_cancelled=lambda: self._on_failed(None),
            offers={"channel": "channel"},
        )
        task.view.connect(self._on_view)
        task.reported.connect(self._on_event)
        self.changed.emit()

    def stop(self) -> None:
        """End the recording; the pictures recorded so far are kept."""
        if self.running and not self.stopping:
            self.stopping = True
            self._send(Stop())
            self._deadline.start()
            self.changed.emit()

    def toggle(self) -> None:
        """Start the recording, or stop it if it runs."""
        if self.running:
            self.stop()
        else:
            self.start()

    # ---- commands while it runs; without a recording they do nothing

    @property
    def auto(self) -> bool:
        """Whether views and poses are taken automatically once they are still and new."""
        return self._auto

    def pause(self, on: bool) -> None:
        """Pause the recording, or, with False, continue it."""
        if self.live and on != self.paused:
            self.paused = on
            self._send(Pause() if on else Resume())
            self.changed.emit()

    def mark(self) -> None:
        """Mark the frame that is recorded now, to be found later."""
        if self.live and not self.paused:
            self._send(Mark())

    def capture(self) -> None:
        """Take the live picture as a view or pose now."""
        if self.live:
            self._send(Capture())

    def set_auto(self, on: bool) -> None:
        """Set whether views and poses are taken automatically; also before a start."""
        if on != self._auto:
            self._auto = on
            self._send(Auto(on))
            self.changed.emit()

    def look_for(self, target: Target) -> None:
        """Set the calibration target that live pictures are searched for."""
        self._send(LookFor(target))

    def discard(self, name: str) -> None:
        """Delete the picture called `name` that this recording has taken."""
        self._send(Discard(name))

    def go_on(self) -> None:
        """Handle the one key of a foot switch: answer the request, else take a picture, or stop a scan."""
        if self._ask is not None:
            self.answer()
        elif self.step != "scan":
            self.capture()
        elif self.paused:
            self.pause(False)
        else:
            self.stop()

    @property
    def sound(self) -> bool:
        """Whether a sound is played when a picture is taken or refused."""
        return self.bench.settings.text(SOUND, "on") == "on"

    def set_sound(self, on: bool) -> None:
        """Set whether a sound is played when a picture is taken or refused."""
        self.bench.settings.keep_text(SOUND, "on" if on else "off")
        self.changed.emit()

    def take_advice(self) -> None:
        """Set the source's exposure to the advised value."""
        if self.advice.settings is not None:
            settings, self.advice = self.advice.settings, WELL_EXPOSED
            self.settings.take(settings)

    def answer(self) -> None:
        """Tell the recording that the user has done what it asked for."""
        if self._ask is not None:
            self._send(self._ask.answer)

    def shown(self) -> None:
        """Ask the recording for its next view, as the last one is on the screen."""
        if self._task is not None:
            self._task.shown()

    def show_by(self, draw: Callable[[LiveView], None]) -> None:
        """Draw each live view by the function `draw`, and ask for the next view after it, even if it fails."""

        def show(view: LiveView) -> None:
            try:
                if self.running:
                    draw(view)
            finally:
                self.shown()

        self.view.connect(show)

    def _configure(self) -> None:
        if self.running:
            self._send(Configure(self.settings.values))
        self.changed.emit()

    # ---- inside

    def _send(self, command: Command) -> None:
        if self._task is not None:
            self._task.send(command)

    def _abandon(self) -> None:
        """Do not wait any longer for a source that hangs: end its process."""
        if self._task is not None:
            self._task.cancel()

    def _request(self, project: Path) -> LiveRequest:
        camera, fan = self.calibration()
        return LiveRequest(
            step=self.step,
            source=self.settings.choice,
            settings=self.settings.values,
            rig=self.model.project.rig,
            folder=recording_folder(project, self.step),
            camera=camera,
            fan=fan,
            options=self.model.project.options,
            display_px=DISPLAY_PX,
            auto=self._auto,
            pairs=self.pairs,
            there=self.there() if self.adding and self.can_add else (),
            calibrated_s=calibrated_s(self.model.results, has_fan=self.model.project.rig.has_fan),
            ending=self.settings.ending,
            check=self.check(),
            boards=self.boards(),
            kept_planes=(project, self.model.project.accepted.planes) if self.model.project.accepted.planes else None,
        )

    def _on_view(self, view: LiveView) -> None:
        self.hear(view)
        self.view.emit(view)

    def _on_event(self, event: LiveEvent) -> None:
        self.hear(event)
        match event:
            case LiveStarted():
                self.settings.opened(self._source, event.capabilities)
                self._take_shutter(event)
                self.started.emit(event)
            case LiveTaken():
                self.beep()
                self.taken.emit(event)
            case LiveAsk() | LiveAnswered():
                self.asked.emit(*self.question)
            case LiveNotice():
                if event.refused:
                    self.beep()
                    QTimer.singleShot(TWICE_MS, self, self.beep)
                self.notice.emit(text_of(event.sentence))
                self.bench.notices.info(text_of(event.sentence))
            case LiveSaving() if self.stopping:
                self._deadline.start()  # it is not hanging: frames still go to the disk
            case LiveUnplugged():
                self.bench.notices.info(text_of(event.sentence))  # the page says it, as long as it is so
                self.unplugged.emit(text_of(event.sentence))
            case LiveBack():
                self.bench.notices.info(tr("{camera} is back; the recording goes on.", camera=self.name))
                self.back.emit()
        self.changed.emit()

    def _take_shutter(self, event: LiveStarted) -> None:
        """Take over how the camera reads its rows out, where nothing is stated; undoable."""
        project, row_time_us = self.model.project, event.capabilities.row_time_us
        if row_time_us is None or project.rig.row_time_us is not None:
            return
        after = replace(project, rig=replace(project.rig, row_time_us=row_time_us))
        self.model.edit(tr("take the shutter from the camera"), after)
        said = (
            tr("{camera} has a rolling shutter, {us} µs from row to row: that is reckoned with.",
               camera=event.name, us=number(row_time_us, ".3g"))
            if row_time_us
            else tr("{camera} has a global shutter: that is reckoned with.", camera=event.name)
        )  # fmt: skip
        self.bench.notices.info(said)

    def beep(self) -> None:
        """Play a short sound, unless sounds are switched off."""
        if self.sound:
            self.sounded.emit()

    def _on_ended(self, ended: LiveEnded) -> None:
        self._task = None
        self._deadline.stop()
        if ended.error is not None:
            self.bench.notices.error(text_of(ended.error))
        self.recorded, self.dropped = ended.recorded, ended.dropped
        if ended.error is None and (lost := self.lost_text()):
            self.bench.notices.warning(lost)
        asked = self.question[0]
        self.over()
        if asked:
            self.asked.emit("", "")

        def finished() -> None:
            self.adding = False
            self.ended.emit(ended)
            self.changed.emit()
            if not self.running:
                self.model.recording_ends(self)

        self._ending.hand_over(ended, adding=self.adding, then=finished)

    def _on_failed(self, problem: Any) -> None:
        """The loop did not get to its own end: it was ended, its process died, or the source could not be opened."""
        why = None
        if isinstance(problem, Failure):
            self.bench.notices.failed(problem)
        elif problem is not None:
            why = problem.message if isinstance(problem, InputError) else plain(text_of(problem))
        recorded = self.recorded
        self._on_ended(LiveEnded(self._ending.folder or Path(), recorded, self.dropped, why))

    def _project_opened(self) -> None:
        if self.running and self.model.folder != self._ending.project_folder:
            self.stop()
        self.changed.emit()
