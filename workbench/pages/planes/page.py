"""The laser planes page: the plate under the fan in the middle; source, plate, laser, poses and result at the side."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from PySide6.QtWidgets import QWidget

from core.messages import Message, capital
from workbench.language import text_of, tr
from workbench.pages.calibration.page import CalibrationPage
from workbench.pages.calibration.target_panel import TargetPanel
from workbench.pages.planes import words
from workbench.pages.planes.panels import PLATES, LaserForm, PlanesCard, PlanesLive, PlanesResult
from workbench.pages.planes.picture import PoseTab
from workbench.pages.planes.presenter import PlanesPresenter
from workbench.pages.planes.tabs import PlanesHistoryTab, RigTab
from workbench.views import ask


class PlanesPage(CalibrationPage):
    """Page of the laser planes: record, calibrate, judge, accept."""

    UNIT = "mm"
    presenter: PlanesPresenter

    def __init__(self, presenter: PlanesPresenter, parent: QWidget | None = None) -> None:
        super().__init__(presenter, parent)
        self.picture = PoseTab(presenter, self._next_action)
        self.rig, self.history = RigTab(presenter), PlanesHistoryTab(presenter)
        self.card, self.result = PlanesCard(presenter), PlanesResult(presenter)
        self.live: PlanesLive = PlanesLive(presenter)
        self.live_panel = self.live.panel
        self.target, self.laser = TargetPanel(presenter.target, PLATES), LaserForm(presenter)
        self.setup = [(tr("Plate"), self.target), (tr("Laser"), self.laser)]
        self._build(
            (
                (self.picture, tr("Picture"), tr("One pose with its target, stripes and line numbers")),
                (self.rig, tr("3D"), tr("Camera, laser planes and poses of the plate")),
                (self.history, tr("History"), tr("Laser planes accepted before; restore them")),
            ),
            tr("Folder with pictures of the plate under the laser"),
            tr("Poses"),
            tr("Pose"),
        )

        presenter.decide = self._decide

    def _decide(self, minority: Message) -> bool:
        """Ask whether planes of a minority of the poses are to be used."""
        text = tr(
            "{minority}. Look at the poses left out, the plate's size and the camera first. Use these laser planes?",
            minority=capital(text_of(minority)),
        )
        return ask.ask(self, tr("Few poses agree"), text, (tr("Use them"), tr("Do not use them"))) == 0

    def refresh(self) -> None:
        self.live.refresh()
        super().refresh()
        needed = self.presenter.is_needed
        self.side_panel.setVisible(needed)
        self.tabs.tabBar().setVisible(needed)
        if not needed:
            self.tabs.setCurrentWidget(self.picture)

    def _error(self, view: Any) -> float:
        return float(view.rms_mm)

    def _sentence(self, view: Any) -> str:
        return words.pose_sentence(view.name, view)

    def _count(self, count: int) -> str:
        return tr("{count} poses", count=count)

    def _tabs_with_bars(self) -> Sequence[QWidget]:
        return self.picture, self.rig
