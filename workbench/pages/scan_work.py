"""What is known of the scan: its frames, the calibrations it is seen with, its measurement and the result."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject, Signal

from core.files.project import Project
from core.files.project_keys import finished, rests_on
from core.files.project_results import ScanSummary
from core.live.events import ScanDetail
from core.model import Camera, Fan
from core.scan.frame_preview import FramePreview
from core.scan.frame_record import FrameRecord
from core.scan.scan_look import ScanLook
from workbench import jobs
from workbench.bench import Bench
from workbench.pages.sources import folder_of
from workbench.tasks import Task

PART = "scan/"

DISPLAY_PX = 1280
"""Width of the pictures that are shown while a recording is measured, at most."""


class ScanWork(QObject):
    """Lists the frames, reads the accepted calibrations, measures, and reads the result.

    `frames` and `reference` are of the project as it is; None while they are being listed. `camera` and `fan` are the
    accepted ones, as far as they have been read. `look` is the scan among the results, whatever it was measured from.
    """

    changed = Signal()

    detail = Signal(object)
    """ScanDetail of a frame, while a recording is measured: all of them, for the points."""

    frame_seen = Signal(object, object, int)
    """ScanDetail, the picture it is about and how many times that is reduced; the next comes after `shown`."""

    started = Signal()
    measured = Signal(object)
    """ScanSummary."""

    task: Task | None

    def __init__(self, bench: Bench, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._bench, self._model = bench, bench.model
        self._forget()

    def _forget(self) -> None:
        self.reference: Path | None = None
        self.frames: tuple[Path, ...] | None = None
        self.no_frames = ""
        self.camera: Camera | None = None
        self.fan: Fan | None = None
        self.look: ScanLook | None = None
        self.no_gauge = ""
        self.task = None
        self.by_itself = False
        self.previews: dict[str, FramePreview] = {}
        self.seen_last = ""
        self._problem = ("", "")
        self._listed = self._calibrated = self._looked = ""
        self._latest: ScanDetail | None = None
        self._reading = False

    @property
    def measuring(self) -> bool:
        """Whether the scan is being measured, or waits for its turn."""
        return self.task is not None

    @property
    def problem(self) -> str:
        """Why the last measurement of the project as it is failed, or ""."""
        return self._problem[1] if self._problem[0] == _key(self._model.project) else ""

    @property
    def names(self) -> tuple[str, ...]:
        """The frames by their names in a set, in the order of the recording."""
        return tuple(f"{PART}{path.name}" for path in self.frames or ())

    def records(self) -> Mapping[str, FrameRecord]:
        """What became of each frame by its name; nothing if the result is of another recording."""
        return {record.name: record for record in self.look.frames} if self.look and self.of_this_recording else {}

    @property
    def of_this_recording(self) -> bool:
        """Whether the result among the results is of the recording in use."""
        done = self._model.results.get("scan")
        return done is not None and done.rests_on.get("recording") == self._model.project.sources.scan

    def opened(self) -> None:
        """Another project: forget; list its frames, read its calibrations and its result."""
        if self.task is not None:
            self.task.cancel()
        self._forget()
        if self._model.folder is not None:
            self.follow()

    def follow(self) -> None:
        """The project or its results are others: look at what has changed."""
        if self._model.folder is None:
            return
        self._list_frames()
        self._read_calibration(self._model.folder)
        self._read_result(self._model.folder)

    def measure(self, *, by_itself: bool = False) -> None:
        """Measure the recording; what it shows comes as `detail` and `frame_seen`."""
        folder, project = self._model.folder, self._model.project
        if folder is None or self.measuring:
            return
        self.by_itself, self.previews, self._latest, self._problem = by_itself, {}, None, ("", "")
        self.seen_last = ""
        task: Task = self._bench.measure(
            jobs.WATCH_SCAN,
            folder,
            project,
            label=self.tr("Scan"),
            on_done=lambda summary: self._measured(folder, project, summary),
            on_failed=lambda problem: self._not_measured(task, project, str(problem)),
            on_cancelled=lambda: self._not_measured(task, project, ""),
            offers={"progress": "progress", "watch": "watch"},
        )
        self.task = task
        task.told.connect(lambda detail: self._told(task, detail))
        self.started.emit()
        self.changed.emit()

    def cancel(self) -> None:
        """Stop measuring; the result before stays."""
        if self.task is not None:
            self.task.cancel()

    def shown(self) -> None:
        """The last `frame_seen` is on the screen; the next one is welcome."""
        self._reading = False
        if self._latest is not None:
            self._read_picture()

    # ---- measuring

    def _told(self, task: Task, detail: ScanDetail) -> None:
        if task is not self.task:
            return
        if detail.preview is not None:
            self.previews[detail.preview.name], self.seen_last = detail.preview, detail.preview.name
        self._latest = detail
        self.detail.emit(detail)
        if not self._reading:
            self._read_picture()

    def _read_picture(self) -> None:
        """Fetch the picture of the newest frame; older ones that nobody had time for are passed over."""
        detail, self._latest = self._latest, None
        folder = folder_of(self._model, "scan")
        if detail is None or detail.preview is None or folder is None:
            return
        self._reading = True
        self._bench.quick.run(
            jobs.DISPLAY_PICTURE,
            folder / short(detail.preview.name),
            self._model.project.rig.channel,
            DISPLAY_PX,
            label=self.tr("Reading a picture"),
            on_done=lambda answer: self.frame_seen.emit(detail, *answer),
            on_failed=lambda _: self.shown(),
            on_cancelled=self.shown,
        )

    def _measured(self, folder: Path, project: Project, summary: ScanSummary) -> None:
        self.task, self.no_gauge = None, summary.no_gauge
        if folder != self._model.folder:
            return
        self._looked = ""
        results = dict(self._model.results)
        results["scan"] = scan = finished("scan", project, results)
        thickness = finished("inspect", project, results) if summary.gauge is not None else None
        self._model.record_all({"scan": scan, "inspect": thickness})
        self.measured.emit(summary)

    def _not_measured(self, task: Task, project: Project, problem: str) -> None:
        if task is self.task:
            self.task, self._problem = None, (_key(project), problem)
            self.changed.emit()

    # ---- reading

    def _list_frames(self) -> None:
        folder, wanted = folder_of(self._model, "scan"), self._model.project.sources.scan
        if self.frames is not None and wanted == self._listed:
            return
        if wanted == self._listed and wanted:
            return  # on its way
        self._listed, self.frames, self.reference, self.no_frames = wanted, None, None, ""
        self.previews = {}
        if folder is None:
            self.frames = ()
            return

        def listed(found: tuple[Path | None, tuple[Path, ...]]) -> None:
            if self._listed == wanted:
                self.reference, self.frames = found
                self.changed.emit()

        def refused(problem: Any) -> None:
            if self._listed == wanted:
                self.frames, self.no_frames = (), str(problem)
                self.changed.emit()

        self._bench.glance(
            jobs.LIST_FRAMES,
            folder,
            label=self.tr("Listing the frames"),
            on_done=listed,
            on_failed=refused,
            offers={},
        )

    def _read_calibration(self, folder: Path) -> None:
        project = self._model.project
        wanted = f"{project.accepted.camera}|{project.accepted.fan}"
        if wanted == self._calibrated:
            return
        self._calibrated, self.camera, self.fan = wanted, None, None
        if not project.accepted.camera:
            return

        def read(found: tuple[Camera | None, Fan | None]) -> None:
            if self._calibrated == wanted and folder == self._model.folder:
                self.camera, self.fan = found
                self.changed.emit()

        self._bench.quick.run(  # what is wrong with it is told when it is measured with
            jobs.ACCEPTED_CALIBRATION, folder, project, label=self.tr("Reading the calibrations"), on_done=read
        )

    def _read_result(self, folder: Path) -> None:
        done = self._model.results.get("scan")
        wanted = f"{folder}|{done.key}|{done.at}" if done is not None else ""
        if wanted == self._looked:
            return
        self._looked = wanted
        if done is None:
            self.look = None
            return

        def read(look: ScanLook) -> None:
            if self._looked == wanted:
                self.look = look
                self.changed.emit()

        self._bench.glance(jobs.SHOW_SCAN, folder, label=self.tr("Reading the scan"), on_done=read)


def short(name: str) -> str:
    """The name of a frame within its folder."""
    return name.removeprefix(PART)


def _key(project: Project) -> str:
    return repr(sorted(rests_on("scan", project, {}).items()))
