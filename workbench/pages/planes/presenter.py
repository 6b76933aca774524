"""Decisions of the laser planes page: pictures, plate, which poses count, the fan's constraint, accept or reject."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
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
from workbench.pages.planes_stage import Stage, missing, stage_of, why_not_accept, why_not_measure, why_not_reject
from workbench.pages.planes_work import PlanesWork
from workbench.pages.presenter import StepPresenter
from workbench.pages.sources import folder_of, put_source
from workbench.pages.target_choice import TargetChoice

PART = "planes/"

PAIRS = "live/planes/pairs"
"""The setting whether poses are taken with the laser on and off."""


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
        return stage_of(self)

    @property
    def candidate(self) -> str:
        """The id of the calibration that is shown, or ""."""
        return fan_id(self.work.calibration.fan) if self.work.calibration is not None else ""

    def blocker(self) -> str:
        return missing(self)

    def busy(self) -> str:
        return self.live.busy()

    @property
    def can_measure(self) -> str:
        """Why the pictures cannot be measured now, or ""."""
        return why_not_measure(self)

    @property
    def can_accept(self) -> str:
        """Why nothing can be accepted now, or ""."""
        return why_not_accept(self)

    @property
    def can_reject(self) -> str:
        """Why nothing can be rejected now, or ""."""
        return why_not_reject(self)

    # ---- pictures, plate, laser

    @property
    def folder(self) -> Path | None:
        """The folder of the pictures."""
        return folder_of(self.model, "planes")

    def use_folder(self, folder: Path) -> None:
        """Take the pictures of a folder, and measure them."""
        self.live.stop()
        put_source(self.model, "planes", folder, self.tr("choose the laser planes' pictures"))
        self.work.search()

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
            self.work.search()

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
        if self.work.searching:
            return self.tr("The pictures are being measured; wait for it, or cancel it.")
        if self.seen_by.reading:
            return self.tr("The camera calibration is being read.")
        return ""

    def _live_taken(self, taken: LiveTaken) -> None:
        self.live_views.append((taken.name, taken.thumbnail))

    def _live_ended(self, ended: LiveEnded) -> None:
        if ended.recorded and self.folder == ended.folder:
            self.work.search()

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
