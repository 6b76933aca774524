"""Decisions of the scan page: recording, settings, which frames count, measuring."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import Any

from core.calibrate.sitting import Acquisition, hours_of_sitting
from core.errors import InputError
from core.files.project.data import Project
from core.files.project.keys import changed, inputs_of
from core.files.recording.recording_set import CHECK, boards_beside
from core.image.stripes.stripe import StripeSettings
from core.pipeline.live.events import LiveEnded, LiveView, ScanDetail
from core.pipeline.live.rig_check import rig_check
from core.scan.features.frames import FrameRecord
from core.settings.options import Options
from core.settings.rig import RIG
from core.states import OUT_OF_DATE
from workbench.bench import Bench
from workbench.language import tr
from workbench.pages.live.presenter import LivePresenter
from workbench.pages.presenter import StepPresenter
from workbench.pages.scan import stability, words
from workbench.pages.scan.artefacts import KnownArtefacts
from workbench.pages.scan.check import CheckStage, RigCheck
from workbench.pages.scan.guidance import Guidance, Situation, guidance, is_enough, is_recording
from workbench.pages.scan.run import ScanRun, short
from workbench.pages.scan.scrub import FrameScrub
from workbench.pages.scan.stage import Facts, Stage, WhyNot, disabled_reasons, stage_of
from workbench.pages.scan.thumbnails import FrameThumbnails
from workbench.pages.scan.work import ScanWork
from workbench.pages.settings import changed_options, values_of
from workbench.pages.sources import folder_of, put_source, scan_begins_live
from workbench.pages.whole import MeasuringAll
from workbench.step_state import State


class ScanPresenter(StepPresenter):
    """Presenter of the scan: recording, measuring, looking through its frames."""

    step = "scan"

    def __init__(self, bench: Bench) -> None:
        super().__init__(bench)
        self._leaving = False
        self.model.leaving.connect(self._leave)  # before the recording is ended for it
        self.live = LivePresenter(bench, "scan", self)
        self.live.calibration = lambda: (self.work.camera, self.work.fan)
        self.live.cannot_start = self._cannot_record
        self.live.boards = lambda: self.boards
        self.work = ScanWork(bench, self)
        self.run = ScanRun(bench, self)
        self.check = RigCheck(bench, self)
        self.artefacts = KnownArtefacts(bench, lambda: self.run.measuring, self)
        self.check_live = LivePresenter(bench, "check", self)
        self.check_live.calibration = self.live.calibration
        self.check_live.cannot_start = self._cannot_take
        self.live.check = lambda: self.check.valid
        self.scrub = FrameScrub(bench, self.work, self)
        self.thumbnails = FrameThumbnails(bench, self)
        self.whole: MeasuringAll | None = None
        """The whole job, offered here too where the window has it: the next part of a series begins on this page."""
        self.live_stage = ""
        self._seen: ScanDetail | None = None
        self._shown = False
        self.live.changed.connect(self._look_again)
        self.live.started.connect(self._live_started)
        self.live.view.connect(self._live_view)
        self.live.ended.connect(self._live_ended)
        self.work.changed.connect(self._look_again)
        self.run.changed.connect(self._look_again)
        self.check.changed.connect(self.changed)
        self.artefacts.changed.connect(self.changed)
        self.check_live.changed.connect(self._look_again)
        self.check_live.ended.connect(self._check_taken)
        self.scrub.changed.connect(self.changed)
        self.model.results_changed.connect(self._results_changed)

    def offer_whole(self, whole: MeasuringAll) -> None:
        """Set the job that does all steps, which the page offers beside measuring the scan."""
        self.whole = whole
        whole.changed.connect(self.changed)

    # ---- state

    @property
    def stage(self) -> Stage:
        """How far the scan is: no recording, live, measuring, measured, outdated, …."""
        return stage_of(self._facts())

    def _facts(self) -> Facts:
        accepted, state, work = self.project.accepted, self.state.state, self.work
        return Facts(
            has_fan=self.has_fan,
            boards=bool(self.boards),
            live=self.live.running,
            check_live=self.check_live.running,
            measuring=self.run.measuring,
            failed=bool(self.run.problem),
            measured=state in (State.DONE, State.OUTDATED),
            outdated=state is State.OUTDATED,
            camera=bool(accepted.camera),
            planes=bool(accepted.planes) or not self.has_fan,
            calibrations_read=work.calibrations_read,
            source=bool(self.project.sources.scan),
            listed=work.frames is not None,
            frames=bool(work.frames),
            counting=not self.project.options.excluded.issuperset(work.names),
            read_only=self.model.is_read_only,
        )

    @property
    def recording(self) -> bool:
        """Whether frames of a live scan are being recorded, a pause included."""
        return self.stage is Stage.LIVE and is_recording(self.live_stage)

    @property
    def guidance(self) -> Guidance:
        """What the page tells the hand now: light, sentence and button."""
        live = self.live
        return guidance(
            Situation(
                live.state_text(),
                live.gone,
                live.stopping,
                live.question,
                live.paused,
                self._seen,
                live.checks,
                has_fan=self.has_fan,
            )
        )

    @property
    def scrubbing(self) -> bool:
        """Whether single frames of the recording can be looked at: there are frames, and nothing runs."""
        running = self.check_live.running or self.stage in (Stage.LIVE, Stage.MEASURING)
        return not running and bool(self.work.frames)

    def blocker(self) -> str:
        stage = self.stage
        if stage is Stage.MEASURED:
            return ""
        if stage in (Stage.LIVE, Stage.MEASURING):
            return self.cannot_measure
        if stage is Stage.OUTDATED and not self.changed_since():
            return self.state.sentence
        if self.cannot_measure:
            return self.cannot_measure
        return {
            Stage.FAILED: tr("The scan could not be measured; look at why, or record another one."),
            Stage.OUTDATED: tr(OUT_OF_DATE["scan"]),
        }.get(stage, tr("Measure the scan first."))

    @property
    def cannot_measure(self) -> str:
        """Reason why the scan cannot be measured now; "" if it can."""
        return {
            WhyNot.NOTHING: "",
            WhyNot.LIVE: tr("Stop the recording first."),
            WhyNot.MEASURING: tr("The scan is being measured."),
            WhyNot.READ_ONLY: self.bench.cannot_write,
            WhyNot.NO_CAMERA: tr("Accept a camera calibration first."),
            WhyNot.NO_PLANES: tr("Accept the laser planes first."),
            WhyNot.NO_SOURCE: tr("Record a scan, or choose a recording, first."),
            WhyNot.LISTING: tr("The frames are being listed."),
            WhyNot.NO_FRAMES: self.work.no_frames or tr("Choose a folder that holds the frames of a scan."),
            WhyNot.ALL_LEFT_OUT: tr("All frames are left out; let some of them count again."),
        }[disabled_reasons(self._facts()).measure]

    def changed_since(self) -> tuple[str, ...]:
        """List the inputs of the measured scan that have changed since it was measured."""
        done = self.model.results.get("scan")
        return changed(done.rests_on, inputs_of("scan", self.project, {})) if done is not None else ()

    @property
    def has_fan(self) -> bool:
        """Whether the rig has a fan that is calibrated and checked, and whose lines measure alone."""
        return self.project.rig.has_fan

    @property
    def boards(self) -> tuple[str, ...]:
        """Names of the boards that lie beside the part in a live scan."""
        return boards_beside(self.project.rig, plate=self.project.plate_beside is True)

    @property
    def asks_for_plate(self) -> bool:
        """Whether it is to be asked if the plate is left beside the part: once, before anything is recorded."""
        asked = self.project.plate_beside is not None or bool(self.boards)
        before = self.stage in (Stage.NONE, Stage.EMPTY)
        return self.has_fan and not asked and before and not self.model.is_read_only

    def leave_plate_beside(self, on: bool) -> None:
        """Answer whether the plate is left beside the part; undoable."""
        label = tr("leave the plate beside the part") if on else tr("leave no plate beside the part")
        self.model.edit(label, replace(self.project, plate_beside=on))

    @property
    def calibrated(self) -> bool:
        """Whether all is accepted that a scan is measured with; without it frames give stripes but no points."""
        facts = self._facts()
        return facts.camera and facts.planes

    @property
    def check_is_due(self) -> bool:
        """Whether pictures of the interim check should be taken next: there are none of today, and no scan yet.

        Planes that were calibrated a moment ago are as good as a check.
        """
        if self.stage is not Stage.NONE or not (self.has_fan and self.calibrated and self.work.calibrations_read):
            return False
        if self.check.stage is CheckStage.CHECKING or not scan_begins_live(self.model):
            return False
        now, planes = datetime.now().astimezone(), self.work.planes_taken
        here = None if planes is None else Acquisition(planes.camera, now, now)
        hours = hours_of_sitting(planes, here, self.project.rig.validity.fresh_hours)
        return rig_check(self.check.valid, now, hours).state == "unknown"

    # ---- recording

    @property
    def folder(self) -> Path | None:
        """Folder of the recording; None if none is chosen."""
        return folder_of(self.model, "scan")

    def use_folder(self, folder: Path) -> None:
        """Make `folder` the recording to measure; if it is in a recording set, use that set's check, too."""
        self.live.stop()
        self.run.cancel()
        put_source(self.model, "scan", folder, tr("choose the recording of the scan"))
        its_check = folder.parent / CHECK
        if self.has_fan and folder.name == "scan" and its_check.is_dir():
            self.check.use_folder(its_check)

    # ---- frames

    def go_to_next_mark(self) -> None:
        """Show the next frame that was marked while recording; after the last one, the first."""
        names, here = self.work.names, self.scrub.index
        marked = [place for place, name in enumerate(names) if name in self.work.marked]
        if marked:
            self.scrub.go_to(next((place for place in marked if place > here), marked[0]))

    def record_of(self, name: str) -> FrameRecord | None:
        """Return what the measured scan says of the frame called `name`; None if it does not have the frame."""
        return self.work.records().get(name)

    def is_left_out(self, name: str) -> bool:
        """Whether the frame called `name` is left out by the user."""
        return name in self.project.options.excluded

    def set_used(self, names: Sequence[str], used: bool) -> None:
        """Use the frames called `names`, or leave them out; undoable."""
        excluded = self.project.options.excluded
        after = excluded - set(names) if used else excluded | set(names)
        what = short(names[0]) if len(names) == 1 else tr("{count} frames", count=len(names))
        label = tr("let {what} count", what=what) if used else tr("leave out {what}", what=what)
        self._set_options(label, replace(self.project.options, excluded=after))

    def points_of_frame(self) -> tuple[Any, Any]:
        """Return pixels (N, 2) and σ (N,) in mm of the current frame's measured points; None, None without any."""
        look, stages = self.work.look, self.scrub.stages
        record = self.record_of(stages.name) if stages is not None else None
        if look is None or record is None:
            return None, None
        mine = look.frame == record.index
        return look.uv[mine], look.sigma[mine]

    # ---- settings

    @property
    def _stripe_found(self) -> StripeSettings | None:
        """Width and contrast as the last measurement took them."""
        return None if self.work.look is None else self.work.look.stripe

    @property
    def largest_sigma_mm(self) -> float:
        """Largest σ of depth in mm that a point may have to be kept."""
        return self.project.options.sigma_cut_mm

    def settings(self) -> dict[str, Any]:
        """Return the settings of the scan and of the rig's stability as the fields of a form."""
        rig = self.project.rig
        return {
            **values_of("scan", self.project.options, self._stripe_found),
            **stability.rig_shown(rig),
            **{key: getattr(rig.validity, key) for key in RIG["validity"]},
            "row_time_us": rig.row_time_us,
            "channel": rig.channel_of("scan") or "",
        }

    def set_setting(self, field: str, value: Any) -> None:
        """Change one setting of the scan; undoable. A signal says why if it is impossible."""
        if field in stability.rig_shown(self.project.rig):
            after = replace(self.project, rig=stability.rig_stated(self.project.rig, field, value))
            self.model.edit(tr("change what is known of the rig's stability"), after, f"scan {field}")
            return
        if field == "channel":
            after = replace(self.project, rig=self.project.rig.with_channel("scan", value or None))
            self.model.edit(tr("change the colour that is looked at"), after, f"scan {field}")
            return
        if field == "row_time_us":
            after = replace(self.project, rig=replace(self.project.rig, row_time_us=value))
            self.model.edit(tr("change what is known of the camera's shutter"), after, f"scan {field}")
            return
        if field in RIG["validity"]:
            rig = self.project.rig
            after = replace(self.project, rig=replace(rig, validity=replace(rig.validity, **{field: value})))
            self.model.edit(tr("change how long calibration and check hold"), after, f"scan {field}")
            return
        try:
            options = changed_options("scan", self.project.options, self._stripe_found, field, value)
        except (InputError, ValueError) as error:
            self.bench.notices.failed(error)
            self.changed.emit()
            return
        self._set_options(tr("change how the scan is measured"), options, f"scan {field}")

    # ---- measuring

    def measure(self) -> None:
        """Measure the recording, in the background."""
        if not self.cannot_measure:
            self.run.start()

    def measure_everything(self) -> None:
        """Do every step that is not up to date, to the report, in the background."""
        if self.whole is not None:
            self.whole.start()

    def cancel(self) -> None:
        """Stop measuring the recording; an earlier result stays."""
        self.run.cancel()

    # ---- keys

    def do_run(self) -> None:
        self.measure()

    def do_live(self) -> None:
        (self.check_live if self.check_live.running else self.live).toggle()

    def do_capture(self) -> None:
        """Take the reference, start the frames, or take a picture of the check: what is asked for; by shortcut."""
        if self.check_live.running:
            self.check_live.capture()
        else:
            self.live.answer()

    # ---- what happens elsewhere

    def entered(self) -> None:
        self._shown = True
        self.work.look_again()
        self._follow_frames()

    def left(self) -> None:
        self._shown = False
        self.scrub.set_active(False)

    def opened(self) -> None:
        self._shown = self._leaving = False
        self.scrub.forget()
        self.thumbnails.forget()
        self.run.opened()
        self.check.opened()
        self.artefacts.opened()
        self.work.opened()

    def project_changed(self, before: Project, after: Project) -> None:
        if before.sources.scan != after.sources.scan:
            self.scrub.forget()
        self.thumbnails.follow()
        self.work.follow()
        self.check.follow()
        self.artefacts.follow()
        self._follow_frames()

    def _leave(self) -> None:
        """The project is about to be left: what is recorded now is measured another time."""
        self._leaving = True

    def _results_changed(self) -> None:
        self.work.follow()
        self.check.follow()
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
        return {
            WhyNot.NOTHING: "",
            WhyNot.MEASURING: tr("The scan is being measured; wait for it, or cancel it."),
            WhyNot.NO_BOARDS: tr(words.NO_LIVE_SCAN),
            WhyNot.NO_CAMERA: tr("Accept a camera calibration first."),
            WhyNot.CHECK_LIVE: tr("Pictures of the check are being taken."),
            WhyNot.READING_CALIBRATIONS: tr("The calibrations are being read."),
        }[disabled_reasons(self._facts()).record]

    def _cannot_take(self) -> str:
        """Why no pictures of a check can be taken now, or ""."""
        return {
            WhyNot.NOTHING: "",
            WhyNot.NOT_CALIBRATED: tr("Accept camera and laser planes first: they are what is checked."),
            WhyNot.LIVE: tr("Stop the recording first."),
            WhyNot.READING_CALIBRATIONS: tr("The calibrations are being read."),
        }[disabled_reasons(self._facts()).take_check]

    def _check_taken(self, ended: LiveEnded) -> None:
        """The pictures are the check's by now: check."""
        if ended.recorded and self.check.folder == ended.folder and not self._leaving:
            self.check.start()

    def _live_started(self) -> None:
        self._leaving, self._seen = False, None
        self._set_live_stage("")

    def _live_view(self, view: LiveView) -> None:
        if isinstance(view.detail, ScanDetail):
            had_enough = self._seen is not None and is_enough(self._seen)
            self._seen = view.detail
            if is_enough(view.detail) and not had_enough:
                self.live.beep()
            self._set_live_stage(view.detail.stage)

    def _set_live_stage(self, stage: str) -> None:
        if stage != self.live_stage:
            self.live_stage = stage
            self.changed.emit()

    def _live_ended(self, ended: LiveEnded) -> None:
        """The recording is the source by now: measure it, if that can be done."""
        self.live_stage, self._seen = "", None
        if not ended.recorded or self.folder != ended.folder or self._leaving:
            return
        if self.calibrated:
            self.run.start(by_itself=True)
        else:
            self.bench.notices.info(tr("The scan is recorded. It can be measured once its calibrations are accepted."))
