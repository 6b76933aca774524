"""Decisions of the laser planes page: pictures, plate, which poses count, the fan's constraint, accept or reject."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import Any

from core.calibrate.results import PlanePose
from core.files.fan_file import fan_id
from core.files.project import Project
from core.files.project_keys import finished
from core.image.target_view import TargetView
from core.live.events import LiveEnded, LiveTaken
from core.model import Camera, Fan
from workbench import jobs
from workbench.bench import Bench
from workbench.pages.acceptance import Acceptance
from workbench.pages.live_presenter import LivePresenter
from workbench.pages.planes_camera import PlanesCamera
from workbench.pages.planes_history import PlanesHistory
from workbench.pages.planes_look import PlanesLook
from workbench.pages.planes_work import PlanesWork
from workbench.pages.presenter import StepPresenter
from workbench.pages.sources import folder_of, put_source
from workbench.pages.target_choice import TargetChoice
from workbench.step_state import State

PART = "planes/"

PAIRS = "live/planes/pairs"
"""The setting whether poses are taken with the laser on and off."""


class Stage(StrEnum):
    """How far the calibration of the laser planes is."""

    NO_CAMERA = "no camera"
    NONE = "none"
    EMPTY = "empty"
    FOUND = "found"
    LIVE = "live"
    MEASURING = "measuring"
    SOLVING = "solving"
    FAILED = "failed"
    SOLVED = "solved"
    REJECTED = "rejected"
    ACCEPTED = "accepted"
    OTHER = "other"
    OUTDATED = "outdated"


class PlanesPresenter(StepPresenter):
    """The fan: poses measured, planes solved and judged; what is accepted."""

    step = "planes"

    def __init__(self, bench: Bench) -> None:
        super().__init__(bench)
        self.live = LivePresenter(bench, "planes", self)
        self.live.pairs = bench.settings.text(PAIRS, "yes") == "yes"
        self.work = PlanesWork(bench, self)
        self.look, self.seen_by = PlanesLook(bench, self.work, self), PlanesCamera(bench, self)
        self.history = PlanesHistory(bench, self)
        self.target = TargetChoice(bench, "plane_target", self.tr("change the plate"), self)
        self.acceptance = Acceptance(bench, "planes", jobs.ACCEPT_FAN, self)
        self.live_views: list[tuple[str, Any]] = []
        self.live.calibration = self._known
        self.live.there = self._views_that_count
        self.live.cannot_start = self._cannot_record
        self.live.changed.connect(self.changed)
        self.live.started.connect(lambda _: self.live_views.clear())
        self.live.taken.connect(self._live_taken)
        self.live.ended.connect(self._live_ended)
        self.work.changed.connect(self._work_changed)
        self.history.changed.connect(self.changed)
        self.acceptance.kept.connect(self.history.refresh)
        self.acceptance.changed.connect(self.changed)
        self.seen_by.changed.connect(self.changed)

    # ---- state

    @property
    def stage(self) -> Stage:
        """How far the calibration is."""
        work, accepted = self.work, self.project.accepted.fan
        if self.live.running:
            return Stage.LIVE
        if work.measuring:
            return Stage.MEASURING
        if work.poses is not None and work.solving:
            return Stage.SOLVING
        done = self.state.state is State.DONE
        if accepted and self.candidate in ("", accepted):
            return Stage.ACCEPTED if done else Stage.OUTDATED
        if self.candidate:
            if accepted and done:
                return Stage.OTHER
            return Stage.REJECTED if self.acceptance.is_rejected(self.candidate) else Stage.SOLVED
        if not self.project.accepted.camera:
            return Stage.NO_CAMERA
        if work.problem:
            return Stage.FAILED
        if not self.project.sources.planes:
            return Stage.NONE
        return Stage.EMPTY if work.pictures == () else Stage.FOUND

    @property
    def candidate(self) -> str:
        """The id of the calibration that is shown, or ""."""
        return fan_id(self.work.calibration.fan) if self.work.calibration is not None else ""

    def blocker(self) -> str:
        return {
            Stage.NO_CAMERA: self.tr("Accept a camera calibration first."),
            Stage.NONE: self.tr("Record or choose pictures of the plate under the laser first."),
            Stage.EMPTY: self.tr("Choose a folder that holds pictures of the plate under the laser."),
            Stage.FOUND: self.tr("Calibrate the laser planes from their pictures first."),
            Stage.LIVE: self.tr("Stop the live source when there are enough poses."),
            Stage.MEASURING: self.tr("The pictures are being measured."),
            Stage.SOLVING: self.tr("The laser planes are being solved."),
            Stage.FAILED: self.tr("The laser planes could not be calibrated; record more poses or check the plate."),
            Stage.SOLVED: self.tr("Accept the laser planes first."),
            Stage.REJECTED: self.tr("The laser planes were rejected; accept better ones first."),
            Stage.ACCEPTED: "",
            Stage.OTHER: "",
            Stage.OUTDATED: self.state.sentence
            if self.candidate
            else self.tr("The accepted laser planes are out of date; calibrate again."),
        }[self.stage]

    def busy(self) -> str:
        return self.live.busy()

    @property
    def can_measure(self) -> str:
        """Why the pictures cannot be measured now, or ""."""
        if self.live.running:
            return self.tr("Stop the live source first.")
        if not self.project.accepted.camera:
            return self.tr("Accept a camera calibration first.")
        if not self.project.sources.planes:
            return self.tr("Choose or record pictures first.")
        if self.work.measuring:
            return self.tr("The pictures are being measured.")
        return ""

    @property
    def can_accept(self) -> str:
        """Why nothing can be accepted now, or ""."""
        if self.live.running:
            return self.tr("Stop the live source first.")
        if self.work.calibration is None or self.work.solving or self.acceptance.keeping:
            return self.tr("There is no calibration yet.")
        if self.candidate == self.project.accepted.fan and self.state.state is State.DONE:
            return self.tr("These laser planes are accepted already.")
        return ""

    @property
    def can_reject(self) -> str:
        """Why nothing can be rejected now, or ""."""
        if self.live.running:
            return self.tr("Stop the live source first.")
        if not self.candidate or self.work.solving:
            return self.tr("There is no calibration yet.")
        if self.acceptance.is_rejected(self.candidate) and self.candidate != self.project.accepted.fan:
            return self.tr("This calibration is rejected already.")
        return ""

    # ---- pictures, plate, laser

    @property
    def folder(self) -> Path | None:
        """The folder of the pictures."""
        return folder_of(self.model, "planes")

    def use_folder(self, folder: Path) -> None:
        """Take the pictures of a folder, and measure them."""
        self.live.stop()
        put_source(self.model, "planes", folder, self.tr("choose the laser planes' pictures"))
        self.work.measure()

    def set_laser(self, field: str, value: Any) -> None:
        """Change "lines", "angle" (rad; None where nobody states it) or "constrain"; undoable."""
        project = self.project
        if field == "constrain":
            after = replace(project, options=replace(project.options, constrain_fan=bool(value)))
        else:
            changes: dict[str, Any] = {field: value or 0.0}
            after = replace(project, rig=replace(project.rig, **changes))
        self.model.edit(self.tr("change the laser"), after, f"laser {field}")

    def set_pairs(self, on: bool) -> None:
        """Whether each pose is also taken with the laser off; remembered by the program, as the rig stays the same."""
        self.live.pairs = on
        self.bench.settings.keep_text(PAIRS, "yes" if on else "no")
        self.changed.emit()

    # ---- poses

    @property
    def current(self) -> str:
        """The pose that is looked at."""
        return self.look.current

    def poses(self) -> tuple[PlanePose, ...]:
        """The poses as the calibration shown judges them."""
        return self.work.calibration.poses if self.work.calibration is not None else ()

    def set_used(self, names: Sequence[str], used: bool) -> None:
        """Let poses count, or leave them out; undoable. While they are taken live, put them aside."""
        if self.live.running:
            if not used:
                for name in names:
                    self.live.discard(name)
                self.live_views = [view for view in self.live_views if view[0] not in names]
                self.changed.emit()
            return
        stored = {PART + name for name in names}
        excluded = self.project.options.excluded
        after = excluded - stored if used else excluded | stored
        what = names[0] if len(names) == 1 else self.tr("{0} poses").format(len(names))
        label = self.tr("let {0} count") if used else self.tr("leave out {0}")
        options = replace(self.project.options, excluded=frozenset(after))
        self.model.edit(label.format(what), replace(self.project, options=options))

    def choose_pose(self, name: str) -> None:
        """Show this pose."""
        if name != self.current:
            self.look.current = name
            self.look.refresh()
            self.changed.emit()

    def pose_of(self, name: str) -> PlanePose | None:
        """A pose as the calibration shown judges it."""
        return next((pose for pose in self.poses() if pose.name == name), None)

    # ---- accept and reject

    def accept(self) -> None:
        """Measure with the planes that are shown, from now on; undoable."""
        if not self.can_accept:
            self.acceptance.accept(self.work.calibration, self.work.poses)

    def reject(self) -> None:
        """Do not measure with the planes that are shown; undoable."""
        if not self.can_reject:
            self.acceptance.reject(self.candidate)

    # ---- keys

    def do_run(self) -> None:
        if not self.can_measure:
            self.work.measure()

    def do_accept(self) -> None:
        self.accept()

    def do_live(self) -> None:
        self.live.toggle()

    def do_capture(self) -> None:
        self.live.capture()

    # ---- what happens elsewhere

    def opened(self) -> None:
        self.look.forget()
        self.acceptance.forget()
        self.seen_by.forget()
        self.seen_by.follow()
        self.work.opened()
        self.history.forget()
        self.history.refresh()

    def project_changed(self, before: Project, after: Project) -> None:
        if before.sources.planes != after.sources.planes:
            self.look.forget()
        self.seen_by.follow()
        self.work.follow()

    def stop(self) -> None:
        self.live.finish()

    def _known(self) -> tuple[Camera | None, Fan | None]:
        return self.seen_by.camera, self.work.calibration.fan if self.work.calibration is not None else None

    def _views_that_count(self) -> tuple[TargetView, ...]:
        """What the plate shows in the pictures there are, without those left out by hand."""
        excluded = self.project.options.excluded
        counting = (pose.view for pose in self.work.poses or () if PART + pose.name not in excluded)
        return tuple(view for view in counting if view is not None)

    def _cannot_record(self) -> str:
        """Why no poses can be taken now, or ""."""
        if self.work.measuring:
            return self.tr("The pictures are being measured; wait for it, or cancel it.")
        if self.seen_by.reading:
            return self.tr("The camera calibration is being read.")
        return ""

    def _live_taken(self, taken: LiveTaken) -> None:
        self.live_views.append((taken.name, taken.thumbnail))

    def _live_ended(self, ended: LiveEnded) -> None:
        if ended.recorded and self.folder == ended.folder:
            self.work.measure()

    def _work_changed(self) -> None:
        self.look.follow()
        self._recognise()
        self.changed.emit()

    def _recognise(self) -> None:
        """Where pictures and settings give just what is accepted, it is not out of date, whatever was changed since."""
        done = self.model.results.get("planes")
        if done is None or not self.candidate or self.work.solving or self.candidate != self.project.accepted.fan:
            return
        now = finished("planes", self.project, self.model.results, done.at)
        if now.rests_on != done.rests_on:
            self.model.record("planes", now)
