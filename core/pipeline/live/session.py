"""A live recording from the first frame to the last: read, record, look, show. Runs in a process of its own, no Qt.

Recording comes first: every frame of a scan goes to the disk before anything else is done with it. Looking at frames
is done beside it, by one thread, for as many of them as there is time for. Pictures are shown as fast as the window
shows them and no faster.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable

from core.acquire.settings import TITLES
from core.acquire.source import Ended, Frame, FrameSource, Unplugged, WaitingSource
from core.errors import InputError
from core.files.atomic import make_folder
from core.files.recording.recorder import Recorder
from core.messages import Message
from core.pipeline.live.camera import LiveCamera
from core.pipeline.live.commands import Command, Configure, LiveRequest, Stop, Switch
from core.pipeline.live.context import LiveContext, LiveStep
from core.pipeline.live.display import Display, Reduced
from core.pipeline.live.events import LiveBack, LiveEnded, LiveEvent, LiveNotice, LiveStarted, LiveUnplugged, LiveView
from core.pipeline.live.planes import LivePlanes
from core.pipeline.live.scan import LiveScan
from core.pipeline.live.sources import make_source

RETRY_S = 1.0
"""How often a source that was unplugged is looked for."""

LISTEN_S = 0.05
"""Commands are heard at least this often."""

WORKING_LISTEN_S = 0.002
"""The same while a frame is being looked at."""

PATIENCE_S = 0.25
"""A picture shown together with what was found in it stands so long at most while the next is being looked at; then
the newest come, without."""

LAST_LOOK_S = 5.0
"""How long the last frame of a source that has ended may take to be looked at."""

MOST_DAMAGED = 20
"""So many damaged frames in a row end the recording."""

_RATE_OVER_S = 2.0
"""Over how many of the last seconds the rate of frames is counted."""


class LiveLoop:
    """Loop of a live recording that takes frames from one source through one step until it is stopped."""

    def __init__(
        self, context: LiveContext, step: LiveStep, commands: Callable[[], Command | None], ready: Callable[[], bool]
    ) -> None:
        self._context, self._step, self._commands, self._ready = context, step, commands, ready
        self._source: FrameSource = context.source
        self._waiting_source = context.source if isinstance(context.source, WaitingSource) else None
        self._display = Display.of(context.request.rig, context.request.display_px)
        self._stopping = self._started = False
        self._waiting: deque[Command] = deque()
        self._newest: Frame | None = None
        self._fresh: Frame | None = None
        self._ahead: tuple[Frame, Reduced] | None = None
        self._shown_index = -1
        self._held_s = -PATIENCE_S  # when a picture was last shown with what was found in it
        self._times: deque[float] = deque()
        self._dropped_before = self._dropped_now = self._unmissed = self._damaged = 0

    @property
    def dropped(self) -> int:
        """Number of frames that source and disk have lost since the first picture was recorded."""
        return self._dropped_before + self._dropped_now - self._unmissed + self._context.lost

    def run(self) -> Message | None:
        """Record until stopped or the source ends; return the message of an error that ended it too early, or None."""
        try:
            self._open()
            self._source.prepare(self._context.request.step)
            self._step.begin()
            while not self._stopping:
                self._turn()
        except Ended:
            return self._look_at_last()
        except InputError as problem:
            return problem.message
        return None

    def _turn(self) -> None:
        """One turn: commands, a frame, what was found, a picture for the window."""
        try:
            self._obey()
            if self._stopping:
                return
            frame = self._read()
            if frame is not None:
                self._take_in(frame)
            self._fresh = self._step.poll() or self._fresh
            self._show()
            self._step.rest()
        except Unplugged as gone:
            self._wait_for_source(gone.message)

    def _open(self) -> None:
        """Open the source, and tell it what it can be told."""
        self._source.open()
        context = self._context
        context.capabilities = self._source.capabilities
        told = context.settings.only(context.capabilities.names)
        if left := [TITLES[name][0] for name in context.settings.stated if name not in told.stated]:
            context.notice(
                Message(
                    "live.settings_not_there", "{source} has no {settings:and} to set: what it has is used.",
                    source=self._source.name, settings=left,
                )
            )  # fmt: skip
        self._source.configure(told)

    def _read(self) -> Frame | None:
        """The next frame; one that is damaged is told and left out, unless all are.

        A source that waits is read when the last frame has been looked at: so every one is.
        """
        if self._context.worker.busy and self._waiting_source is not None and self._waiting_source.waits:
            time.sleep(WORKING_LISTEN_S)
            return None
        try:
            frame = self._source.read(WORKING_LISTEN_S if self._context.worker.busy else LISTEN_S)
        except Unplugged:
            raise
        except InputError as damage:
            self._damaged += 1
            if self._damaged >= MOST_DAMAGED:
                raise
            self._context.notice(damage.message)
            return None
        if frame is not None:
            self._damaged = 0
        return frame

    def _take_in(self, frame: Frame) -> None:
        if not self._started:
            self._started = True
            height, width = frame.picture.shape
            self._context.emit(LiveStarted(self._source.name, (width, height), self._context.capabilities))
        self._newest, self._dropped_now = frame, frame.dropped
        if not self._context.recorded:
            self._unmissed = self._dropped_before + self._dropped_now
        self._times.append(frame.time_s)
        while len(self._times) > 2 and frame.time_s - self._times[0] > _RATE_OVER_S:
            self._times.popleft()
        self._context.rate_hz = self._rate()
        was_busy = self._context.worker.busy
        self._step.frame(frame)
        if self._step.show_with_findings and self._context.worker.busy and not was_busy:
            self._ahead = frame, self._display.reduced(frame.picture)  # it will be shown when it has been looked at

    def _obey(self) -> None:
        """Act on all commands that have come."""
        while (command := self._waiting.popleft() if self._waiting else self._commands()) is not None:
            match command:
                case Stop():
                    self._stopping = True
                    return
                case Configure(settings):
                    try:
                        self._source.configure(settings)
                        self._context.settings = self._context.settings.updated(settings)
                        self._step.handle(command)
                    except Unplugged:
                        raise
                    except InputError as error:
                        self._context.emit(LiveNotice(error.message))
                case Switch(lasers):
                    if not self._context.switch(lasers):
                        self._context.notice(
                            Message("live.lasers_by_hand", "This source cannot switch the lasers: do it by hand.")
                        )
                case _:
                    self._step.handle(command)

    def _show(self) -> None:
        """Send the window a picture if it is ready for one and there is a new one."""
        newest, fresh = self._newest, self._fresh
        if newest is None or not self._ready():
            return
        now = time.monotonic()
        paired = self._step.show_with_findings
        if paired and self._context.worker.busy and now - self._held_s < PATIENCE_S and fresh is None:
            return
        frame = newest
        if paired and fresh is not None:
            frame, self._held_s = fresh, now
        if frame.index == self._shown_index and fresh is None:
            return
        self._fresh, self._shown_index = None, frame.index
        ahead = self._ahead
        picture, scale = ahead[1] if ahead and ahead[0] is frame else self._display.reduced(frame.picture)
        self._context.emit(
            LiveView(
                picture,
                scale,
                frame.index,
                self._context.rate_hz,
                self._context.recorded,
                self.dropped,
                self._step.detail(frame),
            )
        )

    def _rate(self) -> float:
        if len(self._times) < 2:
            return 0.0
        return (len(self._times) - 1) / max(self._times[-1] - self._times[0], 1e-6)

    def _wait_for_source(self, sentence: Message) -> None:
        """The source is gone: look for it until it is back, or until told to stop."""
        self._context.emit(LiveUnplugged(sentence))
        self._source.close()
        self._dropped_before, self._dropped_now = self._dropped_before + self._dropped_now, 0
        self._newest = self._fresh = self._ahead = None
        self._shown_index = -1
        self._times.clear()
        tried = time.monotonic()
        while not self._stopping:
            while (command := self._commands()) is not None:
                if isinstance(command, Stop):
                    self._stopping = True
                    return
                self._waiting.append(command)
            time.sleep(LISTEN_S)
            if time.monotonic() - tried < RETRY_S:
                continue
            tried = time.monotonic()
            try:
                self._open()
                self._step.begin()
            except InputError:
                self._source.close()
                continue
            self._context.emit(LiveBack())
            return

    def _look_at_last(self) -> Message | None:
        """The source has ended: wait for the frame that is being looked at, and show it if the window is ready."""
        deadline = time.monotonic() + LAST_LOOK_S
        try:
            while self._context.worker.busy and time.monotonic() < deadline:
                self._fresh = self._step.poll() or self._fresh
                time.sleep(WORKING_LISTEN_S)
        except InputError as problem:
            return problem.message
        self._show()
        return None


def run_live(
    request: LiveRequest,
    commands: Callable[[], Command | None],
    emit: Callable[[LiveEvent], None],
    ready: Callable[[], bool],
) -> LiveEnded:
    """Record live until stopped, or until the source has no more frames; return what was recorded.

    Parameters
    ----------
    request
        What to record, from where, into which folder.
    commands
        The next command, or None.
    emit
        Takes all events but the last, LiveEnded, which is returned.
    ready
        Whether the last LiveView has been shown: if not, there is no other.

    An InputError on the way (no such source, disk full) ends the recording and is told in LiveEnded; what is recorded
    by then is kept.
    """
    try:
        source = make_source(request.source, request.rig)
        folder = make_folder(request.folder)
        if any(folder.iterdir()):
            raise InputError(
                Message("live.folder_not_empty", "there is something in the folder already"),
                where=folder,
                todo=Message("advice.name_new_folder", "name a new one"),
            )
    except InputError as refused:
        return LiveEnded(request.folder, 0, 0, refused.message)
    context = LiveContext(request, source, emit)
    step = _step(context)
    loop = LiveLoop(context, step, commands, ready)
    error = None
    try:
        error = loop.run()
    finally:
        context.close()
        source.close()
        error = _finished(step) or error
        if not any(folder.iterdir()):
            folder.rmdir()
    return LiveEnded(request.folder, context.recorded, loop.dropped, error)


def _finished(step: LiveStep) -> Message | None:
    """Have everything on the disk; what could not be written, or None."""
    try:
        step.finish()
    except InputError as problem:
        return problem.message
    return None


def _step(context: LiveContext) -> LiveStep:
    match context.request.step:
        case "camera":
            return LiveCamera(context)
        case "planes" | "check":
            return LivePlanes(context)
        case "scan":
            return LiveScan(context, Recorder(context.request.folder, ending=context.request.ending))
