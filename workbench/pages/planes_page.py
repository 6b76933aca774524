"""The laser planes page: the plate under the fan in the middle; source, plate, laser, poses and result at the side."""

from __future__ import annotations

import math
from typing import Any

from PySide6.QtWidgets import QTabWidget, QVBoxLayout, QWidget

from workbench.pages import planes_words as words
from workbench.pages.planes_presenter import PlanesPresenter, Stage
from workbench.pages.planes_tabs import HistoryTab, PoseTab, RigTab
from workbench.pages.step_page import StepPage, heading, muted
from workbench.pages.target_panel import TargetPanel
from workbench.views.forms import SettingsForm
from workbench.views.live_panel import LivePanel, LiveStrip
from workbench.views.plots import Bar, BarsWithThreshold
from workbench.views.source_chooser import SourceChooser
from workbench.views.stage_card import CardButton, StageCard
from workbench.views.tables import ListRow, ViewList
from workbench.views.value_rows import ValueRows

PLATES = ("black_square", "checkerboard", "charuco", "circle_grid")


class PlanesPage(StepPage):
    """Record, calibrate, judge, accept."""

    presenter: PlanesPresenter

    def __init__(self, presenter: PlanesPresenter, parent: QWidget | None = None) -> None:
        super().__init__(presenter, parent)
        self.strip, self.tabs, self.bars = LiveStrip(presenter.live), QTabWidget(), BarsWithThreshold()
        self.pose, self.rig, self.history = PoseTab(presenter), RigTab(presenter), HistoryTab(presenter)
        for tab, title, tip in (
            (self.pose, self.tr("Picture"), self.tr("One pose with its target, stripes and line numbers")),
            (self.rig, self.tr("3D"), self.tr("Camera, light planes and poses of the plate")),
            (self.history, self.tr("History"), self.tr("Laser planes accepted before; restore them")),
        ):
            self.tabs.setTabToolTip(self.tabs.addTab(tab, title), tip)
        self.tabs.currentChanged.connect(lambda _: self._refresh_tab())
        self.bars.setFixedHeight(140)
        self.centre.addWidget(self.strip)
        self.centre.addWidget(self.tabs, 1)
        self.centre.addWidget(self.bars)

        self.card = StageCard(
            [
                CardButton("calibrate", self.tr("Calibrate"), "mdi6.play", presenter.do_run),
                CardButton("accept", self.tr("Accept"), "mdi6.check-bold", presenter.accept),
                CardButton("reject", self.tr("Reject"), "mdi6.close-thick", presenter.reject),
            ]
        )
        self.add_to_side(self.card)
        self.live_panel = LivePanel(presenter.live)
        self.source = SourceChooser(self.live_panel, what=self.tr("Folder with pictures of the plate under the laser"))
        self.add_panel(self.tr("Pictures"), self.source)
        self.target, self.laser = TargetPanel(presenter, PLATES), self._laser_form()
        self.target_fold = self.add_panel(self.tr("Plate"), self.target)
        self.laser_fold = self.add_panel(self.tr("Laser"), self.laser)
        self.poses = ViewList()
        self.poses.set_headers(self.tr("Pose"), self.tr("RMS (mm)"))
        self.poses.setMinimumHeight(220)
        self.poses_fold = self.add_panel(self.tr("Poses"), self.poses)
        self.quality, self.angles, self.verdict, self.notes = ValueRows(), ValueRows(), muted(), muted()
        self.result_fold = self.add_panel(self.tr("Result"), self._result())
        self._rows: Any = None
        self._bars: Any = None
        self._connect()

    def refresh(self) -> None:
        p, stage, calibration = self.presenter, self.presenter.stage, self.presenter.work.calibration
        self._show_stage(stage)
        self.target.refresh()
        rig, options = p.project.rig, p.project.options
        self.laser.set_values(
            {"lines": rig.lines, "angle": math.degrees(rig.angle), "constrain": options.constrain_fan}
        )
        for widget in (self.target, self.laser):
            widget.setEnabled(stage is not Stage.LIVE)
        count = len(p.work.pictures) if p.work.pictures is not None else None
        detail = self.tr("{0} poses").format(count) if count is not None and p.folder is not None else ""
        self.source.set_folder(p.folder, detail)
        if stage is Stage.LIVE:
            self.source.set_mode("live")
            self.tabs.setCurrentWidget(self.pose)
        self._show_poses()
        self.quality.set_rows(words.quality_rows(calibration))
        self.angles.set_rows(words.angle_rows(calibration))
        self.verdict.setText(calibration.verdict if calibration is not None else "")
        self.notes.setText("\n".join(calibration.notes) if calibration is not None else "")
        self.notes.setVisible(bool(self.notes.text()))
        self.result_fold.setVisible(calibration is not None and stage is not Stage.LIVE)
        self._refresh_tab()

    def _connect(self) -> None:
        p = self.presenter
        self.source.folder_chosen.connect(p.use_folder)
        self.source.accept_drops_on(self.pose.image)
        self.laser.edited.connect(self._laser_edited)
        self.poses.toggled.connect(lambda name, used: p.set_used([name], used))
        self.poses.toggled_together.connect(lambda names, used: p.set_used(list(names), used))
        self.poses.current_changed.connect(p.choose_pose)
        self.bars.bar_clicked.connect(p.choose_pose)
        p.model.opened.connect(self._opened)

    def _opened(self) -> None:
        known = bool(self.presenter.project.sources.planes)
        self.tabs.setCurrentIndex(0)
        self.source.set_mode("folder" if known else "live")
        for fold in (self.target_fold, self.laser_fold):
            if known:
                fold.collapse(animate=False)
            else:
                fold.expand(animate=False)

    def _laser_form(self) -> SettingsForm:
        form = SettingsForm()
        form.add_number(
            "lines", self.tr("Lines"), "", self.tr("How many lines the fixed laser draws."), minimum=1, maximum=9
        )
        form.add_number(
            "angle", self.tr("Angle"), "°", self.tr("Between neighbouring lines, as its maker states it."),
            minimum=0.1, maximum=45, decimals=3, step=0.1,
        )  # fmt: skip
        form.add_check(
            "constrain",
            self.tr("Hold the planes to one pencil"),
            self.tr("Steadier; used only where the free planes agree with it."),
        )
        return form

    def _laser_edited(self, key: str, value: Any) -> None:
        self.presenter.set_laser(key, math.radians(value) if key == "angle" else value)

    def _refresh_tab(self) -> None:
        tab: Any = self.tabs.currentWidget()
        tab.refresh()

    def _show_poses(self) -> None:
        rows = self._pose_rows()
        self.poses_fold.setVisible(bool(rows))
        shown = [(row.name, row.text, row.used, row.reason, id(row.thumbnail)) for row in rows]
        if shown != self._rows:
            self._rows = shown
            self.poses.set_rows(rows)
        current = self.presenter.current
        if current and self.poses.current() != current:
            self.poses.set_current(current)
        poses = [] if self.presenter.live.running else self.presenter.poses()
        bars = [Bar(pose.name, _known(pose.rms_mm), pose.used, words.pose_sentence(pose.name, pose)) for pose in poses]
        self.bars.setVisible(bool(bars))
        if bars and bars != self._bars:
            self._bars = bars
            self.bars.set_bars(bars, label=self.tr("RMS"), unit="mm")
        self.bars.set_current(current)

    def _pose_rows(self) -> list[ListRow]:
        p, work = self.presenter, self.presenter.work
        if p.live.running:
            return [ListRow(name, None, self.tr("taken"), thumbnail=picture) for name, picture in p.live_views]
        if work.calibration is not None:
            return [
                ListRow(
                    pose.name, _known(pose.rms_mm), words.mm(pose.rms_mm), pose.used, pose.reason,
                    work.thumbnails.get(pose.name),
                )
                for pose in work.calibration.poses
            ]  # fmt: skip
        left_out = {name.removeprefix("planes/") for name in p.project.options.excluded_in("planes")}
        reasons = {pose.name: pose.reason for pose in work.poses or () if pose.reason}
        return [
            ListRow(
                path.stem, None, "", path.stem not in left_out and path.stem not in reasons,
                reasons.get(path.stem, ""), work.thumbnails.get(path.stem),
            )
            for path in work.pictures or ()
        ]  # fmt: skip

    def _result(self) -> QWidget:
        result = QWidget()
        column = QVBoxLayout(result)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self.quality)
        column.addWidget(heading(self.tr("Angles between the planes")))
        column.addWidget(self.angles)
        column.addWidget(self.verdict)
        column.addWidget(self.notes)
        return result

    def _show_stage(self, stage: Stage) -> None:
        p = self.presenter
        title, sentence = self._words()[stage]
        primary = {
            Stage.SOLVED: "accept",
            Stage.FOUND: "calibrate",
            Stage.FAILED: "calibrate",
            Stage.OUTDATED: "accept" if p.candidate and not p.can_accept else "calibrate",
        }.get(stage, "")
        self.card.show_stage(
            title,
            sentence,
            {
                "calibrate": (p.can_measure, self.tr("Measure all pictures and solve the planes (Ctrl+R)")),
                "accept": (p.can_accept, self.tr("Measure with these laser planes from now on (Ctrl+Return)")),
                "reject": (p.can_reject, self.tr("Do not measure with these laser planes")),
            },
            primary,
        )

    def _words(self) -> dict[Stage, tuple[str, str]]:
        p = self.presenter
        return {
            Stage.NO_CAMERA: (
                self.tr("The camera comes first"),
                self.tr("The planes are seen through the camera: accept its calibration, then come back."),
            ),
            Stage.NONE: (
                self.tr("No pictures yet"),
                self.tr("Choose a folder of pictures of the plate under the fan, or take them with a live source."),
            ),
            Stage.EMPTY: (self.tr("No pictures there"), self.tr("The folder holds no pictures; choose another one.")),
            Stage.FOUND: (
                self.tr("{0} poses, not measured yet").format(len(p.work.pictures or ())),
                self.tr("Check plate and laser below, then press Calibrate."),
            ),
            Stage.LIVE: (
                p.live.state_text(),
                self.tr("Hold the plate into the fan at different distances and tilts; five poses or more."),
            ),
            Stage.MEASURING: (
                self.tr("Measuring the pictures …"),
                self.tr("Target and stripes are found in each pose."),
            ),
            Stage.SOLVING: (self.tr("Solving …"), self.tr("Planes and poses are adjusted together.")),
            Stage.FAILED: (self.tr("No calibration"), p.work.problem),
            Stage.SOLVED: (
                self.tr("Calibrated, not accepted yet"),
                self.tr("Look at the poses and the angles; leave out what is bad, then accept."),
            ),
            Stage.REJECTED: (
                self.tr("Rejected"),
                self.tr("Leave out bad poses, or take other pictures; or accept it after all."),
            ),
            Stage.ACCEPTED: (self.tr("Accepted"), p.state.sentence),
            Stage.OUTDATED: (self.tr("Accepted, but out of date"), p.state.sentence),
        }


def _known(value: float) -> float | None:
    """None for NaN."""
    return None if math.isnan(value) else value
