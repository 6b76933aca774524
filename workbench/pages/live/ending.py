"""How a recording ends: its folder becomes the source of its step, together with the pictures it was added to."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from PySide6.QtCore import QObject

from core.acquire.source import Step
from core.errors import InputError
from core.files.project.data import Done
from core.files.recording.unfinished import forget_recording, note_recording
from core.pipeline.live.events import LiveEnded
from workbench.bench import Bench
from workbench.language import tr
from workbench.pages.sources import folder_of, put_source
from workbench.work import jobs


class LiveEnding(QObject):
    """Finisher of recordings: it finds a folder, notes it in case of a crash, and adds it to the project at the end."""

    def __init__(self, bench: Bench, step: Step, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._bench, self._model, self._step = bench, bench.model, step
        self.project_folder: Path | None = None
        self.folder: Path | None = None

    def begin(self, project: Path, folder: Path) -> None:
        """Note on the disk that a recording into `folder` begins, so that it can be found after a crash.

        Raises
        ------
        InputError
            If that cannot be noted in the project's folder.
        """
        note_recording(project, self._step, folder)
        self.project_folder, self.folder = project, folder

    def hand_over(self, ended: LiveEnded, *, adding: bool, then: Callable[[], None]) -> None:
        """Make a recording the source of its step, with the earlier pictures if `adding`; then call `then`."""

        def take(*, keep_left_out: bool = False) -> None:
            put_source(self._model, self._step, ended.folder, self._label(), keep_left_out=keep_left_out)
            done()

        def done() -> None:
            if self.project_folder is not None and (not ended.recorded or self.project_folder == self._model.folder):
                self._forget_note(self.project_folder)
            then()

        before = folder_of(self._model, self._step)
        if not ended.recorded or self.project_folder is None or self.project_folder != self._model.folder:
            done()
        elif adding and before is not None:
            self._bench.run_quick(
                self,
                jobs.ADD_RECORDING,
                before,
                ended.folder,
                label=tr("Adding the pictures that were there"),
                on_done=lambda _: take(keep_left_out=True),
                on_failed=lambda _: take(),
                on_cancelled=take,
            )
        else:
            take()

    def _label(self) -> str:
        return {
            "camera": tr("record views of the target"),
            "planes": tr("record poses of the plate"),
            "scan": tr("record a scan"),
            "check": tr("take the pictures of the check"),
        }[self._step]

    def _forget_note(self, project: Path) -> None:
        """The recording is in the project: once that is on the disk, it need not be found after a crash."""
        self._model.autosave()
        try:
            forget_recording(project)
        except InputError as error:
            self._bench.notices.failed(error)


def calibrated_s(results: Mapping[str, Done], *, has_fan: bool = True) -> float | None:
    """Return the time of the older of the two calibrations in s since 1970; None if one is missing.

    Without a fan there is but that of the camera.
    """
    needed = ("camera", "planes") if has_fan else ("camera",)
    made = [results[step].at.timestamp() for step in needed if step in results]
    return min(made) if len(made) == len(needed) else None
