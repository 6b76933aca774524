"""Decisions of the inspect page: which scan is shown, when its thickness is measured, what may come next."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PySide6.QtCore import Signal

from core.errors import InputError
from core.files.project.data import Project
from core.files.project.folder import source_folder
from core.files.project.keys import finished
from core.files.project.view_file import drop_view, write_view
from core.inspect.result_list import ResultList
from core.inspect.shown.seen_from import SeenFrom
from core.inspect.shown.view_frame import ViewFrame, part_frame, shown_frame
from workbench.bench import Bench
from workbench.language import text_of, tr
from workbench.pages.inspect.clicked import InspectClicked, Target
from workbench.pages.inspect.clicked import Mode as ClickMode
from workbench.pages.inspect.cut import InspectCut
from workbench.pages.inspect.drawn import InspectDrawn
from workbench.pages.inspect.faces import FACES, InspectFaces
from workbench.pages.inspect.features.conditions import InspectConditions
from workbench.pages.inspect.features.edit import LINE, InspectFeatureEdit
from workbench.pages.inspect.features.plan import InspectFeatures
from workbench.pages.inspect.features.templates import InspectTemplates
from workbench.pages.inspect.part import InspectPart
from workbench.pages.inspect.picks import InspectPicks, Mode
from workbench.pages.inspect.repeats.repeats import InspectRepeats
from workbench.pages.inspect.scan import InspectScan
from workbench.pages.inspect.stage import Facts, Stage, WhyNot, stage_of, why_not_measure
from workbench.pages.presenter import StepPresenter
from workbench.step_state import State
from workbench.wing import inspect_layers
from workbench.work import jobs
from workbench.work.tasks import Task

RELIEF = "relief"
"""The name of the picture that is made of the surface itself."""

MOST_POINTS_SENT = 100_000
"""So many of the chosen points are enough for an outline."""


class InspectPresenter(StepPresenter):
    """Presenter of the scan among the results, its thickness, and everything one does with the two."""

    step = "inspect"

    measured = Signal()
    """The thickness was measured on this page, and is shown now."""

    picture_ready = Signal(str, object)
    """Name of a recorded picture, and the picture."""

    def __init__(self, bench: Bench) -> None:
        super().__init__(bench)
        self.scan = InspectScan(bench)
        self.clip_mm: float | None = None
        self.picture = RELIEF
        self.seen_from: Callable[[], SeenFrom | None] = lambda: None
        """Asked for the view in 3D when the page is left; None: the surface is seen as at first."""
        self.is_put_back: Callable[[], bool] = lambda: False
        """Asked then as well: whether it was seen from elsewhere before."""
        self.outlining = ""
        self._measuring: Task | None = None
        self._unmeasurable = ""
        self._seen = self._just_measured = False
        self.faces, self.picks = InspectFaces(self.model, self.scan), InspectPicks(self.scan)
        self.part = InspectPart(self.model)
        self.repeats = InspectRepeats(bench, self.scan, self.faces)
        self.features = InspectFeatures(bench, self.scan)
        self.feature = InspectFeatureEdit(self.features, self.scan)
        self.clicked = InspectClicked(self.features, self.scan)
        self.cut = InspectCut(self.features, self.scan, lambda: self.frame)
        self.drawn = InspectDrawn(
            self.faces,
            self.features,
            self.feature,
            lambda: self.scan.gauge is not None and not self.scan.is_thickness_old,
        )
        self.conditions, self.templates = InspectConditions(self.features), InspectTemplates(self.features)
        for part in (self.faces, self.picks, self.repeats, self.features, self.clicked):
            part.changed.connect(self.changed)
        self.layers = inspect_layers(bench, self)
        for layer in self.layers.values():
            layer.connect(self.changed)
        self.scan.changed.connect(self._scan_changed)
        self.model.results_changed.connect(self._look_at_scan)
        bench.settings.part_frame_changed.connect(self.changed)

    def _look_at_scan(self) -> None:
        self.scan.look(seen=self._seen)

    # ---- state

    @property
    def stage(self) -> Stage:
        """How far the measurement of the thickness is: no scan, measuring, measured, …."""
        return stage_of(self._facts())

    def _facts(self) -> Facts:
        scan = self.scan
        return Facts(
            scan="scan" in self.model.results,
            shown=scan.view is not None,
            unreadable=bool(scan.problem),
            stale=scan.stale,
            measuring=self._measuring is not None,
            failed=bool(self._unmeasurable),
            thickness=scan.gauge is not None,
            outdated=self.state.state is not State.DONE,
            face_missing=bool(self.faces.missing()),
            read_only=self.model.is_read_only,
        )

    def blocker(self) -> str:
        return tr("Scan the part first.") if "scan" not in self.model.results else ""

    def warning(self) -> str:
        """Return a sentence on what the report will lack if the user goes on now; "" if nothing."""
        return {
            Stage.UNMEASURED: tr("Measure the thickness, or go on without one: then the report has none."),
            Stage.FAILED: tr("Without a thickness the report shows the surface only."),
            Stage.OUTDATED: tr("Measure the scan again first, on the page before.")
            if self.scan.is_old
            else tr("Measure again, or the report prints the thickness as it was."),
        }.get(self.stage, "")

    @property
    def problem_of_measuring(self) -> str:
        """Reason why the last measurement gave no thickness; "" if it gave one."""
        return self._unmeasurable

    @property
    def cannot_measure(self) -> str:
        """Reason why the thickness cannot be measured now; "" if it can."""
        return {
            WhyNot.NOTHING: "",
            WhyNot.NO_SCAN: tr("Scan the part first."),
            WhyNot.UNREADABLE: tr("The scan cannot be read."),
            WhyNot.READ_ONLY: self.bench.cannot_write,
            WhyNot.MEASURING: tr("The thickness is being measured."),
            WhyNot.FACE_MISSING: self.faces.missing(),
        }[why_not_measure(self._facts())]

    # ---- measuring

    def do_run(self) -> None:
        """Measure the thickness on the scan in the project's results, in the background."""
        folder, project = self.model.folder, self.project
        if folder is None or self.cannot_measure:
            return
        self._unmeasurable = ""

        def done(_: Any) -> None:
            if folder == self.model.folder:
                self._just_measured = True
                self.model.record("gauge", finished("gauge", project, self.model.results))

        def failed(problem: Any) -> None:
            if folder == self.model.folder:
                self._unmeasurable = text_of(problem)

        self._measuring = self.bench.run_long(
            self,
            jobs.MEASURE_GAUGE,
            folder,
            self.scan.as_scanned(),
            label=tr("Measuring the thickness"),
            on_done=done,
            on_failed=failed,
        )
        self._measuring.ended.connect(self._measured)
        self.changed.emit()

    def _measured(self) -> None:
        self._measuring = None
        self.changed.emit()

    # ---- what is shown

    @property
    def part_frame(self) -> ViewFrame | None:
        """Frame of the part: its part coordinates or its lower face; None if neither is known."""
        gauge = self.scan.gauge
        return part_frame(self.features.pose_camera_part, None if gauge is None else gauge.lower.plane)

    @property
    def frame(self) -> ViewFrame:
        """Frame in which the surface and all coordinates are shown: the part's or the camera's."""
        return shown_frame(self.part_frame, wanted=self.bench.settings.part_frame)

    @property
    def results(self) -> ResultList | None:
        """All results on the part with the verdict; None while the features' results are not known."""
        shown = self.features.shown
        if shown is None:
            return None if "inspection" in self.model.results else ResultList.of(self.scan.gauge)
        rows = [row for feature in shown.features for row in feature.rows]
        return ResultList.of(self.scan.gauge, rows, unmeasured=shown.unmeasured)

    def points_shown(self) -> int:
        """Count the points shown: those with a σ up to the limit that the user has set."""
        if self.scan.view is None:
            return 0
        return len(self.scan.view) if self.clip_mm is None else self.scan.view.up_to(self.clip_mm)

    def triangles_shown(self) -> int:
        """Count the triangles shown: those with a σ up to the limit that the user has set."""
        mesh = self.scan.view.mesh if self.scan.view is not None else None
        if mesh is None:
            return 0
        return len(mesh.triangles) if self.clip_mm is None else mesh.up_to(self.clip_mm)

    def clip(self, sigma_mm: float | None) -> None:
        """Show only points with a σ up to `sigma_mm`; None shows all. No result changes."""
        if sigma_mm != self.clip_mm:
            self.clip_mm = sigma_mm
            self.changed.emit()

    def choose_picture(self, name: str) -> None:
        """Show the picture called `name`: RELIEF, the measured surface, or a recorded picture."""
        if name == self.picture:
            return
        self.picture = name
        self.read_picture()
        self.changed.emit()

    def read_picture(self) -> None:
        """Read the recorded picture that is chosen, in the background; `picture_ready` delivers it."""
        name, folder = self.picture, self.model.folder
        if name == RELIEF or folder is None:
            return
        scans = source_folder(folder, self.scan.recording)
        if scans is None:
            return
        self.bench.run_quick(
            self,
            jobs.READ_PICTURE,
            scans / Path(name).name,
            self.project.rig.channel_of("scan"),
            self.project.rig.mosaic,
            label=tr("Reading a picture"),
            on_done=lambda picture: self.picture_ready.emit(name, picture) if name == self.picture else None,
            on_failed=lambda _: self.choose_picture(RELIEF),
            offers={},
            replace_waiting=True,
        )

    # ---- points and faces clicked in 3D

    def start_picking(self, mode: Mode) -> None:
        """Start picking a point, or the ends of a distance, by clicks in 3D; the mode "" ends it."""
        self.clicked.stop()
        self.picks.start(mode)

    def start_clicking(self, mode: ClickMode, target: Target | None = None) -> None:
        """Start proposing a face by one click in 3D, or a step by two; the mode "" ends it."""
        self.picks.stop()
        self.clicked.start(mode, target)

    def click_region(self, name: str) -> None:
        """Start proposing a face by a click in 3D for the chosen feature's region called `name`."""
        if self.feature.spec is not None:
            self.start_clicking("face", Target(self.feature.spec.name, self.feature.place_of(name)))

    def click(self, point: int) -> None:
        """Handle a click on point number `point`: pick it, or grow a face from it."""
        if self.clicked.mode:
            self.clicked.click(point)
        else:
            self.picks.pick(point)

    def end_picking(self) -> None:
        """End picking points and proposing faces by clicks in 3D."""
        self.picks.stop()
        self.clicked.stop()

    # ---- regions chosen in 3D

    def outline(self, face: str, chosen: NDArray[np.bool_]) -> None:
        """Turn the points marked in `chosen` (N,) into the polygon of a region: the outline of the face among them."""
        folder, view = self.model.folder, self.scan.view
        if folder is None or view is None:
            return
        numbers = view.number[: len(chosen)][chosen]
        if not len(numbers):
            self.bench.notices.warning(tr("There are no points in that region."))
            return
        self.outlining = face
        meant = face if face in FACES else self.feature.selected_face
        feature = "" if face in FACES else self.features.chosen
        self.drawn.begin(feature, face, view.points[: len(chosen)][chosen])

        def done(outline: Any) -> None:
            if feature and feature != self.features.chosen:
                self.bench.notices.warning(tr("Another feature was chosen before the region was there: draw it again."))
            elif view is self.scan.view:
                self.drawn.outlined(feature, face, outline)
                self.set_region(face, outline)

        task = self.bench.run_quick(
            self,
            jobs.OUTLINE_SELECTED,
            folder,
            numbers[:: -(-len(numbers) // MOST_POINTS_SENT)],
            meant,
            label=tr("Outlining the chosen points"),
            on_done=done,
        )
        task.ended.connect(self._outlined)
        self.changed.emit()

    def set_region(self, name: str, corners: ArrayLike) -> None:
        """Set the polygon (n, 2) in px of the region called `name`: of a face, or of the chosen feature."""
        if name in FACES:
            self.faces.set_region(name, corners)
        elif name == LINE:
            self.feature.set_line(corners)
        else:
            self.feature.set_region(self.feature.place_of(name), corners)

    def _outlined(self) -> None:
        self.outlining = ""
        self.drawn.end_outlining()
        self.changed.emit()

    # ---- what happens elsewhere

    def opened(self) -> None:
        self._just_measured = False
        self.faces.forget()
        self.features.forget()
        self.scan.forget()
        self.scan.look(seen=self._seen)

    def entered(self) -> None:
        self._seen = True
        self.scan.look(seen=True)

    def left(self) -> None:
        self._seen = False
        self.end_picking()
        self._keep_view()

    def _keep_view(self) -> None:
        """Keep how the surface was left, which the report shows; it is no edit, and nothing that was measured."""
        view, folder = self.seen_from(), self.model.folder
        if folder is None or self.model.is_read_only or not self.scan.is_of_project:
            return
        try:
            if view is not None:
                write_view(folder, view, self.scan.recording)
            elif self.is_put_back():
                drop_view(folder)
        except InputError as error:
            self.bench.notices.failed(error)

    def project_changed(self, before: Project, after: Project) -> None:
        if before.rig.gauge != after.rig.gauge:
            self._unmeasurable = ""
        self.faces.follow(before.rig.gauge, after.rig.gauge)
        self.features.follow(before.inspection)
        self.clicked.follow()

    def _scan_changed(self) -> None:
        """Another scan is shown, or the same one with another thickness, or none."""
        if self.scan.is_new:
            self.picks.clear()
            self.clicked.stop()
            self.cut.show(False)
            for layer in self.layers.values():
                layer.forget()
            self.faces.forget_regions()
            self.clip_mm, self.outlining, self._unmeasurable = None, "", ""
            self.drawn.forget()
        if self.scan.view is None or self.picture not in (RELIEF, *self.scan.view.pictures):
            self.picture = RELIEF
        self.read_picture()
        if self.scan.view is not None:
            self.features.look()
        self.changed.emit()
        if self._just_measured and not self.scan.stale:
            self._just_measured = False
            self.measured.emit()
