"""Decisions of the camera page: pictures, target, which views count, accept or reject."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from PySide6.QtCore import Signal

from core.calibrate.results import LEFT_OUT, ViewQuality
from core.files.camera_file import camera_id
from core.files.project import Project
from core.image.target_view import TargetView
from core.live.events import LiveEnded, LiveTaken
from core.model.arrays import Array
from workbench import jobs
from workbench.bench import Bench
from workbench.pages.acceptance import Acceptance
from workbench.pages.camera_history import CameraHistory
from workbench.pages.camera_stage import Stage, missing, stage_of, why_not_accept, why_not_reject, why_not_search
from workbench.pages.camera_work import CameraWork
from workbench.pages.live_presenter import LivePresenter
from workbench.pages.presenter import StepPresenter
from workbench.pages.sources import folder_of, put_source
from workbench.pages.target_choice import TargetChoice

PART = "camera/"


class CameraPresenter(StepPresenter):
    """The camera: its pictures found, solved and judged; what is accepted."""

    step = "camera"

    picture_ready = Signal(str, object)
    """Name of a view and its picture."""

    def __init__(self, bench: Bench) -> None:
        super().__init__(bench)
        self.live = LivePresenter(bench, "camera", self)
        self.work = CameraWork(bench, self)
        self.history = CameraHistory(bench, self)
        self.target = TargetChoice(bench, "camera_target", self.tr("change the camera's target"), self)
        self.acceptance = Acceptance(bench, "camera", jobs.ACCEPT_CAMERA, self)
        self.current = ""
        self.threshold: float | None = None
        self._read = ""
        self.live_views: list[tuple[str, Any]] = []
        self.live.there = self._views_that_count
        self.live.changed.connect(self.changed)
        self.live.started.connect(lambda _: self.live_views.clear())
        self.live.taken.connect(self._live_taken)
        self.live.ended.connect(self._live_ended)
        self.work.changed.connect(self._work_changed)
        self.history.changed.connect(self.changed)
        self.acceptance.kept.connect(self.history.refresh)
        self.acceptance.changed.connect(self.changed)

    # ---- state

    @property
    def stage(self) -> Stage:
        """How far the calibration is."""
        return stage_of(self)

    @property
    def candidate(self) -> str:
        """The id of the calibration that is shown, or ""."""
        calibration = self.work.calibration
        return camera_id(calibration.camera) if calibration is not None else ""

    def blocker(self) -> str:
        return missing(self)

    def busy(self) -> str:
        return self.live.busy()

    @property
    def can_search(self) -> str:
        """Why the target cannot be looked for now, or ""."""
        return why_not_search(self)

    @property
    def can_accept(self) -> str:
        """Why nothing can be accepted now, or ""."""
        return why_not_accept(self)

    @property
    def can_reject(self) -> str:
        """Why nothing can be rejected now, or ""."""
        return why_not_reject(self)

    # ---- pictures

    @property
    def folder(self) -> Path | None:
        """The folder of the pictures."""
        return folder_of(self.model, "camera")

    def use_folder(self, folder: Path) -> None:
        """Take the pictures of a folder, and look for the target in them."""
        self.live.stop()
        put_source(self.model, "camera", folder, self.tr("choose the camera's pictures"))
        self.work.search()

    # ---- what is solved for

    def model_values(self) -> dict[str, Any]:
        """Which parameters are free, and what is done with what does not fit."""
        camera = self.project.options.camera
        return {"skew": camera.skew, "k3": camera.k3, "outliers": camera.outliers}

    def set_model(self, field: str, value: Any) -> None:
        """Change one of `model_values`; undoable, and solved again at once."""
        options = self.project.options
        changed: dict[str, Any] = {field: value}
        after = replace(options, camera=replace(options.camera, **changed))
        self.model.edit(self.tr("change the camera model"), replace(self.project, options=after))

    # ---- views

    def views(self) -> tuple[ViewQuality, ...]:
        """The views as the calibration shown judges them."""
        return self.work.calibration.views if self.work.calibration is not None else ()

    def set_used(self, names: Sequence[str], used: bool) -> None:
        """Let views count, or leave them out; undoable. While they are taken live, put them aside."""
        if self.live.running:
            if not used:
                self._put_aside(names)
            return
        excluded = self.project.options.excluded
        after = excluded - set(names) if used else excluded | set(names)
        what = short(names[0]) if len(names) == 1 else self.tr("{0} views").format(len(names))
        label = self.tr("let {0} count") if used else self.tr("leave out {0}")
        self._exclude(after, label.format(what))

    def set_threshold(self, limit: float) -> None:
        """Leave out the views above a limit in px, and let those count that only the last limit left out."""
        before, self.threshold = self.threshold, limit
        judged = {view.view.name: view.rms_px for view in self.views() if view.used or view.reason == LEFT_OUT}
        above = {name for name, rms in judged.items() if rms > limit}
        freed = {name for name, rms in judged.items() if before is not None and before < rms <= limit}
        excluded = (self.project.options.excluded | above) - freed
        self._exclude(excluded, self.tr("leave out views above {0} px").format(f"{limit:.2f}"), "camera threshold")
        self.changed.emit()

    def choose_view(self, name: str) -> None:
        """Show this view."""
        if name != self.current:
            self.current = name
            self._read_picture()
            self.changed.emit()

    def quality_of(self, name: str) -> ViewQuality | None:
        """A view as the calibration shown judges it."""
        return next((view for view in self.views() if view.view.name == name), None)

    def corners_of(self, name: str) -> Array | None:
        """Where the target's corners (N, 2) were found in a view; None if they were not, or nobody has looked."""
        if self.work.seen is None:
            return None
        return next((view.uv for view in self.work.seen.found if view.name == name), None)

    def read_again(self) -> None:
        """The picture of the current view is wanted again."""
        self._read = ""
        self._read_picture()

    # ---- accept and reject

    def accept(self) -> None:
        """Measure with the calibration that is shown, from now on; undoable."""
        if not self.can_accept:
            self.acceptance.accept(self.work.calibration)

    def reject(self) -> None:
        """Do not measure with the calibration that is shown; undoable."""
        if not self.can_reject:
            self.acceptance.reject(self.candidate)

    # ---- keys

    def do_run(self) -> None:
        if not self.can_search:
            self.work.search()

    def do_accept(self) -> None:
        self.accept()

    def do_live(self) -> None:
        self.live.toggle()

    def do_capture(self) -> None:
        self.live.capture()

    # ---- what happens elsewhere

    def opened(self) -> None:
        self.current, self.threshold, self._read = "", None, ""
        self.acceptance.forget()
        self.work.opened()
        self.history.forget()
        self.history.refresh()

    def project_changed(self, before: Project, after: Project) -> None:
        if before.sources.camera != after.sources.camera:
            self.current, self.threshold, self._read = "", None, ""
        self.work.follow()

    def stop(self) -> None:
        self.live.finish()

    def _exclude(self, excluded: frozenset[str], label: str, merge_key: str = "") -> None:
        options = replace(self.project.options, excluded=frozenset(excluded))
        self.model.edit(label, replace(self.project, options=options), merge_key)

    def _live_taken(self, taken: LiveTaken) -> None:
        self.live_views.append((f"{PART}{taken.name}", taken.thumbnail))

    def _views_that_count(self) -> tuple[TargetView, ...]:
        """What the target shows in the pictures there are, without those left out by hand."""
        found = self.work.seen.found if self.work.seen is not None else ()
        return tuple(view for view in found if view.name not in self.project.options.excluded)

    def _put_aside(self, names: Sequence[str]) -> None:
        for name in names:
            self.live.discard(short(name))
        self.live_views = [view for view in self.live_views if view[0] not in names]
        self.changed.emit()

    def _live_ended(self, ended: LiveEnded) -> None:
        if ended.recorded and self.folder == ended.folder:
            self.work.search()

    def _work_changed(self) -> None:
        self.history.shown_is(self.work.calibration)
        names = [f"{PART}{path.name}" for path in self.work.pictures or ()]
        if self.current not in names:
            self.current = names[0] if names else ""
        self._read_picture()
        self.changed.emit()

    def _read_picture(self) -> None:
        name, folder = self.current, self.folder
        if not name or folder is None or self._read == name:
            return
        self._read = name
        self.bench.glance(
            jobs.READ_PICTURE,
            folder / short(name),
            self.project.rig.channel,
            label=self.tr("Reading a picture"),
            on_done=lambda picture: self.picture_ready.emit(name, picture) if name == self.current else None,
            offers={},
            replace_waiting=True,
        )


def short(name: str) -> str:
    """The name of a picture within its folder."""
    return name.removeprefix(PART)
