"""The laser planes page: the plate under the fan in the middle; source, plate, laser, poses and result at the side."""

from __future__ import annotations

import math
from typing import Any

from PySide6.QtCore import QEvent
from PySide6.QtWidgets import QTabWidget, QWidget

from workbench.pages import planes_words as words
from workbench.pages.planes_panels import PLATES, LaserForm, PlanesCard, PlanesLive, PlanesResult
from workbench.pages.planes_picture import PoseTab
from workbench.pages.planes_presenter import PlanesPresenter
from workbench.pages.planes_stage import Stage
from workbench.pages.planes_tabs import HistoryTab, RigTab
from workbench.pages.step_page import StepPage
from workbench.pages.target_panel import TargetPanel
from workbench.views.live_strip import LiveStrip
from workbench.views.plots import Bar, BarsWithThreshold
from workbench.views.source_chooser import SourceChooser
from workbench.views.tables import ListRow, ViewList
from workbench.wording import in_the_window


class PlanesPage(StepPage):
    """Record, calibrate, judge, accept."""

    presenter: PlanesPresenter

    def __init__(self, presenter: PlanesPresenter, parent: QWidget | None = None) -> None:
        super().__init__(presenter, parent)
        self.strip, self.tabs, self.bars = LiveStrip(presenter.live), QTabWidget(), BarsWithThreshold()
        self.pose = PoseTab(presenter, lambda: self.source.choose())
        self.rig, self.history = RigTab(presenter), HistoryTab(presenter)
        for tab, title, tip in (
            (self.pose, self.tr("Picture"), self.tr("One pose with its target, stripes and line numbers")),
            (self.rig, self.tr("3D"), self.tr("Camera, light planes and poses of the plate")),
            (self.history, self.tr("History"), self.tr("Laser planes accepted before; restore them")),
        ):
            self.tabs.setTabToolTip(self.tabs.addTab(tab, title), tip)
        self.tabs.currentChanged.connect(lambda _: self._refresh_tab())
        self.bars.setFixedHeight(150)
        self.centre.addWidget(self.strip)
        self.centre.addWidget(self.tabs, 1)
        self.centre.addWidget(self.bars)

        self.card = PlanesCard(presenter)
        self.add_to_side(self.card)
        self.live = PlanesLive(presenter)
        self.source = SourceChooser(self.live, what=self.tr("Folder with pictures of the plate under the laser"))
        self.pictures_fold = self.add_panel(self.tr("Pictures"), self.source)
        self.target, self.laser = TargetPanel(presenter.target, PLATES), LaserForm(presenter)
        self.target_fold = self.add_panel(self.tr("Plate"), self.target)
        self.laser_fold = self.add_panel(self.tr("Laser"), self.laser)
        self.poses = ViewList()
        self.poses.setMinimumHeight(240)
        self.poses_fold = self.add_panel(self.tr("Poses"), self.poses)
        self.result = PlanesResult(presenter)
        self.result_fold = self.add_panel(self.tr("Result"), self.result)
        self._rows: Any = None
        self._bars: Any = None
        self._folded = ""
        self._connect()

    def refresh(self) -> None:
        p, stage = self.presenter, self.presenter.stage
        self.card.refresh()
        self.target.refresh()
        self.laser.refresh()
        self.live.refresh()
        for widget in (self.target, self.laser):
            widget.setEnabled(stage is not Stage.LIVE)
        count = len(p.work.pictures) if p.work.pictures is not None else None
        detail = self.tr("{0} poses").format(count) if count is not None and p.folder is not None else ""
        self.source.set_folder(p.folder, detail)
        self.live.panel.set_primary(stage in (Stage.NONE, Stage.EMPTY))
        self._fold(stage)
        self._show_poses()
        self.result_fold.setVisible(self.result.refresh() and stage is not Stage.LIVE)
        self._refresh_tab()

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange and hasattr(self, "_folded"):
            self._changed()

    def _connect(self) -> None:
        p = self.presenter
        self.source.folder_chosen.connect(p.use_folder)
        self.source.accept_drops_on(self)
        self.poses.toggled_together.connect(lambda names, used: p.set_used(list(names), used))
        self.poses.current_changed.connect(p.choose_pose)
        self.bars.bar_clicked.connect(p.choose_pose)
        p.model.opened.connect(self._opened)

    def _opened(self) -> None:
        self._folded = ""
        self.tabs.setCurrentIndex(0)
        self.source.set_mode("folder" if self.presenter.project.sources.planes else "live")

    def _fold(self, stage: Stage) -> None:
        """Once there is a result, it takes the room of what it was made from; the user may unfold that again."""
        live, work = stage is Stage.LIVE, self.presenter.work
        wanted = "live" if live else "result" if work.searching or work.poses is not None else "pictures"
        if wanted == self._folded:
            return
        self._folded = wanted
        if live:
            self.source.set_mode("live")
            self.tabs.setCurrentWidget(self.pose)
        for fold, opened in (
            (self.pictures_fold, wanted != "result"),
            (self.target_fold, wanted == "pictures"),
            (self.laser_fold, wanted == "pictures"),
        ):
            if opened:
                fold.expand(animate=False)
            else:
                fold.collapse(animate=False)

    def _refresh_tab(self) -> None:
        tab: Any = self.tabs.currentWidget()
        tab.refresh()
        self._show_bars()

    def _show_poses(self) -> None:
        rows = self._pose_rows()
        self.poses_fold.setVisible(bool(rows))
        shown = [(row.name, row.text, row.used, row.reason, id(row.thumbnail)) for row in rows]
        if shown != self._rows:
            self._rows = shown
            measured = self.presenter.work.calibration is not None and not self.presenter.live.running
            self.poses.set_headers(self.tr("Pose"), self.tr("RMS (mm)") if measured else "")
            self.poses.set_rows(rows)
        if self.presenter.current and self.poses.current() != self.presenter.current:
            self.poses.set_current(self.presenter.current)

    def _show_bars(self) -> None:
        """The error of each pose, below what it is about."""
        about = self.tabs.currentWidget() is not self.history and not self.presenter.live.running
        poses = self.presenter.poses() if about else ()
        bars = [Bar(pose.name, _known(pose.rms_mm), pose.used, words.pose_sentence(pose.name, pose)) for pose in poses]
        self.bars.setVisible(bool(bars))
        if bars and bars != self._bars:
            self._bars = bars
            self.bars.set_bars(bars, label=self.tr("RMS"), unit="mm")
        self.bars.set_current(self.presenter.current)

    def _pose_rows(self) -> list[ListRow]:
        p, work = self.presenter, self.presenter.work
        if p.live.running:
            return [ListRow(name, None, self.tr("taken"), thumbnail=picture) for name, picture in p.live_views]
        if work.calibration is not None:
            return [
                ListRow(
                    pose.name, _known(pose.rms_mm), words.mm(pose.rms_mm), pose.used, in_the_window(pose.reason),
                    work.thumbnails.get(pose.name),
                )
                for pose in work.calibration.poses
            ]  # fmt: skip
        left_out = {name.removeprefix("planes/") for name in p.project.options.excluded_in("planes")}
        reasons = {pose.name: in_the_window(pose.reason) for pose in work.poses or () if pose.reason}
        return [
            ListRow(
                path.stem, None, "", path.stem not in left_out and path.stem not in reasons,
                reasons.get(path.stem, ""), work.thumbnails.get(path.stem),
            )
            for path in work.pictures or ()
        ]  # fmt: skip


def _known(value: float) -> float | None:
    """None for NaN."""
    return None if math.isnan(value) else value
