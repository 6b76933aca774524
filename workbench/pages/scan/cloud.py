"""The 3D view of the scan page: the cloud as it grows, and the measured one."""

from __future__ import annotations

from typing import Any

import numpy as np
from PySide6.QtWidgets import QWidget

from core.inspect.shown.view_frame import part_frame
from core.pipeline.live.events import LiveView, ScanDetail
from workbench.language import tr
from workbench.pages.frame_tool import FrameTool
from workbench.pages.scan.overlays import PREVIEW_SIGMA_MM
from workbench.pages.scan.presenter import ScanPresenter
from workbench.pages.scan.stage import Stage
from workbench.views.layouts import in_column
from workbench.views.scene.view import Colouring, SceneView

_NOTHING = np.zeros((0, 3), np.float32), np.zeros(0, np.float32)


class ScanCloud(QWidget):
    """Points coloured by σ: the preview while something runs, else the result."""

    def __init__(self, presenter: ScanPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter = presenter
        self._look: Any = None
        self._growing = False
        self._limit = 0.0
        self.scene = SceneView()
        self.scene.setAccessibleName(tr("Measured points in 3D"))
        self.frame = FrameTool(self.scene, presenter.bench.settings)
        in_column(self.scene, on=self)
        self._last = self._message()
        self.scene.clear(self._last)

    def refresh(self) -> None:
        """Show the measured cloud, unless a scan is being recorded or measured."""
        p = self._presenter
        if p.stage in (Stage.LIVE, Stage.MEASURING) or p.work.frames is None:
            return  # what is there grows, or stands until it is clear what comes next
        look, limit = p.work.look, p.largest_sigma_mm
        if look is None or not len(look):
            if self._look is not None or self._growing or not self._said(self._message()):
                self._look, self._growing = None, False
                self.scene.clear(self._message())
            return
        if look is self._look and not self._growing:
            return
        self._look, self._growing = look, False
        self.frame.show(part_frame(None, look.ground))
        self.scene.set_cloud(look.points, values=look.sigma, colouring=Colouring("σ", "mm", (0.0, limit)))

    def begin_live(self) -> None:
        """Clear the view, as a live recording begins."""
        self._look = None
        self.scene.clear(self._message())
        self._grow_anew()

    def begin_measuring(self) -> None:
        """Prepare for a recording to be measured; the old cloud stays until its first points come."""
        self._look, self._growing = None, True
        if not self.scene.state().points:
            self.scene.clear(self._message())

    def show_live(self, view: LiveView) -> None:
        """Add the points that a live view brings."""
        if isinstance(view.detail, ScanDetail):
            self.grow(view.detail)

    def grow(self, detail: ScanDetail) -> None:
        """Add the points of a measured frame, or replace all points if the frame brings all."""
        if detail.renewed:
            self._grow_anew()
        if len(detail.points):
            self.scene.add_points(detail.points.points, detail.points.sigma)

    def _grow_anew(self) -> None:
        self._growing = True
        self.frame.show(None)  # where the part lies is not known before it is measured
        points, sigma = _NOTHING
        self.scene.set_cloud(points, values=sigma, colouring=Colouring("σ", "mm", (0.0, PREVIEW_SIGMA_MM)))

    def _said(self, message: str) -> bool:
        said, self._last = self._last, message
        return said == message

    def _message(self) -> str:
        p = self._presenter
        if p.live.running and not p.calibrated:
            return tr("There are no points without accepted calibrations; the pictures are recorded.")
        if p.live.running or p.run.measuring:
            return tr("The points will grow here.")
        if p.work.look is not None and not p.work.look.problems:
            return tr("No point is certain enough; allow a larger σ in the settings, or scan again.")
        if p.stage is Stage.NONE:
            return tr("The measured points will be here.")
        return p.cannot_measure or tr("Press Measure: the points will grow here.")
