"""Decisions of the laser planes page: pictures, plate, which poses count, the fan's constraint, accept or reject."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from core.calibrate.fan.poses.pose_features import usual_stripe
from core.calibrate.results import PlanePose
from core.errors import InputError
from core.files.project.data import Project
from core.files.project.keys import finished
from core.files.results.planes_file import planes_id
from core.image.stripes.stripe import StripeSettings
from core.image.targets.target_view import TargetView
from core.messages import Message
from core.model import Camera, Fan
from core.states import OUT_OF_DATE
from workbench.bench import Bench
from workbench.language import tr
from workbench.pages.calibration.history import PlanesHistory
from workbench.pages.calibration.presenter import CalibrationPresenter
from workbench.pages.calibration.stage import Stage
from workbench.pages.calibration.target import TargetChoice
from workbench.pages.planes.current_pose import CurrentPose
from workbench.pages.planes.work import PlanesCamera, PlanesWork
from workbench.pages.settings import changed_options, values_of
from workbench.work import jobs

PAIRS = "live/planes/pairs"
"""The setting whether poses are taken with the laser on and off."""


class PlanesPresenter(CalibrationPresenter):
    """Presenter of the fan: poses measured, planes solved and judged, and what is accepted."""

    step = "planes"
    KEEP = jobs.ACCEPT_PLANES
    work: PlanesWork
    look: CurrentPose
    history: PlanesHistory

    def __init__(self, bench: Bench) -> None:
        super().__init__(bench)
        self.decide: Callable[[Message], bool] = lambda _: False
        """Ask whether planes that only a minority of the poses agrees on are to be used; the page's question."""
        self.live.pairs = bench.settings.text(PAIRS, "yes") == "yes"
        self.work = PlanesWork(bench, self)
        self.look = CurrentPose(bench, self.work, tr("Reading a pose"), self)
        self.seen_by = PlanesCamera(bench, self)
        self.history = PlanesHistory(bench, self.acceptance, self.live, self)
        self.target = TargetChoice(bench, "plane_target", tr("change the plate"), self)
        self.live.calibration = self._known
        self.live.cannot_start = self._cannot_record
        self._connect()
        self.seen_by.changed.connect(self.changed)

    # ---- state

    @property
    def candidate(self) -> str:
        """Id of the calibration of the light planes that is shown; "" for none."""
        return planes_id(self.work.calibration.fan) if self.work.calibration is not None else ""

    def _is_current(self) -> bool:
        return self.is_done and not self._tells_too_little

    @property
    def _tells_too_little(self) -> bool:
        """Whether the accepted planes are those shown, and their file, of an earlier version, knows less of them."""
        entries = self.history.entries if self.candidate == self.acceptance.accepted else ()
        return any(entry.id == self.candidate and not entry.facts_known for entry in entries)

    def _missing(self) -> dict[Stage, str]:
        outdated = tr(OUT_OF_DATE["planes"])
        if self._tells_too_little:
            outdated = tr("The file of these laser planes, of an earlier version, tells too little; accept them again.")
        elif self.candidate:
            outdated = self.state.sentence
        return {
            Stage.NO_CAMERA: tr("Accept a camera calibration first."),
            Stage.NONE: tr("Record or choose pictures of the plate under the laser first."),
            Stage.EMPTY: tr("Choose a folder that holds pictures of the plate under the laser."),
            Stage.FOUND: tr("Calibrate the laser planes from their pictures first."),
            Stage.LIVE: tr("Stop the live source when there are enough poses."),
            Stage.SEARCHING: tr("The pictures are being measured."),
            Stage.SOLVING: tr("The laser planes are being solved."),
            Stage.FAILED: tr("The laser planes could not be calibrated; record more poses or check the plate."),
            Stage.SOLVED: tr("Accept the laser planes first."),
            Stage.REJECTED: tr("The laser planes were rejected; accept better ones first."),
            Stage.OUTDATED: outdated,
        }

    def _accepted_already(self) -> str:
        return tr("These laser planes are accepted already.")

    def _names(self, count: int) -> str:
        return tr("{count} poses", count=count)

    def _source_label(self) -> str:
        return tr("choose the laser planes' pictures")

    def _made(self) -> tuple[Any, ...]:
        return self.work.calibration, self.work.poses, self._minority() is not None

    def _minority(self) -> Message | None:
        """What is to be decided before the planes that are shown can be accepted."""
        if self.work.calibration is None or self.project.options.accept_few_poses:
            return None
        return self.work.calibration.minority

    def accept(self) -> None:
        """Accept the light planes that are shown, asking first if only a minority of poses was used; undoable."""
        minority = None if self.cannot_accept else self._minority()
        if minority is None or self.decide(minority):
            super().accept()

    # ---- laser

    def set_laser(self, field: str, value: Any) -> None:
        """Change "lines", "angle" in rad (None: not stated), "channel" ("": found) or an option; undoable.

        What cannot be is refused with a sentence.
        """
        project = self.project
        if field in self.option_values():
            try:
                options = changed_options("planes", project.options, self._found_stripe(), field, value)
            except (InputError, ValueError) as error:
                self.bench.notices.failed(error)
                self.changed.emit()
                return
            after = replace(project, options=options)
        elif field == "channel":
            after = replace(project, rig=project.rig.with_channel("planes", value or None))
        else:
            changes: dict[str, Any] = {field: value or 0.0}
            after = replace(project, rig=replace(project.rig, **changes))
        self.model.edit(tr("change the laser"), after, f"laser {field}")

    def option_values(self) -> dict[str, Any]:
        """Return the options of calibrating the planes; width and contrast of stripes as set, or as measured."""
        return values_of("planes", self.project.options, self._found_stripe())

    def _found_stripe(self) -> StripeSettings | None:
        return usual_stripe(self.work.poses or ())

    def set_pairs(self, on: bool) -> None:
        """Set whether each pose is also taken with the laser off; remembered by the program."""
        self.live.pairs = on
        self.bench.settings.keep_text(PAIRS, "yes" if on else "no")
        self.changed.emit()

    # ---- poses

    def views(self) -> tuple[PlanePose, ...]:
        """List the poses with the quality that the calibration shown gives them."""
        return self.work.calibration.poses if self.work.calibration is not None else ()

    # ---- what happens elsewhere

    def opened(self) -> None:
        self.seen_by.forget()
        self.seen_by.follow()
        super().opened()

    def project_changed(self, before: Project, after: Project) -> None:
        self.seen_by.follow()
        super().project_changed(before, after)

    def _known(self) -> tuple[Camera | None, Fan | None]:
        return self.seen_by.camera, self.work.calibration.fan if self.work.calibration is not None else None

    def views_that_count(self) -> tuple[TargetView, ...]:
        """List the views of the plane target in the pictures, without poses left out by hand."""
        excluded = self.project.options.excluded
        counting = (pose.view for pose in self.work.poses or () if self.stored(pose.name) not in excluded)
        return tuple(view for view in counting if view is not None)

    def _cannot_record(self) -> str:
        """Why no poses can be taken now, or ""."""
        if not self.is_needed:
            return self.state.sentence
        if self.work.searching:
            return tr("The pictures are being measured; wait for it, or cancel it.")
        if self.seen_by.reading:
            return tr("The camera calibration is being read.")
        return ""

    def _work_changed(self) -> None:
        self._recognise()
        super()._work_changed()

    def _recognise(self) -> None:
        """Where pictures and settings give just what is accepted, it is not out of date, whatever was changed since."""
        done = self.model.results.get("planes")
        if done is None or not self.candidate or self.work.solving or self.candidate != self.project.accepted.planes:
            return
        now = finished("planes", self.project, self.model.results, done.at)
        if now.rests_on != done.rests_on:
            self.model.record("planes", now)
