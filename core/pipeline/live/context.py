"""What the steps of a live recording share: the source's lasers, the folder, the events, and a second pair of hands."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any, Protocol

from core.acquire.source import Capabilities, Frame, FrameSource, Lasers, Picture, WaitingSource
from core.files.pictures import write_picture
from core.files.recording.recording_log import RecordingLog, logged
from core.held_files import rename
from core.messages import Message
from core.pipeline.live.commands import Command, LiveRequest
from core.pipeline.live.display import Display
from core.pipeline.live.events import Detail, LiveAnswered, LiveAsk, LiveEvent, LiveNotice, LiveTaken
from core.pipeline.live.sources import camera_name

THUMBNAIL_PX = 240
"""Width in pixels at most of the small picture that the window lists."""
DISCARDED = "discarded"
"""Folder within the recording for what was put aside."""


class LiveStep(Protocol):
    """Interface of the steps of a live recording: camera, planes and scan."""

    @property
    def show_with_findings(self) -> bool:
        """Whether a frame is shown together with what was found in it, even after later frames have come."""

    def begin(self) -> None:
        """Start the step, once the source is open."""

    def frame(self, frame: Frame) -> None:
        """Record a frame if it is to be recorded, and have it analysed if there is time."""

    def poll(self) -> Frame | None:
        """Take the result of an analysis that has ended; return its frame if `detail` has changed, else None."""

    def detail(self, shown: Frame) -> Detail | None:
        """Return what has been found so far, to be shown with the frame `shown`; None before anything is.

        Called only when it is shown.
        """

    def rest(self) -> None:
        """Start a piece of work that was put off until a picture has been shown, if there is any."""

    def handle(self, command: Command) -> None:
        """Follow a command that concerns this step, such as Capture or Pause; Stop and Switch do not come here."""

    def finish(self) -> None:
        """Write all that is recorded to the disk, as no more frames come."""


class Worker:
    """Thread that does one job at a time; a job that comes while it is busy is refused."""

    def __init__(self) -> None:
        self._pool = ThreadPoolExecutor(1, thread_name_prefix="live")
        self._job: Future[Any] | None = None

    @property
    def busy(self) -> bool:
        """Whether a job is running, or has ended and its result has not been taken."""
        return self._job is not None

    def start(self, job: Callable[..., Any], *args: Any) -> bool:
        """Start `job(*args)` in the thread; return False, without starting it, if the worker is busy."""
        if self._job is not None:
            return False
        self._job = self._pool.submit(job, *args)
        return True

    def take(self, timeout_s: float = 0.0) -> Any | None:
        """Return the result of a job that has ended, once; None if there is none by `timeout_s`; raise its error."""
        job = self._job
        if job is None or not (job.done() or timeout_s > 0):
            return None
        try:
            return job.result(timeout_s)
        except TimeoutError:
            if job.done():
                raise
            return None
        finally:
            if job.done():
                self._job = None

    def close(self) -> None:
        """Refuse further jobs; one that is running ends by itself and is not waited for."""
        self._pool.shutdown(wait=False, cancel_futures=True)


class LiveContext:
    """Source, events and files of a live recording, which each of its steps works with.

    `recorded` counts what is on the disk, `lost` frames the disk was too slow for. `settings` is what the source has
    been told, `capabilities` what it can be told, `rate_hz` how many frames a second have come of late.
    """

    def __init__(self, request: LiveRequest, source: FrameSource, emit: Callable[[LiveEvent], None]) -> None:
        self.request, self.source, self.emit = request, source, emit
        self.worker = Worker()
        self.recorded = self.lost = 0
        self.rate_hz = 0.0
        self.lasers = Lasers(fan=False, hand=False)
        self.settings, self.capabilities = request.settings, Capabilities()
        self._log = RecordingLog(request.folder)
        self._asking = False
        self._told: Message | None = None

    def close(self) -> None:
        """Close the writers of pictures, as no more pictures come."""
        self.worker.close()
        self._log.close()

    def switch(self, lasers: Lasers) -> bool:
        """Set which lasers are on from now on; return True if the source switches them, False if a person must."""
        self.lasers = lasers
        return self.source.lasers(lasers)

    def release_scene(self, frame: Frame) -> None:
        """Tell a source that waits for it that the scene in `frame` was taken or is useless, so that it may go on."""
        if isinstance(self.source, WaitingSource):
            self.source.go_on(frame)

    def ask(self, sentence: Message, button: str, answer: Command) -> None:
        """Ask the user to do what `sentence` says and then to press `button`, which sends `answer`."""
        self._asking = True
        self.emit(LiveAsk(sentence, button, answer))

    def answered(self) -> None:
        """Withdraw the request that the user was asked to follow, if there is one."""
        if self._asking:
            self._asking = False
            self.emit(LiveAnswered())

    def notice(self, sentence: Message, *, refused: bool = False) -> None:
        """Show a sentence to the user unless it was the last one shown; `refused`: it says why nothing was taken."""
        if sentence != self._told:
            self._told = sentence
            self.emit(LiveNotice(sentence, refused))

    @property
    def camera(self) -> str:
        """Name of the open camera for the logs of recordings; "" for a replay, which has no camera."""
        return camera_name(self.request.source, self.source)

    def write(self, name: str, picture: Picture, frame: Frame | None = None) -> None:
        """Write a picture under `name` (without ending) and, if a `frame` is given, when it was taken into the log.

        Raises
        ------
        InputError
            If the disk is full.
        """
        path = self.request.folder / f"{name}.png"
        write_picture(path, picture)
        if frame is not None:
            self._log.add(logged(path.name, frame, frame.dropped, self.camera))

    def took(self, name: str, picture: Picture) -> None:
        """Report to the window that the view, pose or reference `name` is on the disk, with a thumbnail."""
        self._told = None
        self.emit(LiveTaken(name, Display.of(self.request.rig, THUMBNAIL_PX).reduced(picture)[0]))

    def put_aside(self, *names: str) -> bool:
        """Move pictures (names without ending) out of the recording, to `discarded`; False if none of them exists."""
        there = [path for name in names if (path := self.request.folder / f"{name}.png").exists()]
        if there:
            aside = self.request.folder / DISCARDED
            aside.mkdir(exist_ok=True)
            for path in there:
                rename(path, aside / path.name)
        return bool(there)


def as_sentence(what: Message) -> Message:
    """Make a sentence of the `what` of an InputError: with a capital letter, ended by a full stop."""
    return Message("live.reason", "{reason:capital}.", reason=what)
