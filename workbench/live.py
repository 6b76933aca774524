"""A live source in the window: one session from start to stop, its pictures and events as Qt signals."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QObject, Signal

from workbench import jobs
from workbench.tasks import Lane, Task

if TYPE_CHECKING:
    from core.pipeline.live import LiveRequest


class LiveSession(QObject):
    """One live recording.

    `view` brings the pictures, already decoded for display, never more than can be shown; whoever shows one calls
    `shown`. `told` brings everything else (core.pipeline.live: LiveStarted, LiveTaken, LiveAsk, LiveNotice,
    LiveUnplugged, LiveBack). `ended` brings LiveEnded, or what went wrong; what was recorded is kept in either case.
    """

    view = Signal(object)
    told = Signal(object)
    ended = Signal(object)
    failed = Signal(object)

    def __init__(self, lane: Lane, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._lane = lane
        self._task: Task | None = None

    @property
    def running(self) -> bool:
        """Whether a source is open."""
        return self._task is not None

    def start(self, request: LiveRequest) -> None:
        """Open the source and go."""
        if self._task is not None:
            return
        self._task = task = self._lane.run(
            jobs.RUN_LIVE,
            request,
            label=f"live {request.step}",
            on_done=self._done,
            on_failed=self._failed,
            on_cancelled=lambda: self._failed(None),
            offers={"channel": "channel"},
        )
        task.view.connect(self.view)
        task.told.connect(self.told)

    def send(self, command: Any) -> None:
        """Give the loop a command (core.pipeline.live: Capture, Auto, Switch, Pause, Resume, Stop, …)."""
        if self._task is not None:
            self._task.send(command)

    def abandon(self) -> None:
        """Do not wait any longer for a source that hangs: end its process."""
        if self._task is not None:
            self._task.cancel()

    def shown(self) -> None:
        """The last view has been shown."""
        if self._task is not None:
            self._task.shown()

    def _done(self, result: Any) -> None:
        self._task = None
        self.ended.emit(result)

    def _failed(self, problem: Any) -> None:
        self._task = None
        self.failed.emit(problem)
