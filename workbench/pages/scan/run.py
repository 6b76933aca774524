"""The measurement of a recording while it runs: what it shows, and what it leaves in the project."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject, Signal

from core.files.project.data import Project
from core.files.project.keys import finished, inputs_of
from core.files.project.results import ScanSummary
from core.messages import Message
from core.pipeline.live.events import ScanDetail
from core.scan.preview.shown import PreviewCloud
from workbench.bench import Bench
from workbench.language import text_of, tr
from workbench.pages.sources import folder_of
from workbench.work import jobs
from workbench.work.tasks import Task

PART = "scan/"

DISPLAY_PX = 1280
"""Width of the pictures that are shown while a recording is measured, at most."""


class ScanRun(QObject):
    """Job that measures the recording of the project as it is at the start, and records the result.

    `seen` says of each frame so far how many points it has in the preview, and why it has none; `newest` is the last.
    """

    changed = Signal()

    frame_seen = Signal(object, object, int)
    """ScanDetail with all points since the last one, the picture it is about, and how many times that is reduced. The
    next comes after `shown`; frames in between are passed over."""

    started = Signal()

    seen: dict[str, tuple[int, Message | None]]
    newest: str
    by_itself: bool
    """Whether it was started by the end of a recording."""

    no_gauge: Message | None
    """Why the last measurement gave no thickness; None if it did."""

    def __init__(self, bench: Bench, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._bench, self._model = bench, bench.model
        self._task: Task | None = None
        self._reading = False
        self._problem = ("", "")
        self.no_gauge = None
        self._forget(by_itself=False)

    def _forget(self, *, by_itself: bool) -> None:
        self.by_itself, self.seen, self.newest = by_itself, {}, ""
        self._latest: ScanDetail | None = None
        self._points: list[PreviewCloud] = []
        self._renewed = False

    @property
    def measuring(self) -> bool:
        """Whether the scan is being measured, or waits for the process."""
        return self._task is not None

    @property
    def problem(self) -> str:
        """Reason why the last measurement of the scan failed; "" if it did not, or the project has changed."""
        made_of, problem = self._problem
        return problem if problem and made_of == _key(self._model.project) else ""  # the key takes a millisecond

    def opened(self) -> None:
        """Stop measuring, and drop the last problem, as another project is open."""
        self.cancel()
        self._task, self._problem, self.no_gauge = None, ("", ""), None
        self._forget(by_itself=False)

    def start(self, *, by_itself: bool = False) -> None:
        """Measure the project's recording, in the background."""
        folder, project = self._model.folder, self._model.project
        if folder is None or self.measuring:
            return
        self._forget(by_itself=by_itself)
        self._problem = ("", "")
        task: Task = self._bench.run_long(
            self,
            jobs.WATCH_SCAN,
            folder,
            project,
            label=tr("Scan"),
            on_done=lambda summary: self._measured(folder, project, summary),
            on_failed=lambda problem: self._not_measured(task, project, text_of(problem)),
            on_cancelled=lambda: self._not_measured(task, project, ""),
            offers={"progress": "progress", "watch": "watch"},
        )
        self._task = task
        task.reported.connect(lambda detail: self._told(task, detail))
        self.started.emit()
        self.changed.emit()

    def cancel(self) -> None:
        """Stop measuring; an earlier result stays."""
        if self._task is not None:
            self._task.cancel()

    def shown(self) -> None:
        """Ask for the next frame, as the one of the last `frame_seen` is on the screen."""
        self._reading = False
        if self._latest is not None:
            self._read_picture()

    def _told(self, task: Task, detail: ScanDetail) -> None:
        if task is not self._task:
            return
        if detail.preview is not None:
            preview = detail.preview
            self.seen[preview.name], self.newest = (len(preview.points), preview.reason), preview.name
        if detail.renewed:
            self._points, self._renewed = [], True
        self._points.append(detail.points)
        self._latest = detail
        if not self._reading:
            self._read_picture()

    def _read_picture(self) -> None:
        """Fetch the picture of the newest frame."""
        detail, self._latest = self._latest, None
        folder = folder_of(self._model, "scan")
        if detail is None or detail.preview is None or folder is None:
            return
        self._reading = True
        self._bench.quick.run(
            self,
            jobs.DISPLAY_PICTURE,
            folder / short(detail.preview.name),
            self._model.project.rig.channel_of("scan"),
            DISPLAY_PX,
            self._model.project.rig.mosaic,
            label=tr("Reading a picture"),
            on_done=lambda answer: self._seen(detail, *answer),
            on_failed=lambda _: self.shown(),
            on_cancelled=self.shown,
        )

    def _seen(self, detail: ScanDetail, picture: Any, scale: int) -> None:
        """The picture has come: tell it with all points that were not yet told."""
        points, renewed = PreviewCloud.joined(self._points), self._renewed
        self._points, self._renewed = [], False
        self.frame_seen.emit(replace(detail, points=points, renewed=renewed), picture, scale)

    def _measured(self, folder: Path, project: Project, summary: ScanSummary) -> None:
        self._task, self.no_gauge = None, summary.no_gauge
        if folder != self._model.folder:
            return
        results = dict(self._model.results)
        results["scan"] = scan = finished("scan", project, results)
        thickness = finished("gauge", project, results) if summary.gauge is not None else None
        self._model.record_all({"scan": scan, "gauge": thickness})

    def _not_measured(self, task: Task, project: Project, problem: str) -> None:
        if task is self._task:
            self._task, self._problem = None, (_key(project), problem)
            self.changed.emit()


def short(name: str) -> str:
    """Return the name of a frame without its folder."""
    return name.removeprefix(PART)


def _key(project: Project) -> str:
    return repr(sorted(inputs_of("scan", project, {}).items()))
