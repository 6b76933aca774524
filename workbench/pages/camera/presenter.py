"""Decisions of the camera page: pictures, target, which views count, accept or reject."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from core.calibrate.results import ViewQuality
from core.files.project.data import Project
from core.files.results.camera_file import camera_id
from core.image.exclusion import Exclusion
from core.image.targets.target_view import TargetView
from core.model.arrays import Array
from core.pipeline.live.events import CameraDetail, LiveView
from core.states import OUT_OF_DATE
from workbench.bench import Bench
from workbench.language import tr
from workbench.pages.calibration.current_picture import CurrentPicture
from workbench.pages.calibration.history import CameraHistory
from workbench.pages.calibration.presenter import CalibrationPresenter
from workbench.pages.calibration.stage import Stage
from workbench.pages.calibration.target import TargetChoice
from workbench.pages.camera.work import CameraWork
from workbench.pages.settings import changed_options, values_of
from workbench.work import jobs


class CameraPresenter(CalibrationPresenter):
    """Presenter of the camera: its pictures found, solved and judged, and what is accepted."""

    step = "camera"
    KEEP = jobs.ACCEPT_CAMERA
    work: CameraWork
    history: CameraHistory

    def __init__(self, bench: Bench) -> None:
        super().__init__(bench)
        self.work = CameraWork(bench, self)
        self.look = CurrentPicture(bench, self.work, tr("Reading a picture"), self)
        self.history = CameraHistory(bench, self.acceptance, self.live, self)
        self.target = TargetChoice(bench, "camera_target", tr("change the camera's target"), self)
        self.threshold: float | None = None
        self._counted: tuple[int, int] | None = None
        """What the live picture shows in place of the board that was entered."""
        self._lacking = False
        """Whether something was missing in the recording that runs, when it was last seen."""
        self.live.view.connect(self._live_view)
        self._connect()

    # ---- state

    @property
    def candidate(self) -> str:
        """Id of the camera calibration that is shown; "" for none."""
        calibration = self.work.calibration
        return camera_id(calibration.camera) if calibration is not None else ""

    def _is_current(self) -> bool:
        return self.candidate == self.acceptance.accepted or self.is_done

    def _missing(self) -> dict[Stage, str]:
        return {
            Stage.NONE: tr("Record or choose pictures of the camera's target first."),
            Stage.EMPTY: tr("Choose a folder that holds pictures of the camera's target."),
            Stage.FOUND: tr("Calibrate the camera from its pictures first."),
            Stage.LIVE: tr("Stop the live source when there are enough views."),
            Stage.SEARCHING: tr("The pictures are being searched for the target."),
            Stage.SOLVING: tr("The camera is being solved."),
            Stage.FAILED: tr("The camera could not be calibrated; record more views or check the target."),
            Stage.SOLVED: tr("Accept a camera calibration first."),
            Stage.REJECTED: tr("The calibration was rejected; accept a better one first."),
            Stage.OUTDATED: tr(OUT_OF_DATE["camera"]),
        }

    def _accepted_already(self) -> str:
        return tr("This calibration is accepted already.")

    def _names(self, count: int) -> str:
        return tr("{count} views", count=count)

    def _source_label(self) -> str:
        return tr("choose the camera's pictures")

    def _made(self) -> tuple[Any, ...]:
        return (self.work.calibration,)

    # ---- the board, counted wrongly

    @property
    def counted(self) -> tuple[int, int] | None:
        """Columns and rows of the board seen in the pictures if they differ from the target entered; else None."""
        return self._counted if self.live.running else self.work.counted

    def take_counted(self) -> None:
        """Set the target's columns and rows to those counted in the pictures, and search again; undoable."""
        counted = self.counted
        if counted is not None:
            self.target.take_counted(*counted)
            self.do_run()

    # ---- what is solved for

    def model_values(self) -> dict[str, Any]:
        """Return the fields of the form: which camera parameters are free, and how outliers are treated."""
        return values_of("camera", self.project.options)

    def set_model(self, field: str, value: Any) -> None:
        """Change one field of `model_values` and solve the camera again; undoable."""
        after = changed_options("camera", self.project.options, None, field, value)
        self.model.edit(tr("change the camera model"), replace(self.project, options=after))

    # ---- views

    def views(self) -> tuple[ViewQuality, ...]:
        """List the views of the camera calibration shown, with the quality of each."""
        return self.work.calibration.views if self.work.calibration is not None else ()

    def set_threshold(self, limit: float) -> None:
        """Leave out views with an RMS above `limit` in px; use again those that the threshold before left out."""
        before, self.threshold = self.threshold, limit
        judged = {one.name: one.rms_px for one in self.views() if one.used or one.exclusion is Exclusion.BY_HAND}
        above = {name for name, rms in judged.items() if rms > limit}
        freed = {name for name, rms in judged.items() if before is not None and before < rms <= limit}
        excluded = (self.project.options.excluded | above) - freed
        self._exclude(excluded, tr("leave out views above {limit:.2f} px", limit=limit), "camera threshold")
        self.changed.emit()

    def corners_of(self, name: str) -> Array | None:
        """Return the target's corners (N, 2) in px found in a view; None if it was not searched or has none."""
        if self.work.seen is None:
            return None
        return next((view.uv for view in self.work.seen.found if view.name == name), None)

    # ---- what happens elsewhere

    def opened(self) -> None:
        self.threshold = None
        super().opened()

    def project_changed(self, before: Project, after: Project) -> None:
        if before.sources.camera != after.sources.camera:
            self.threshold = None
        if before.rig.camera_target != after.rig.camera_target:
            self._counted = None
            self.live.look_for(after.rig.camera_target)
        super().project_changed(before, after)

    def views_that_count(self) -> tuple[TargetView, ...]:
        """List the targets found in the pictures, without pictures left out by hand."""
        found = self.work.seen.found if self.work.seen is not None else ()
        return tuple(view for view in found if view.name not in self.project.options.excluded)

    def _live_started(self) -> None:
        super()._live_started()
        self._counted, self._lacking = None, False

    def _live_view(self, view: LiveView) -> None:
        """Note what is counted in place of the board entered, and stop once nothing is missing any more."""
        detail = view.detail
        if not isinstance(detail, CameraDetail) or not self.live.live:
            return
        counted = detail.counted or (self._counted if detail.uv is None else None)
        if counted != self._counted:
            self._counted = counted
            self.changed.emit()
        if self._lacking and not detail.missing and self.live.auto:
            self.live.beep()
            self.bench.notices.info(
                tr("Nothing is missing: the live source was stopped, and the camera is calibrated.")
            )
            self.live.stop()
        self._lacking = bool(detail.missing)

    def _work_changed(self) -> None:
        self.history.shown_is(self.work.calibration)
        super()._work_changed()
