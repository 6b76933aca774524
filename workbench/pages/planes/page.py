"""The laser planes page: the plate under the fan in the middle; source, plate, laser, poses and result at the side."""

from __future__ import annotations

from PySide6.QtWidgets import QWidget

from workbench.language import text_of
from workbench.pages.calibration.page import CalibrationPage, known
from workbench.pages.calibration.stage import Stage
from workbench.pages.calibration.target_panel import TargetPanel
from workbench.pages.planes import words
from workbench.pages.planes.panels import PLATES, LaserForm, PlanesCard, PlanesLive, PlanesResult
from workbench.pages.planes.picture import PoseTab
from workbench.pages.planes.presenter import PlanesPresenter
from workbench.pages.planes.tabs import HistoryTab, RigTab
from workbench.views.lists.view_list import ListRow
from workbench.views.plots.bars import Bar


class PlanesPage(CalibrationPage):
    """Record, calibrate, judge, accept."""

    UNIT = "mm"
    presenter: PlanesPresenter

    def __init__(self, presenter: PlanesPresenter, parent: QWidget | None = None) -> None:
        super().__init__(presenter, parent)
        self.pose = PoseTab(presenter, lambda: self.source.choose())
        self.rig, self.history = RigTab(presenter), HistoryTab(presenter)
        self._add_tabs(
            (self.pose, self.tr("Picture"), self.tr("One pose with its target, stripes and line numbers")),
            (self.rig, self.tr("3D"), self.tr("Camera, light planes and poses of the plate")),
            (self.history, self.tr("History"), self.tr("Laser planes accepted before; restore them")),
        )
        self.card = PlanesCard(presenter)
        self.add_to_side(self.card)
        self.live = PlanesLive(presenter)
        self._add_source(self.live, self.live.panel, self.tr("Folder with pictures of the plate under the laser"))
        self.target, self.laser = TargetPanel(presenter.target, PLATES), LaserForm(presenter)
        self.target_fold = self.add_panel(self.tr("Plate"), self.target)
        self.laser_fold = self.add_panel(self.tr("Laser"), self.laser)
        self._setup_folds = (self.target_fold, self.laser_fold)
        self.poses_fold = self.add_list(self.tr("Poses"), self.views)
        self.result = PlanesResult(presenter)
        self.result_fold = self.add_panel(self.tr("Result"), self.result)
        self._connect(presenter.choose_pose)

    def refresh(self) -> None:
        self.card.refresh()
        self.target.refresh()
        self.laser.refresh()
        self.live.refresh()
        for widget in (self.target, self.laser):
            widget.setEnabled(not self._is_live())
        self._show_source(self.tr("{0} poses"), first=self.presenter.stage in (Stage.NONE, Stage.EMPTY))
        self._fold()
        self._show_views(self.poses_fold)
        self.result_fold.setVisible(self.result.refresh() and not self._is_live())
        self._refresh_tab()

    def _is_live(self) -> bool:
        return self.presenter.stage is Stage.LIVE

    def _headings(self) -> tuple[str, str]:
        return self.tr("Pose"), self.tr("RMS [mm]")

    def _view_bars(self) -> list[Bar]:
        if self.tabs.currentWidget() is self.history:
            return []
        return [
            Bar(pose.name, known(pose.rms_mm), pose.used, words.pose_sentence(pose.name, pose))
            for pose in self.presenter.poses()
        ]

    def _view_rows(self) -> list[ListRow]:
        p, work = self.presenter, self.presenter.work
        if p.live.running:
            return [ListRow(name, None, self.tr("taken"), thumbnail=picture) for name, picture in p.live_views]
        if work.calibration is not None:
            return [
                ListRow(
                    pose.name, known(pose.rms_mm), words.mm(pose.rms_mm), pose.used,
                    text_of(pose.reason or ""), work.thumbnails.get(pose.name),
                )
                for pose in work.calibration.poses
            ]  # fmt: skip
        left_out = {name.removeprefix("planes/") for name in p.project.options.excluded_in("planes")}
        reasons = {pose.name: text_of(pose.reason or "") for pose in work.poses or () if pose.reason}
        return [
            ListRow(
                path.stem, None, "", path.stem not in left_out and path.stem not in reasons,
                reasons.get(path.stem, ""), work.thumbnails.get(path.stem),
            )
            for path in work.pictures or ()
        ]  # fmt: skip
