"""What is known of the scan: its frames, the calibrations it is seen with, and the result."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject, Signal

from core.calibrate.sitting import Acquisition
from core.model import Camera, Fan
from core.model.arrays import Array
from core.scan.features.frames import FrameRecord
from core.scan.preview.shown import ShownScan
from workbench.bench import Bench
from workbench.language import text_of, tr
from workbench.pages.scan.run import PART
from workbench.pages.sources import folder_of
from workbench.work import jobs


class ScanWork(QObject):
    """Reader of the list of frames, the accepted calibrations and the result.

    `frames` and `reference` are of the project as it is; None while they are being listed. `marked` are the
    frames that somebody marked, by their names in a set. `camera` and `fan` are the accepted ones, once
    `calibrations_read`. `look` is the scan among the results, whatever it was measured from.
    """

    changed = Signal()

    def __init__(self, bench: Bench, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._bench, self._model = bench, bench.model
        self._forget()

    def _forget(self) -> None:
        self.reference: Path | None = None
        self.frames: tuple[Path, ...] | None = None
        self.marked: frozenset[str] = frozenset()
        self.no_frames = ""
        self.camera: Camera | None = None
        self.fan: Fan | None = None
        self.planes_taken: Acquisition | None = None
        self.calibrations_read = False
        self.look: ShownScan | None = None
        self._listed = self._calibrated = self._looked = self._thickness = ""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the recording's frames within a recording set, in order."""
        return tuple(f"{PART}{path.name}" for path in self.frames or ())

    def records(self) -> Mapping[str, FrameRecord]:
        """Return what the measured scan says of each frame, by name; empty if it is of another recording."""
        return {record.name: record for record in self.look.frames} if self.look and self.of_this_recording else {}

    def known_planes(self) -> Mapping[str, Array]:
        """Return where the known planes of this recording are seen, (K, 2) px by name; empty until it is measured."""
        return self.look.known_planes if self.look and self.of_this_recording else {}

    @property
    def of_this_recording(self) -> bool:
        """Whether the scan in the project's results was measured from the recording in use."""
        done = self._model.results.get("scan")
        return done is not None and done.rests_on.get("recording") == self._model.project.sources.scan

    def opened(self) -> None:
        """List the frames of the project now open, and read its calibrations and its scan."""
        self._forget()
        if self._model.folder is not None:
            self.follow()

    def follow(self) -> None:
        """Read again what has changed in the project: frames, calibrations or the scan."""
        if self._model.folder is None:
            return
        self._list_frames()
        self._read_calibration(self._model.folder)
        self._read_result(self._model.folder)

    def look_again(self) -> None:
        """Read the scan again if its thickness was measured anew, as heights count from the part's lower face."""
        if self._model.folder is not None and self.look is not None and self._thickness != self._thickness_now():
            self._looked = ""
            self._read_result(self._model.folder)

    def _list_frames(self) -> None:
        folder, wanted = folder_of(self._model, "scan"), self._model.project.sources.scan
        if self.frames is not None and wanted == self._listed:
            return
        if wanted == self._listed and wanted:
            return  # on its way
        self._listed, self.frames, self.reference, self.no_frames = wanted, None, None, ""
        self.marked = frozenset()
        if folder is None:
            self.frames = ()
            return

        def listed(found: tuple[Path | None, tuple[Path, ...]]) -> None:
            if self._listed == wanted:
                self.reference, self.frames = found
                self.changed.emit()

        def refused(problem: Any) -> None:
            if self._listed == wanted:
                self.frames, self.no_frames = (), text_of(problem)
                self.changed.emit()

        def read(marked: frozenset[str]) -> None:
            if self._listed == wanted:
                self.marked = frozenset(f"{PART}{name}" for name in marked)
                self.changed.emit()

        self._bench.run_quick(self, jobs.MARKED_FRAMES, folder, label=tr("Reading the marks"), on_done=read, offers={})
        self._bench.run_quick(
            self,
            jobs.LIST_FRAMES,
            folder,
            label=tr("Listing the frames"),
            on_done=listed,
            on_failed=refused,
            offers={},
        )

    def _read_calibration(self, folder: Path) -> None:
        project = self._model.project
        wanted = f"{project.accepted.camera}|{project.accepted.planes}"
        if wanted == self._calibrated:
            return
        self._calibrated, self.camera, self.fan, self.planes_taken = wanted, None, None, None
        self.calibrations_read = not project.accepted.camera
        if self.calibrations_read:
            return

        def read(found: tuple[Camera | None, Fan | None, Acquisition | None]) -> None:
            if self._calibrated == wanted and folder == self._model.folder:
                self.camera, self.fan, self.planes_taken = found
                self.calibrations_read = True
                self.changed.emit()

        self._bench.quick.run(
            self,
            jobs.ACCEPTED_CALIBRATION,
            folder,
            project,
            label=tr("Reading the calibrations"),
            on_done=read,
            on_failed=lambda _: read((None, None, None)),  # what is wrong is told when it is measured with them
        )

    def _read_result(self, folder: Path) -> None:
        done = self._model.results.get("scan")
        wanted = f"{folder}|{done.key}|{done.at}" if done is not None else ""
        if wanted == self._looked:
            return
        self._looked, self._thickness = wanted, self._thickness_now()
        if done is None:
            self.look = None
            return

        def read(look: ShownScan) -> None:
            if self._looked == wanted:
                self.look = look
                self.changed.emit()

        self._bench.run_quick(self, jobs.SHOW_SCAN, folder, label=tr("Reading the scan"), on_done=read)

    def _thickness_now(self) -> str:
        """Tells one measurement of the thickness from another; nothing without one."""
        done = self._model.results.get("gauge")
        return "" if done is None else f"{done.key}|{done.at}"
