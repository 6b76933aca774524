"""Decisions of the scan page: recording, settings, which frames count, measuring."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from core.errors import InputError
from core.files.options import Options
from core.files.project import Project
from core.files.project_keys import changed, rests_on
from core.live.events import LiveEnded, LiveView, ScanDetail
from core.scan.frame_record import FrameRecord
from workbench.bench import Bench
from workbench.pages.live_presenter import LivePresenter
from workbench.pages.presenter import StepPresenter
from workbench.pages.scan_run import ScanRun, short
from workbench.pages.scan_scrub import FrameScrub
from workbench.pages.scan_settings import changed_options, values_of
from workbench.pages.scan_stage import Stage, missing, stage_of, why_not_measure, why_not_record
from workbench.pages.scan_thumbnails import FrameThumbnails
from workbench.pages.scan_work import ScanWork
from workbench.pages.sources import folder_of, put_source


class ScanPresenter(StepPresenter):
    """The scan: recorded, measured, looked at."""

    step = "scan"

    def __init__(self, bench: Bench) -> None:
        super().__init__(bench)
        self._leaving = False
        self.model.leaving.connect(self._leave)  # before the recording is ended for it
        self.live = LivePresenter(bench, "scan", self)
        self.live.calibration = lambda: (self.work.camera, self.work.fan)
        self.live.cannot_start = self._cannot_record
        self.work = ScanWork(bench, self)
        self.run = ScanRun(bench, self)
        self.scrub = FrameScrub(bench, self.work, self)
        self.thumbnails = FrameThumbnails(bench, self)
        self.live_stage = ""
        self._shown = False
        self.live.changed.connect(self._look_again)
        self.live.started.connect(self._live_started)
        self.live.view.connect(self._live_view)
        self.live.ended.connect(self._live_ended)
        self.work.changed.connect(self._look_again)
        self.run.changed.connect(self._look_again)
        self.scrub.changed.connect(self.changed)
        self.model.results_changed.connect(self._results_changed)

    # ---- state

    @property
    def stage(self) -> Stage:
        """How far the scan is."""
        return stage_of(self)

    @property
    def scrubbing(self) -> bool:
        """Whether single frames of the recording are looked at: nothing runs, and there are frames."""
        return self.stage not in (Stage.LIVE, Stage.MEASURING) and bool(self.work.frames)

    def blocker(self) -> str:
        return missing(self)

    def busy(self) -> str:
        return self.live.busy()

    @property
    def cannot_measure(self) -> str:
        """Why the scan cannot be measured now, or ""."""
        return why_not_measure(self)

    def changed_since(self) -> tuple[str, ...]:
        """What the result rests on and is not what it was."""
        done = self.model.results.get("scan")
        return changed(done.rests_on, rests_on("scan", self.project, {})) if done is not None else ()

    @property
    def calibrated(self) -> bool:
        """Whether a camera and laser planes are accepted: without them there are stripes, but no points."""
        return bool(self.project.accepted.camera and self.project.accepted.fan)

    # ---- recording

    @property
    def folder(self) -> Path | None:
        """The folder of the recording."""
        return folder_of(self.model, "scan")

    def use_folder(self, folder: Path) -> None:
        """Measure another recording."""
        self.live.stop()
        self.run.cancel()
        put_source(self.model, "scan", folder, self.tr("choose the recording of the scan"))

    # ---- frames

    def record_of(self, name: str) -> FrameRecord | None:
        """What became of a frame, if the recording has been measured."""
        return self.work.records().get(name)

    def is_left_out(self, name: str) -> bool:
        """Whether a frame is left out by hand."""
        return name in self.project.options.excluded

    def set_used(self, names: Sequence[str], used: bool) -> None:
        """Let frames count, or leave them out; undoable."""
        excluded = self.project.options.excluded
        after = excluded - set(names) if used else excluded | set(names)
        what = short(names[0]) if len(names) == 1 else self.tr("{0} frames").format(len(names))
        label = self.tr("let {0} count") if used else self.tr("leave out {0}")
        self._set_options(label.format(what), replace(self.project.options, excluded=after))

    def points_of_frame(self) -> tuple[Any, Any]:
        """Pixels (N, 2) and σ (N,) in mm of the measured points of the frame whose stages are shown."""
        look, stages = self.work.look, self.scrub.stages
        record = self.record_of(stages.name) if stages is not None else None
        if look is None or record is None:
            return None, None
        mine = look.frame == record.index
        return look.uv[mine], look.sigma[mine]

    # ---- settings

    def settings(self) -> dict[str, Any]:
        """How the scan is measured, as the fields of a form."""
        return values_of(self.project.options, self.work.look)

    def set_setting(self, field: str, value: Any) -> None:
        """Change a setting; undoable. What cannot be is refused with a sentence."""
        try:
            options = changed_options(self.project.options, self.work.look, field, value)
        except (InputError, ValueError) as error:
            self.bench.notices.error(str(error))
            self.changed.emit()
            return
        self._set_options(self.tr("change how the scan is measured"), options, f"scan {field}")

    # ---- measuring

    def measure(self) -> None:
        """Measure the recording."""
        if not self.cannot_measure:
            self.run.start()

    def cancel(self) -> None:
        """Stop measuring; what was measured before stays."""
        self.run.cancel()

    # ---- keys

    def do_run(self) -> None:
        self.measure()

    def do_live(self) -> None:
        self.live.toggle()

    def do_capture(self) -> None:
        """What the recording asks for is done: take the reference, start."""
        self.live.answer()

    # ---- what happens elsewhere

    def entered(self) -> None:
        self._shown = True
        self._follow_frames()

    def left(self) -> None:
        self._shown = False
        self.scrub.set_active(False)

    def opened(self) -> None:
        self._shown = self._leaving = False
        self.scrub.forget()
        self.thumbnails.forget()
        self.run.opened()
        self.work.opened()

    def project_changed(self, before: Project, after: Project) -> None:
        if before.sources.scan != after.sources.scan:
            self.scrub.forget()
        self.thumbnails.follow()
        self.work.follow()
        self._follow_frames()

    def stop(self) -> None:
        self._leave()
        self.live.finish()

    def _leave(self) -> None:
        """The project is about to be left: what is recorded now is measured another time."""
        self._leaving = True

    def _results_changed(self) -> None:
        self.work.follow()
        self._follow_frames()

    def _look_again(self) -> None:
        self._follow_frames()
        self.changed.emit()

    def _follow_frames(self) -> None:
        self.scrub.set_active(self._shown and self.scrubbing)

    def _set_options(self, label: str, options: Options, merge_key: str = "") -> None:
        self.model.edit(label, replace(self.project, options=options), merge_key)

    def _cannot_record(self) -> str:
        """Why no recording can start now, or ""."""
        return why_not_record(self)

    def _live_started(self) -> None:
        self._leaving = False
        self._set_live_stage("")

    def _live_view(self, view: LiveView) -> None:
        if isinstance(view.detail, ScanDetail):
            self._set_live_stage(view.detail.stage)

    def _set_live_stage(self, stage: str) -> None:
        if stage != self.live_stage:
            self.live_stage = stage
            self.changed.emit()

    def _live_ended(self, ended: LiveEnded) -> None:
        """The recording is the source by now: measure it, if that can be done."""
        self.live_stage = ""
        if not ended.recorded or self.folder != ended.folder or self._leaving:
            return
        if self.calibrated:
            self.run.start(by_itself=True)
        else:
            self.bench.notices.info(
                self.tr("The scan is recorded. It can be measured once camera and laser planes are accepted.")
            )
